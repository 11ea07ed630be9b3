"""What the program says of runs that end without an answer, and of answers that are doubtful; none of the shipped scenes
is."""

import unittest

from sweep import FLOOR, SOURCE, Extremes, Table, pair, scenes, shipped, solve, stack

BLOCKS = {'Decomposition/Cells per block': 10}
SQUARE = {'Size': '10, 10', 'Cells': '4, 4', 'Material': 'elastic'}


class NotConverged(Extremes):
    """Status 3: which test failed, by how much, where, and what to try."""

    def test_messages(self):
        table = Table('not converged')
        for what, case, words, overrides in (
                ('SMALBE, two outer steps', shipped('box_on_circle'),
                 ('reached its iteration limit', 'of |Pd|, the tolerance is 0.0001', 'largest error of the displacement: ',
                  'of body box', 'contact circle', 'Max outer iterations'),
                 {**BLOCKS, 'Solver/Algorithm': 'smalbe', 'Solver/SMALBE/Max outer iterations': 2}),
                ('conjugate gradients, three steps', shipped('box_linear'),
                 ('reached its iteration limit', 'the projected gradient is', 'error in the energy norm', ' of body box',
                  'Solver/PCG/Max iterations'), {**BLOCKS, 'Solver/PCG/Max iterations': 3}),
                ('tolerance below rounding', shipped('box_linear'), ('stagnated', 'set Solver/Tolerance to '),
                 {**BLOCKS, 'Solver/Tolerance': 1e-15}),
                ('check below rounding', stack(box={'Young modulus': '2.1e14'}),
                 ('the check from the recovered displacement fails: equilibrium of a node is', ' at (', ') of body box',
                  'allowed is 1.00e-08', 'this is rounding', 'set Solver/Tolerance to '), {'Solver/Tolerance': 1e-11})):
            for ranks in (1, 2):
                result = self.ends(3, table, '{}, {} rank(s)'.format(what, ranks), case, *words, overrides=overrides,
                                   ranks=ranks)
                self.assertEqual(result.summary['status'], 'not converged')
                self.assertEqual(result.stderr.count('remedy: '), 1, result)

    def test_bounds_that_smalbe_does_not_settle_are_left_to_newton(self):
        table = Table('SMALBE, one update of slip bounds')
        result = self.converges(table, 'raous', shipped('raous'),
                                {'Solver/Algorithm': 'smalbe', 'Friction/Max iterations': 1, 'Solver/Tolerance': 1e-2},
                                checks=0.05)
        self.assertEqual(result.summary['solver']['fallbacks'], 1)

    def test_bolt_tightened_by_cooling(self):
        """Head and nut of the lap joint stick and slip in turn while sets settle: solved by changing ever fewer entries. The pull
        is held by friction up to 0.2 times the normal forces on the upper plate, of the head and of the joint; beyond that the
        plates slide until the bolt bears, 1 mm and more, which is not what the linear theory is for."""
        table = Table('bolt tightened by cooling: change of temperature, part of the pull')
        cooled = {'Contact nut left/Offset': 0, 'Contact nut right/Offset': 0, 'Temperatures': 'cooling',
                  'Temperature cooling/Bodies': 'bolt'}

        def settings(change, part):
            return {**cooled, 'Temperature cooling/Change': '-{}*min(t,1)'.format(change),
                    'Traction pull/Traction x': '-9.375*{}*max(t-1,0)'.format(part)}

        for change, part in ((100, 1), (200, 1), (400, 1), (50, 0.8), (20, 0.3)):
            result = self.converges(table, '{} K, {}'.format(change, part), shipped('lap_joint'), settings(change, part),
                                    checks=1e-3)
            normal = sum(pair(result, name)['normal_force'] for name in ('head left', 'joint left'))
            self.assertLess(abs(pair(result, 'head left')['tangential_force']), 0.2 * pair(result, 'head left')['normal_force'])
            self.assertGreater(0.2 * normal, 1500 * part)
        for subdomains in (6, 12):
            self.converges(table, '100 K, {} subdomains'.format(subdomains), shipped('lap_joint'),
                           {**settings(100, 1), 'Decomposition/Subdomains': subdomains}, checks=1e-3)
        self.ends(4, table, '50 K, 1: more than friction holds', shipped('lap_joint'), 'friction is too weak',
                  'body upper plate: translation along (-1, 0)', overrides=settings(50, 1))

    def test_place_is_that_of_the_scene(self):
        """A point of the outline of the body that is named, in the units of the scene."""
        table = Table('place of the largest error')
        result = self.ends(3, table, 'box on a circle', shipped('box_on_circle'), ' of body box, contact circle',
                           overrides={**BLOCKS, 'Solver/Algorithm': 'smalbe', 'Solver/SMALBE/Max outer iterations': 2})
        x, y = (float(word) for word in result.stderr.split(' at (')[1].split(')')[0].split(','))
        self.assertEqual(y, 0)
        self.assertTrue(0 <= x <= 10 and abs(x * 2 - round(x * 2)) < 1e-9, result.stderr)  # a node: cells of 0.5 mm


class Doubtful(Extremes):
    """Status 0 with warnings: printed and in summary.json."""

    def warned(self, table, what, case, *words, overrides=None, without=()):
        result = self.converges(table, what, case, overrides)
        texts = result.summary['warnings']
        for word in words:
            self.assertTrue(any(word in text for text in texts), '{}\n{}\n{}'.format(word, texts, result))
            self.assertIn(word, result.stdout)
        for word in without:
            self.assertFalse(any(word in text for text in texts), '{}\n{}\n{}'.format(word, texts, result))
        return result

    def test_overlap_beyond_an_element(self):
        table = Table('overlap, elements of 2.5 mm')
        held = {'floor': FLOOR, 'side': {**scenes.HELD, 'Boundary': 'box/top'}}
        for overlap, doubtful in ((0.01, False), (2.4, False), (2.6, True), (4, True)):
            case = scenes.box(bodies={'base': SQUARE, 'box': {**SQUARE, 'Origin': '0, {!r}'.format(10 - overlap)}},
                              supports=held, contacts={'joint': {'Slave': 'box/bottom', 'Master': 'base/top',
                                                                 'Law': 'frictionless'}},
                              Decomposition={'Method': 'METIS', 'Subdomains': '3'}, Solver={'Tolerance': '1e-8'})
            text = ('Contact joint: its sides overlap by {:g} mm'.format(overlap),)
            self.warned(table, '{:g}'.format(overlap), case, *(text if doubtful else ()), without=() if doubtful else text)

    def test_mixed_units(self):
        table = Table('units of bodies, of loads')
        self.warned(table, 'modulus of one body in Pa', stack(box={'Young modulus': '2.1e11'}), 'body box is ',
                    'check that their meshes and materials use the same units')
        self.warned(table, 'all moduli in Pa', stack(base={'Young modulus': '2.1e11'}, box={'Young modulus': '2.1e11'}),
                    'are the moduli given in Pa', without=('same units', 'linear theory'))
        self.warned(table, 'all in m, N and Pa', stack(unit=1e3), without=('Pa',))
        self.warned(table, 'moduli in GPa', stack(base={'Young modulus': '210'}, box={'Young modulus': '210'}),
                    'the strain of body ', 'linear theory', without=('same units',))
        self.warned(table, 'load in Pa', stack(load={'Traction y': '-1e7', 'Traction x': '1e6'}),
                    'Contact joint: the pressure of ', 'is above the Young modulus of 2.1e+05 MPa', 'check the units of loads')

    def test_beyond_small_displacements(self):
        table = Table('strain, rotation, motion')
        self.warned(table, 'none of it', stack(), without=('',))
        self.warned(table, 'rubber', stack(base={'Young modulus': '150'}, box={'Young modulus': '150'}),
                    'the strain of body ', 'the rotation of body ', without=('size of the body',))
        lever = scenes.box(bodies={'box': {'Size': '200, 2', 'Cells': '80, 2', 'Material': 'elastic'}},
                           supports={'held': scenes.HELD}, tractions={'down': {'Boundary': 'box/top', 'Traction y': '-0.02'}},
                           Decomposition={'Method': 'none'}, Solver={'Tolerance': '1e-8'})
        self.warned(table, 'slender lever', lever, 'the rotation of body box at (', without=('the strain of',))
        self.warned(table, 'gap of 100 times the body', stack(contact={'Gap': '1e3'}), 'the displacement of body box at (',
                    'times the size of the body', without=('the strain of', 'the rotation of'))

    def test_sliding_beyond_an_element(self):
        """A block driven along another one by 3 mm: 12 mm of top on 10 mm, elements of 1 mm."""
        table = Table('slide [mm], elements of 2.5 mm')
        for slide, doubtful in ((1, False), (4, True)):
            case = scenes.box(bodies={'base': {**SQUARE, 'Size': '30, 10', 'Cells': '12, 4', 'Origin': '-10, 0'},
                                      'box': {**SQUARE, 'Origin': '0, 10'}},
                              supports={'floor': FLOOR, 'drive': {'Boundary': 'box/top', 'Displacement x': repr(slide),
                                                                  'Displacement y': '-0.001'}},
                              contacts={'joint': {'Slave': 'box/bottom', 'Master': 'base/top', 'Law': 'Coulomb',
                                                  'Friction coefficient': '0.1'}},
                              Decomposition={'Method': 'METIS', 'Subdomains': '3'}, Solver={'Tolerance': '1e-8'})
            text = ('Contact joint: its sides slide by',)
            self.warned(table, '{:g}'.format(slide), case, *(text if doubtful else ()), without=() if doubtful else text)

    def test_locking(self):
        table = Table('locking')
        nearly = {'Poisson ratio': '0.4999'}
        self.warned(table, 'standard', stack(base=nearly), 'standard elements lock', 'nearly incompressible',
                    overrides={'Plane state': 'plane strain'})
        self.warned(table, 'nearly incompressible', stack(base=nearly), without=('lock',),
                    overrides={'Plane state': 'plane strain', 'Discretization/Element': 'nearly incompressible'})

    def test_shipped_scenes_are_beyond_doubt(self):
        table = Table('shipped scenes')
        for path in sorted((SOURCE / 'prm').glob('*.prm')):
            overrides = BLOCKS if path.stem.startswith('box') else None
            # at the default tolerance of 1e-4 the program allows 5e-2; the tutorial has a penetration of 1.06e-3 in its second step
            # (doc/status.md), where its pressures are within 0.4 % of those at 1e-10
            result = self.converges(table, path.stem, shipped(path.stem), overrides, checks=2e-3 if path.stem == 'tutorial' else 1e-3)
            for name in ('force_balance', 'moment_balance', 'nodal_equilibrium'):
                self.assertLess(result.summary['residuals'][name], 1e-8, (path.stem, name))
            warnings = result.summary['warnings']
            if path.stem == 'dome':  # stones that stick to two neighbours and to the seat at one corner: said, and right
                self.assertEqual(len(warnings), 1, path.stem)
                self.assertIn('only the sums of the forces are determined', warnings[0])
            else:
                self.assertEqual(warnings, [], path.stem)


if __name__ == '__main__':
    unittest.main()
