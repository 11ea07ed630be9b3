"""Grids graded towards the contact, where the start of the solver is far from the solution: its price, and what it finds."""

import sys
import unittest

from program import SOURCE, WORK, converged

sys.path.insert(0, str(SOURCE / 'benchmarks'))
import graded_scenes  # noqa: E402
from scene_files import Variant  # noqa: E402


class Graded(unittest.TestCase):
    # 1362 and 8047 multiplications by way of the fallback, before the first step was taken as a whole
    def test_no_fallback_and_few_multiplications_without_friction(self):
        for smallest, degree in ((graded_scenes.SMALLEST, 1), (graded_scenes.STEEP, 2)):
            with self.subTest(smallest=smallest, degree=degree):
                scene = graded_scenes.circle(Variant(degree, 8), 50, 'frictionless', smallest).write(WORK / str(degree))
                result = converged(scene, {'Solver/Tolerance': '1e-8'})
                solver = result.summary['solver']
                self.assertEqual(solver['fallbacks'], 0)
                self.assertLess(solver['hessian_multiplications'], 110)
                # 814.5 N/mm by Hertz' formula
                self.assertAlmostEqual(result.summary['results']['contact'][0]['normal_force'], 814.5, delta=4)

    # 135 and 2096 multiplications in 21 and 195 steps, with a fallback, when the residual knew the stiffness of bodies only
    def test_few_steps_with_coulomb_friction(self):
        for smallest, degree, most in ((graded_scenes.SMALLEST, 1, 100), (graded_scenes.STEEP, 2, 300)):
            with self.subTest(smallest=smallest, degree=degree):
                scene = graded_scenes.circle(Variant(degree, 8), 50, 'coulomb0.2', smallest).write(WORK / f'coulomb-{degree}')
                solver = converged(scene, {'Solver/Tolerance': '1e-8'}).summary['solver']
                self.assertEqual(solver['fallbacks'], 0)
                self.assertLessEqual(solver['outer_iterations'], 25)
                self.assertLess(solver['hessian_multiplications'], most)

    # Bodies that contact alone holds; 208 (92 steps), 166 (66, a fallback) and 342 (127) when unbalanced forces moved them however
    # small they were. The four steps of the bolted joint are all counted.
    def test_loose_bodies_on_meshes_refined_towards_the_contact(self):
        def refined(levels, **sides):
            return {'Body {}/Refine {}'.format(body, name): value
                    for body, side in sides.items() for name, value in (('towards', side), ('levels', levels))}
        for name, settings, steps, most in (
                ('hertz_ball', refined(3, ball='contact of ball', block='contact of block'), 20, 60),
                ('cattaneo_mindlin', {'Discretization/Degree': 1, **refined(2, upper='contact', lower='contact')}, 30, 80),
                ('bolted_joint', {'Discretization/Refinements': 1}, 70, 180)):
            with self.subTest(name=name):
                solver = converged(SOURCE / 'prm' / (name + '.prm'), {'Solver/Tolerance': '1e-8', **settings}).summary['solver']
                self.assertEqual(solver['fallbacks'], 0)
                self.assertLessEqual(solver['outer_iterations'], steps)
                self.assertLess(solver['hessian_multiplications'], most)


if __name__ == '__main__':
    unittest.main()
