"""Tolerances from 1e-2 to 1e-13: what is reached, or that it cannot be; the same input gives the same bits."""

import pathlib
import unittest

from sweep import QUIET, Extremes, Table, figures, scenes, shipped, solve, stack

BLOCKS = {'Decomposition/Cells per block': 10}


class Accuracy(Extremes):

    def test_tolerance(self):
        """Errors against the answer to 1e-13 fall with the tolerance."""
        for what, case, overrides in (('stack', stack(), {}), ('box on a circle', shipped('box_on_circle'), BLOCKS),
                                      ('box without contact', shipped('box_linear'), BLOCKS),
                                      ('Hertz', shipped('hertz'), {'Traction load/Traction x': '0'})):
            table = Table(what + ': tolerance')
            energy = {}
            for power in (13, 12, 10, 8, 6, 4, 2):
                tolerance = 10.**-power
                result = self.converges(table, '1e-{}'.format(power), case, {**overrides, 'Solver/Tolerance': tolerance},
                                        checks=min(0.05, 1000 * tolerance))
                energy[power] = result.summary['results']['strain_energy']
                self.near(energy[power], energy[13], min(0.1, 1000 * tolerance), power)

    def test_tolerance_with_smalbe(self):
        table = Table('box on a circle, SMALBE: tolerance')
        for power in (2, 4, 8, 12, 13):
            self.converges(table, '1e-{}'.format(power), shipped('box_on_circle'),
                           {**BLOCKS, 'Solver/Tolerance': 10.**-power, 'Solver/Algorithm': 'smalbe'},
                           checks=min(0.05, 1000 * 10.**-power))

    def test_coarse_tolerances_pass_the_checks(self):
        """|Pd| may be large against what is left of it in the displacement: 0.1 of it is no answer, and is solved on."""
        table = Table('Hertz and box, coarse tolerances')
        for tolerance in (0.5, 0.1, 0.03):
            self.converges(table, 'Hertz, {:g}'.format(tolerance), shipped('hertz'), {'Solver/Tolerance': tolerance}, checks=0.05)
            self.converges(table, 'box on a circle, {:g}'.format(tolerance), shipped('box_on_circle'),
                           {**BLOCKS, 'Solver/Tolerance': tolerance}, checks=0.05)

    def test_largest_displacement_where_a_support_moves(self):
        """The coarse mesh has its largest displacement at the support, 0.03; the right one is elsewhere. 0.0307: with
        Refinements = 1 of degree 2 0.03067 +- 9e-5, with 2 of degree 1 0.03072 +- 4e-5."""
        case = pathlib.Path(__file__).parent / 'prescribed_maximum.prm'
        for degree in (1, 2):
            result = solve(case, {'Discretization/Degree': degree, 'Output/VTU': 'false'})
            self.assertEqual(result.status, 0, result)
            bar = next(bar for bar in result.summary['error_bars'] if bar['quantity'] == 'max_displacement')
            missing = abs(bar['value'] - 0.0307)
            self.assertLess(missing / 5, bar['error'])
            self.assertLess(bar['error'], missing)

    def test_tolerance_that_rounding_forbids(self):
        """The message names the tolerance that can be reached, and it can."""
        table = Table('stiffness ratio, tolerance beyond rounding')
        for ratio, tolerance in ((1e6, 1e-13), (1e9, 1e-10)):
            case = stack(box={'Young modulus': repr(2.1e5 * ratio)})
            result = self.ends(3, table, '{:g}, {:g}'.format(ratio, tolerance), case, 'this is rounding', ' of body box',
                               'set Solver/Tolerance to ', overrides={'Solver/Tolerance': tolerance})
            self.assertIs(result.summary['converged'], False)
            reachable = result.stderr.split('set Solver/Tolerance to ')[1].split()[0]
            self.assertLess(float(reachable), 1e-6)
            self.converges(table, '{:g}, {} as it says'.format(ratio, reachable), case,
                           {'Solver/Tolerance': float(reachable)}, checks=1000 * float(reachable))
        table = Table('no contact, tolerance beyond rounding')
        result = self.ends(3, table, '1e-15', shipped('box_linear'), 'stagnated', 'the projected gradient is',
                           ' of body box', overrides={**BLOCKS, 'Solver/Tolerance': 1e-15})
        reachable = result.stderr.split('set Solver/Tolerance to ')[1].split()[0]
        self.converges(table, reachable + ' as it says', shipped('box_linear'),
                       {**BLOCKS, 'Solver/Tolerance': float(reachable)})

    def test_errors_that_are_rounding(self):
        """One node of a half disc touches, and the solution is exact: squared errors were negative, their root no number."""
        table = Table('one node in contact')
        for cells in (96, 160):
            body = {'Shape': 'half disc', 'Center': '0, 20', 'Radius': '20', 'Cells along arc': cells, 'Material': 'soft'}
            disc = scenes.box(plane_state='plane strain', bodies={'disc': body},
                              materials={'soft': {'Young modulus': '1e4', 'Poisson ratio': '0.3'}},
                              obstacles={'plane': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}},
                              supports={'middle': {'Body': 'disc', 'Point': '0, 20', 'Displacement x': '0'}},
                              tractions={'load': {'Boundary': 'disc/flat', 'Pressure': '0.01'}},
                              contacts={'touch': {'Slave': 'disc/arc', 'Master': 'plane', 'Law': 'frictionless'}},
                              Decomposition={'Method': 'auto'}, Solver={'Tolerance': '1e-4'})
            result = self.converges(table, cells, disc)
            self.assertLess(result.summary['error']['algebraic_relative'], 1e-6)

    def test_same_input_and_ranks_give_the_same_bits(self):
        table = Table('twice the same')
        for what, case, overrides in (('stack', stack(cells=(6, 4)), {}),  # clamp: tests/cases/multibody_invariance.py
                                      ('two load steps', shipped('cattaneo_mindlin'), {}),
                                      ('box, SMALBE', shipped('box_on_circle'), {**BLOCKS, 'Solver/Algorithm': 'smalbe'})):
            for ranks in (1, 2):
                one, other = (solve(case, {**QUIET, **overrides}, ranks=ranks) for _ in range(2))
                table.add('{}, {} rank(s)'.format(what, ranks), other)
                self.assertEqual(other.status, 0, other)
                self.assertEqual(figures(one), figures(other))
                for name in ('contact.csv', 'convergence.csv'):
                    self.assertEqual((one.directory / name).read_bytes(), (other.directory / name).read_bytes(), name)


if __name__ == '__main__':
    unittest.main()
