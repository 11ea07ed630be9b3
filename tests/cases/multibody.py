"""Shipped scenes of several bodies: equilibrium of their parts, tractions, overlap in all its forms, limits of friction
(the other figures of their headers: multibody_extra.py)."""

import functools
import math
import unittest

from program import converged, shipped, solve

ACCURATE = {'Solver/Tolerance': 1e-9, 'Friction/Tolerance': 1e-9}


@functools.lru_cache(maxsize=None)
def scene(name, overrides=(), ranks=1):
    return converged(shipped(name), {**ACCURATE, **dict(overrides)}, ranks=ranks)


def pairs(result):
    return {pair['pair']: pair for pair in result.summary['results']['contact']}


def last_step(result):
    rows = result.contact
    return [row for row in rows if row['step'] == rows[-1]['step']]


def direction(degrees):
    return math.cos(math.radians(degrees)), math.sin(math.radians(degrees))


def force_on_slave(pair, normal):
    """Of a straight pair with this outward normal of its slave: compression acts against it, friction along the
    tangent, which is the normal turned by +90 degrees."""
    n, t = pair['normal_force'], pair['tangential_force']
    return -n * normal[0] - t * normal[1], -n * normal[1] + t * normal[0]


class Multibody(unittest.TestCase):

    def assert_near(self, value, expected, relative, what=''):
        self.assertLessEqual(abs(value - expected), relative * abs(expected), '{}: {} in place of {}'.format(
            what, value, expected))

    def assert_in_equilibrium(self, result, limit=1e-8):
        residuals = result.summary['residuals']
        for name in ('force_balance', 'moment_balance'):
            self.assertLess(residuals[name], limit, name)

    # clamp

    def test_clamp_every_interface_carries_the_bolt_force(self):
        result = scene('clamp', ranks=2)
        pair = pairs(result)
        self.assert_in_equilibrium(result)
        down, flank = (0, -1), direction(-25)  # outward normals of the slaves below B and at its flank
        self.assert_near(force_on_slave(pair['seat'], (0, 1))[1], -1e4, 1e-7)
        self.assert_near(force_on_slave(pair['flange'], down)[1] + force_on_slave(pair['upper flank'], flank)[1] +
                         force_on_slave(pair['lower flank'], flank)[1], 1e4, 1e-7)
        self.assert_near(force_on_slave(pair['web'], down)[1] - force_on_slave(pair['back'], direction(155))[1], 1e4,
                         1e-7)

    def test_clamp_friction_stays_in_its_cone_and_most_zones_slide(self):
        for name, pair in pairs(scene('clamp', ranks=2)).items():
            self.assertLessEqual(abs(pair['tangential_force']), 0.1 * pair['normal_force'] * (1 + 1e-6), name)
            if name not in ('web', 'back'):
                self.assert_near(abs(pair['tangential_force']), 0.1 * pair['normal_force'], 1e-6, name)

    # Cattaneo-Mindlin

    def test_traction_of_cattaneo_and_mindlin(self):
        """q = mu p (full sliding) less that of the stick zone, to 4 % of its largest value."""
        a, c, p0, mu = 0.74279, 0.52523, 857.07, 0.3
        for row in last_step(scene('cattaneo_mindlin')):
            x = row['x']
            q = sum(sign * mu * p0 * width / a * math.sqrt(max(0, 1 - (x / width) ** 2))
                    for sign, width in ((1, a), (-1, c)))
            if min(abs(abs(x) - a), abs(abs(x) - c)) > 0.1:  # kinks are a cell wide
                self.assertLess(abs(abs(row['tangential_traction']) - q), 0.04 * 181.811, row)

    def test_first_step_does_not_slip(self):
        rows = [row for row in scene('cattaneo_mindlin').contact if row['step'] == 0]
        self.assertEqual({row['status'] for row in rows}, {'open', 'stick'})
        for row in rows:
            if abs(row['x']) < 0.5:  # at the ends the meshes, which do not match, leave some
                self.assertLess(abs(row['tangential_traction']), 0.01 * 857, row)

    # press fit

    LAME = 63.0

    def press_fit(self, expected, tolerance, **overrides):
        pair = pairs(scene('press_fit', tuple((name.replace('_', ' '), value) for name, value in overrides.items())))
        pressure = pair['fit']['normal_force'] / (20 * math.pi / 2)
        self.assert_near(pressure, expected, tolerance, overrides)

    def test_press_fit_pressure(self):
        self.press_fit(self.LAME, 2e-3)
        self.press_fit(self.LAME, 2e-4, **{'Discretization/Refinements': 2})
        self.press_fit(self.LAME, 1e-3, **{'Discretization/Degree': 2})
        self.press_fit(self.LAME / 0.91, 2e-3, **{'Plane state': 'plane strain'})

    def test_press_fit_by_offset_by_overlap_and_by_cooling(self):
        quadratic = {'Discretization/Degree': 2}
        self.press_fit(self.LAME, 2e-3, **{**quadratic, 'Contact fit/Gap': 'geometry', 'Contact fit/Offset': -0.02})
        self.press_fit(self.LAME, 5e-3, **{**quadratic, 'Contact fit/Gap': 'geometry', 'Body shaft/Radius': 20.02})
        self.press_fit(self.LAME, 2e-3, **{'Contact fit/Gap': 0, 'Temperatures': 'cooling',
                                           'Temperature cooling/Bodies': 'ring',
                                           'Temperature cooling/Change': -250 / 3})

    def test_press_fit_with_friction_does_not_need_it(self):
        friction = {'Contact fit/Law': 'Coulomb', 'Contact fit/Friction coefficient': 0.2}
        self.press_fit(self.LAME, 2e-3, **friction)

    # arch

    def test_arch_thrust_stays_inside_the_stones(self):
        result = scene('arch', ranks=2)
        self.assert_in_equilibrium(result)
        thickness = 500
        joints = {}
        for row in result.contact:
            joints.setdefault(row['pair'], []).append(row)
        self.assertEqual(len(joints), 25)
        thrust = {}  # distance of the centre of pressure from the intrados
        for name, rows in joints.items():
            self.assertGreaterEqual(min(row['pressure'] for row in rows), 0, name)
            radii = [math.hypot(row['x'], row['y']) - 2500 for row in rows]
            self.assertLess(max(abs(min(radii)), abs(max(radii) - thickness)), 1e-6, name)
            force = sum(row['pressure'] for row in rows)
            thrust[name] = sum(r * row['pressure'] for r, row in zip(radii, rows)) / force
            self.assertTrue(0 < thrust[name] < thickness, '{}: {}'.format(name, thrust[name]))
        # hinges: extrados at the right springing and beside the load, intrados at the right haunch
        for name in ('j00', 'j15'):
            self.assertGreater(thrust[name], 2 / 3 * thickness, name)
            self.assertGreater(pairs(result)[name]['open_nodes'], 0, name)
        for name in ('j05', 'j06'):
            self.assertLess(thrust[name], 1 / 3 * thickness, name)
        for name, pair in pairs(result).items():
            self.assertGreater(pair['normal_force'], 2.9e4, name)
            self.assertGreater(pair['contact_nodes'], 0, name)
            self.assertLessEqual(abs(pair['tangential_force']), 0.6 * pair['normal_force'], name)

    def test_arch_springings_carry_weight_and_load(self):
        pair = pairs(scene('arch', ranks=2))
        # start of v01 and end of v24 look down, 10 degrees off the horizontal on either side
        right = force_on_slave(pair['j00'], direction(-80))
        left = force_on_slave(pair['j24'], direction(-100))
        self.assert_near(right[0], -left[0], 1e-6)
        self.assert_near(abs(right[0]), 30.1e3, 2e-3)
        # polygons of 48 and 96 sides: a little lighter than the ring of the header
        self.assert_near(right[1] + left[1], 110.4e3, 1e-3)

    # lap joint

    def test_lap_joint_preload(self):
        pair = pairs(scene('lap_joint', (('Load steps/Factors', '1'),)))
        halves = [pair[a]['normal_force'] + pair[b]['normal_force'] for a, b in
                  (('head left', 'head right'), ('nut left', 'nut right'))]
        self.assert_near(halves[0], halves[1], 1e-7)
        self.assert_near(halves[0], 13.65e3, 5e-3)

    # no equilibrium

    def no_equilibrium(self, case, overrides, sliding, resting=()):
        result = solve(case, overrides, ranks=2)
        self.assertEqual(result.status, 4, result)
        for body in sliding:
            self.assertIn('body {}: '.format(body), result.stderr, result)
        for body in resting:
            self.assertNotIn('body {}: '.format(body), result.stderr, result)
        self.assertIn('\n  remedy: ', result.stderr, result)

    def test_incline_beyond_the_friction_angle_names_what_slides(self):
        """tan 20 = 0.36397: 0.37 holds, 0.36 does not."""
        scene('incline', (('Contact upper joint/Friction coefficient', 0.37),))
        self.no_equilibrium(shipped('incline'), {'Contact upper joint/Friction coefficient': 0.36}, 'c', 'ab')
        self.no_equilibrium(shipped('incline'), {'Contact lower joint/Friction coefficient': 0.36}, 'bc', 'a')

    def test_arch_below_the_critical_friction_coefficient(self):
        """0.342 for rigid stones: 0.36 holds, 0.32 does not."""
        def arch(friction):
            return {'Contact j{:02d}/Friction coefficient'.format(i): friction for i in range(25)}
        scene('arch', tuple(arch(0.36).items()))
        self.no_equilibrium(shipped('arch'), arch(0.32), ('v01',))

    def test_arch_under_more_than_it_bears(self):
        """56.3 kN for rigid stones: 50 kN holds, 60 kN does not."""
        scene('arch', (('Point load load/Force y', -5e4),))
        self.no_equilibrium(shipped('arch'), {'Point load load/Force y': -6e4}, ('v16',))


if __name__ == '__main__':
    unittest.main()
