"""Solids from a .prm (Dimension = 3): against GetFEM, the plane and closed forms; invariances; what is refused."""

import math
import unittest

import fields
import scenes
from program import converged, new_path, run, shipped, solve

SOFT = {'Young modulus': '1000', 'Poisson ratio': '0.25', 'Density': '2e-9', 'Thermal expansion': '1e-5'}
BAR = {'Size': '2, 3, 4', 'Cells': '2, 3, 4', 'Material': 'elastic'}
CORNER = {side: {'Boundary': 'box/' + side, 'Displacement normal': '0'} for side in ('left', 'bottom', 'back')}
CUT = {'Method': 'METIS', 'Subdomains': '3'}
SHARP = {'Tolerance': '1e-11'}


def solid(name='solid', **kinds):
    """A .prm in space with the sections of scenes.text(), by default a bar of 2 x 3 x 4 mm."""
    lines = scenes.text(**{'materials': {'elastic': SOFT}, 'bodies': {'box': BAR}, 'Decomposition': CUT, 'Solver': SHARP,
                           **kinds}).split('\n')
    return scenes.write(name, '\n'.join(['set Dimension = 3'] + lines[1:]))  # the first one sets the plane state


def turned(x, angle, axis):
    """Rodrigues; degrees."""
    length = math.sqrt(sum(a * a for a in axis))
    a = [component / length for component in axis]
    cross = [a[1] * x[2] - a[2] * x[1], a[2] * x[0] - a[0] * x[2], a[0] * x[1] - a[1] * x[0]]
    along = sum(p * q for p, q in zip(a, x))
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return [c * x[d] + s * cross[d] + (1 - c) * along * a[d] for d in range(3)]


def text(vector):
    return ', '.join(repr(float(component)) for component in vector)


class Solids(unittest.TestCase):

    def near(self, found, expected, tolerance=1e-8):
        for one, other in zip(found, expected):
            self.assertAlmostEqual(one, other, delta=tolerance * max(1, *map(abs, expected)))

    def refused(self, case, overrides, *words, status=2, options=()):
        result = solve(case, overrides, options=options)
        self.assertEqual(result.status, status, result)
        self.assertIn('\n  remedy: ', result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)

    def figures(self, result):
        summary = result.summary
        pair, results = summary['results']['contact'][0], summary['results']
        return ([results['max_displacement'], results['strain_energy'], results['max_von_mises'], pair['max_pressure'],
                 pair['normal_force'], abs(pair['tangential_force'])],
                [pair[name] for name in ('contact_nodes', 'stick_nodes', 'slip_nodes')])


class CubeOnSphere(Solids):
    """Figures of GetFEM 5.4 and of a prototype in numpy."""

    def test_agrees_with_getfem(self):
        tresca = {'Contact sphere/Law': 'Tresca', 'Contact sphere/Slip bound': 100}
        for overrides, ranks, pressure, force, nodes in (({}, 2, 1709.0033, 17913.706, [45, 2]),
                                                         (tresca, 1, 1666.441, 16889.394, [45])):
            result = converged(shipped('cube_on_sphere'), overrides, ranks=ranks)
            found, counts = self.figures(result)
            self.assertAlmostEqual(found[3] / pressure, 1, delta=1e-6)
            self.assertAlmostEqual(found[4] / force, 1, delta=1e-6)
            self.assertEqual(counts[:len(nodes)], nodes)
            self.check_files(result)

    def test_hexahedra_refined_towards_the_sphere(self):
        """Converged on 48^3 cells: 1740.989 MPa, 18131.36 N."""
        for levels, degree, n_nodes, error in ((1, 2, 145, 4e-3), (2, 1, 330, 3e-2)):
            result = converged(shipped('cube_on_sphere'), {
                'Body cube/Cells': '5, 5, 5', 'Body cube/Refine towards': 'bottom', 'Body cube/Refine levels': levels,
                'Discretization/Degree': degree, 'Decomposition/Method': 'METIS', 'Solver/Tolerance': 1e-6})
            found, counts = self.figures(result)
            self.assertAlmostEqual(found[3] / 1740.989, 1, delta=error)
            self.assertAlmostEqual(found[4] / 18131.36, 1, delta=error)
            self.assertEqual(counts[0], n_nodes)

    def check_files(self, result):
        summary = result.summary
        pair = summary['results']['contact'][0]
        sums = [0] * 6
        for row in result.contact:
            traction = [row['traction_' + d] - row['pressure'] * row['normal_' + d] for d in 'xyz']
            force = [row['area'] * component for component in traction]
            x = [row[d] for d in 'xyz']
            sums = [a + b for a, b in zip(sums, force + [x[1] * force[2] - x[2] * force[1], x[2] * force[0] - x[0] * force[2],
                                                        x[0] * force[1] - x[1] * force[0]])]
            if row['status'] == 'slip':  # along the force, against it
                self.assertAlmostEqual(math.hypot(*(row['traction_' + d] for d in 'xyz')) / row['slip_bound'], 1, delta=1e-6)
                if row['slip'] > 1e-8:
                    work = sum(row['traction_' + d] * row['slip_' + d] for d in 'xyz')
                    self.assertAlmostEqual(work / (row['slip_bound'] * row['slip']), -1, delta=1e-4)
        self.near(sums, pair['force'] + pair['moment'])
        outside = [summary['results'][kind][0] for kind in ('loads', 'supports')] + [pair]
        for what in ('force', 'moment'):
            self.near([sum(one[what][d] for one in outside) for d in range(3)], [0, 0, 0], 1e-5)
        vtp = (result.directory / 'contact_000.vtp').read_bytes()
        n_faces = int(vtp.split(b'NumberOfPolys="')[1].split(b'"')[0])
        self.assertTrue(150 < n_faces <= 256, n_faces)  # without those around pruned nodes
        self.assertEqual(len(list(result.directory.glob('subdomain_000_*.vtu'))), 8)

    def test_ranks_partitions_and_orientation_change_nothing(self):
        coarse = {'Decomposition/Cells per block': 4, 'Solver/Tolerance': 1e-12}
        expected, counts = self.figures(converged(shipped('cube_on_sphere'), coarse))
        metis = {**coarse, 'Decomposition/Method': 'METIS', 'Decomposition/Subdomains': 5, 'Body cube/Cells': '8, 8, 8'}
        move = [1, -2, 3]
        rotated = {**coarse, 'Body cube/Rotation': 37, 'Body cube/Rotation axis': '1, 2, 2', 'Body cube/Translation': text(move),
                   'Obstacle sphere/Center': text(a + b for a, b in zip(turned([5, -100, 5], 37, [1, 2, 2]), move))}
        for overrides, ranks in ((coarse, 2), (metis, 2), (rotated, 1)):
            found, n = self.figures(converged(shipped('cube_on_sphere'), overrides, ranks=ranks))
            self.assertEqual(n, counts)
            for one, other in zip(found, expected):
                self.assertAlmostEqual(one / other, 1, delta=1e-8)


class PlaneStrain(Solids):

    def test_a_layer_between_planes_of_symmetry_is_the_plane(self):
        held = {'held': {'Boundary': 'box/left', 'Displacement x': '0', 'Displacement y': '0'}}
        planes = {'back': {'Boundary': 'box/back', 'Displacement normal': '0'}, 'front': {'Boundary': 'box/front', 'Displacement z': '0'}}
        pressed = {'pressed': {'Boundary': 'box/top', 'Pressure': '500'}}
        for law in ({'Law': 'Tresca', 'Slip bound': '150'}, {'Law': 'Coulomb', 'Friction coefficient': '0.3'}):
            contacts = {'touch': {'Slave': 'box/bottom', 'Master': 'round', **law}}
            plane = scenes.box(plane_state='plane strain', bodies={'box': {'Size': '10, 10', 'Cells': '12, 12', 'Thickness': 2,
                                                                           'Material': 'elastic'}},
                               obstacles={'round': {'Center': '5, -100', 'Radius': '100'}}, supports=held, tractions=pressed,
                               contacts=contacts, Decomposition=CUT, Solver=SHARP)
            space = solid(materials={'elastic': scenes.ELASTIC}, bodies={'box': {'Size': '10, 10, 2', 'Cells': '12, 12, 1',
                                                                                 'Material': 'elastic'}},
                          obstacles={'round': {'Shape': 'cylinder', 'Center': '5, -100, 0', 'Radius': '100'}},
                          supports={**held, **planes}, tractions=pressed, contacts=contacts)
            a, b = converged(plane), converged(space)
            (of_plane, n), (of_space, m) = self.figures(a), self.figures(b)
            self.assertEqual(m, [2 * k for k in n])
            for one, other in zip(of_space[:5], of_plane[:5]):
                self.assertAlmostEqual(one / other, 1, delta=1e-8)
            forces = [result.summary['results']['contact'][0]['force'] for result in (a, b)]
            self.near(forces[1][:2], forces[0], 1e-8)


class LoadsAndSupports(Solids):

    def probe(self, result):
        return result.summary['results']['probes'][0]

    def test_uniform_stress_and_free_expansion(self):
        probes = {'tip': {'Body': 'box', 'Point': '2, 3, 4'}}
        pulled = solid(supports=CORNER, probes=probes, tractions={'pull': {'Boundary': 'box/front where x > -1', 'Traction z': '10*t'},
                                                                  'side': {'Boundary': 'box/top', 'Pressure': '-4'}})
        tip = self.probe(converged(pulled, ranks=2))
        self.near(tip['stress'], [0, 4, 0, 10, 0, 0], 1e-7)
        self.near(tip['displacement'], [-2 * 0.25 * 14 / 1000, 3 * (4 - 2.5) / 1000, 4 * (10 - 1) / 1000], 1e-8)
        self.assertAlmostEqual(tip['von_mises'], math.sqrt(100 - 40 + 16), delta=1e-6)
        warm = scenes.write('warm', solid(supports=CORNER, probes=probes).read_text().replace(
            'set Bodies', 'set Temperatures = sun\nset Bodies') + 'subsection Temperature sun\n  set Change = 100\nend\n')
        tip = self.probe(converged(warm))
        self.near(tip['displacement'], [2e-3, 3e-3, 4e-3], 1e-9)
        self.near(tip['stress'], [0] * 6, 1e-7)

    def test_resultants_of_all_loads(self):
        case = solid(supports={'wall': {'Boundary': 'box/left', **{'Displacement ' + d: '0' for d in 'xyz'}}},
                     tractions={'shear': {'Boundary': 'box/top', 'Traction z': '2*x', 'Pressure': '1'}},
                     body_forces={'spin': {'Angular velocity': '1000', 'Axis': '0, 0, 5', 'Axis direction': '0, 3, 0'},
                                  'weight': {'Acceleration y': '-9810'}},
                     point_loads={'push': {'Body': 'box', 'Point': '2, 3, 0', 'Force x': '5', 'Force z': '-1'}},
                     foundations={'bed': {'Boundary': 'box/bottom', 'Normal stiffness': '10', 'Tangential stiffness': '1'}})
        result = converged(case, ranks=2)
        results = result.summary['results']
        loads = {load['load']: load for load in results['loads']}
        mass = 24 * 2e-9
        self.near(loads['shear']['force'], [0, -8, 16])
        self.near(loads['shear']['moment'], [3 * 16 + 2 * 8, -16 * 2 * 2 / 3, -8])
        self.near(loads['spin']['force'], [mass * 1e6 * 1, 0, mass * 1e6 * (2 - 5)])
        self.near(loads['weight']['force'], [0, -9810 * mass, 0])
        self.near(loads['push']['moment'], [-3, 2, -15])
        all_of = results['loads'] + results['supports'] + results['foundations']
        for what in ('force', 'moment'):
            self.near([sum(one[what][d] for one in all_of) for d in range(3)], [0, 0, 0], 1e-6)
        self.assertLess(result.summary['residuals']['moment_balance'], 1e-10)
        columns = result.rows('history.csv')[0]
        self.assertAlmostEqual(columns['traction shear Fz'], 16, delta=1e-8)
        self.assertAlmostEqual(columns['point load push Mz'], -15, delta=1e-8)

    def test_block_slides_in_a_direction_oblique_to_the_mesh(self):
        """Uniform pressure and shear, nu = 0; two load steps, forth and back."""
        pressure, mu, G = 20, 0.3, 500
        along = (0.6, 0, 0.8)
        shear = [mu * pressure * component for component in along]
        sign = '(t <= 1 ? 1 : -1)'
        moved = {'Boundary': 'box/top', 'Displacement y': -pressure / 1000 * 3}
        moved.update({'Displacement ' + d: '{}*(t <= 1 ? t : 2 - t)'.format(0.1 * component)
                      for d, component in zip('xz', (0.6, 0.8))})
        sides = {side: {'Boundary': 'box/' + side, 'Traction y': '{}*{}*{}'.format(sign, direction, value)}
                 for side, direction, value in (('right', 1, shear[0]), ('left', -1, shear[0]), ('front', 1, shear[2]),
                                                ('back', -1, shear[2]))}
        case = solid(materials={'elastic': {'Young modulus': '1000', 'Poisson ratio': '0'}}, supports={'moved': moved},
                     tractions=sides, obstacles={'floor': {'Shape': 'half space', 'Point': '0, 0, 0', 'Normal': '0, 2, 0'}},
                     contacts={'joint': {'Slave': 'box/bottom', 'Master': 'floor', 'Law': 'Coulomb', 'Friction coefficient': mu}},
                     **{'Load steps': {'Factors': '1, 2'}})
        result = converged(case, ranks=2)
        rows = result.contact
        self.assertEqual({row['status'] for row in rows}, {'slip'})
        first = 0.1 - mu * pressure / G * 3
        second = -0.1 + 2 * mu * pressure / G * 3
        for row in rows:
            way, back = (first, 1) if row['step'] == 0 else (second, -1)
            self.assertAlmostEqual(row['pressure'], pressure, delta=1e-6)
            self.near([row['slip_' + d] for d in 'xyz'], [way * component for component in along], 1e-8)
            self.near([row['traction_' + d] for d in 'xyz'], [-back * component for component in shear], 1e-6)
            self.assertAlmostEqual(row['total_slip'], abs(first if row['step'] == 0 else first + second), delta=1e-8)


class TwoBodies(Solids):
    """Matching meshes, node to node, and others."""

    LOW = {'Size': '4, 2, 3', 'Cells': '4, 2, 3', 'Material': 'elastic'}
    HIGH = {'Size': '4, 2, 2', 'Cells': '4, 3, 2', 'Origin': '1, 2, 0', 'Material': 'elastic'}
    CLAMPED = {'foot': {'Boundary': 'low/bottom', **{'Displacement ' + d: '0' for d in 'xyz'}}}
    SHEARED = {'push': {'Boundary': 'high/top', 'Pressure': '10', 'Traction x': '1.2', 'Traction z': '0.9'}}

    def stack(self, sides=('high/bottom', 'low/top'), law=None, tractions=None, high=None, **kinds):
        law = law or {'Law': 'Coulomb', 'Friction coefficient': '0.4'}
        return solid(bodies={'low': self.LOW, 'high': high or self.HIGH}, supports=self.CLAMPED,
                     tractions=tractions or self.SHEARED, contacts={'joint': {'Slave': sides[0], 'Master': sides[1], **law}},
                     Decomposition={'Method': 'METIS', 'Subdomains': '5'}, **kinds)

    def test_stress_is_uniform_in_the_patch_test(self):
        high = {**self.HIGH, 'Origin': '0, 2, 0', 'Size': '4, 2, 3', 'Cells': '4, 3, 3'}
        roller = {'foot': {'Boundary': 'low/bottom', 'Displacement y': '0'},
                  **{side: {'Boundary': 'low/' + side, 'Displacement normal': '0'} for side in ('left', 'back')}}
        case = solid(bodies={'low': self.LOW, 'high': high}, supports=roller, tractions={'push': {'Boundary': 'high/top', 'Pressure': '10'}},
                     contacts={'joint': {'Slave': 'low/top', 'Master': 'high/bottom', 'Law': 'Tresca', 'Slip bound': '1'}},
                     probes={'in': {'Body': 'high', 'From': '0.3, 2, 0.2', 'To': '3.9, 4, 2.9', 'Number of points': '7'}})
        towards = {'Body low/Refine towards': 'top', 'Body low/Refine levels': 1}
        for overrides, ranks, n_rows in (({}, 2, 20), (towards, 1, 13 * 10), ({**towards, 'Discretization/Degree': 2}, 1, 25 * 19)):
            result = converged(case, overrides, ranks=ranks)
            for row in result.rows('probes.csv', text=('probe',)):
                self.near([row['stress_' + c] for c in ('xx', 'yy', 'xy', 'zz', 'xz', 'yz')], [0, -10, 0, 0, 0, 0], 1e-8)
            self.assertEqual(len(result.contact), n_rows)
            for row in result.contact:
                self.assertAlmostEqual(row['pressure'], 10, delta=1e-7)

    def test_forces_balance_whichever_side_is_the_slave(self):
        found = []
        for sides in (('high/bottom', 'low/top'), ('low/top', 'high/bottom')):
            result = converged(self.stack(sides), ranks=2)
            summary = result.summary
            pair = summary['results']['contact'][0]
            sign = 1 if sides[0].startswith('high') else -1
            self.near([sign * f for f in pair['force']], [-1.2 * 8, 80, -0.9 * 8], 1e-6)  # of the part that overhangs, too
            self.near(pair['moment_mismatch'], [0, 0, 0])
            self.assertGreater(pair['slip_nodes'], 0)
            self.assertGreater(pair['stick_nodes'], 0)
            self.assertLess(summary['residuals']['moment_balance'], 1e-10)
            found.append([summary['results']['max_displacement'], summary['results']['strain_energy'], pair['normal_force'],
                          pair['stick_nodes'], pair['slip_nodes']])
        for one, other in zip(*found):
            self.assertAlmostEqual(one / other, 1, delta=1e-8)

    def test_bonded_halves_are_one_body(self):
        half = {'Size': '2, 3, 4', 'Cells': '2, 3, 4', 'Material': 'elastic'}
        load = {'Traction y': '1', 'Traction z': 'y-1'}
        wall = {'wall': {'Boundary': 'left/left', **{'Displacement ' + d: '0' for d in 'xyz'}}}
        halves = solid(bodies={'left': half, 'right': {**half, 'Origin': '2, 0, 0'}}, supports=wall,
                       tractions={'end': {'Boundary': 'right/right', **load}},
                       contacts={'glue': {'Slave': 'left/right', 'Master': 'right/left', 'Law': 'bonded'}},
                       Decomposition={'Method': 'METIS', 'Subdomains': '4'})
        whole = solid(bodies={'left': {**half, 'Size': '4, 3, 4', 'Cells': '4, 3, 4'}}, supports=wall,
                      tractions={'end': {'Boundary': 'left/right', **load}})
        a, b = converged(halves, ranks=2), converged(whole)
        for name in ('max_displacement', 'strain_energy'):
            self.assertAlmostEqual(a.summary['results'][name] / b.summary['results'][name], 1, delta=1e-9)
        pair = a.summary['results']['contact'][0]
        self.near(pair['force'], [0, 12, 4 * (9 / 2 - 3)], 1e-8)

    def test_meshes_that_do_not_match_are_coupled_by_mortar(self):
        finer = {**self.HIGH, 'Cells': '6, 3, 5'}
        result = converged(self.stack(high=finer), ranks=2)
        pair = result.summary['results']['contact'][0]
        self.near(pair['force'], [-1.2 * 8, 80, -0.9 * 8], 1e-6)
        case = self.stack(high=finer, law={'Law': 'frictionless', 'Discretization': 'node to node'})
        for case, words in ((case, 'the meshes do not match'), (self.stack(high={**self.HIGH, 'Origin': '1, 40, 0'}), 'out of reach'),
                            (self.stack(high={**self.HIGH, 'Origin': '30, 2, 0'}), 'do not')):
            result = solve(case)
            self.assertEqual(result.status, 2, result)
            self.assertIn(words, result.stderr)


class Shapes(Solids):

    def test_volumes_and_surfaces(self):
        half, quarter = math.pi / 2, math.pi / 4
        for shape, more, volume, areas, centre in (
                ('ball', {}, 36 * math.pi, {'surface': 36 * math.pi}, (1, 2, 3)),
                ('half ball', {}, 18 * math.pi, {'surface': 18 * math.pi, 'flat': 9 * math.pi}, (1, 2 - 9 / 8, 3)),
                ('cylinder', {'Length': 4}, 36 * math.pi, {'side': 24 * math.pi, 'back': 9 * math.pi, 'front': 9 * math.pi}, (1, 2, 5)),
                ('tube', {'Length': 4, 'Inner radius': 1, 'Cells along axis': 5}, 32 * math.pi,
                 {'inner': 8 * math.pi, 'outer': 24 * math.pi, 'back': 8 * math.pi, 'front': 8 * math.pi}, (1, 2, 5))):
            body = {'Shape': shape, 'Center': '1, 2, 3', 'Radius': '3', 'Cells around': '32', 'Material': 'elastic', **more}
            loads = {name: {'Boundary': 'box/' + name, 'Traction x': '1'} for name in areas}
            case = solid(bodies={'box': body}, foundations={'bed': {'Boundary': 'box/*', 'Normal stiffness': 1, 'Tangential stiffness': 1}},
                         tractions={**loads, 'closed': {'Boundary': 'box/*', 'Pressure': '1'}}, body_forces={'weight': {'Force y': '1'}},
                         Solver={'Tolerance': '1e-6'}, Output={'VTU': 'false'})
            found = {load['load']: load for load in converged(case).summary['results']['loads']}
            for name, area in areas.items():
                self.assertAlmostEqual(found[name]['force'][0] / area, 1, delta=0.015, msg=shape + name)
            weight = found['weight']
            self.assertAlmostEqual(weight['force'][1] / volume, 1, delta=0.02, msg=shape)
            self.assertAlmostEqual(weight['moment'][2] / weight['force'][1], centre[0], delta=1e-9)
            self.assertAlmostEqual(-weight['moment'][0] / weight['force'][1], centre[2], delta=1e-9)
            self.near(found['closed']['force'] + found['closed']['moment'], [0] * 6, 1e-9)

    def test_tube_on_a_shaft(self):
        """Lame: a tube pressed on a rigid shaft with an overlap."""
        tube = {'Shape': 'tube', 'Radius': '40', 'Inner radius': '20', 'Length': '4', 'Cells around': '48', 'Cells along axis': '1',
                'Material': 'elastic'}
        ends = {side: {'Boundary': 'box/' + side, 'Displacement z': '0'} for side in ('back', 'front')}
        case = solid(materials={'elastic': {'Young modulus': '2.1e5', 'Poisson ratio': '0.3'}}, bodies={'box': tube}, supports=ends,
                     obstacles={'shaft': {'Shape': 'cylinder', 'Center': '0, 0, 0', 'Radius': '20.02'}},
                     contacts={'seat': {'Slave': 'box/inner', 'Master': 'shaft', 'Law': 'Coulomb', 'Friction coefficient': '0.1'}},
                     Solver={'Tolerance': '1e-8'})
        E = 2.1e5 / (1 - 0.09)
        nu = 0.3 / 0.7
        pressure = 0.02 * E / (20 * ((1600 + 400) / (1600 - 400) + nu))
        rows = converged(case).contact
        self.assertEqual(len(rows), 96)
        for row in rows:
            self.assertAlmostEqual(row['pressure'] / pressure, 1, delta=0.02)

    def test_function_and_bore_are_the_shapes_that_they_describe(self):
        held = {'top': {'Boundary': 'box/top', **{'Displacement ' + d: v for d, v in zip('xyz', ('0.01', '-0.05', '0.02'))}}}
        law = {'Slave': 'box/bottom', 'Master': 'floor', 'Law': 'Coulomb', 'Friction coefficient': '0.3'}
        found = []
        for floor in ({'Shape': 'half space', 'Point': '0, -0.3, 0', 'Normal': '-0.1, 1, -0.2'},
                      {'Shape': 'function', 'Height': '-0.3 + 0.1*x + 0.2*z'}):
            found.append(self.figures(converged(solid(supports=held, obstacles={'floor': floor}, contacts={'touch': law}))))
        self.assertEqual(found[0][1], found[1][1])
        for one, other in zip(*(figures for figures, _ in found)):
            self.assertAlmostEqual(one / other, 1, delta=1e-7)


class Refused(Solids):

    def test_what_space_does_not_have(self):
        cube = shipped('cube_on_sphere')
        for name, value, *words in (
                ('Dimension', 4, "Dimension = '4'", '2 (plane), 3 (space)'),
                ('Plane state', 'plane stress', "Plane state = 'plane stress'", 'the plane (Dimension = 2) only'),
                ('Accuracy', '0 %', "Accuracy = '0 %'", 'draft, engineering, reference'),
                ('Goal', 'strain_energy', 'Goal', 'no accuracy'),
                ('Contact sphere/Master', 'cube/top', 'Contact sphere: cube/bottom and cube/top'),
                ('Body cube/Shape', 'disc', "Shape = 'disc'", 'cuboid'), ('Body cube/Size', '10, 10', "Size = '10, 10'"),
                ('Body cube/Thickness', 2, 'Thickness', 'the plane'),
                ('Body cube/Refine towards', 'under', 'Refine towards', "no boundary 'under'"),
                ('Body cube/File', 'a.msh', 'Body cube/File', 'has no meaning for Shape = cuboid'),
                ('Body cube/Rotation axis', '0, 0, 0', "Rotation axis = '0, 0, 0'", 'no length'),
                ('Body cube/Radius', 3, 'Radius', 'has no meaning for Shape = cuboid'),
                ('Obstacle sphere/Shape', 'polyline', "Shape = 'polyline'", 'half space'),
                ('Obstacle sphere/Points', '0 0; 1 0', 'Obstacle sphere/Points', 'the plane'),
                ('Discretization/Degree', 3, "Degree = '3'"),
                ('Support clamp/Boundary', 'cube/inner', "boundary 'inner'", 'front'),
                ('Traction pressed/Pressure', '500*w', 'z', 't')):
            with self.subTest(name):
                self.refused(cube, {name: value}, *words)
        self.refused(shipped('box_on_circle'), {'Support held/Displacement z': 0}, 'space (Dimension = 3) only')
        self.assertEqual(run('--list-parameters', 'text', '--set', 'Dimension=3').stdout.count('Traction pressed/Traction z'), 1)

    def test_sides_that_face_away_or_are_far(self):
        cube = shipped('cube_on_sphere')
        self.refused(cube, {'Contact sphere/Slave': 'cube/top'}, 'face away from each other')
        self.refused(cube, {'Contact sphere/Reach': 1, 'Obstacle sphere/Center': '5, -102, 5'}, 'out of reach')

    def test_free_motions_are_named(self):
        hinge = {'hinge': {'Boundary': 'box/left where y < -1', **{'Displacement ' + d: '0' for d in 'xyz'}}}
        pull = {'pull': {'Boundary': 'box/right', 'Traction z': '1'}}
        point = {'tip': {'Body': 'box', 'Point': '0, 0, 0', **{'Displacement ' + d: '0' for d in 'xyz'}},
                 'other': {'Body': 'box', 'Point': '0, 3, 0', 'Displacement x': '0', 'Displacement z': '0'}}
        self.refused(solid(supports=point, tractions=pull), {}, 'rotation about the axis along (0, -1, 0) through (0, ', status=4)
        self.refused(solid(supports={'floor': {'Boundary': 'box/bottom', 'Displacement y': '0'}}, tractions=pull), {},
                     'body box: ', 'one of 3 free motions', status=4)
        self.refused(solid(supports=hinge), {}, 'no face', "'y < -1'")


def abaqus_block(name, size, n, origin=(0, 0, 0)):
    """Path of an .inp with a block of C3D10, six to a brick, whose sides are sets of nodes."""
    places, elements = {}, []

    def node(twice):  # by twice its place on the lattice
        return places.setdefault(twice, len(places) + 1)

    for i, j, k in ((i, j, k) for i in range(n[0]) for j in range(n[1]) for k in range(n[2])):
        corner = [tuple(2 * (a + (c >> d & 1)) for d, a in enumerate((i, j, k))) for c in range(8)]
        for a, b in ((1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1)):  # from corner 0 to corner 7
            v = [corner[c] for c in (0, a, b, 7)]
            middles = [tuple((p + q) // 2 for p, q in zip(v[a], v[b])) for a, b in ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))]
            elements.append([node(x) for x in v + middles])
    lines = ['*NODE'] + ['{}, {}'.format(number, text(o + s * x / (2 * m) for o, s, x, m in zip(origin, size, place, n)))
                         for place, number in places.items()]
    lines += ['*ELEMENT, TYPE=C3D10, ELSET=block'] + ['{}, {}'.format(1 + e, ', '.join(map(str, element)))
                                                      for e, element in enumerate(elements)]
    for d, (low, high) in enumerate((('left', 'right'), ('bottom', 'top'), ('back', 'front'))):
        for side, at in ((low, 0), (high, 2 * n[d])):
            lines += ['*NSET, NSET=' + side] + [str(number) for place, number in places.items() if place[d] == at]
    path = new_path(name + '.inp')
    path.write_text('\n'.join(lines) + '\n')
    return path


class Quadratic(Solids):
    """Elements of degree 2."""

    TWO = {'Discretization': {'Degree': '2'}}
    LOW, HIGH, CLAMPED, SHEARED, stack = TwoBodies.LOW, TwoBodies.HIGH, TwoBodies.CLAMPED, TwoBodies.SHEARED, TwoBodies.stack

    def test_forces_balance_where_facets_are_covered_in_part(self):
        """One block overhangs the other, meshes that do not match, either side the slave."""
        inp = abaqus_block('low', (4, 2, 3), (4, 2, 3))
        high = {**self.HIGH, 'Cells': '5, 2, 4'}
        for low in (self.LOW, {'Shape': 'mesh', 'File': inp, 'Material': 'elastic'}):
            for sides in (('high/bottom', 'low/top'), ('low/top', 'high/bottom')):
                self.LOW = low
                result = converged(self.stack(sides, high=high, Solver={'Tolerance': '1e-9'}, **self.TWO), ranks=2)
                pair = result.summary['results']['contact'][0]
                sign = 1 if sides[0].startswith('high') else -1
                self.near([sign * f for f in pair['force']], [-1.2 * 8, 80, -0.9 * 8], 1e-6)
                self.near(pair['moment_mismatch'], [0, 0, 0], 1e-9)
                self.assertLess(result.summary['residuals']['moment_balance'], 1e-9)

    def test_moments_balance_on_curved_faces(self):
        """The force of a slave node acts at a mean of nodes, which on a curved face is not the node itself."""
        bodies = {'ball': {'Shape': 'half ball', 'Center': '0, 10, 0', 'Radius': '10', 'Cells around': '8', 'Material': 'elastic'},
                  'plate': {'Size': '10, 5, 10', 'Origin': '-5, -5, -5', 'Cells': '8, 8, 5', 'Material': 'elastic'}}
        fixed = {'Displacement x': '0', 'Displacement z': '0'}
        supports = {'floor': {'Boundary': 'plate/bottom', 'Displacement y': '0', **fixed},
                    'driven': {'Boundary': 'ball/flat', 'Displacement y': '-0.5', **fixed}}
        case = solid(bodies=bodies, supports=supports, contacts={'touch': {'Slave': 'ball/surface', 'Master': 'plate/top', 'Law': 'Coulomb',
                                                                           'Friction coefficient': '0.3'}}, **self.TWO)
        tetrahedra = {'Accuracy': '90 %'}  # hexahedra are divided
        results = converged(case, tetrahedra).summary['results']
        pair, (ball,) = results['contact'][0], [s for s in results['supports'] if s['support'] == 'driven']
        scale = 10 * pair['normal_force']
        for of_supports, mismatch in zip(zip(*(support['moment'] for support in results['supports'])), pair['moment_mismatch']):
            self.assertAlmostEqual((sum(of_supports) + mismatch) / scale, 0, delta=1e-10)
        for of_ball, of_contact in zip(ball['moment'], pair['moment']):
            self.assertAlmostEqual((of_ball + of_contact) / scale, 0, delta=1e-10)

    def volume(self, directory):
        sum_ = 0
        for piece in fields.pieces(directory):
            arrays = fields.read_vtu(piece)
            x, cells, begin = arrays['Points'], [v for (v,) in arrays['connectivity']], 0
            for (end,) in arrays['offsets']:
                corner = [x[v] for v in cells[begin:end]]
                tetrahedra = [(0, 1, 2, 3)] if end - begin == 4 else [(0, 1, 3, 4), (2, 3, 1, 6), (5, 4, 6, 1), (7, 6, 4, 3), (1, 3, 4, 6)]
                for a, b, c, d in tetrahedra:
                    u, v, w = ([q - p for p, q in zip(corner[a], corner[other])] for other in (b, c, d))
                    part = (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])) / 6
                    self.assertGreater(part, 0)
                    sum_ += part
                begin = end
        return sum_

    def test_cantilever(self):
        """Timoshenko: F l^3 / (3 E I) + F l / (kappa G A), the clamped end is stiffer than the plane cross-section by little."""
        E, nu, l, h, b, F = 1000, 0.25, 40, 4, 2, 0.5
        wall = {'wall': {'Boundary': 'box/left', **{'Displacement ' + d: '0' for d in 'xyz'}}}
        load = {'end': {'Boundary': 'box/right', 'Traction y': F / (h * b)}}
        inp = abaqus_block('beam', (l, h, b), (12, 2, 1))
        deflection = F * l ** 3 / (3 * E * b * h ** 3 / 12) + F * l / (5 / 6 * E / (2 * (1 + nu)) * b * h)
        for body in ({'Size': text((l, h, b)), 'Cells': '8, 2, 1'}, {'Shape': 'mesh', 'File': inp}):
            case = solid(bodies={'box': {**body, 'Material': 'elastic'}}, supports=wall, tractions=load,
                         probes={'tip': {'Body': 'box', 'Point': text((l, h / 2, b / 2))},
                                 'in': {'Body': 'box', 'Point': text((l / 2, h, b / 2))}}, **self.TWO)
            result = converged(case, ranks=2)
            tip, inside = result.summary['results']['probes']
            self.assertAlmostEqual(tip['displacement'][1] / deflection, 1, delta=0.01)
            self.assertAlmostEqual(inside['stress'][0] / (-F * l / 2 * 6 / (b * h * h)), 1, delta=0.02)
            self.assertAlmostEqual(self.volume(result.directory), l * h * b, delta=1e-4)

    def test_nearly_incompressible_elements_do_not_lock(self):
        """A bent bar of rubber: coarse hexahedra and tetrahedra against finer hexahedra."""
        rubber = {'Young modulus': '10', 'Poisson ratio': '0.4999'}
        wall = {'wall': {'Boundary': 'box/left', **{'Displacement ' + d: '0' for d in 'xyz'}}}
        load = {'end': {'Boundary': 'box/right', 'Traction y': '0.001'}}
        inp = abaqus_block('rubber', (12, 3, 3), (6, 2, 2))
        found = []
        for body in ({'Size': '12, 3, 3', 'Cells': '6, 2, 2'}, {'Shape': 'mesh', 'File': inp}, {'Size': '12, 3, 3', 'Cells': '12, 4, 4'}):
            case = solid(materials={'elastic': rubber}, bodies={'box': {**body, 'Material': 'elastic'}}, supports=wall, tractions=load,
                         Discretization={'Degree': '2', 'Element': 'nearly incompressible'})
            found.append(converged(case).summary['results']['max_displacement'])
        self.assertAlmostEqual(found[0] / found[2], 1, delta=0.01)
        self.assertAlmostEqual(found[1] / found[2], 1, delta=0.03)

    def test_a_layer_between_planes_of_symmetry_is_the_plane(self):
        held = {'held': {'Boundary': 'box/left', 'Displacement x': '0', 'Displacement y': '0'}}
        planes = {side: {'Boundary': 'box/' + side, 'Displacement normal': '0'} for side in ('back', 'front')}
        pressed = {'pressed': {'Boundary': 'box/top', 'Pressure': '500'}}
        contacts = {'touch': {'Slave': 'box/bottom', 'Master': 'round', 'Law': 'Coulomb', 'Friction coefficient': '0.3'}}
        plane = scenes.box(plane_state='plane strain', bodies={'box': {'Size': '10, 10', 'Cells': '8, 8', 'Thickness': 2, 'Material': 'elastic'}},
                           obstacles={'round': {'Center': '5, -100', 'Radius': '100'}}, supports=held, tractions=pressed,
                           contacts=contacts, Decomposition=CUT, Solver=SHARP, **self.TWO)
        space = solid(materials={'elastic': scenes.ELASTIC}, bodies={'box': {'Size': '10, 10, 2', 'Cells': '8, 8, 1', 'Material': 'elastic'}},
                      obstacles={'round': {'Shape': 'cylinder', 'Center': '5, -100, 0', 'Radius': '100'}},
                      supports={**held, **planes}, tractions=pressed, contacts=contacts, **self.TWO)
        a, b = converged(plane), converged(space, ranks=2)
        (of_plane, n), (of_space, m) = self.figures(a), self.figures(b)
        self.assertEqual(m[0], 3 * n[0])
        for one, other in zip(of_space[:5], of_plane[:5]):
            self.assertAlmostEqual(one / other, 1, delta=1e-8)

    def test_ranks_partitions_and_orientation_change_nothing(self):
        coarse = {'Decomposition/Cells per block': 2, 'Solver/Tolerance': 1e-12, 'Discretization/Degree': 2}
        first = converged(shipped('cube_on_sphere'), coarse)
        expected, counts = self.figures(first)
        vtp = (first.directory / 'contact_000.vtp').read_bytes()
        self.assertEqual(int(vtp.split(b'NumberOfPolys="')[1].split(b'"')[0]), 64)
        move = [1, -2, 3]
        metis = {**coarse, 'Decomposition/Method': 'METIS', 'Decomposition/Subdomains': 5, 'Body cube/Cells': '4, 4, 4'}
        rotated = {**coarse, 'Body cube/Rotation': 37, 'Body cube/Rotation axis': '1, 2, 2', 'Body cube/Translation': text(move),
                   'Obstacle sphere/Center': text(a + b for a, b in zip(turned([5, -100, 5], 37, [1, 2, 2]), move))}
        for overrides, ranks in ((coarse, 2), (metis, 2), (rotated, 1)):
            found, n = self.figures(converged(shipped('cube_on_sphere'), overrides, ranks=ranks))
            self.assertEqual(n, counts)
            for one, other in zip(found, expected):
                self.assertAlmostEqual(one / other, 1, delta=1e-8)


class Shipped(Solids):
    """Bodies in contact: the figures in the headers of the .prm files."""

    def test_ring_on_a_shaft(self):
        result = converged(shipped('ring_on_shaft'))
        lame = 0.02 * 2.1e5 / (1 - 0.09) / (20 * ((1600 + 400) / (1600 - 400) + 1))
        for row in result.contact:
            self.assertAlmostEqual(row['pressure'] / lame, 1, delta=0.006)
            self.assertEqual(row['status'], 'stick')
        self.assertEqual(result.summary['warnings'], [])

    def test_oblique_blocks(self):
        joint = converged(shipped('oblique_blocks'), {'Solver/Tolerance': 1e-8}).summary['results']['contact'][0]
        self.near(joint['force'], [-96, 800, -128], 1e-6)
        self.refused(shipped('oblique_blocks'), {'Contact joint/Friction coefficient': 0.19}, 'body box: translation along', status=4)


if __name__ == '__main__':
    unittest.main()
