"""Motions that nothing resists and no load drives are set to zero and named, whatever mesh and scale; with a load along them
there is no equilibrium."""

import math
import pathlib
import unittest

import scenes
import solids
from program import run, solve

STEEL = {'Young modulus': '2.1e5', 'Poisson ratio': '0.3'}
SMALL = {'Decomposition': {'Method': 'METIS', 'Subdomains': '3'}, 'Output': {'VTU': 'false'}}


def shaft(radius, load, refinements=0, law='Coulomb', young='2.1e5', centre_only=True, **kinds):
    """A shaft held at its centre in a ring that is loaded; nodes do not match."""
    supports = {'centre': {'Body': 'shaft', 'Point': '0, 0', 'Displacement x': '0', 'Displacement y': '0'}}
    if not centre_only:
        supports['rim'] = {'Body': 'shaft', 'Point': '{}, 0'.format(radius), 'Displacement y': '0'}
    joint = {'Slave': 'hub/inner', 'Master': 'shaft/arc', 'Law': law}
    if law == 'Coulomb':
        joint['Friction coefficient'] = '0.15'
    return scenes.box(
        'shaft', materials={'steel': {**STEEL, 'Young modulus': young}}, bodies={
            'shaft': {'Shape': 'disc', 'Radius': radius, 'Cells along arc': '32', 'Material': 'steel'},
            'hub': {'Shape': 'ring', 'Inner radius': '20', 'Radius': '40', 'Cells': '40, 4', 'Material': 'steel'}},
        supports=supports, tractions={'load': {'Boundary': 'hub/outer', **load}}, contacts={'fit': joint},
        Discretization={'Refinements': refinements}, **{**SMALL, **kinds})


def fit_of_revolution(**supports):
    """A ring shrunk on a shaft of twice its length."""
    return scenes.box('fit', plane_state='axisymmetric', materials={'steel': STEEL}, bodies={
        'shaft': {'Origin': '0, -10', 'Size': '10.01, 20', 'Cells': '10, 20', 'Material': 'steel'},
        'ring': {'Origin': '10, -5', 'Size': '10, 10', 'Cells': '10, 10', 'Material': 'steel'}},
        supports=supports, contacts={'fit': {'Slave': 'ring/left', 'Master': 'shaft/right', 'Law': 'Coulomb',
                                             'Friction coefficient': '0.15'}},
        Solver={'Tolerance': '1e-8'}, **SMALL)


class FreeMotions(unittest.TestCase):

    def converges(self, case, *words, ranks=1):
        result = solve(case, ranks=ranks)
        self.assertEqual(result.status, 0, result)
        warnings = [text for text in result.summary['warnings'] if text.startswith('nothing resists')]
        self.assertEqual(len(warnings), 1 if words else 0, result)
        for word in words:
            self.assertIn(word, warnings[0])
        return result

    def test_bodies_of_revolution(self):
        """Along the axis nothing holds them, as in the plane and in space."""
        free = self.converges(fit_of_revolution(), 'translation along the axis')
        held = self.converges(fit_of_revolution(end={'Body': 'shaft', 'Point': '0, 0', 'Displacement y': '0'}))
        (free, held) = (result.summary['results']['contact'][0] for result in (free, held))
        self.assertGreater(held['normal_force'], 1e4)
        for key in ('normal_force', 'max_pressure'):
            self.assertAlmostEqual(free[key] / held[key], 1, places=5)

    def test_a_shaft_held_at_its_centre_alone(self):
        turns = ('body shaft: rotation about (0, 0); body hub: rotation about (0, 0)', 'set to zero')
        down = {'Traction y': '-1*(y>0)'}
        for radius in ('20', '20.02', '19.98'):  # the distance of the sides is no lever
            for refinements in (0, 1):
                result = self.converges(shaft(radius, down, refinements), *turns, ranks=1 + refinements)
                centre, *held = (one['force'] for one in result.summary['results']['supports'])
                load = result.summary['results']['loads'][0]['force'][1]
                self.assertAlmostEqual((centre[1] + sum(force[1] for force in held)) / load, -1, delta=1e-6)
                self.assertLess(max([0, *(math.hypot(*force) for force in held)]), 1e-5 * abs(load))
        self.converges(shaft('20', down, law='frictionless'), 'body shaft: rotation about (0, 0)',
                       'body hub: rotation about (0, 0)')
        checked = run(shaft('20.02', down), '--check')
        self.assertEqual(checked.status, 0, checked)
        self.assertIn(turns[0], checked.stdout)

    def press_fit(self, law, force=('5', '3'), edges='48', **kinds):
        """A shaft in a ring, pushed by forces through its centre."""
        return scenes.box('fit', plane_state='plane strain', materials={'steel': STEEL}, bodies={
            'shaft': {'Shape': 'disc', 'Radius': '10', 'Cells along arc': '32', 'Material': 'steel'},
            'hub': {'Shape': 'ring', 'Inner radius': '10', 'Radius': '20', 'Cells': edges + ', 4', 'Material': 'steel'}},
            supports={'held': {'Boundary': 'hub/outer', 'Displacement x': '0', 'Displacement y': '0'}},
            body_forces={'g': {'Bodies': 'shaft', 'Force x': force[0], 'Force y': force[1]}},
            contacts={'fit': {'Slave': 'shaft/arc', 'Master': 'hub/inner', 'Offset': '-0.01', **law}},
            probes={side: {'Body': 'shaft', 'Point': point} for side, point in (('east', '10, 0'), ('west', '-10, 0'))}, **SMALL, **kinds)

    def test_rounding_is_no_force_that_holds(self):
        """A ring leaves its shaft because it turns: 3.65e-12 N were '110 % of the largest force', with friction as the reason."""
        rings = {name: {'Shape': 'ring', 'Inner radius': inner, 'Radius': outer, 'Cells': cells, 'Material': 'steel'}
                 for name, inner, outer, cells in (('shaft', '10', '20', '16, 2'), ('hub', '20', '60', '16, 4'))}
        for law in ({}, {'Law': 'Coulomb', 'Friction coefficient': '0.2'}):
            result = solve(scenes.box('spin', materials={'steel': {**STEEL, 'Density': '7.85e-9'}}, bodies=rings,
                                      body_forces={'spin': {'Angular velocity': '4000'}},
                                      contacts={'fit': {'Slave': 'hub/inner', 'Master': 'shaft/outer', 'Offset': '-0.02', **law}},
                                      Decomposition={'Method': 'auto'}, Output={'VTU': 'false'}))
            self.assertEqual(result.status, 0, result)
            self.assertNotIn('are held by', result.stdout)
            self.assertNotIn('held motions', result.stdout)

    def test_a_rotation_set_to_zero_is_zero(self):
        """Without friction one node was held, whose deformation showed as a rotation of 1.8e-4."""
        turned = []
        for law in ({'Law': 'frictionless'}, {'Law': 'Tresca', 'Slip bound': '0'}):
            for ranks, tolerance in ((1, '1e-8'), (2, '1e-4')):
                result = self.converges(self.press_fit(law, Solver={'Tolerance': tolerance}), 'body shaft: rotation about (0, 0)', ranks=ranks)
                u = [probe['displacement'] for probe in result.summary['results']['probes']]
                self.assertAlmostEqual(u[0][1], u[1][1], delta=1e-6)
                turned.append(u[0][1])
        self.assertAlmostEqual(min(turned), max(turned), delta=1e-6)

    def test_a_motion_set_to_zero_does_not_depend_on_the_mesh(self):
        """The mean over the nodes moved with them: 8 to 12 % of the largest displacement."""
        blocks = scenes.box('blocks', materials={'steel': STEEL}, bodies={
            'block': {'Origin': '-10, 0', 'Size': '20, 10', 'Cells': '8, 4', 'Material': 'steel'},
            'ground': {'Origin': '-20, -10', 'Size': '40, 10', 'Cells': '10, 4', 'Material': 'steel'}},
            supports={'below': {'Boundary': 'ground/bottom', 'Displacement x': '0', 'Displacement y': '0'}},
            tractions={'load': {'Boundary': 'block/top', 'Pressure': '1'}},
            contacts={'touch': {'Slave': 'block/bottom', 'Master': 'ground/top', 'Law': 'frictionless'}},
            probes={'middle': {'Body': 'block', 'Point': '0, 5'}}, Decomposition={'Method': 'none'}, Output={'VTU': 'false'})
        for levels in (0, 1, 2):
            refined = {'Body block/Refine towards': 'left', 'Body block/Refine levels': levels} if levels else {}
            results = solve(blocks, refined).summary['results']
            self.assertLess(abs(results['probes'][0]['displacement'][0]), 2e-3 * results['max_displacement'])

    def test_pairs_between_two_sides_of_one_body(self):
        """Rows across the gap between the lips of a clip resisted its rotation: 0.281 mm and 36 rad instead of 0.0757 and 0.159 mm."""
        pin = {'Support rim/Body': 'd', 'Support rim/Point': '9.98, 0', 'Support rim/Displacement y': '0', 'Supports': 'pd, rim'}
        back = {'Supports': 'h, back', 'Support back/Body': 'c', 'Support back/Point': '-10, 0', 'Support back/Displacement y': '0'}
        for name, more in (('collar', pin), ('self_clip', back)):
            case = pathlib.Path(__file__).parent / (name + '.prm')
            free = self.converges(case, 'rotation about')
            stress = [solve(case, {'Solver/Tolerance': '1e-8', **settings}).summary['results']['max_von_mises'] for settings in ({}, more)]
            self.assertAlmostEqual(stress[0] / stress[1], 1, delta=1e-6)
            self.assertLess(free.summary['results']['max_displacement'], 0.2)
            self.assertLess(free.summary['solver']['hessian_multiplications'], 300)

    def test_bonded_across_a_gap_and_held_at_one_point(self):
        """Mirror-symmetric loads leave no shear force in the bond: 4.75 N once."""
        blocks = scenes.box('pair', materials={'steel': STEEL}, bodies={
            'low': {'Origin': '-5, -5', 'Size': '10, 5', 'Cells': '10, 5', 'Material': 'steel'},
            'high': {'Origin': '-5, 0.001', 'Size': '10, 5', 'Cells': '7, 4', 'Material': 'steel'}},
            supports={'pin': {'Body': 'low', 'Point': '0, 0', 'Displacement x': '0', 'Displacement y': '0'}},
            tractions={'up': {'Boundary': 'high/top', 'Traction x': '-x', 'Traction y': '10'},
                       'down': {'Boundary': 'low/bottom', 'Traction x': '-x', 'Traction y': '-10'}},
            contacts={'bond': {'Slave': 'high/bottom', 'Master': 'low/top', 'Law': 'bonded'}}, **SMALL)
        force = self.converges(blocks, 'rotation about').summary['results']['contact'][0]['force']
        self.assertLess(abs(force[0]), 1e-6 * abs(force[1]))

    def test_friction_across_a_gap_without_any_rotation_held(self):
        """Largest pressure 663 instead of 548 MPa, when the gap followed the rotations of strained edges."""
        found = []
        for gap in (0., 0.5):
            blocks = scenes.box('blocks', materials={'steel': STEEL}, bodies={
                'low': {'Origin': '-4, -5', 'Size': '8, 5', 'Cells': '8, 4', 'Material': 'steel'},
                'high': {'Origin': '-3, {}'.format(gap), 'Size': '6, 5', 'Cells': '6, 4', 'Material': 'steel'}},
                supports={'pin': {'Body': 'low', 'Point': '0, -5', 'Displacement x': '0', 'Displacement y': '0'}},
                tractions={'down': {'Boundary': 'high/top', 'Pressure': '200'}, 'up': {'Boundary': 'low/bottom', 'Pressure': '150'}},
                contacts={'touch': {'Slave': 'high/bottom', 'Master': 'low/top', 'Law': 'Coulomb', 'Friction coefficient': '0.5'}},
                Solver={'Tolerance': '1e-10'}, **SMALL)
            found.append(self.converges(blocks, 'body low: rotation about (0, -5)', 'body high: ').summary['results']['contact'][0])
        for key in ('max_pressure', 'normal_force', 'traction_norm'):
            self.assertAlmostEqual(found[1][key] / found[0][key], 1, delta=1e-6)

    def test_a_gap_that_a_translation_closes_changes_nothing(self):
        """Friction of two held blocks: the gap followed the rotations of strained edges, 21 % more traction across 0.5 mm."""
        found = []
        for gap in (0., 0.5, 2.):
            blocks = scenes.box('blocks', materials={'steel': STEEL}, bodies={
                'low': {'Origin': '-6, -5', 'Size': '12, 5', 'Cells': '12, 4', 'Material': 'steel'},
                'high': {'Origin': '-4, {}'.format(gap), 'Size': '8, 5', 'Cells': '8, 4', 'Material': 'steel'}},
                supports={'floor': {'Boundary': 'low/bottom', 'Displacement x': '0', 'Displacement y': '0'},
                          'press': {'Boundary': 'high/top', 'Displacement x': '0', 'Displacement y': '{}'.format(-gap - 0.01)}},
                contacts={'touch': {'Slave': 'high/bottom', 'Master': 'low/top', 'Law': 'Coulomb', 'Friction coefficient': '0.5'}},
                Discretization={'Degree': '2'}, Solver={'Tolerance': '1e-10'}, **SMALL)
            found.append(self.converges(blocks).summary['results']['contact'][0])
        for pair in found[1:]:
            for key in ('max_pressure', 'normal_force', 'traction_norm'):
                self.assertAlmostEqual(pair[key] / found[0][key], 1, delta=1e-6)

    def test_forces_of_rounding_do_not_turn_a_body(self):
        """A heated block on the top of a dome: its weight rests on one node, two others bear 1e-10 of it."""
        block = solids.solid('block', materials={'light': {'Library': 'aluminium'}}, bodies={
            'block': {'Origin': '-20, 0, -8', 'Size': '40, 15, 16', 'Cells': '8, 4, 4', 'Material': 'light'}},
            obstacles={'dome': {'Shape': 'function', 'Height': '-0.00002*(x^2+z^2)'}},
            body_forces={'weight': {'Bodies': 'block', 'Acceleration y': '-9810'}},
            temperatures={'heat': {'Bodies': 'block', 'Change': '20'}},
            contacts={'top': {'Slave': 'block/bottom', 'Master': 'dome', 'Law': 'Coulomb', 'Friction coefficient': '0.15'}},
            probes={side: {'Body': 'block', 'Point': point} for side, point in (('east', '20, 15, 0'), ('west', '-20, 15, 0'))},
            Decomposition={'Method': 'none'}, Solver={'Tolerance': '1e-4'})
        result = self.converges(block, 'body block: rotation about the axis along (0, 1, 0)')
        east, west = (probe['displacement'] for probe in result.summary['results']['probes'])
        self.assertAlmostEqual(east[2], west[2], delta=1e-9)  # which node is held along z is a matter of rounding

    def test_a_mesh_that_cuts_the_outline_unevenly(self):
        """The centroid of a polygon refined on one side is not the centre; a torque, however small, is refused."""
        goals = {'Accuracy': '1 %', 'Goal': 'fit.max_pressure', 'Output/VTU': 'false'}
        for ranks in (1, 2):
            result = solve(self.press_fit({'Law': 'frictionless'}, force=('0.5', '0.21')), goals, ranks=ranks)
            self.assertEqual(result.status, 0, result)
            self.assertGreater(len(result.summary['meshes']), 1)
            self.assertIn('rotation about (0, 0)', ' '.join(result.summary['warnings']))
            held, = result.summary['results']['supports']
            load, = result.summary['results']['loads']
            for d in (0, 1):
                self.assertAlmostEqual(held['force'][d] / load['force'][d], -1, delta=1e-9)
        for torque in (1e-3, 1e-6):  # of force times radius
            turning = 2 * torque * math.hypot(0.5, 0.3) / 10
            pushed = self.press_fit({'Law': 'frictionless'}, force=('0.5-{}*y'.format(turning), '0.3+{}*x'.format(turning)))
            for settings in ({}, goals):
                self.assertEqual(solve(pushed, settings).status, 4)

    def test_a_torque_on_it(self):
        torque = {'Traction x': '-y/40', 'Traction y': 'x/40'}
        for radius in ('20', '20.02'):
            result = run(shaft(radius, torque), '--check')
            self.assertEqual(result.status, 4, result)
            self.assertIn('body hub: rotation about (0, 0), where the loads push', result.stderr)
        later = shaft('20.02', {'Traction x': '-y/40*(t>1)', 'Traction y': 'x/40*(t>1)-(y>0)'},
                      **{'Load steps': {'Factors': '1, 2'}})
        result = solve(later)
        self.assertEqual(result.status, 4, result)
        self.assertEqual(len(result.summary['steps']), 1)

    def test_a_torque_across_a_clearance(self):
        """Nothing presses the hub on the shaft: no tolerance would make friction hold it."""
        torque = {'Traction x': '-y/400', 'Traction y': 'x/400'}
        result = solve(shaft('19.9', torque, centre_only=False))
        self.assertIn(result.status, (3, 4), result)
        self.assertNotIn('Tolerance', result.stderr)
        self.assertRegex(result.stderr, 'remedy: (support bodies that friction alone holds|raise the friction coefficient)')

    def test_rotation_held_by_friction_takes_few_multiplications(self):
        """11195 and 22742 of degree 2 once; 15 to 23 now."""
        for radius in ('20', '20.02'):
            for load in ({'Traction y': '-1*(y>0)'}, {'Traction x': '-y/400', 'Traction y': 'x/400'}):
                if radius == '20.02' or 'Traction x' not in load:
                    result = solve(shaft(radius, load, centre_only=False), {'Discretization/Degree': 2})
                    self.assertEqual(result.status, 0, result)
                    self.assertLess(result.summary['solver']['hessian_multiplications'], 100)
                    self.assertEqual(result.summary['solver']['fallbacks'], 0)

    def test_a_small_load_across_a_clearance(self):
        """The plate hangs on one node: it rocks freely about it."""
        for young, pressures in (('2.1e5', ('1e-3', '5e-5', '1e-7')), ('2.1e11', ('10', ))):
            for pressure in pressures:
                result = solve(shaft('19.9', {'Traction y': '-{}*(y<0)'.format(pressure)}, young=young, centre_only=False))
                self.assertEqual(result.status, 0, result)
                results = result.summary['results']
                load = results['loads'][0]['force'][1]
                self.assertAlmostEqual(results['contact'][0]['force'][1] / load, -1, delta=1e-3)
                self.assertAlmostEqual(results['max_displacement'], 0.1, delta=0.02)

    def test_loads_that_balance_themselves(self):
        """Heat, opposed tractions: rounding decided about equilibrium (status 4), and turned the body by 4e-4."""
        def square(law='frictionless', at=(0.1, 1), loads={}, **kinds):
            return scenes.box('square', plane_state='plane stress', materials={'steel': {**STEEL, 'Thermal expansion': '1.2e-5'}}, bodies={
                'b': {'Origin': '{}, {}'.format(*at), 'Size': '8, 8', 'Cells': '6, 6', 'Material': 'steel'}},
                obstacles={'w': {'Shape': 'half plane', 'Point': '{}, {}'.format(at[0] - 0.1, at[1]), 'Normal': '1, 0'}},
                contacts={'c': {'Slave': 'b/left', 'Master': 'w', 'Law': law, **({'Friction coefficient': '0.3'} if law == 'Coulomb' else {})}},
                Output={'VTU': 'false'}, **loads, **kinds)
        cold = {'temperatures': {'cold': {'Bodies': 'b', 'Change': '-100'}}}
        three = {'Decomposition': {'Method': 'METIS', 'Subdomains': '3'}}
        pulled = {'tractions': {'top': {'Boundary': 'b/top', 'Traction y': '100'}, 'bottom': {'Boundary': 'b/bottom', 'Traction y': '-100'}}}
        half = 4 * 1.2e-3  # of the change of width
        for case, ranks, x, y in ((square(loads=cold), 1, half, half), (square('Coulomb', loads=cold, **three), 2, half, half),
                                  (square(at=(1e4, -2e4), loads=cold), 1, half, half),
                                  (square(loads=pulled, Decomposition={'Method': 'none'}), 1, 0.3 * 100 / 2.1e5 * 4, 100 / 2.1e5 * 4)):
            result = self.converges(case, 'body b', ranks=ranks)
            results = result.summary['results']
            self.assertAlmostEqual(results['max_displacement'] / math.hypot(x, y), 1, delta=1e-6)
            self.assertEqual(results['contact'][0]['normal_force'], 0)

    def test_a_ring_heated_until_it_comes_off(self):
        """And cooled again: status 4 and 3 once. The gap is even all around, 1.2e-5 * 200 * 20 - 0.02 mm."""
        steel = {**STEEL, 'Thermal expansion': '1.2e-5'}
        for law in ({'Law': 'frictionless'}, {'Law': 'Coulomb', 'Friction coefficient': '0.15'}):
            result = self.converges(scenes.box('ring', plane_state='plane stress', materials={'steel': steel}, bodies={
                'shaft': {'Shape': 'disc', 'Radius': '20', 'Cells along arc': '16', 'Material': 'steel'},
                'hub': {'Shape': 'ring', 'Inner radius': '20', 'Radius': '60', 'Cells': '16, 4', 'Material': 'steel'}},
                temperatures={'heat': {'Bodies': 'hub', 'Change': '200*(t<2)'}},
                contacts={'fit': {'Slave': 'hub/inner', 'Master': 'shaft/arc', 'Offset': '-0.02', **law}},
                Decomposition={'Method': 'none'}, Output={'VTU': 'false'}, **{'Load steps': {'Factors': '1, 2'}}), 'body hub')
            for row in result.contact:
                if row['step'] == 0:
                    self.assertAlmostEqual(row['gap'], 0.028, delta=1e-6)
            self.assertGreater(result.summary['steps'][1]['contact'][0]['normal_force'], 1000)

    def test_forces_that_are_nothing_beside_the_gap(self):
        """What the load closes elastically is 1e-10 to 1e-15 of the gap: forces must balance all the same."""
        smalbe = {'Solver': {'Algorithm': 'smalbe'}}
        for radius, pressure, where, refinements, ranks, changes in (
                ('19.9', '5e-5', '1', 1, 1, {}), ('19', '1e-10', '(y<0)', 0, 2, {}), ('19.9', '5e-5', '(y<0)', 0, 1, {}),
                ('19.9', '5e-5', '(y<0)', 0, 1, smalbe), ('19.999', '5e-5', '(y>0)', 0, 1, smalbe)):
            result = solve(shaft(radius, {'Traction y': '-{}*{}'.format(pressure, where)}, refinements, young='2.1e11',
                                 centre_only=False, **changes), ranks=ranks)
            self.assertEqual(result.status, 0, result)
            results = result.summary['results']
            self.assertAlmostEqual(results['contact'][0]['force'][1] / results['loads'][0]['force'][1], -1, delta=1e-3)


if __name__ == '__main__':
    unittest.main()
