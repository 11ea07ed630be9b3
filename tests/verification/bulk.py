"""Linear elasticity against a manufactured solution: observed rates of both degrees in the energy norm and at the nodes."""

import functools
import unittest

import measured
from energy import rate

manufactured = functools.lru_cache(maxsize=None)(measured.manufactured)


class Bulk(unittest.TestCase):

    def rates(self, degree, plane_state, energy_rate, nodal_rate):
        errors = [manufactured(cells, degree, plane_state) for cells in (8, 16, 32)]
        for coarse, fine in zip(errors, errors[1:]):
            self.assertGreaterEqual(rate(coarse['energy_error'], fine['energy_error']), energy_rate)
            self.assertGreaterEqual(rate(coarse['nodal_error'], fine['nodal_error']), nodal_rate)
        return errors[-1]

    def test_degree_1(self):
        self.assertLess(self.rates(1, 'plane strain', 0.95, 1.95)['energy_error'], 0.04)

    def test_degree_2(self):
        for plane_state in ('plane strain', 'plane stress'):
            with self.subTest(plane_state):
                self.assertLess(self.rates(2, plane_state, 1.95, 2.95)['energy_error'], 1e-3)

    def test_the_norm_sees_a_wrong_displacement(self):
        """Degree 1 is far from the quadratic field: this checks the check."""
        one, two = (manufactured(8, degree, 'plane strain') for degree in (1, 2))
        self.assertGreater(one['energy_error'], 5 * two['energy_error'])
        self.assertGreater(one['energy_error'], 0.1)


if __name__ == '__main__':
    unittest.main()
