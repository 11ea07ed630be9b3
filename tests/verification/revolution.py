"""Bodies of revolution (Plane state = axisymmetric): closed forms, patch test, invariance, diagnosis. Figures: doc of the scenes in
prm/ (hertz_ball, push_out, circular_punch); 1/E* = 2 (1 - nu^2) / E between equal bodies."""

import math
import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / 'cases'))

import scenes  # noqa: E402
from program import SOURCE, converged, run, shipped, solve  # noqa: E402

QUIET = {'Output/VTU': 'false'}
STEEL = {'Young modulus': '2.1e5', 'Poisson ratio': '0.3'}
PRECISE = {'Tolerance': '1e-10'}
PARTS = {'Method': 'METIS', 'Subdomains': '6'}


def axisymmetric(**kinds):
    kinds = {'materials': {'steel': STEEL}, 'Decomposition': PARTS, 'Solver': PRECISE, **kinds}
    for body in kinds['bodies'].values():
        body.setdefault('Material', 'steel')
    return scenes.box('revolution', plane_state='axisymmetric', **kinds)


def pressures(result):
    return sorted((row['x'], row['pressure']) for row in result.contact)


def fitted_hertz(result):
    """Radius and largest pressure from p^2 = p0^2 (1 - r^2 / a^2) by least squares, weighted with r, above p0 / 5."""
    nodes = pressures(result)
    largest = max(p for r, p in nodes)
    nodes = [(r * r, p * p, r + 1e-3) for r, p in nodes if p > 0.2 * largest]
    w = sum(n[2] for n in nodes)
    x = sum(n[2] * n[0] for n in nodes) / w
    y = sum(n[2] * n[1] for n in nodes) / w
    slope = sum(n[2] * (n[0] - x) * (n[1] - y) for n in nodes) / sum(n[2] * (n[0] - x)**2 for n in nodes)
    square = y - slope * x
    return math.sqrt(square / -slope), math.sqrt(square), largest


class Hertz(unittest.TestCase):

    def check(self, result, a, p0, part=0.01):
        fitted_a, fitted_p0, largest = fitted_hertz(result)
        self.assertLess(abs(fitted_a / a - 1), part, fitted_a)
        self.assertLess(abs(fitted_p0 / p0 - 1), part, fitted_p0)
        self.assertLess(abs(largest / p0 - 1), part, largest)
        force = result.summary['results']['contact'][0]['force']
        self.assertAlmostEqual(force[1] / 1000, 1, delta=2e-4)  # the flat of the ball is a circle of 50 mm

    def test_ball_on_block(self):
        for overrides in ({}, {'Discretization/Degree': 2, 'Discretization/Refinements': 0}):
            with self.subTest(overrides):
                self.check(converged(shipped('hertz_ball'), {**QUIET, **overrides}, ranks=2), 0.6875, 1010.1)

    def test_ball_on_a_rigid_half_space(self):
        ball = {'Shape': 'mesh', 'File': str(SOURCE / 'meshes' / 'ball.msh'), 'Part': 'ball'}
        case = axisymmetric(bodies={'ball': ball},
                            obstacles={'ground': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}},
                            tractions={'load': {'Boundary': 'ball/flat', 'Pressure': '0.127323954473516'}},
                            contacts={'touch': {'Slave': 'ball/contact of ball', 'Master': 'ground'}},
                            Discretization={'Refinements': '1'}, Solver={'Tolerance': '1e-6'})
        for degree in (1, 2):
            with self.subTest(degree=degree):
                self.check(converged(case, {**QUIET, 'Discretization/Degree': degree}), 0.5457, 1603.4, 0.012)


def press_fit(bore, law, pressure='0'):
    shaft = {'Origin': '{}, 0'.format(bore), 'Size': '{}, 30'.format(20 - bore), 'Cells': '8, 12'}
    ring = {'Origin': '20, 0', 'Size': '20, 30', 'Cells': '9, 15'}
    return axisymmetric(bodies={'shaft': shaft, 'ring': ring},
                        supports={'shaft end': {'Boundary': 'shaft/bottom', 'Displacement y': '0'},
                                  'ring end': {'Boundary': 'ring/bottom', 'Displacement y': '0'}},
                        contacts={'fit': {'Slave': 'ring/left', 'Master': 'shaft/right', 'Offset': '-0.02', **law}})


class PressFit(unittest.TestCase):

    def test_pressure_and_hoop_stress_of_lame(self):
        for bore, pressure in ((0, 78.75), (10, 63.0)):
            with self.subTest(bore=bore):
                result = converged(press_fit(bore, {'Law': 'frictionless'}), {**QUIET, 'Discretization/Degree': 2})
                for r, p in pressures(result):
                    self.assertLess(abs(p / pressure - 1), 1e-3)
                results = result.summary['results']
                self.assertAlmostEqual(results['max_hoop_stress'] / (5 / 3 * pressure), 1, delta=5e-3)
                self.assertAlmostEqual(results['contact'][0]['normal_force'] / (2 * math.pi * 20 * 30 * pressure), 1, delta=1e-3)

    def test_pushed_out(self):
        result = converged(shipped('push_out'), QUIET, ranks=2)
        steps = [step['contact'][0] for step in result.summary['steps']]
        self.assertLess(abs(steps[0]['normal_force'] / (2 * math.pi * 20 * 30) / 63 - 1), 0.025)
        area = math.pi * (20**2 - 10**2)
        for step, factor in zip(steps, (0, 0.25, 0.5, 0.75, 1)):
            self.assertAlmostEqual(step['force'][1] / (area * 35), -factor, delta=1e-6)
        self.assertEqual(result.summary['results']['contact'][0]['moment'], 0)
        beyond = solve(shipped('push_out'), {**QUIET, 'Traction push/Pressure': '45*t'})
        self.assertEqual(beyond.status, 4, beyond)
        self.assertIn('body shaft: translation along the axis', beyond.stderr)


class HalfSpace(unittest.TestCase):

    def test_flat_punch(self):
        for degree, refinements in ((1, 1), (2, 0)):
            with self.subTest(degree=degree):
                result = converged(shipped('circular_punch'), {**QUIET, 'Discretization/Degree': degree,
                                                               'Discretization/Refinements': refinements})
                force = -result.summary['results']['contact'][0]['force'][1]
                self.assertLess(abs(force / 1000 - 1), 0.012)
                inside = [(r, p) for r, p in pressures(result) if r < 3]
                for r, p in inside:
                    self.assertLess(abs(p * 2 * math.pi * 25 * math.sqrt(1 - r * r / 25) / force - 1), 0.02, r)
                self.assertLess(abs(inside[0][1] * 2 * math.pi * 25 / force - 1), 0.01)

    def test_uniform_pressure_of_love(self):
        """The depths are read from the gaps to a plane above, which nothing touches."""
        half_space = {'Shape': 'mesh', 'File': str(SOURCE / 'meshes' / 'half_space.msh')}
        case = axisymmetric(bodies={'half': half_space},
                            obstacles={'above': {'Shape': 'half plane', 'Point': '0, 0.01', 'Normal': '0, -1'}},
                            supports={'bottom': {'Boundary': 'half/bottom', 'Displacement y': '0'}},
                            tractions={'press': {'Boundary': 'half/circle', 'Pressure': '100'}},
                            contacts={'far': {'Slave': 'half/circle', 'Master': 'above'}},
                            Solver={'Tolerance': '1e-8', 'Prune contact': 'false'})
        for degree, refinements, part in ((1, 1, 0.01), (2, 0, 0.005)):
            with self.subTest(degree=degree):
                result = converged(case, {**QUIET, 'Discretization/Degree': degree, 'Discretization/Refinements': refinements})
                depths = sorted((row['x'], row['gap'] - 0.01) for row in result.contact)
                self.assertLess(abs(depths[0][1] / 4.333e-3 - 1), part, depths[0])
                self.assertLess(abs(depths[-1][1] / 2.759e-3 - 1), part, depths[-1])
                self.assertEqual(depths[-1][0], 5)
                self.assertAlmostEqual(result.summary['results']['loads'][0]['force'][1] / (-100 * math.pi * 25), 1, delta=1e-9)


class Patch(unittest.TestCase):
    """Two cylinders, one on the other, whose meshes do not match: uniform axial stress, and with it radial and hoop stress."""

    def check(self, overrides, lateral, bodies=None):
        bodies = bodies or {'lower': {'Size': '6, 3', 'Cells': '5, 3'},
                            'upper': {'Origin': '0, 3', 'Size': '6, 3', 'Cells': '7, 4'}}
        side = {name: {'Boundary': name + '/right', 'Pressure': str(lateral)} for name in bodies}
        case = axisymmetric(bodies=bodies,
                            supports={'ground': {'Boundary': 'lower/bottom', 'Displacement y': '0'}},
                            tractions={'press': {'Boundary': 'upper/top', 'Pressure': '100'}, **(side if lateral else {})},
                            contacts={'joint': {'Slave': 'upper/bottom', 'Master': 'lower/top', 'Law': 'frictionless',
                                                'Discretization': 'mortar'}}, Solver={'Tolerance': '1e-12'})
        result = converged(case, {**QUIET, **overrides})
        rows = pressures(result)
        for r, p in rows:
            self.assertLess(abs(p / 100 - 1), 1e-10, (r, p, overrides))
        results = result.summary['results']
        for key in ('min_hoop_stress', 'max_hoop_stress'):
            self.assertLess(abs(results[key] + lateral), 1e-8, key)
        self.assertLess(abs(results['max_von_mises'] - (100 - lateral)), 1e-8)
        self.assertAlmostEqual(results['contact'][0]['force'][1] / (100 * math.pi * 36), 1, delta=1e-12)
        return rows

    def test_uniform_stress(self):
        for lateral in (0, 40):
            for degree in (1, 2):
                rows = self.check({'Discretization/Degree': degree}, lateral)
                # the node on the axis has a multiplier with degree 1 alone
                self.assertEqual(rows[0][0] == 0, degree == 1)
            self.check({'Discretization/Degree': 2, 'Discretization/Element': 'nearly incompressible'}, lateral)

    def test_away_from_the_axis(self):
        rings = {'lower': {'Origin': '2, 0', 'Size': '4, 3', 'Cells': '5, 3'},
                 'upper': {'Origin': '2, 3', 'Size': '4, 3', 'Cells': '7, 4'}}
        case = axisymmetric(bodies=rings,
                            supports={'ground': {'Boundary': 'lower/bottom', 'Displacement y': '0'}},
                            tractions={'press': {'Boundary': 'upper/top', 'Pressure': '100'}},
                            contacts={'joint': {'Slave': 'upper/bottom', 'Master': 'lower/top', 'Law': 'frictionless'}},
                            Solver={'Tolerance': '1e-12'})
        for r, p in pressures(converged(case, QUIET)):
            self.assertLess(abs(p / 100 - 1), 1e-10, r)


class Program(unittest.TestCase):

    def test_ranks_and_partitions_agree(self):
        case, reference = press_fit(10, {'Law': 'Coulomb', 'Friction coefficient': '0.15'}), None
        for ranks, parts in ((1, 1), (1, 5), (2, 5), (3, 8)):
            result = converged(case, {**QUIET, 'Decomposition/Subdomains': parts}, ranks=ranks)
            rows = sorted((row['y'], row['pressure'], row['tangential_traction']) for row in result.contact)
            reference = reference or rows
            for one, other in zip(rows, reference):
                for a, b in zip(one, other):
                    self.assertAlmostEqual(a, b, delta=1e-8 * 63)

    def test_a_body_without_support_along_the_axis_is_named(self):
        case = axisymmetric(bodies={'pin': {'Size': '2, 10', 'Cells': '2, 8'}},
                            obstacles={'wall': {'Shape': 'half plane', 'Point': '2.1, 0', 'Normal': '-1, 0'}},
                            tractions={'pull': {'Boundary': 'pin/top', 'Traction y': '5'}},
                            contacts={'touch': {'Slave': 'pin/right', 'Master': 'wall'}})
        result = solve(case, QUIET)
        self.assertEqual(result.status, 4, result)
        self.assertIn('body pin: translation along the axis', result.stderr)

    def test_check_and_log_say_that_forces_are_those_of_the_circumference(self):
        result = run(shipped('push_out'), '--check')
        self.assertEqual(result.status, 0, result)
        self.assertIn('forces are those over the whole circumference', result.stdout)
        self.assertIn('kernel', result.stdout)

    def test_sections_beyond_the_axis_are_refused(self):
        case = axisymmetric(bodies={'ball': {'Shape': 'disc', 'Radius': '5', 'Center': '0, 5'}},
                            obstacles={'ground': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}},
                            contacts={'touch': {'Slave': 'ball/arc', 'Master': 'ground'}})
        for ranks in (1, 2):
            result = solve(case, QUIET, ranks=ranks)
            self.assertEqual(result.status, 2, result)
            for words in ('Body ball', 'x = -5 mm', 'x >= 0'):
                self.assertIn(words, result.stderr)


if __name__ == '__main__':
    unittest.main()
