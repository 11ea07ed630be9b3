"""Patch test, moments of curved pairs, pruning, both algorithms: what multibody.py
leaves out."""

import functools
import math
import unittest

import scenes
from program import converged, shipped

@functools.lru_cache(maxsize=None)
def scene(name, *overrides, ranks=1):
    return converged(shipped(name), {'Output/VTU': 'false', **dict(overrides)}, ranks=ranks)


def pairs(result):
    return {pair['pair']: pair for pair in result.summary['results']['contact']}


class Figures(unittest.TestCase):

    def near(self, value, expected, part, what=''):
        self.assertLessEqual(abs(value - expected), part * abs(expected), '{} {} {}'.format(what, value, expected))

    def test_patch(self):
        for degree in (1, 2):
            for ratio in (0, 0.3):
                for law in ('frictionless', 'bonded'):
                    with self.subTest(degree=degree, ratio=ratio, law=law):
                        result = scene('patch_gmsh', ('Discretization/Degree', degree), ('Solver/Tolerance', 1e-12),
                                       ('Material steel/Poisson ratio', ratio), ('Contact cut/Law', law))
                        # the stress recovered at the nodes equals that of the elements: it is uniform
                        self.assertLess(result.summary['error']['estimate_energy_relative'], 1e-10)
                        self.near(result.summary['results']['max_von_mises'], 10, 1e-10)
                        for row in result.contact:
                            self.near(row['pressure'], 10, 2e-10)

    def test_moments_of_the_two_sides_agree(self):  # and to second order: tests/interface/mortar.cc
        pair, = pairs(scene('hertz', ('Body cylinder/Refine levels', 2), ('Body block/Refine levels', 2),
                            ('Discretization/Refinements', 2), ('Solver/Tolerance', 1e-8),
                            ('Traction load/Traction x', '0'))).values()
        self.assertLess(abs(pair['moment_mismatch']) / pair['normal_force'], 1e-3)  # mm: of a lever of 50
        press = pairs(scene('press_fit', ('Discretization/Refinements', 2), ('Solver/Tolerance', 1e-8)))['fit']
        self.assertLess(abs(press['moment_mismatch']), 1e-3 * 1981 * 20)


class Parts(unittest.TestCase):
    """What no shipped scene has."""

    STIFF = {'elastic': {'Young modulus': '1e5', 'Poisson ratio': '0'}}
    PRESSED = {'pressed': {'Boundary': 'box/top', 'Pressure': '10'}}
    TIGHT = {'Tolerance': '1e-10'}

    def test_foundation_sinks_by_pressure_over_stiffness(self):
        case = scenes.box(materials=self.STIFF, foundations={'soil': {'Boundary': 'box/bottom', 'Normal stiffness': '200',
                                                                      'Tangential stiffness': '50'}},
                          tractions={'pressed': {'Boundary': 'box/top', 'Pressure': '10', 'Traction x': '2'},
                                     'held': {'Boundary': 'box/bottom', 'Traction x': '1'}}, Solver=self.TIGHT)
        energy = converged(case).summary['results']['strain_energy']
        self.assertGreater(energy, 0)
        case = scenes.box(materials=self.STIFF, foundations={'soil': {'Boundary': 'box/bottom', 'Normal stiffness': '200',
                                                                      'Tangential stiffness': '50'}},
                          tractions=self.PRESSED, Solver=self.TIGHT)
        for ranks in (1, 2):
            sinks = converged(case, ranks=ranks).summary['results']['max_displacement']
            self.assertAlmostEqual(sinks / (10 / 200 + 10 / 1e5 * 10), 1, delta=1e-8)

    def stack(self, contacts=None, **sections):
        bodies = {'box': {'Origin': '0, 4', 'Size': '4, 4', 'Cells': '4, 4', 'Material': 'elastic'},
                  'base': {'Size': '10, 4', 'Cells': '15, 6', 'Material': 'elastic'}}
        floor = {'floor': {'Boundary': 'base/bottom', 'Displacement x': '0', 'Displacement y': '0'}}
        kinds = {'contacts': contacts} if contacts else {}
        return scenes.box(materials=self.STIFF, bodies=bodies, supports=floor, tractions=self.PRESSED, Solver=self.TIGHT,
                          Decomposition={'Method': 'METIS', 'Subdomains': '4'}, **kinds, **sections)

    def test_contact_that_is_found_is_the_one_that_would_be_declared(self):
        law = {'Law': 'Coulomb', 'Friction coefficient': '0.3'}
        found = converged(self.stack(**{'Contact search': {'Mode': 'automatic', 'Reach': '0.1', **law}}), ranks=2)
        self.assertIn('found between', found.stdout)
        declared = converged(self.stack({'pair': {'Slave': 'base/top', 'Master': 'box/bottom', **law}}))
        for one, other in zip(found.summary['results']['contact'], declared.summary['results']['contact']):
            self.assertAlmostEqual(one['normal_force'], 40, delta=1e-6)
            self.assertAlmostEqual(one['max_pressure'] / other['max_pressure'], 1, delta=1e-5)

    def test_obstacles_of_all_shapes_agree_on_a_plane(self):
        rows = []
        for shape in ({'Shape': 'half plane', 'Point': '3, -1', 'Normal': '0, 2'},
                      {'Shape': 'polyline', 'Points': '-20 -1; 3 -1; 40 -1'},
                      {'Shape': 'function', 'Height': '-1 + 0*x'}):
            case = scenes.box(obstacles={'plane': shape}, tractions={'pressed': {'Boundary': 'box/top', 'Pressure': '10*(1+x/20)'}},
                              contacts={'ground': {'Slave': 'box/bottom', 'Master': 'plane', 'Law': 'Coulomb',
                                                   'Friction coefficient': '0.4'}}, Solver=self.TIGHT)
            result = converged(case)
            self.assertAlmostEqual(result.summary['results']['contact'][0]['normal_force'], 125, delta=1e-6)
            rows.append([row['pressure'] for row in result.contact])
        for other in rows[1:]:
            for a, b in zip(rows[0], other):
                self.assertAlmostEqual(a, b, delta=1e-5 * max(rows[0]))

    def test_box_inside_a_hole(self):
        case = scenes.box(obstacles={'pipe': {'Shape': 'hole', 'Center': '5, 20', 'Radius': '20.615528128088304'}},
                          tractions=self.PRESSED,
                          contacts={'bed': {'Slave': 'box/bottom', 'Master': 'pipe', 'Law': 'Coulomb',
                                            'Friction coefficient': '0.5'}}, Solver=self.TIGHT)
        result = converged(case)
        self.assertEqual(result.summary['results']['contact'][0]['contact_nodes'], 2)
        # the box bears on its two edges; their normals lean by asin(5 / 20.6), friction keeps them from parting
        sine, cosine, area = 5 / 425 ** 0.5, 20 / 425 ** 0.5, 0.5
        edges = [row for row in result.contact if row['pressure'] > 0]
        self.assertAlmostEqual(sum(row['pressure'] * cosine - abs(row['tangential_traction']) * sine for row in edges) * area,
                               100, delta=1e-6)

    def test_large_friction_coefficients(self):
        stuck = []
        for mu in (2, 5):
            result = converged(shipped('raous'), {'Contact ground/Friction coefficient': mu, 'Output/VTU': 'false'})
            largest = max(row['pressure'] for row in result.contact)
            for row in result.contact:
                self.assertLessEqual(abs(row['tangential_traction']), mu * row['pressure'] + 1e-4 * largest, row)
                if row['status'] == 'slip':  # friction is at its bound and against the slip
                    self.assertAlmostEqual(row['tangential_traction'], -math.copysign(mu * row['pressure'], row['slip']),
                                           delta=1e-4 * largest, msg=row)
            stuck.append([row['status'] for row in result.contact].count('stick'))
        self.assertGreater(stuck[1], stuck[0])


class Tractions(unittest.TestCase):

    @staticmethod
    def blocks(overhang, load, **contact):
        """A block whose top ends the overhang beyond a node of the block on it."""
        return scenes.box(bodies={'lower': {'Size': '{}, 5'.format(5 + overhang), 'Cells': '10, 10', 'Material': 'elastic'},
                                  'upper': {'Origin': '0, 5', 'Size': '10, 5', 'Cells': '20, 10', 'Material': 'elastic'}},
                          supports={'below': {**scenes.HELD, 'Boundary': 'lower/bottom'},
                                    'side': {'Boundary': 'upper/left', 'Displacement x': '0'}},
                          tractions={'load': {'Boundary': 'upper/top', **load}},
                          contacts={'touch': {'Slave': 'upper/bottom', 'Master': 'lower/top', 'Law': 'frictionless',
                                              **contact}},
                          Decomposition={'Method': 'METIS'}, Solver={'Tolerance': '1e-8'})

    def test_slivers_of_slave_nodes_make_no_largest_pressure(self):
        for law in ('frictionless', 'bonded'):
            for overhang in (1e-3, 1e-2, 0.1, 0.2):
                with self.subTest(law=law, overhang=overhang):
                    result = converged(self.blocks(overhang, {'Traction y': '-100*(x<5)'}, Law=law))
                    pair, = result.summary['results']['contact']
                    *inside, last = sorted(result.contact, key=lambda row: row['x'])
                    self.assertEqual(last['x'], 5.5)  # the node of which a sliver faces the lower block
                    self.assertGreater(last['pressure'], 0)
                    self.assertLess(last['pressure'], inside[-1]['pressure'])
                    self.assertEqual(pair['max_pressure'], max(row['pressure'] for row in inside))
                    self.assertAlmostEqual(pair['normal_force'] / 500, 1, delta=1e-9)
                    self.assertAlmostEqual(pair['contact_length'], 5 + overhang, delta=1e-12)

    def test_bonds_carry_tension_and_shear(self):
        bodies = {name: {'Origin': '0, {}'.format(y), 'Size': '10, 5', 'Cells': '{}, 5'.format(n), 'Material': 'elastic'}
                  for name, y, n in (('lower', 0, 10), ('upper', 5, 7))}
        for load, normal, tangential in ((('0', '100'), -1000, 0), (('5', '-100'), 1000, -50)):
            case = scenes.box(materials={'elastic': {'Young modulus': '1e5', 'Poisson ratio': '0'}}, bodies=bodies,
                              supports={'below': {**scenes.HELD, 'Boundary': 'lower/bottom'}},
                              tractions={'load': {'Boundary': 'upper/top', 'Traction x': load[0], 'Traction y': load[1]}},
                              contacts={'bond': {'Slave': 'upper/bottom', 'Master': 'lower/top', 'Law': 'bonded'}},
                              Decomposition={'Method': 'METIS', 'Subdomains': '5'}, Solver={'Tolerance': '1e-10'})
            for ranks in (1, 2):
                result = converged(case, ranks=ranks)
                pair, = result.summary['results']['contact']
                self.assertAlmostEqual(pair['normal_force'], normal, delta=1e-6)
                self.assertAlmostEqual(pair['tangential_force'], tangential, delta=1e-6)
                self.assertAlmostEqual(pair['contact_length'], 10, delta=1e-12)
                self.assertEqual((pair['contact_nodes'], pair['stick_nodes'], pair['open_nodes'], pair['slip_nodes']),
                                 (8, 8, 0, 0))
                for row in result.contact:
                    self.assertEqual((row['status'], row['slip_bound']), ('stick', float('inf')))
                    if load[0] == '0':
                        self.assertAlmostEqual(row['pressure'], -100, delta=1e-6)
                        self.assertAlmostEqual(row['tangential_traction'], 0, delta=1e-6)


class BondsThatMeet(unittest.TestCase):
    """Bodies bonded to each other all around a point: one bond there follows from the others."""

    PLACES = {'a': '0, 0', 'b': '5, 0', 'c': '5, 5', 'd': '0, 5'}
    AROUND = (('a/right', 'b/left'), ('b/top', 'c/bottom'), ('d/right', 'c/left'), ('a/top', 'd/bottom'))

    def around(self, pairs, **more):
        square = {'Size': '5, 5', 'Cells': '4, 4', 'Material': 'elastic'}
        return scenes.box(bodies={name: {'Origin': origin, **square} for name, origin in self.PLACES.items()},
                          supports={'left': {**scenes.HELD, 'Boundary': 'a/left'}, 'upper': {**scenes.HELD, 'Boundary': 'd/left'}},
                          tractions={'load': {'Boundary': 'c/top', 'Traction x': '20', 'Traction y': '-100'}},
                          contacts={'pair {}'.format(i): {'Slave': slave, 'Master': master, 'Law': 'bonded'}
                                    for i, (slave, master) in enumerate(pairs)},
                          Decomposition={'Method': 'METIS'}, Solver={'Tolerance': '1e-10', **more})

    def test_the_last_pair_gives_way_and_the_answer_is_that_of_one_body(self):
        whole = converged(scenes.box(bodies={'box': {**scenes.BOX, 'Cells': '8, 8'}}, supports={'left': scenes.HELD},
                                     tractions={'load': {'Boundary': 'box/top', 'Traction x': '20*(x>5)',
                                                         'Traction y': '-100*(x>5)'}},
                                     Decomposition={'Method': 'METIS'}, Solver={'Tolerance': '1e-10'}))
        energy = whole.summary['results']['strain_energy']
        for pairs in (self.AROUND, self.AROUND[::-1], tuple((master, slave) for slave, master in self.AROUND)):
            tractions = []
            for algorithm, ranks in (('semismooth newton', 1), ('semismooth newton', 2), ('smalbe', 1)):
                with self.subTest(pairs=pairs, algorithm=algorithm, ranks=ranks):
                    result = converged(self.around(pairs, Algorithm=algorithm), ranks=ranks)
                    dual = result.summary['problem']['dual']['total']
                    self.assertEqual(dual, 2 * (20 - 1 - 1) + 2 * 10)  # less the one implied and that of held nodes; supports
                    self.assertAlmostEqual(result.summary['results']['strain_energy'] / energy, 1, delta=1e-6)
                    at_point = [row for row in result.contact if (row['x'], row['y']) == (5, 5)]
                    self.assertEqual([row['pair'] for row in at_point], ['pair 0', 'pair 1', 'pair 2'])
                    tractions.append([value for row in at_point
                                      for value in (row['pressure'], row['tangential_traction'])])
            for other in tractions[1:]:  # they are unique
                for one, expected in zip(other, tractions[0]):
                    self.assertAlmostEqual(one, expected, delta=1e-4)


class Invariance(unittest.TestCase):

    def assert_same(self, a, b, tolerance):
        for name, pair in pairs(a).items():
            other = pairs(b)[name]
            for key in ('normal_force', 'tangential_force', 'max_pressure'):
                scale = max(abs(pair['normal_force']), 1e-300) if 'force' in key else pair['max_pressure']
                self.assertLessEqual(abs(pair[key] - other[key]), tolerance * scale, (name, key))
        for key in ('max_displacement', 'strain_energy'):
            x, y = (r.summary['results'][key] for r in (a, b))
            self.assertLessEqual(abs(x - y), tolerance * abs(x), key)

    def test_algorithm(self):
        for name in ('clamp', 'arch', 'hertz'):
            with self.subTest(name):
                tight = (('Solver/Tolerance', 1e-8),)
                self.assert_same(scene(name, *tight), scene(name, *tight, ('Solver/Algorithm', 'smalbe')), 1e-4)

    def test_pruning(self):
        for name in ('hertz', 'clamp', 'lap_joint'):
            with self.subTest(name):
                tight = (('Solver/Tolerance', 1e-8),)
                pruned, whole = scene(name, *tight), scene(name, *tight, ('Solver/Prune contact', 'false'))
                self.assertLessEqual(pruned.summary['problem']['dual']['normal'],
                                     whole.summary['problem']['dual']['normal'])
                self.assert_same(pruned, whole, 1e-4)

    def test_pruned_nodes_come_back_where_they_would_penetrate(self):
        # a soft box that the load presses flat on the circle: nodes far apart at first touch in the end
        soft = (('Contact circle/Law', 'frictionless'), ('Material elastic/Young modulus', 300),
                ('Obstacle disc/Radius', 5), ('Obstacle disc/Center', '5, -5'),
                ('Decomposition/Cells per block', 5), ('Solver/Tolerance', 1e-8))
        pruned, whole = scene('box_on_circle', *soft), scene('box_on_circle', *soft, ('Solver/Prune contact', 'false'))
        self.assertIn('pruning ', pruned.stdout)
        self.assert_same(pruned, whole, 1e-5)


if __name__ == '__main__':
    unittest.main()
