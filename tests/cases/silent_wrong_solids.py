"""What silent_wrong.py shows in the plane, of solids: scenes that once gave a wrong answer with status 0 and without a word."""

import math
import unittest

import solids
from program import converged, new_path, solve
from silent_wrong import Case, force, only

STEEL = {'Young modulus': '2.1e5', 'Poisson ratio': '0.3'}
BAR = {'Size': '10, 4, 10', 'Cells': '5, 2, 5', 'Material': 'elastic'}
FLOOR = {'Shape': 'half space', 'Point': '0, 0, 0', 'Normal': '0, 1, 0'}
TOUCH = {'Slave': 'bar/bottom', 'Master': 'floor', 'Law': 'frictionless'}
BONDED = {'touch': {**TOUCH, 'Law': 'bonded'}}
DEGREES = [{'Discretization': {'Degree': degree}} for degree in '12']


def held(boundary, y='0'):
    return {'Boundary': boundary, 'Displacement x': '0', 'Displacement y': y, 'Displacement z': '0'}


def bar(**kinds):
    return solids.solid('bar', **{'materials': {'elastic': STEEL}, 'bodies': {'bar': BAR}, 'Decomposition': {'Method': 'none'},
                                  'Solver': {'Tolerance': '1e-8'}, 'obstacles': {'floor': FLOOR}, 'contacts': {'touch': TOUCH},
                                  **kinds})


def two_bars(**kinds):
    return bar(**{'bodies': {'bar': BAR, 'lid': {**BAR, 'Origin': '0, 4, 0', 'Cells': '4, 2, 3'}}, 'obstacles': {},
                  'supports': {'one': held('bar/bottom'), 'two': held('lid/top', '-0.001')},
                  'contacts': {'joint': {'Slave': 'bar/top', 'Master': 'lid/bottom', 'Law': 'frictionless'}}, **kinds})


class Held(Case):
    """Contact nodes whose normal motion supports prescribe."""

    def test_prescribed_penetration_is_refused(self):
        for degree in DEGREES:
            for support in (held('bar/bottom', '-0.1'), {'Boundary': 'bar/bottom', 'Displacement normal': '0.1'},
                            {'Body': 'bar', 'Point': '4, 0, 4', **held('', '-0.1')}):
                support = {key: value for key, value in support.items() if value}
                self.refused(bar(supports={'push': support}, **degree), 4, 'Support push', 'Contact touch', '0.1 mm inside')

    def test_of_two_sides_too_and_on_two_ranks(self):
        for supports in ({'one': held('bar/top'), 'two': held('lid/bottom', '-0.02')},
                         {'one': held('bar/top', '0.02'), 'two': held('lid/bottom')}):
            self.refused(two_bars(supports=supports), 4, 'Support one', 'Support two', 'Contact joint', '0.02 mm inside', ranks=2)

    def test_where_both_agree_the_reaction_is_shared(self):
        result = converged(bar(supports={'rest': held('bar/bottom')}, tractions={'p': {'Boundary': 'bar/top', 'Traction y': '-1'}},
                               Decomposition={'Method': 'METIS', 'Subdomains': '3'}), ranks=2)
        self.near(force(result), [0, 50, 0])
        self.near(force(result, 'supports'), [0, 50, 0])
        self.warned(result, 'Contact touch', 'only the sum')


class Sides(Case):

    def test_a_bond_to_an_obstacle_reports_its_force(self):
        for degree, n in zip(DEGREES, (36, 121)):
            result = converged(bar(tractions={'p': {'Boundary': 'bar/top', 'Traction x': '0.5', 'Traction y': '-1'}},
                                   contacts=BONDED, **degree), ranks=2)
            pair = only(result.summary['results']['contact'])
            self.near(pair['force'], [-50, 100, 0])
            self.assertEqual([pair['contact_nodes'], len(result.contact)], [n, n])

    def test_of_tetrahedra_of_degree_2_too_whose_corners_have_no_area(self):
        mesh = solids.abaqus_block('block', (10, 4, 10), (3, 1, 3))
        for law in ('bonded', 'frictionless'):
            result = converged(bar(bodies={'bar': {'Shape': 'mesh', 'File': mesh, 'Material': 'elastic'}}, Discretization={'Degree': '2'},
                                   tractions={'p': {'Boundary': 'bar/top', 'Traction y': '-1'}}, contacts={'touch': {**TOUCH, 'Law': law}},
                                   supports={} if law == 'bonded' else {'s': {'Boundary': 'bar/left', 'Displacement x': '0',
                                                                              'Displacement z': '0'}}))
            self.near(force(result), [0, 100, 0], 1e-7)
            self.near([sum(row['pressure'] * row['area'] for row in result.contact)], [100], 1e-7)

    def test_one_surface_in_two_pairs(self):
        for slave in ('bar/*', 'bar/bottom where x < 5'):
            self.refused(bar(contacts={'c': TOUCH, 'd': {**TOUCH, 'Slave': slave}}), 2, 'Contact c', 'Contact d', 'face')
        self.refused(two_bars(contacts={'c': {'Slave': 'bar/top', 'Master': 'lid/bottom'},
                                        'd': {'Slave': 'lid/*', 'Master': 'bar/top'}}), 2, 'Contact c', 'Contact d', 'face')

    def test_all_is_reserved(self):
        self.refused(bar(bodies={'all': BAR}, contacts={'touch': {**TOUCH, 'Slave': 'all/bottom'}}), 2, "'all' is reserved")


class AfterLoading(Case):
    """Geometry that no row of contact watches. The bar moves down by 0.2 mm as a whole."""

    DOWN = {'push': held('bar/top', '-0.2')}
    BALL = {'Shape': 'half ball', 'Center': '0, 10, 0', 'Radius': '10', 'Cells around': '64', 'Material': 'elastic'}

    def test_a_reach_that_is_too_small(self):
        plate = {'Size': '8, 2, 8', 'Origin': '-4, -2, -4', 'Cells': '10, 2, 10', 'Material': 'elastic'}
        supports = {'push': held('ball/flat', '-0.6'), 'base': held('plate/bottom')}
        against_floor = {'bodies': {'ball': {**self.BALL, 'Cells around': '32'}}, 'supports': {'push': supports['push']}}
        against_plate = {'bodies': {'ball': self.BALL, 'plate': plate}, 'supports': supports, 'obstacles': {}}
        for master, reach, kinds in (('floor', '0.005', against_floor), ('plate/top', '0.05', against_plate)):
            def reaching(how_far):
                pair = {'Slave': 'ball/surface', 'Master': master, 'Law': 'frictionless', 'Reach': how_far}
                return solve(bar(contacts={'joint': pair}, **kinds))
            self.assertEqual(reaching('auto').status, 0)
            short = reaching(reach)
            self.assertEqual(short.status, 3, short)
            self.assertIn('farther away than the Reach of {} mm'.format(reach), short.stderr)
            self.assertIn('Contact joint/Reach', short.stderr)
        refused = reaching('1e-6')  # no node of the plate is that near
        self.assertEqual(refused.status, 2, refused)
        self.assertIn('within an element', refused.stderr)
        self.assertIn('raise Contact joint/Reach', refused.stderr)

    def within(self, obstacle, depth, **kinds):
        case = bar(supports=self.DOWN, obstacles={'thorn': obstacle}, contacts={'touch': {**TOUCH, 'Master': 'thorn'}}, **kinds)
        result = converged(case)
        self.warned(result, 'obstacle thorn is ' + depth, 'inside body bar at', 'on a face of 2 mm', 'refine')
        return result

    def test_round_obstacles_between_nodes(self):
        for degree in DEGREES:
            self.within({'Shape': 'ball', 'Center': '4.45, -0.31, 5.55', 'Radius': '0.3'}, '0.19 mm', **degree)
            self.within({'Shape': 'cylinder', 'Center': '4.5, -0.31, 5.07', 'Radius': '0.3', 'Axis': '0, 0, 1'}, '0.19 mm', **degree)

    def test_obstacles_that_are_wholly_inside(self):
        self.within({'Shape': 'ball', 'Center': '4.95, -0.12, 5.07', 'Radius': '0.02'}, '0.1 mm')
        self.within({'Shape': 'ball', 'Center': '4.95, -0.1001, 5.07', 'Radius': '0.0001'}, '0.1 mm')
        self.within({'Shape': 'cylinder', 'Center': '4.5, -0.12, 5.07', 'Radius': '0.02', 'Axis': '1, 0, 0.1'}, '0.1 mm')

    def test_narrow_bumps(self):
        for width in (0.3, 0.06):
            self.within({'Shape': 'function', 'Height': 'exp(-((x-5.13)^2+(z-4.9)^2)/{}^2) - 1'.format(width)}, '')

    def test_needles_of_triangles(self):
        for half in (0.1, 0.01):
            base = [(5.13 - half, -3, 4.9 - half), (5.13 + half, -3, 4.9 - half), (5.13 + half, -3, 4.9 + half), (5.13 - half, -3, 4.9 + half)]
            faces = [(base[(i + 1) % 4], base[i], (5.13, -0.05, 4.9)) for i in range(4)]
            path = new_path('needle.stl')
            path.write_text('solid needle\n' + ''.join(
                'facet normal 0 0 0\nouter loop\n' + ''.join('vertex {} {} {}\n'.format(*corner) for corner in face) +
                'endloop\nendfacet\n' for face in faces + [base[:3], (base[0], base[2], base[3])]) + 'endsolid needle\n')
            self.within({'Shape': 'stl', 'File': path}, '0.15 mm')

    def test_bodies_of_degree_2_that_no_pair_joins(self):
        low = {'Size': '4, 2, 4', 'Cells': '2, 2, 2', 'Material': 'elastic'}
        for degree in DEGREES:
            for y, status in ((2, 0), (1.5, 2)):
                case = bar(bodies={'low': low, 'high': {**low, 'Origin': '1, {}, 1'.format(y), 'Size': '2, 2, 2'}}, obstacles={}, contacts={},
                           supports={'floor': held('low/bottom'), 'top': held('high/top', '-0.1')}, **degree)
                result = solve(case)
                self.assertEqual(result.status, status, result)
                if status == 0:
                    self.warned(result, 'body high is 0.1 mm inside body low', 'no contact pair joins the two')
                else:
                    self.assertIn("bodies 'low' and 'high' overlap", result.stderr)


class EndsOfSides(Case):

    def corner_on_plate(self, lifted, **pair):
        clamp = {'Displacement x': '0', 'Displacement y': '0', 'Displacement z': '0'}
        return converged(solids.solid('plate', materials={'elastic': STEEL}, Decomposition={'Method': 'none'}, bodies={
            'block': {'Size': '8, 8, 2', 'Cells': '8, 8, 2', 'Rotation': '10', 'Rotation axis': '0, 0, 1', 'Material': 'elastic'},
            'plate': {'Origin': '-10, -8, -1', 'Size': '22, 8, 4', 'Cells': '30, 8, 4', 'Material': 'elastic'}},
            supports={'floor': {'Boundary': 'plate/bottom', **clamp},
                      'hand': {'Boundary': 'block/top', **clamp, 'Displacement y': lifted}},
            contacts={'pair': {**pair, 'Law': 'frictionless'}}, Solver={'Tolerance': '1e-8'})).summary['results']

    def test_a_master_is_not_extended_beyond_its_edge(self):
        """2270 N between bodies that are apart."""
        results = self.corner_on_plate('0.02', Slave='plate/top', Master='block/bottom')
        self.assertEqual(results['contact'][0]['normal_force'], 0)

    def test_an_edge_is_pressed_along_the_normal_of_the_other_side(self):
        force = self.corner_on_plate('-0.01', Slave='block/bottom', Master='plate/top')['contact'][0]['force']
        self.assertGreater(abs(force[1]), 100)
        self.assertLess(math.hypot(force[0], force[2]), 1e-9 * abs(force[1]))

    def test_pressures_on_slivers_of_tetrahedra_of_degree_2(self):
        """A punch that ends 0.02 mm beyond nodes: 231973 MPa at corners of triangles, whose own area is zero."""
        clamp = {'Displacement x': '0', 'Displacement y': '0', 'Displacement z': '0'}
        for end in (15.02, 15.1):
            mesh = solids.abaqus_block('base', (20, 8, 10), (4, 2, 2))
            scene = solids.solid('punch', materials={'elastic': STEEL}, Decomposition={'Method': 'none'}, bodies={
                'base': {'Shape': 'mesh', 'File': mesh, 'Material': 'elastic'},
                'punch': {'Origin': '5, 8, 0', 'Size': '{}, 4, 10'.format(end - 5), 'Cells': '4, 2, 4', 'Material': 'elastic'}},
                supports={'floor': {'Boundary': 'base/bottom', **clamp}, 'guide': {'Body': 'punch', 'Point': '5, 12, 0', **{
                    key: value for key, value in clamp.items() if key != 'Displacement y'}}},
                tractions={'load': {'Boundary': 'punch/top', 'Pressure': '60'}}, Discretization={'Degree': '2'},
                contacts={'seat': {'Slave': 'base/top', 'Master': 'punch/bottom', 'Law': 'Coulomb', 'Friction coefficient': '0.3'}})
            pair = converged(scene).summary['results']['contact'][0]
            self.assertAlmostEqual(pair['normal_force'], 600 * (end - 5), delta=1)
            self.assertLess(pair['max_pressure'], 600, end)


class Loads(Case):

    def resultant(self, load, **kinds):
        result = converged(bar(tractions={'p': {'Boundary': 'bar/top', **load}}, contacts=BONDED, **kinds))
        sums = only(result.summary['results']['loads'])
        self.near(force(result), [-f for f in sums['force']], 1e-6)
        return sums

    def test_peaks_within_a_face(self):
        for degree in DEGREES:
            for width in (0.5, 0.08):
                sums = self.resultant({'Pressure': '1000*exp(-((x-4.9)^2+(z-5.13)^2)/{}^2)'.format(width)}, **degree)
                total = -1000 * math.pi * width ** 2
                self.near(sums['force'], [0, total, 0], 1e-6)
                self.near(sums['moment'], [-5.13 * total, 0, 4.9 * total], 1e-6)

    def test_jumps(self):
        for degree in DEGREES:
            sums = self.resultant({'Traction y': '-20*(x>2.3 && x<7.1)'}, **degree)
            self.near(sums['force'], [0, -960, 0], 1e-3)

    def test_smooth_formulas_on_tetrahedra(self):
        mesh = solids.abaqus_block('block', (10, 4, 10), (3, 1, 3))
        for degree in DEGREES:
            sums = self.resultant({'Traction y': '-sin(pi*x/10)*cos(z/10)'}, **degree, bodies={
                'bar': {'Shape': 'mesh', 'File': mesh, 'Material': 'elastic'}})
            self.near(sums['force'], [0, -20 / math.pi * 10 * math.sin(1), 0], 1e-8)

    def test_body_forces_on_tetrahedra(self):
        """A constant was warned of as a formula that changes too fast: the rule that it was compared with has no points."""
        mesh = solids.abaqus_block('block', (10, 4, 10), (3, 1, 3))
        for degree in DEGREES:
            result = converged(bar(bodies={'bar': {'Shape': 'mesh', 'File': mesh, 'Material': 'elastic'}}, contacts=BONDED, **degree,
                                   body_forces={'f': {'Bodies': 'bar', 'Force y': '-1*(1 + x/10)'}}))
            self.assertEqual(result.summary['warnings'], [])
            self.near(force(result), [0, 600, 0], 1e-6)

    def test_a_formula_without_end_is_warned_of(self):
        case = bar(tractions={'p': {'Boundary': 'bar/top', 'Traction y': '-1 + 9*sin(1e7*x)*sin(3e6*z)'}}, contacts=BONDED)
        self.warned(solve(case), 'traction p', 'changes faster')


class FormulasAtNodes(Case):

    def formulas(self, contact, **kinds):
        result = converged(bar(supports={'hold': held('bar/left')}, tractions={'p': {'Boundary': 'bar/top', 'Traction y': '-1'}},
                               contacts={'touch': {**TOUCH, **contact}}, **kinds))
        return [text for text in result.summary['warnings'] if 'it is evaluated at nodes only' in text]

    def test_peaks_within_a_face_are_warned_of(self):
        peak = 'exp(-((x-4.9)^2+(z-5.13)^2)/0.3^2)'
        mesh = solids.abaqus_block('block', (10, 4, 10), (3, 1, 3))
        for more in DEGREES + [{'bodies': {'bar': {'Shape': 'mesh', 'File': mesh, 'Material': 'elastic'}}}]:
            for name, contact in (('Slip bound', {'Law': 'Tresca', 'Slip bound': '0.1 + ' + peak}),
                                  ('Gap', {'Gap': '-1e-4*' + peak})):
                with self.subTest(name, **more):
                    text = only(self.formulas(contact, **more))
                    self.assertIn('Contact touch/' + name + ': the formula is', text)
                    self.assertIn('of its face of', text)

    def test_where_nodes_see_it_nothing_is_said(self):
        for contact in ({'Law': 'Tresca', 'Slip bound': '1 + sin(pi*x/10)*cos(z/10)'}, {'Gap': '(x^2+z^2)/2000'}):
            self.assertEqual(self.formulas(contact), [])


def bricks(cells):
    """Path of an .inp with these cuboids (two corners each) as one body with the sets low and up."""
    numbers, elements = {}, []
    for (x, y, z), (u, v, w) in cells:
        corners = [(x, y, z), (u, y, z), (u, v, z), (x, v, z), (x, y, w), (u, y, w), (u, v, w), (x, v, w)]
        elements.append([numbers.setdefault(corner, len(numbers) + 1) for corner in corners])
    lines = ['*NODE'] + ['{}, {}, {}, {}'.format(number, *corner) for corner, number in numbers.items()]
    lines += ['*ELEMENT, TYPE=C3D8, ELSET=block']
    lines += ['{}, {}'.format(k, ', '.join(map(str, element))) for k, element in enumerate(elements, 1)]
    for name, y in (('low', 0), ('up', 1)):
        lines += ['*NSET, NSET=' + name] + [str(number) for corner, number in numbers.items() if corner[1] == y]
    path = new_path('bricks.inp')
    path.write_text('\n'.join(lines) + '\n')
    return path


class Meshes(Case):

    ONE = ((0, 0, 0), (1, 1, 1))

    def scene(self, cells):
        return bar(bodies={'bar': {'Shape': 'mesh', 'File': bricks(cells), 'Material': 'elastic'}}, obstacles={}, contacts={},
                   supports={'low': held('bar/low')}, tractions={'p': {'Boundary': 'bar/up', 'Traction y': '-1'}})

    def test_nodes_inside_faces_and_edges_are_refused(self):
        halves = [((1, 0, 0), (2, 0.5, 1)), ((1, 0.5, 0), (2, 1, 1))]
        quarters = [((1, y, z), (2, y + 0.5, z + 0.5)) for y in (0, 0.5) for z in (0, 0.5)]
        for others in (halves, quarters):
            self.refused(self.scene([self.ONE] + others), 2, 'has a node inside an edge or face at (1, 0.5, 0)')

    def test_a_mesh_without_them_is_taken(self):
        result = converged(self.scene([self.ONE, ((1, 0, 0), (2, 1, 1)), ((0, 0, 1), (1, 1, 3))]))
        self.near(force(result, 'supports'), [0, 4, 0])

    def test_cells_too_flat_for_double_precision_are_refused(self):
        bodies = {'shaft': {'Shape': 'cylinder', 'Radius': '37553.3', 'Length': '8', 'Cells around': '16', 'Cells along axis': '11',
                            'Material': 'elastic'},
                  'ring': {'Shape': 'tube', 'Radius': '40', 'Inner radius': '20', 'Length': '5', 'Center': '0, 0, 1.5', 'Cells around': '16',
                           'Cells along axis': '3', 'Material': 'elastic'}}
        self.refused(solids.solid('flat', bodies=bodies, supports={'end': held('shaft/back'), 'other': held('ring/outer')},
                                  contacts={'fit': {'Slave': 'ring/inner', 'Master': 'shaft/side', 'Law': 'Coulomb',
                                                    'Friction coefficient': '0.3'}},
                                  Decomposition={'Method': 'METIS', 'Subdomains': '12', 'Seed': '8'}), 2, 'subdomain', 'degenerate cells')


class Scales(Case):

    def test_a_soft_pair_beside_a_stiff_one_is_as_accurate(self):
        scene = {kind: {} for kind in ('materials', 'bodies', 'supports', 'tractions', 'contacts')}
        for n, x, modulus, scale in (('0', 40, '2e5', 1), ('1', 0, '2', 1e-6)):
            scene['materials'][n] = {'Young modulus': modulus, 'Poisson ratio': '0.3'}
            scene['bodies']['block' + n] = {'Origin': f'{x}, 0, 0', 'Size': '6, 3, 5', 'Cells': '6, 4, 5', 'Material': n}
            scene['bodies']['base' + n] = {'Origin': f'{x - 2}, -4, -2', 'Size': '10, 4, 9', 'Cells': '7, 3, 6', 'Material': n}
            scene['supports'][n] = held(f'base{n}/bottom')
            scene['tractions'][n] = {'Boundary': f'block{n}/top', 'Traction x': str(10 * scale), 'Traction y': str(-100 * scale),
                                     'Traction z': str(10 / 3 * scale)}
            scene['contacts'][n] = {'Slave': f'block{n}/bottom', 'Master': f'base{n}/top', 'Law': 'Coulomb',
                                    'Friction coefficient': '0.3'}
        stiff, soft = converged(solids.solid('scales', Solver={'Tolerance': '1e-4'}, **scene)).summary['results']['contact']
        self.assertEqual(soft['stick_nodes'], stiff['stick_nodes'])
        for figure in ('tangential_force', 'max_pressure'):
            self.near([1e6 * soft[figure]], [stiff[figure]], 5e-3)


if __name__ == '__main__':
    unittest.main()
