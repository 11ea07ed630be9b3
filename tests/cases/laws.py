"""Laws of contact as a user meets them: cohesion with a shear limit, on a block whose stress is uniform."""

import unittest

import scenes
from program import converged, solve

AREA, PRESSURE = 10, 20  # mm^2, MPa
GROUND = {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}
LAW = {'Slave': 'box/bottom', 'Master': 'ground', 'Law': 'cohesion', 'Cohesion': '3', 'Friction coefficient': '0.2'}
STRENGTH = 3 + 0.2 * PRESSURE


def block(shear, supports=None, **law):
    """Pressed on the ground and sheared, by tractions at the top unless supports move it there."""
    sides = {side: {'Boundary': 'box/' + side, 'Traction y': sign * shear} for side, sign in (('left', -1), ('right', 1))}
    top = {'top': {'Boundary': 'box/top', 'Traction x': shear, 'Traction y': -PRESSURE}}
    return scenes.box(materials={'elastic': {'Young modulus': '1e5', 'Poisson ratio': '0'}}, obstacles={'ground': GROUND},
                      contacts={'joint': {**LAW, **law}}, supports=supports or {},
                      tractions=sides if supports else {**sides, **top})


class Cohesion(unittest.TestCase):

    def test_block_sticks_up_to_cohesion_and_friction(self):
        result = converged(block(0.999 * STRENGTH), {'Solver/Tolerance': 1e-8}, ranks=2)
        pair = result.summary['results']['contact'][0]
        self.assertAlmostEqual(pair['tangential_force'], -0.999 * STRENGTH * AREA, delta=1e-4)
        for row in result.contact:
            self.assertEqual(row['status'], 'stick')
            self.assertAlmostEqual(row['slip_bound'], STRENGTH, delta=1e-4)

    def test_block_beyond_strength_or_limit_has_no_equilibrium(self):
        for shear, law in ((1.001 * STRENGTH, {}), (5.01, {'Shear limit': '5'})):
            result = solve(block(shear, **law))
            self.assertEqual(result.status, 4, result)
            self.assertIn('move body box: translation along (', result.stderr)

    def test_block_slides_under_the_shear_limit(self):
        moved = {'moved': {'Boundary': 'box/top', 'Displacement x': '0.01', 'Displacement y': '-2e-3'}}
        for algorithm in ('semismooth newton', 'smalbe'):
            result = converged(block(5, moved, **{'Shear limit': '5'}),
                               {'Solver/Tolerance': 1e-8, 'Solver/Algorithm': algorithm})
            for row in result.contact:
                self.assertEqual(row['status'], 'slip')
                self.assertAlmostEqual(row['slip_bound'], 5, delta=1e-4)
                self.assertAlmostEqual(row['tangential_traction'], -5, delta=1e-4)
                self.assertAlmostEqual(row['slip'], 0.01 - 5 * 10 / 5e4, delta=1e-7)

    def test_its_numbers_are_asked_for(self):
        law = {key: LAW[key] for key in ('Slave', 'Master', 'Law')}
        for more, words in (({}, 'Cohesion is not set'), ({'Cohesion': '1'}, 'Friction coefficient is not set'),
                            ({'Cohesion': '1', 'Friction coefficient': '0', 'Shear limit': '-1'}, 'Shear limit'),
                            ({'Cohesion': '1-x', 'Friction coefficient': '0'}, 'joint/Cohesion is -')):
            result = solve(scenes.box(obstacles={'ground': GROUND}, contacts={'joint': {**law, **more}},
                                      tractions={'pressed': scenes.PRESSED}))
            self.assertEqual(result.status, 2, result)
            self.assertIn(words, result.stderr)


if __name__ == '__main__':
    unittest.main()
