"""Linear scenes against closed forms, and that a scene carries only what it requires."""

import unittest

import fields
import scenes
from program import converged, shipped

LENGTH, HEIGHT, E, NU, STRESS = 10., 2., 1e5, 0.3, 100.

SINGLE = 2e-7  # .vtu files hold single precision


def bar(ratio, supports, tractions, plane_state='plane stress', thickness='1', tolerance='1e-12'):
    return scenes.box(plane_state=plane_state,
                      materials={'elastic': {'Young modulus': E, 'Poisson ratio': ratio}},
                      bodies={'box': {'Size': '10, 2', 'Material': 'elastic', 'Thickness': thickness}},
                      supports=supports, tractions=tractions,
                      Decomposition={'Method': 'blocks', 'Blocks': '2', 'Cells per block': '4', 'Subdomains': '3'},
                      Solver={'Tolerance': tolerance})


CLAMPED = {'held': scenes.HELD}
ROLLERS = {'wall': {'Boundary': 'box/left', 'Displacement x': '0'},
           'floor': {'Boundary': 'box/bottom', 'Displacement y': '0'}}
PULLED = {'pulled': {'Boundary': 'box/right', 'Traction x': STRESS}}
DECOMPOSITIONS = ({}, {'Decomposition/Method': 'METIS'}, {'Decomposition/Method': 'none'})


class Linear(unittest.TestCase):

    def uniform(self, result, strain_x, strain_y, stress_x, stress_y=0., thickness=1., stress_z=0.):
        """u = (strain_x x, strain_y y) everywhere, and what follows from it."""
        summary = result.summary
        results = summary['results']
        self.assertEqual(summary['solver']['algorithm'], 'pcg')
        largest = ((strain_x * LENGTH) ** 2 + (strain_y * HEIGHT) ** 2) ** 0.5
        self.assertAlmostEqual(results['max_displacement'] / largest, 1, delta=1e-8)
        energy = (strain_x * stress_x + strain_y * stress_y) / 2 * LENGTH * HEIGHT * thickness
        self.assertAlmostEqual(results['strain_energy'] / energy, 1, delta=1e-8)
        self.assertLess(summary['error']['estimate_energy_relative'], 1e-7)
        for (x, y, _), copies in fields.field(result.directory, 'displacement').items():
            for u in copies:
                self.assertAlmostEqual(u[0] / largest, strain_x * x / largest, delta=SINGLE)
                self.assertAlmostEqual(u[1] / largest, strain_y * y / largest, delta=SINGLE)
        exact = (stress_x, 0, 0, 0, stress_y, 0, 0, 0, stress_z)
        for copies in fields.field(result.directory, 'stress').values():
            for stress in copies:
                for value, expected in zip(stress, exact):
                    self.assertAlmostEqual(value / stress_x, expected / stress_x, delta=SINGLE)
        return results

    def test_bar_without_lateral_strain(self):
        for decomposition in DECOMPOSITIONS:
            for ranks in (1, 2):
                result = converged(bar('0', CLAMPED, PULLED), decomposition, ranks)
                results = self.uniform(result, STRESS / E, 0, STRESS)
                self.assertAlmostEqual(results['max_von_mises'] / STRESS, 1, delta=1e-8)

    def test_bar_in_plane_stress(self):
        results = self.uniform(converged(bar(NU, ROLLERS, PULLED, thickness='3')), STRESS / E,
                               -NU * STRESS / E, STRESS, thickness=3)
        self.assertAlmostEqual(results['max_von_mises'] / STRESS, 1, delta=1e-8)

    def test_bar_in_plane_strain(self):
        results = self.uniform(converged(bar(NU, ROLLERS, PULLED, 'plane strain')), (1 - NU * NU) * STRESS / E,
                               -NU * (1 + NU) * STRESS / E, STRESS, stress_z=NU * STRESS)
        mises = STRESS * (1 - NU + NU * NU) ** 0.5  # stresses STRESS, 0, NU STRESS
        self.assertAlmostEqual(results['max_von_mises'] / mises, 1, delta=1e-8)

    def test_bar_with_prescribed_elongation(self):
        supports = {**ROLLERS, 'pull': {'Boundary': 'box/right', 'Displacement x': '0.01'}}
        self.uniform(converged(bar(NU, supports, {})), 1e-3, -NU * 1e-3, 1e-3 * E)

    def test_prescribed_displacement_by_formula(self):
        """Linear displacements on the whole boundary: constant strain, whatever the element."""
        formula = {'Displacement x': '1e-3*x', 'Displacement y': '2e-3*y'}
        supports = {side: {'Boundary': 'box/' + side, **formula} for side in ('left', 'right', 'bottom', 'top')}
        factor = E / (1 - NU * NU)
        for degree in (1, 2):
            self.uniform(converged(bar(NU, supports, {}), {'Discretization/Degree': degree}, ranks=2), 1e-3, 2e-3,
                         factor * (1e-3 + NU * 2e-3), factor * (2e-3 + NU * 1e-3))

    def test_loads_on_held_boundaries_alone_strain_nothing(self):
        """What rounding leaves of the displacement is no reason to doubt the answer."""
        disc = {'disc': {'Shape': 'disc', 'Radius': '1', 'Cells along arc': '24', 'Material': 'elastic'}}
        case = scenes.box(materials={'elastic': {'Young modulus': '2.1e5', 'Poisson ratio': NU}}, bodies=disc,
                          supports={'rim': {'Boundary': 'disc/arc', 'Displacement x': '0', 'Displacement y': '0'}},
                          tractions={'down': {'Boundary': 'disc/arc', 'Traction y': '-10'}}, Decomposition={'Method': 'METIS'})
        for subdomains in (1, 2, 5):
            results = converged(case, {'Decomposition/Subdomains': subdomains}).summary['results']
            self.assertLess(results['max_displacement'], 1e-15)
            self.assertAlmostEqual(results['supports'][0]['force'][1] / -results['loads'][0]['force'][1], 1, delta=1e-12)

    def test_no_load_gives_no_displacement(self):
        results = converged(bar(NU, CLAMPED, {}), ranks=2).summary['results']
        self.assertEqual([results['max_displacement'], results['strain_energy']], [0, 0])


class OnlyWhatTheSceneRequires(unittest.TestCase):

    def dual(self, case, **overrides):
        settings = {'Decomposition/Cells per block': 4, 'Output/VTU': 'false',
                    **{name.replace('_', '/', 1).replace('_', ' '): value for name, value in overrides.items()}}
        problem = converged(shipped(case), settings).summary['problem']
        return problem['dual'], problem

    def test_frictionless_contact_has_no_tangential_rows(self):
        dual, problem = self.dual('box_frictionless')
        self.assertEqual((dual['normal'], dual['tangential'], problem['contact_candidates']), (8, 0, 8))

    def test_scene_without_contact_has_no_inequality(self):
        dual, problem = self.dual('box_linear')
        self.assertEqual((dual['normal'], dual['tangential'], problem['contact_candidates']), (0, 0, 0))
        self.assertEqual(dual['total'], dual['equality'])

    def test_one_subdomain_has_no_gluing(self):
        for method in ('blocks', 'none', 'METIS'):
            dual, problem = self.dual('box_on_circle', Decomposition_Blocks=1, Decomposition_Method=method,
                                      Decomposition_Subdomains=1)
            self.assertEqual((problem['subdomains'], dual['equality'], dual['normal'], dual['tangential']),
                             (1, 2 * 5, 4, 4), method)  # five held nodes, two components each


if __name__ == '__main__':
    unittest.main()
