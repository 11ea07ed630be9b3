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


def rolling_disc(degree, edges, cells, young='2.1e5', push='0'):
    """A disc that rolls freely on a frictionless floor, pressed by a plate to which cohesion holds it."""
    return scenes.box(
        'roll', plane_state='plane strain', Decomposition={'Method': 'METIS'}, Discretization={'Degree': degree},
        materials={'steel': {'Young modulus': '2.1e5', 'Poisson ratio': '0.3'}, 'soft': {'Young modulus': young, 'Poisson ratio': '0.3'}},
        bodies={'disc': {'Shape': 'disc', 'Center': '0, 6', 'Radius': '6', 'Cells along arc': edges, 'Material': 'steel'},
                'plate': {'Origin': '-15, 12', 'Size': '30, 8', 'Cells': '{}, 4'.format(cells), 'Material': 'soft'}},
        obstacles={'floor': GROUND}, supports={'load': {'Boundary': 'plate/top', 'Displacement x': push, 'Displacement y': '-0.03'}},
        contacts={'c0': {'Slave': 'disc/arc', 'Master': 'floor', 'Law': 'frictionless'},
                  'c1': {'Slave': 'disc/arc', 'Master': 'plate/bottom', 'Law': 'cohesion', 'Friction coefficient': '0.5', 'Cohesion': '20'}})


class Cohesion(unittest.TestCase):

    def test_open_nodes_carry_nothing(self):
        """Nodes that only hold the rolling of the disc carried 20 MPa, and those beside them the opposite."""
        for case in (rolling_disc(2, 32, 20), rolling_disc(1, 32, 20), rolling_disc(1, 48, 31, '3e4', '0.005')):
            for tolerance in (1e-4, 1e-6, 1e-8):
                result = converged(case, {'Solver/Tolerance': tolerance, 'Output/VTU': 'false'})
                largest = max(row['pressure'] for row in result.contact)
                for row in result.contact:
                    if row['pressure'] < 1e-12 * largest:
                        self.assertLess(abs(row['tangential_traction']), 1e-12 * largest, row)
                        self.assertEqual(row['slip_bound'], 0, row)
                        self.assertIn(row['status'], ('open', 'slip') if row['pair'] == 'c0' else ('open', ), row)

    def test_blocks_that_lose_contact(self):
        """Forces of rounding size close no node: the solver ended at status 3 after 101 multiplications."""
        blocks = {'lower': {'Shape': 'cuboid', 'Size': '7, 4, 7', 'Cells': '4, 2, 4', 'Material': 'soft'},
                  'upper': {'Shape': 'cuboid', 'Origin': '1, 4, 1', 'Size': '5, 4, 5', 'Cells': '3, 2, 3', 'Material': 'steel'}}
        law = {'Law': 'cohesion', 'Cohesion': '1', 'Friction coefficient': '0.2'}
        kinds = dict(
            materials={name: {'Young modulus': young, 'Thermal expansion': '1.2e-5'} for name, young in (('soft', '7e4'), ('steel', '2.1e5'))},
            bodies=blocks, obstacles={'floor': {'Shape': 'half space', 'Point': '0, 0, 0', 'Normal': '0, 1, 0'}},
            supports={'left': {'Boundary': 'lower/left', 'Displacement normal': '0'}, 'back': {'Boundary': 'lower/back', 'Displacement normal': '0'},
                      'push': {'Boundary': 'upper/top', 'Displacement x': '0.002', 'Displacement y': '-0.0012', 'Displacement z': '0'}},
            contacts={'between': {'Slave': 'upper/bottom', 'Master': 'lower/top', **law}, 'foot': {'Slave': 'lower/bottom', 'Master': 'floor', **law}},
            temperatures={'cold': {'Bodies': 'all', 'Change': '-30'}}, Decomposition={'Method': 'METIS'})
        content = scenes.text(**kinds).replace('set Plane state = plane stress', 'set Dimension = 3')
        result = converged(scenes.write('cold', content), {'Output/VTU': 'false'})
        self.assertLess(result.summary['solver']['hessian_multiplications'], 60)
        self.assertEqual({(row['status'], row['tangential_traction']) for row in result.contact}, {('open', 0)})

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
