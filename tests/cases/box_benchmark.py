"""prm/box_on_circle.prm against the tables of the paper and the converged figures of doc/ (method, section 6)."""

import functools
import unittest

from program import converged, shipped

CELLS = [(blocks, bound) for blocks in (1, 2, 4) for bound in (500, 150)]
PRIMAL = {1: 5202, 2: 20808, 4: 83232}
KERNEL = {1: 3, 2: 12, 4: 48}
DUAL = {1: 202, 2: 808, 4: 3232}
# bound: what the paper printed and the best of PERMON, multiplications at 1e-4; converged figures
PRINTED = {500: {1: 66, 2: 90, 4: 130}, 150: {1: 78, 2: 112, 4: 161}}
PERMON = {500: {1: 54, 2: 70, 4: 93}, 150: {1: 55, 2: 77, 4: 96}}
SLIPPING = {500: {1: 0, 2: 0, 4: 1}, 150: {1: 14, 2: 29, 4: 59}}
IN_CONTACT = {500: {1: 5, 2: 10, 4: 19}, 150: {1: 5, 2: 10, 4: 20}}
PRESSURE = {500: {1: 1259.5, 2: 1276.8, 4: 1282.9}, 150: {1: 1211.2, 2: 1208.2, 4: 1212.0}}


@functools.lru_cache(maxsize=None)
def solved(blocks, bound, tolerance, algorithm='auto'):
    return converged(shipped('box_on_circle'),
                     {'Decomposition/Blocks': blocks, 'Contact circle/Slip bound': bound, 'Solver/Tolerance': tolerance, 'Solver/Algorithm': algorithm,
                      'Output/VTU': 'false'}, ranks=2 if (blocks, bound) == (4, 150) else 1)


class BoxBenchmark(unittest.TestCase):

    def test_sizes(self):
        for blocks, bound in CELLS[::2]:
            with self.subTest(blocks=blocks, bound=bound):
                problem = solved(blocks, bound, 1e-4).summary['problem']
                self.assertEqual(problem['primal_dofs'], PRIMAL[blocks])
                self.assertEqual(problem['kernel_dimension'], KERNEL[blocks])
                self.assertEqual(problem['dual']['total'], DUAL[blocks])
                self.assertEqual((problem['dual']['normal'], problem['dual']['tangential']), (50 * blocks, 50 * blocks))
                self.assertEqual((problem['subdomains'], problem['cells']), (blocks ** 2, (50 * blocks) ** 2))

    def test_multiplications_of_semismooth_newton(self):
        for blocks, bound in CELLS:
            with self.subTest(blocks=blocks, bound=bound):
                solver = solved(blocks, bound, 1e-4).summary['solver']
                self.assertEqual((solver['algorithm'], solver['fallbacks']), ('semismooth newton', 0))
                self.assertLessEqual(solver['hessian_multiplications'], 40)

    def test_multiplications_of_smalbe(self):
        for blocks, bound in CELLS:
            with self.subTest(blocks=blocks, bound=bound):
                solver = solved(blocks, bound, 1e-4, 'smalbe').summary['solver']
                self.assertEqual((solver['tolerance'], solver['algorithm'], solver['fallbacks']), (1e-4, 'smalbe', 0))
                self.assertLessEqual(solver['hessian_multiplications'], min(PRINTED[bound][blocks], PERMON[bound][blocks]))

    def test_converged_slip_and_contact_nodes(self):
        for blocks, bound in CELLS:
            with self.subTest(blocks=blocks, bound=bound):
                pair = solved(blocks, bound, 1e-8).summary['results']['contact'][0]
                self.assertLessEqual(abs(pair['slip_nodes'] - SLIPPING[bound][blocks]), 1)
                self.assertLessEqual(abs(pair['contact_nodes'] - IN_CONTACT[bound][blocks]), 1)

    def test_converged_pressure(self):
        for blocks, bound in CELLS:
            with self.subTest(blocks=blocks, bound=bound):
                pair = solved(blocks, bound, 1e-8).summary['results']['contact'][0]
                self.assertLessEqual(abs(pair['max_pressure'] - PRESSURE[bound][blocks]), 0.2)

    def test_contact_zone(self):
        for bound in (500, 150):
            closed = [row['x'] for row in solved(4, bound, 1e-8).contact if row['pressure'] > 1]
            self.assertLessEqual(abs(closed[0] - 4.61), 0.05)
            self.assertLessEqual(abs(closed[-1] - 5.54), 0.06)

    def test_default_tolerance_is_near_the_converged_answer(self):
        for blocks, bound in CELLS:
            with self.subTest(blocks=blocks, bound=bound):
                rough, fine = (solved(blocks, bound, tolerance).summary['results'] for tolerance in (1e-4, 1e-8))
                self.assertLessEqual(abs(rough['max_displacement'] / fine['max_displacement'] - 1), 1e-3)
                self.assertLessEqual(abs(rough['contact'][0]['max_pressure'] / fine['contact'][0]['max_pressure'] - 1), 1e-2)

    def test_converged_answer_passes_the_checks(self):
        for blocks, bound in CELLS:
            with self.subTest(blocks=blocks, bound=bound):
                residuals = solved(blocks, bound, 1e-8).summary['residuals']
                for name, limit in (('interface_jump', 1e-6), ('penetration', 1e-6), ('complementarity', 1e-5),
                                    ('friction_bound', 1e-5), ('force_balance', 1e-6), ('moment_balance', 1e-6)):
                    self.assertLess(residuals[name], limit, name)

    def test_forces_balance_the_load(self):
        """The circle and the held edge carry 2500 N; the circle alone less."""
        for blocks, bound in CELLS:
            with self.subTest(blocks=blocks, bound=bound):
                pair = solved(blocks, bound, 1e-8).summary['results']['contact'][0]
                self.assertTrue(0 < pair['normal_force'] < 2500)


if __name__ == '__main__':
    unittest.main()
