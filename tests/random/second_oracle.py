"""Some of the random scenes against oracle.py, which shares neither elements nor contact rows nor solver with the program.

test_random compares all scenes with a dense solver that takes K, f and B from the program: it tells errors of the solvers
alone. These are the scenes that oracle.py understands: obstacles and bodies, degree 1 and 2, all laws, sides whose meshes
match, do not, and hang over. Every other one is run in up to six subdomains.
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / 'cases'))

import oracle
from program import converged

SEEDS = (8, 11, 12, 20, 21, 40, 57, 68, 79, 87, 94, 104, 118, 132)
ACCURATE = {'Solver/Tolerance': '1e-10', 'Friction/Tolerance': '1e-10', 'Output/VTU': 'false'}
MOST_SUBDOMAINS = 6
AGREEMENT = 1e-6  # of forces over the largest, energy, displacement


class SecondOracle(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.place.cleanup)
        subprocess.run([os.environ['TEST_RANDOM'], '--scenes', str(max(SEEDS) + 1), '--write', cls.place.name], check=True,
                       stdout=subprocess.DEVNULL)

    def compare(self, nodes, energy, displacement, result):
        found = result.summary['results']
        self.assertLessEqual(abs(found['strain_energy'] - energy), AGREEMENT * energy)
        self.assertLessEqual(abs(found['max_displacement'] - displacement), AGREEMENT * displacement)
        rows = result.contact
        self.assertEqual(len(rows), len(nodes))
        largest = max(abs(node.traction(kind)) for node in nodes for kind in ('normal', 'tangential'))
        self.assertGreater(largest, 0)
        size = max(abs(x) for node in nodes for x in node.at)
        for node in nodes:
            row, = [row for row in rows if row['pair'] == node.pair and
                    max(abs(row['x'] - node.at[0]), abs(row['y'] - node.at[1])) < 1e-9 * size]
            self.assertLessEqual(abs(row['pressure'] - node.traction('normal')), AGREEMENT * largest, row)
            # the force on the slave has the sign opposite to the multiplier
            self.assertLessEqual(abs(row['tangential_traction'] + node.traction('tangential')), AGREEMENT * largest, row)

    def test_random_scenes(self):
        laws = set()
        for number, seed in enumerate(SEEDS):
            path = pathlib.Path(self.place.name, 'scene_{}.prm'.format(seed))
            scene = oracle.Scene(path.read_text())
            expected = oracle.solve(scene)
            laws.update((node.law, scene.degree) for node in scene.contacts)
            n_cells = sum(body.n[0] * body.n[1] for body in scene.bodies.values())
            how = {'Decomposition/Method': 'METIS' if number % 2 else 'none'}
            if number % 2:
                how['Decomposition/Subdomains'] = max(len(scene.bodies), min(MOST_SUBDOMAINS, n_cells))
            with self.subTest(seed=seed):
                self.compare(*expected, converged(path, {**ACCURATE, **how}))
        self.assertEqual({law for law, _ in laws}, {'frictionless', 'Tresca', 'Coulomb', 'bonded'})
        self.assertEqual({degree for _, degree in laws}, {1, 2})


if __name__ == '__main__':
    unittest.main()
