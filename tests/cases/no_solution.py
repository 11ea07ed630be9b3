"""Scenes without equilibrium end with status 4, solves that stop early with status 3; both say so in summary.json."""

import math
import pathlib
import re
import unittest

import scenes
from program import run, shipped, solve

PULLED = {'Boundary': 'box/top', 'Traction y': '250'}
PUSHED = {'Boundary': 'box/left', 'Traction x': '2'}  # 20 N
WEIGHT = {'Boundary': 'box/top', 'Traction y': '-10'}
ROLLER = {'Boundary': 'box/left', 'Displacement x': '0'}
GIVING = {**scenes.CIRCLE, 'Slip bound': '1'}  # 10 N on the whole bottom
METIS = {'Decomposition/Method': 'METIS', 'Decomposition/Subdomains': '5'}


class NoEquilibrium(unittest.TestCase):

    def refused(self, case, *words, overrides=None, ranks=(1, 2, 3)):
        for n in ranks:
            with self.subTest(ranks=n):
                result = solve(case, overrides, ranks=n)
                self.assertEqual(result.status, 4, result)
                self.assertTrue(result.stderr.startswith('error: '), result)
                self.assertEqual(len(result.stderr.splitlines()), 2, result)
                self.assertIn('\n  remedy: ', result.stderr)
                for word in ('box',) + words:
                    self.assertIn(word, result.stderr, result)
                summary = result.summary
                self.assertEqual(summary['status'], 'no equilibrium')
                self.assertIs(summary['converged'], False)
                self.assertEqual(summary['ranks'], n)
                self.assertEqual(result.files(), ['summary.json'], 'half-written')

    def test_box_pulled_off_the_circle(self):
        case = scenes.box(tractions={'pulled': PULLED}, contacts={'circle': scenes.CIRCLE})
        self.refused(case, 'translation along (')

    def test_box_pulled_off_the_circle_under_metis(self):
        case = scenes.box(tractions={'pulled': PULLED}, contacts={'circle': scenes.CIRCLE})
        self.refused(case, 'translation along (', overrides=METIS, ranks=(2,))

    def test_frictionless_box_pulled_off_the_circle(self):
        case = scenes.box(tractions={'pulled': PULLED},
                          contacts={'circle': {key: scenes.CIRCLE[key] for key in ('Slave', 'Master')}})
        self.refused(case, 'body box', ranks=(2,))

    def test_box_pushed_beyond_the_slip_bound(self):
        case = scenes.box(tractions={'pushed': PUSHED, 'weight': WEIGHT}, contacts={'circle': GIVING})
        self.refused(case, 'body box', ranks=(1, 3))

    def test_blocks_pushed_along_floors_of_nearly_one_direction(self):
        """The proof settled while normal forces on the tilted parts of the floor still grew: status 3 after 813 and 1446
        multiplications."""
        for name in ('tresca_overload', 'coulomb_overload'):
            result = run(str(pathlib.Path(__file__).parent / (name + '.prm')))
            self.assertEqual(result.status, 4, result)
            self.assertIn('no contact forces within their bounds balance the loads, which move body b0: translation', result.stderr)

    def test_box_pushed_below_the_slip_bound_is_held(self):
        case = scenes.box(tractions={'pushed': {**PUSHED, 'Traction x': '0.1'}, 'weight': WEIGHT},
                          contacts={'circle': GIVING})
        result = solve(case, {'Solver/Tolerance': 1e-8}, ranks=2)
        self.assertEqual(result.status, 0, result)
        pair = result.summary['results']['contact'][0]
        self.assertAlmostEqual(pair['normal_force'] / 100, 1, delta=0.05)  # the circle carries the weight
        self.assertGreater(pair['contact_nodes'], 0)

    def test_body_on_rollers(self):
        case = scenes.box(supports={'roller': ROLLER}, tractions={'weight': WEIGHT})
        self.refused(case, 'nothing holds body box', 'translation along (', ranks=(1, 3))

    def test_body_on_rollers_under_metis(self):
        case = scenes.box(supports={'roller': ROLLER}, tractions={'weight': WEIGHT})
        self.refused(case, 'nothing holds body box', 'translation along (', overrides=METIS, ranks=(2,))

    def test_check_finds_the_free_body_and_writes_nothing(self):
        case = scenes.box(supports={'roller': ROLLER}, tractions={'weight': WEIGHT})
        result = run(case, '--check', ranks=2)
        self.assertEqual(result.status, 4, result)
        self.assertIn('nothing holds body box', result.stderr)


class FrictionTooWeak(unittest.TestCase):
    """The shipped ring on its shaft: closed form and coarse mesh agree that it holds up to 1.004 times the torque of turn = 1."""

    def twisted(self, turn, **settings):
        return solve(shipped('ring_on_shaft'), {'Variables/turn': turn, **settings})

    def test_says_what_part_of_the_load_friction_bears(self):
        for turn in (1.1, 2):
            with self.subTest(turn=turn):
                result = self.twisted(turn)
                self.assertEqual(result.status, 4, result)
                found = re.search(r'friction is too weak: .* bears ([0-9.]+) of the load that moves body shaft: rotation about '
                                  r'the axis along \(0, 0, -1\) through \(0, 0, 2.5\)', result.stderr)
                self.assertTrue(found, result)
                self.assertAlmostEqual(float(found.group(1)), 1.004 / turn, delta=0.003)

    def test_normal_forces_of_a_search_that_ended_prove_nothing(self):
        result = self.twisted(0.9, **{'Solver/Algorithm': 'smalbe', 'Solver/SMALBE/Max outer iterations': 1})
        self.assertEqual(result.status, 3, result)


class NormalForcesThatFriction(unittest.TestCase):

    def test_changes(self):
        """A wedge below its limit: "friction is too weak" once, at the normal forces of more friction."""
        results = solve(pathlib.Path(__file__).parent / 'wedge_jack.prm').summary['results']
        self.assertAlmostEqual(results['contact'][0]['normal_force'], 252.03, delta=0.01)


class LimitOfEquilibrium(unittest.TestCase):
    """Stack on an incline of 20 degrees, mu a factor times tan 20."""

    def stack(self, factor, tolerance, ranks=1):
        pairs = ('ground', 'lower joint', 'upper joint')
        friction = {'Contact {}/Friction coefficient'.format(pair): repr(factor * math.tan(math.radians(20))) for pair in pairs}
        return solve(shipped('incline'), {**friction, 'Solver/Tolerance': tolerance, 'Output/VTU': 'false'}, ranks=ranks)

    def warnings(self, result):
        return [text for text in result.summary['warnings'] if 'at the limit of equilibrium' in text]

    def test_what_friction_bears_is_solved_at_any_tolerance(self):
        for factor, part in ((1, '1.00000'), (1 + 1e-6, '1.00000'), (1 + 1e-4, '1.0001')):
            for tolerance in (1e-4, 1e-6, 1e-8, 1e-10):
                with self.subTest(factor=factor, tolerance=tolerance):
                    result = self.stack(factor, tolerance)
                    self.assertEqual(result.status, 0, result)
                    self.assertEqual(len(self.warnings(result)), 1, result)
                    self.assertIn('bears ' + part, self.warnings(result)[0])
                    self.assertIn('body a', self.warnings(result)[0])

    def test_well_below_the_limit_nothing_is_said(self):
        self.assertEqual(self.warnings(self.stack(1.01, 1e-8, ranks=2)), [])

    def test_what_it_does_not_bear_is_refused_at_any_tolerance(self):
        for factor, is_near in ((0.9, False), (1 - 1e-4, True), (1 - 1e-6, True)):
            for tolerance in (1e-4, 1e-6, 1e-8, 1e-10):
                with self.subTest(factor=factor, tolerance=tolerance):
                    result = self.stack(factor, tolerance)
                    self.assertEqual(result.status, 4, result)
                    self.assertEqual('at the limit of equilibrium' in result.stderr, is_near, result)

    def test_within_the_tolerance_both_say_so(self):
        for tolerance, status in ((1e-4, 0), (1e-6, 0), (1e-8, 4), (1e-10, 4)):
            with self.subTest(tolerance=tolerance):
                result = self.stack(1 - 1e-8, tolerance)
                self.assertEqual(result.status, status, result)
                text = result.stderr if status else self.warnings(result)[0]
                self.assertIn('at the limit of equilibrium', text)
                self.assertIn('bears 0.99999999', text)


class NotConverged(unittest.TestCase):

    def check(self, case, overrides, ranks):
        if any('SMALBE' in name for name in overrides):
            overrides = {'Solver/Algorithm': 'smalbe', **overrides}
        result = solve(case, {'Decomposition/Cells per block': 8, **overrides}, ranks=ranks)
        self.assertEqual(result.status, 3, result)
        summary = result.summary
        self.assertEqual(summary['status'], 'not converged')
        self.assertIs(summary['converged'], False)
        for name in ('solution.pvd', 'solution_000.pvtu', 'convergence.csv', 'parameters.prm'):
            self.assertIn(name, result.files())
        self.assertIn('not converged', result.stdout + result.stderr)
        return result

    def test_outer_iterations_run_out(self):
        for ranks in (1, 2):
            result = self.check(shipped('box_on_circle'), {'Solver/SMALBE/Max outer iterations': 2}, ranks)
            self.assertEqual(result.summary['solver']['outer_iterations'], 2)
            self.assertIn('contact.csv', result.files())
            self.assertGreater(max(result.summary['residuals'][name] for name in ('projected_gradient', 'equality')),
                               1e-4)

    def test_inner_iterations_run_out(self):
        self.check(shipped('box_on_circle'), {'Solver/SMALBE/Max inner iterations': 1,
                                              'Solver/SMALBE/Max outer iterations': 5}, 2)

    def test_linear_iterations_run_out(self):
        self.check(shipped('box_linear'), {'Solver/PCG/Max iterations': 3}, 2)

    def test_standard_error_says_so_once_with_a_remedy(self):
        result = self.check(shipped('box_on_circle'), {'Solver/SMALBE/Max outer iterations': 2}, 2)
        self.assertEqual(result.stderr.count('remedy: '), 1, result)
        self.assertIn('Max outer iterations', result.stderr, result)


if __name__ == '__main__':
    unittest.main()
