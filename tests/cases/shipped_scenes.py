"""Every scene of prm/ runs and passes its checks, on a mesh of a few seconds."""

import unittest

from program import SOURCE, converged
from solid_scenes import graded

LIMITS = {'interface_jump': 1e-6, 'penetration': 1e-6, 'complementarity': 1e-5, 'friction_bound': 1e-5,
          'force_balance': 1e-6, 'moment_balance': 1e-6}


def smaller():
    """Of scenes that take longer than others. As they are shipped: tests/extremes/diagnosis.py, on one rank."""
    return {'mindlin': graded('half', 4, 4, '--two-balls'), 'hertz_solid': graded('quarter', 6, 6),
            'flange': {'Load steps/Factors': '1'}, 'lap_joint': {'Load steps/Factors': '1'}}


class ShippedScenes(unittest.TestCase):

    def test_there_are_scenes(self):
        self.assertTrue(list((SOURCE / 'prm').glob('*.prm')))

    def check(self, path, overrides, ranks=1):
        summary = converged(path, {'Decomposition/Cells per block': 10, 'Solver/Tolerance': 1e-8, **overrides},
                            ranks=ranks).summary
        self.assertEqual((summary['status'], summary['case']), ('converged', path.stem))
        for name, limit in LIMITS.items():
            self.assertLess(summary['residuals'][name], limit, name)
        return summary['results']

    def test_every_scene_converges(self):
        meshes = smaller()
        for path in sorted((SOURCE / 'prm').glob('*.prm')):
            with self.subTest(path.name):
                self.check(path, meshes.get(path.stem, {}), ranks=2)

    def test_frictionless_scene_has_no_tangential_force(self):
        results = self.check(SOURCE / 'prm' / 'box_frictionless.prm', {})
        self.assertEqual(results['contact'][0]['tangential_force'], 0)

    def test_circle_below_the_right_end(self):
        self.check(SOURCE / 'prm' / 'box_on_circle.prm', {'Obstacle disc/Center': '10, -20'})

    def test_prescribed_displacement_of_zero_gives_no_force(self):
        results = self.check(SOURCE / 'prm' / 'box_prescribed.prm', {'Support pressed/Displacement y': 0, 'Solver/Tolerance': 1e-10})
        self.assertLess(abs(results['contact'][0]['normal_force']), 1e-6)

    def test_implicit_and_explicit_operator_agree(self):
        results = [self.check(SOURCE / 'prm' / 'box_on_circle.prm', {'Solver/Dual operator': kind})
                   for kind in ('explicit', 'implicit')]
        self.assertAlmostEqual(results[0]['strain_energy'] / results[1]['strain_energy'], 1, delta=1e-8)

    def test_all_expansions_agree(self):
        energies = [self.check(SOURCE / 'prm' / 'box_on_circle.prm', {'Solver/SMALBE/Expansion': kind,
                                                                      'Contact circle/Slip bound': 150})['strain_energy']
                    for kind in ('gradient projection', 'boundary then projection', 'projected CG')]
        for energy in energies:
            self.assertAlmostEqual(energy / energies[0], 1, delta=1e-7)


if __name__ == '__main__':
    unittest.main()
