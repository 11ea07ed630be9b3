"""Friction in space where the solver has to work: fallbacks, discs beside intervals, rollers, loads that friction does not bear."""

import math
import pathlib
import unittest

import scenes
from program import converged, shipped, solve

STEEL = {'Young modulus': '2e5', 'Poisson ratio': '0.3'}
HELD = {'Displacement ' + c: '0' for c in 'xyz'}


def solid(name, subdomains, seed, **kinds):
    lines = scenes.text(**{'materials': {'steel': STEEL},
                           'Decomposition': {'Method': 'METIS', 'Subdomains': str(subdomains), 'Seed': str(seed)},
                           **kinds}).split('\n')
    return scenes.write(name, '\n'.join(['set Dimension = 3'] + lines[1:]))  # the first one sets the plane state


def ring(law):
    """A ring pressed on a shaft by so much that most of it lifts off again, and drawn along it."""
    return solid('ring', 5, 1,
                 bodies={'shaft': {'Shape': 'cylinder', 'Radius': '20.1', 'Length': '8', 'Cells around': '24',
                                   'Cells along axis': '2', 'Material': 'steel'},
                         'ring': {'Shape': 'tube', 'Radius': '40', 'Inner radius': '20', 'Length': '5', 'Center': '0, 0, 1.5',
                                  'Cells around': '16', 'Cells along axis': '2', 'Material': 'steel'}},
                 supports={'back': {'Boundary': 'shaft/back', **HELD}, 'front': {'Boundary': 'ring/front', 'Displacement z': '0.01'}},
                 contacts={'fit': {'Slave': 'ring/inner', 'Master': 'shaft/side', **law}})


def roller(force_z, seed, subdomains):
    """A cylinder on a plane, held along its axis at one end and kept from rolling at the other: nodes there have one tangent, all
    others two."""
    return solid('roller', subdomains, seed,
                 obstacles={'floor': {'Shape': 'half space', 'Point': '0, -5, 0', 'Normal': '0, 1, 0'}},
                 bodies={'roller': {'Shape': 'cylinder', 'Radius': '5', 'Length': '10', 'Cells around': '24',
                                    'Cells along axis': '4', 'Material': 'steel'}},
                 supports={'end': {'Boundary': 'roller/back', 'Displacement z': '0'},
                           'other end': {'Boundary': 'roller/front', 'Displacement x': '0'}},
                 body_forces={'weight': {'Bodies': 'roller', 'Force y': '-1', 'Force z': str(force_z)}},
                 contacts={'joint': {'Slave': 'roller/side', 'Master': 'floor', 'Law': 'Coulomb', 'Friction coefficient': '0.1'}})


def free_roller(seed):
    """Without friction it also slides and rolls freely: the gaps of its open nodes are large beside all displacements."""
    return solid('free roller', 2, seed,
                 obstacles={'floor': {'Shape': 'half space', 'Point': '0, -5, 0', 'Normal': '0, 1, 0'}},
                 bodies={'roller': {'Shape': 'cylinder', 'Radius': '5', 'Length': '10', 'Cells around': '24',
                                    'Cells along axis': '6', 'Material': 'steel'}},
                 supports={'end': {'Boundary': 'roller/back', 'Displacement z': '0'}},
                 body_forces={'weight': {'Bodies': 'roller', 'Force y': '-1', 'Force z': '0.05'}},
                 contacts={'joint': {'Slave': 'roller/side', 'Master': 'floor', 'Law': 'frictionless'}})


def blocks(coefficient, **traction):
    """A block that friction alone holds on another."""
    return solid('blocks', 4, 0,
                 bodies={'low': {'Size': '10, 10, 10', 'Cells': '5, 4, 5', 'Material': 'steel'},
                         'high': {'Size': '10, 10, 10', 'Cells': '4, 3, 4', 'Origin': '0, 10, 0', 'Material': 'steel'}},
                 supports={'floor': {'Boundary': 'low/bottom', **HELD}},
                 tractions={'load': {'Boundary': 'high/top', 'Traction x': '0.8', 'Traction z': '0.6',
                                     'Traction y': '-10*(1+x/10)/1.5'}},
                 contacts={'joint': {'Slave': 'high/bottom', 'Master': 'low/top', 'Law': 'Coulomb',
                                     'Friction coefficient': str(coefficient)}},
                 Solver={'Tolerance': '1e-8'})


class Fallback(unittest.TestCase):
    """Newton's method ends far from the solution; SMALSE-M leads to where it converges."""

    def test_ring_that_lifts_off(self):
        result = converged(ring({'Law': 'Tresca', 'Slip bound': '100'}))
        self.assertIn('slip', [row['status'] for row in result.contact])
        largest = max(row['pressure'] for row in result.contact)
        for row in result.contact:
            self.assertGreaterEqual(row['pressure'], 0)
            if row['pressure'] > 1e-3 * largest:
                self.assertAlmostEqual(row['gap'], 0, delta=1e-5)
            if row['status'] == 'slip':
                self.assertAlmostEqual(abs(row['tangential_traction']) / row['slip_bound'], 1, delta=1e-3)

    def test_the_published_method_comes_to_the_same_forces(self):
        coarse = {'Decomposition/Cells per block': 4}
        for law in ({}, {'Contact sphere/Law': 'Tresca', 'Contact sphere/Slip bound': 100}):
            pairs = [converged(shipped('cube_on_sphere'), {**coarse, **law, 'Solver/Algorithm': algorithm,
                                                           'Solver/Tolerance': 1e-6}).summary['results']['contact'][0]
                     for algorithm in ('semismooth newton', 'smalbe')]
            for name in ('normal_force', 'tangential_force', 'max_pressure'):
                self.assertAlmostEqual(pairs[1][name] / pairs[0][name], 1, delta=1e-4)
            for name in ('contact_nodes', 'stick_nodes', 'slip_nodes'):
                self.assertEqual(pairs[1][name], pairs[0][name])


class HeldSlave(unittest.TestCase):
    """A clamped end that the ring reaches, on the finer side: 32 nodes there would have rows that move 20 nodes of the ring."""

    def fit(self, slave, master):
        return converged(solid(
            'fit', 8, 1,
            bodies={'shaft': {'Shape': 'cylinder', 'Radius': '20.02', 'Length': '8', 'Cells around': '32',
                              'Cells along axis': '3', 'Material': 'steel'},
                    'ring': {'Shape': 'tube', 'Radius': '40', 'Inner radius': '20', 'Length': '5', 'Center': '0, 0, 1.5',
                             'Cells around': '20', 'Cells along axis': '3', 'Material': 'steel'}},
            supports={'back': {'Boundary': 'shaft/back', **HELD}, 'front': {'Boundary': 'ring/front', 'Displacement z': '0.01'}},
            contacts={'joint': {'Slave': slave, 'Master': master, 'Law': 'Coulomb', 'Friction coefficient': '0.3'}}))

    def test_ring_drawn_over_a_clamped_end(self):
        result, exchanged = self.fit('shaft/side', 'ring/inner'), self.fit('ring/inner', 'shaft/side')
        pair, other = (run.summary['results']['contact'][0] for run in (result, exchanged))
        self.assertAlmostEqual(pair['normal_force'] / other['normal_force'], 1, delta=0.01)  # 1.024 with these rows
        self.assertLess(pair['max_pressure'], 200)  # 587 with these rows
        self.assertTrue(all(row['z'] > 0 for row in result.contact))
        self.assertLess(result.summary['solver']['hessian_multiplications'], 300)  # 1271 with these rows
        for run, of_pair in ((result, pair), (exchanged, other)):
            force_z = [entry for entry in run.summary['results']['supports'] if entry['support'] == 'front'][0]['force'][2]
            self.assertAlmostEqual(force_z / (0.3 * of_pair['normal_force']), 1, delta=1e-3)  # all of it slips


class SlidingRing(unittest.TestCase):

    def test_slip_is_opposite_to_friction_where_all_of_a_body_slides(self):
        """A ring turned on its shaft, held by friction alone along the axis: its axial position follows from the directions of slip.
        Without them this scene ended with status 3 and slips up to 9 degrees off."""
        case = solid(
            'ring', 3, 2,
            bodies={'shaft': {'Shape': 'cylinder', 'Radius': '20.1', 'Length': '8', 'Cells around': '24', 'Cells along axis': '2',
                              'Material': 'steel'},
                    'ring': {'Shape': 'tube', 'Radius': '30', 'Inner radius': '20', 'Length': '5', 'Center': '0, 0, 1.5',
                             'Cells around': '16', 'Cells along axis': '2', 'Material': 'steel'}},
            supports={'end': {'Boundary': 'shaft/back', **HELD},
                      'driven': {'Boundary': 'ring/outer', 'Displacement x': '-0.001*y', 'Displacement y': '0.001*x'}},
            contacts={'fit': {'Slave': 'shaft/side', 'Master': 'ring/inner', 'Law': 'Tresca', 'Slip bound': '10'}})
        for tolerance, angle in (('1e-4', 0.3), ('1e-5', 0.02)):  # degrees
            result = converged(case, {'Solver/Tolerance': tolerance})
            slipping = [row for row in result.contact if row['status'] == 'slip' and row['slip'] > 1e-6]
            self.assertGreater(len(slipping), 20)
            for row in slipping:
                work = sum(row['traction_' + c] * row['slip_' + c] for c in 'xyz')
                self.assertAlmostEqual(work / (row['tangential_traction'] * row['slip']), -1, delta=math.radians(angle) ** 2 / 2)


class DraggedStrip(unittest.TestCase):
    """A strip on a floor whose end is pulled far beyond all strains: friction alone holds it across, hardly, since its force turns
    with the slip. If such forces were held, one of them left free would carry everything: status 3 after 5000 multiplications."""

    def strip(self, subdomains, size, pull, **law):
        return solid('strip', subdomains, 0,
                     obstacles={'floor': {'Shape': 'half space', 'Point': '0, 0, 0', 'Normal': '0, 1, 0'}},
                     bodies={'strip': {'Size': size, 'Cells': '40, 1, 2', 'Material': 'steel'}},
                     supports={'end': {'Boundary': 'strip/right', 'Displacement x': pull}},
                     tractions={'load': {'Boundary': 'strip/top', 'Pressure': '0.5'}},
                     contacts={'joint': {'Slave': 'strip/bottom', 'Master': 'floor', **law}})

    def test_slender_strips_are_cut(self):
        """With one subdomain status 3 after more than 6000 multiplications."""
        for pull in ('0.002', '0.02'):
            scene = self.strip('auto', '100, 0.5, 4', pull, **{'Law': 'Coulomb', 'Friction coefficient': '0.3'})
            found = converged(scene).summary
            self.assertGreater(found['problem']['subdomains'], 10)
            self.assertLessEqual(found['solver']['hessian_multiplications'], 400)

    def test_thin_rings_are_not_cut(self):
        """In 23 subdomains 379 multiplications, 114 without friction."""
        tube = {'Shape': 'tube', 'Length': '1', 'Cells around': '40', 'Cells along axis': '1', 'Material': 'steel'}
        for law, most in (({'Law': 'frictionless'}, 30), ({'Law': 'Coulomb', 'Friction coefficient': '0.1'}, 280)):
            scene = solid('rings', 'auto', 0,
                          bodies={'shaft': {**tube, 'Inner radius': '10', 'Radius': '20'},
                                  'ring': {**tube, 'Inner radius': '20', 'Radius': '40'}},
                          supports={body: {'Boundary': body + '/back', 'Displacement normal': '0'} for body in ('shaft', 'ring')},
                          contacts={'fit': {'Slave': 'ring/inner', 'Master': 'shaft/outer', 'Gap': '-0.02', **law}})
            found = converged(scene, {'Solver/Tolerance': '1e-8'}).summary
            self.assertEqual(found['problem']['subdomains'], 2)
            self.assertLessEqual(found['solver']['hessian_multiplications'], most)

    def test_forces(self):
        for law, bound in (('Coulomb', {'Friction coefficient': '0.3'}), ('Tresca', {'Slip bound': '0.15'})):
            # of 1000 mm, rounding is above 1e-8 of the strains; at 1e-7 some pulls, 900 and 1000 mm, end with status 3
            for pull, tolerance in (('1', '1e-8'), ('1000', '3e-6')):
                scene = self.strip(8, '100, 2, 4', pull, Law=law, **bound)
                found = converged(scene, {'Solver/Tolerance': tolerance}).summary
                self.assertAlmostEqual(found['results']['contact'][0]['force'][0], -60, delta=0.01, msg=f'{law} {pull}')
                self.assertLessEqual(found['solver']['hessian_multiplications'], 300, f'{law} {pull}')


class TurnedDisc(unittest.TestCase):
    """Slips of 1e3 to 1e5 times what forces across them strain: thousands of multiplications, or status 3."""

    def test_all_nodes_slip(self):
        scene = pathlib.Path(__file__).parent / 'turned_disc.prm'
        for coefficient, subdomains, most in ((0.1, 2, 120), (0.2, 4, 300), (0.3, 8, 200)):
            found = converged(scene, {'Contact A/Friction coefficient': coefficient, 'Decomposition/Method': 'METIS',
                                      'Decomposition/Subdomains': subdomains, 'Output/VTU': 'false'}).summary
            pair = found['results']['contact'][0]
            self.assertEqual(pair['slip_nodes'], pair['contact_nodes'])
            self.assertAlmostEqual(pair['tangential_force'] / pair['normal_force'] / coefficient, 1, delta=1e-6)
            self.assertLessEqual(found['solver']['hessian_multiplications'], most, coefficient)


class Rollers(unittest.TestCase):

    def test_forces_are_told_beside_large_gaps(self):
        """The tolerance is relative to those gaps: at 1e-4 of them nodes were pulled by 0.2 to 0.5 % of the largest pressure."""
        for seed in range(1, 5):
            rows = converged(free_roller(seed)).contact
            pressures = [row['pressure'] for row in rows]
            self.assertGreater(min(pressures), -1e-5 * max(pressures), seed)

    def test_discs_beside_intervals(self):
        for force_z, seed, subdomains in ((0, 8, 8), (0.05, 3, 12), (0.05, 1, 8), (0, 2, 12)):
            summary = converged(roller(force_z, seed, subdomains)).summary
            pair = summary['results']['contact'][0]
            self.assertEqual(summary['solver']['fallbacks'], 0)
            self.assertLess(summary['solver']['hessian_multiplications'], 80)  # 24 to 44 with 24 other cuts
            self.assertAlmostEqual(pair['normal_force'] / abs(pair['force'][1]), 1, delta=1e-6)
            self.assertLess(summary['results']['max_displacement'], 0.01)  # it does not roll


class Loose(unittest.TestCase):
    """A block between a floor and a block that a support moves, both with friction."""

    def between(self, factors, lower, **kinds):
        return solid('between', 2, 0,
                     bodies={'lo': {'Size': '4, 2, 4', 'Cells': '2, 1, 2', 'Material': 'steel', **lower},
                             'up': {'Origin': '0.5, 2, 0.5', 'Size': '3, 2, 3', 'Cells': '2, 1, 2', 'Material': 'steel'}},
                     obstacles={'floor': {'Shape': 'half space', 'Point': '0, 0, 0', 'Normal': '0, 1, 0'}},
                     supports={'drive': {'Boundary': 'up/top', 'Displacement x': '0.005*t', 'Displacement y': '-0.02*min(t, 2-t)',
                                         'Displacement z': '0.003*t'}},
                     contacts={name: {'Slave': slave, 'Master': master, 'Law': 'Coulomb', 'Friction coefficient': '0.3'}
                               for name, slave, master in (('c', 'up/bottom', 'lo/top'), ('f', 'lo/bottom', 'floor'))},
                     Solver={'Tolerance': '1e-8'}, **{'Load steps': {'Factors': factors}}, **kinds)

    def test_unloaded(self):
        """The direction of friction forces of 1e-6 N was checked as if they bent the block: status 3 after up to 6036
        multiplications."""
        for factors, lower, degree in (('1, 2', {}, '1'), ('1, 1.5, 2', {}, '1'), ('1, 2', {}, '2'), ('1, 2', {'Cells': '3, 2, 3'}, '1')):
            summary = converged(self.between(factors, lower, Discretization={'Degree': degree})).summary
            self.assertLess(max(step['hessian_multiplications'] for step in summary['steps']), 100)
            for pair in summary['results']['contact']:
                self.assertLess(pair['normal_force'], 1e-4)  # 4e4 N in the first step

    def test_pushed_within_its_gap(self):
        """A node that was freed in part was put on an infinite bound: forces NaN, status 3."""
        results = converged(str(pathlib.Path(__file__).parent / 'pushed_within_gap.prm')).summary['results']
        for pair in results['contact']:
            self.assertLess(pair['normal_force'], 1e-6)


class TooWeak(unittest.TestCase):

    def test_friction_that_does_not_bear_the_load(self):
        for coefficient in (0, 1e-6, 0.05, 0.09):
            result = solve(blocks(coefficient))
            self.assertEqual(result.status, 4, result)
            self.assertIn('body high', result.stderr)
        converged(blocks(0.15))


if __name__ == '__main__':
    unittest.main()
