"""Patch test, Raous block at its published mesh, moments of curved pairs, pruning, both algorithms: what multibody.py
leaves out."""

import functools
import unittest

from program import SOURCE, converged, shipped

# u_x [um] of the Raous block on 128 x 128 bilinear elements: doc/ (method, section 8)
RAOUS = {0: 28.602, 1.25: 27.225, 5: 22.867, 7.5: 19.807, 11.25: 15.413}


@functools.lru_cache(maxsize=None)
def scene(name, *overrides, ranks=1):
    return converged(shipped(name), {'Output/VTU': 'false', **dict(overrides)}, ranks=ranks)


def pairs(result):
    return {pair['pair']: pair for pair in result.summary['results']['contact']}


def at(rows, x):
    return min(rows, key=lambda row: abs(row['x'] - x))


class Figures(unittest.TestCase):

    def near(self, value, expected, part, what=''):
        self.assertLessEqual(abs(value - expected), part * abs(expected), '{} {} {}'.format(what, value, expected))

    def test_every_answer_is_checked(self):
        for path in sorted((SOURCE / 'prm').glob('*.prm')):
            with self.subTest(path.stem):
                residuals = scene(path.stem).summary['residuals']
                for name in ('force_balance', 'moment_balance', 'nodal_equilibrium'):
                    self.assertLess(residuals[name], 1e-8, name)

    def test_raous_block(self):
        result = scene('raous', ('Body block/Cells', '128, 128'), ('Solver/Tolerance', '1e-8'), ranks=2)
        rows = result.contact
        for x, expected in RAOUS.items():
            self.assertLess(abs(1e3 * at(rows, x)['slip'] - expected), 1e-3, x)
        where = {status: [row['x'] for row in rows if row['status'] == status] for status in ('open', 'slip', 'stick')}
        self.assertLess(max(where['open']), 3.4 + 40 / 128)
        self.assertLess(abs(max(where['slip']) - 28.75), 1.)  # published to the element of a coarser mesh
        self.assertLess(abs(min(where['stick']) - 30), 40 / 128)

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

    def test_moments_of_the_two_sides_agree_to_second_order(self):
        mismatch = []
        for n in (0, 1, 2):
            pair, = pairs(scene('hertz', ('Body cylinder/Refine levels', 2), ('Body block/Refine levels', 2),
                                ('Discretization/Refinements', n), ('Solver/Tolerance', 1e-8),
                                ('Traction load/Traction x', '0'))).values()
            mismatch.append(abs(pair['moment_mismatch']) / pair['normal_force'])
        self.assertLess(mismatch[2], 1e-3)  # mm: of a lever of 50
        press = [abs(pairs(scene('press_fit', ('Discretization/Refinements', n),
                                 ('Solver/Tolerance', 1e-8)))['fit']['moment_mismatch']) for n in (0, 1, 2)]
        self.assertLess(press[2], 1e-3 * 1981 * 20)



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
