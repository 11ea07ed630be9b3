"""Hertz, the NAFEMS roller, the rigid flat punch: closed forms and published figures."""

import unittest

import measured
from energy import rate

measured.RANKS = 1  # those of friction and bulk have two


class Hertz(unittest.TestCase):

    def test_forty_elements_across_the_contact(self):
        for degree, refinements, cells in ((1, 2, 44), (2, 1, 88)):
            with self.subTest(degree=degree):
                found = measured.hertz(refinements, degree, cells=cells)
                self.assertAlmostEqual(found['across'], 40, delta=3)
                self.assertLess(abs(found['p0_error']), 0.01)
                self.assertLess(abs(found['a_error_elements']), 1)
                self.assertLess(found['l2_error'], 0.03)

    def test_pressure_converges(self):
        """Its root at the ends of the contact allows order 1; between 0.5 and 1 the place of the end among the nodes and
        the coarse cells far off show."""
        for degree in (1, 2):
            errors = [measured.hertz(refinements, degree)['l2_error'] for refinements in (0, 1)]
            self.assertGreaterEqual(rate(*errors), 0.5, (degree, errors))

    def test_roller(self):
        for refinements, degree in ((1, 1), (0, 2)):
            found = measured.roller(refinements, degree)
            self.assertLess(abs(found['a_error']), 0.01, (degree, found['fitted_a']))
            self.assertLess(abs(found['a_error_elements']), 1, (degree, found['a']))
            self.assertLess(abs(found['p0_error']), 0.01, (degree, found['p0']))


class FlatPunch(unittest.TestCase):

    def test_pressure_away_from_the_corner(self):
        for degree in (1, 2):
            found = measured.flat_punch(levels=3, degree=degree)
            self.assertEqual(found['last'], 1, 'the punch ends at its corner')
            self.assertLess(found['error'], 0.01, degree)


if __name__ == '__main__':
    unittest.main()
