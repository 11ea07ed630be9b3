"""Grids graded towards the contact, where the start of the solver is far from the solution: its price, and what it finds."""

import math
import sys
import unittest

import scenes
from program import SOURCE, WORK, converged

sys.path.insert(0, str(SOURCE / 'benchmarks'))
import graded_scenes  # noqa: E402
from scene_files import Variant  # noqa: E402


class Slender(unittest.TestCase):
    """Long bodies that friction holds along their length: 8429, 5247 and 6464 multiplications without a solution as one subdomain."""

    FLOOR = {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}
    ROUGH = {'Slave': 'strip/bottom', 'Master': 'floor', 'Law': 'Coulomb', 'Friction coefficient': '0.3'}  # 0.6 MPa

    def displacements(self, case):
        """Of the probe, in every load step, and multiplications."""
        result = converged(case)
        self.assertEqual(result.summary['solver']['fallbacks'], 0)
        return ([row['u_x'] for row in result.rows('probes.csv', text=('probe',))],
                result.summary['solver']['hessian_multiplications'])

    def strip(self, cells, probe, **kinds):
        return scenes.box('strip', **{
            'materials': {'soft': {'Young modulus': '1e5', 'Poisson ratio': '0', 'Thermal expansion': '1e-5'}},
            'bodies': {'strip': {'Size': '100, 1', 'Cells': cells, 'Material': 'soft'}}, 'obstacles': {'floor': self.FLOOR},
            'contacts': {'rough': self.ROUGH}, 'probes': {'end': {'Body': 'strip', 'Point': probe}},
            'Decomposition': {'Method': 'auto'}, 'Solver': {'Tolerance': '1e-8'}, **kinds})

    def test_bar_pushed_along_a_rough_floor(self):
        found, n = self.displacements(self.strip('100, 1', '0, 0.5', **{'Load steps': {'Factors': '0.5, 1, 1.5, 2'}}, tractions={
            'press': {'Boundary': 'strip/top', 'Pressure': '2'}, 'push': {'Boundary': 'strip/left', 'Traction x': '30*min(t,2-t)'}}))
        for value, wanted in zip(found, (1.875e-3, 7.5e-3, 6.5625e-3, 3.75e-3)):  # as a bar of one dimension
            self.assertAlmostEqual(value / wanted, 1, delta=0.02)
        self.assertLess(n, 300)

    def test_bar_pulled_back_and_forth(self):
        """6543 multiplications when slips began with the error of the load step before; far from the end nodes neither stick nor slip."""
        for tolerance in ('1e-4', '1e-6'):
            found, n = self.displacements(self.strip('60, 1', '60, 0.5', **{
                'bodies': {'strip': {'Size': '60, 1', 'Cells': '120, 2', 'Material': 'soft'}}, 'Solver': {'Tolerance': tolerance},
                'contacts': {'rough': {**self.ROUGH, 'Friction coefficient': '0.4'}}, 'Load steps': {'Factors': '0.25:0.25:5'}, 'tractions': {
                    'press': {'Boundary': 'strip/top', 'Pressure': '50'},
                    'pull': {'Boundary': 'strip/right', 'Traction x': '800*(t<=1 ? t : (t<=3 ? 2-t : t-4))'}}}))
            for t, wanted in ((1, 0.16), (2, 0.08), (3, -0.16), (4, -0.08), (5, 0.16)):  # F^2 / (2 q E A), and Masing's rule
                self.assertAlmostEqual(found[4 * t - 1] / wanted, 1, delta=0.03)
            self.assertLess(n, 1100)

    def test_strip_heated_and_cooled(self):
        found, n = self.displacements(self.strip(
            '200, 2', '100, 0.5', **{'Load steps': {'Factors': '1, 2, 3'}}, tractions={'press': {'Boundary': 'strip/top', 'Pressure': '2'}},
            supports={'end': {'Boundary': 'strip/left', 'Displacement x': '0'}},
            temperatures={'heat': {'Bodies': 'strip', 'Change': '20*(t<=1 ? t : (t<=2 ? 2-t : t-2))'}}))
        for value, wanted in zip(found, (1 / 300, 1 / 600, 1 / 300)):
            self.assertAlmostEqual(value / wanted, 1, delta=0.025)
        self.assertLess(n, 450)

    def test_belt_on_a_drum(self):
        """Euler and Eytelwein, with the drum's radius for friction and the middle of the belt for its forces."""
        inner, middle, mu = 50, 50.25, 0.3
        case = scenes.box('belt', materials={'soft': {'Young modulus': '1e5', 'Poisson ratio': '0.3'}},
                          bodies={'belt': {'Shape': 'quarter ring', 'Inner radius': '50', 'Radius': '50.5', 'Cells': '180, 2',
                                           'Material': 'soft'}},
                          obstacles={'drum': {'Shape': 'circle', 'Center': '0, 0', 'Radius': '50'}},
                          supports={'pull': {'Boundary': 'belt/start', 'Displacement y': '-1'}},
                          tractions={'weight': {'Boundary': 'belt/end', 'Traction x': '-20'}},
                          contacts={'wrap': {'Slave': 'belt/inner', 'Master': 'drum', 'Law': 'Coulomb', 'Friction coefficient': mu}},
                          Decomposition={'Method': 'auto'}, Solver={'Tolerance': '1e-8'})
        result = converged(case)
        ratio = abs(result.summary['results']['supports'][0]['force'][1]) / 10  # over the weight
        self.assertAlmostEqual(ratio, math.exp(mu * math.pi / 2 * inner / middle), delta=0.02)
        self.assertLess(result.summary['solver']['hessian_multiplications'], 400)


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
