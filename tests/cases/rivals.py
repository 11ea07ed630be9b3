"""What benchmarks/rivals and benchmarks/primal_newton compare with in space: the same answer, the same scene."""

import importlib.machinery
import importlib.util
import json
import os
import subprocess
import sys
import unittest

from program import ENVIRONMENT, SOURCE, converged, shipped

sys.path.append(str(SOURCE / 'benchmarks'))
import rival_calculix  # noqa: E402


def script(name):
    loader = importlib.machinery.SourceFileLoader(name, str(SOURCE / 'benchmarks' / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


@unittest.skipUnless(os.environ.get('SLIPSTICK_PRIMAL_NEWTON'), 'the benchmarks are not built')
class PrimalNewton(unittest.TestCase):

    def test_cube_with_friction_within_discs(self):
        """A primal method that shares neither solver nor dual problem: sizes of both sets, pressures, forces."""
        settings = {'Contact sphere/Law': 'Tresca', 'Contact sphere/Slip bound': '300', 'Decomposition/Blocks': '1',
                    'Decomposition/Cells per block': '8', 'Output/VTU': 'false'}
        command = [os.environ['SLIPSTICK_PRIMAL_NEWTON'], str(shipped('cube_on_sphere')), '--tolerance', '1e-10']
        for name, value in settings.items():
            command += ['--set', name + '=' + value]
        other = json.loads(subprocess.run(command, env=ENVIRONMENT, check=True, stdout=subprocess.PIPE, timeout=60).stdout)
        self.assertTrue(other['converged'])
        pair = converged(shipped('cube_on_sphere'), settings).summary['results']['contact'][0]
        self.assertEqual((pair['contact_nodes'], pair['slip_nodes']), (other['contact_nodes'], other['slip_nodes']))
        self.assertGreater(72 - pair['slip_nodes'], 0)  # of those that the clamp leaves some stick
        for name in ('max_pressure', 'normal_force', 'tangential_force'):
            self.assertAlmostEqual(pair[name] / other[name], 1, delta=1e-6)


class CalculixDeck(unittest.TestCase):

    def test_cube(self):
        """Volumes are positive, faces are where the loads and the contact are."""
        deck = {}
        keep = lambda name, bodies, held, pressed, contact, physics: deck.update(bodies=bodies, held=held, pressed=pressed, contact=contact)
        rivals, write_deck = script('rivals'), rival_calculix.write_deck
        write, positions = rivals.cube_deck(8, .3)
        rival_calculix.write_deck = keep
        try:
            write('')
        finally:
            rival_calculix.write_deck = write_deck
        corners_of = {3: (0, 1, 5, 4), 5: (2, 3, 7, 6)}  # Abaqus: sides S3 and S5 of C3D8
        bottom, sphere = deck['contact']
        for (body, faces), off in ((bottom, lambda x, y, z: y), ((deck['pressed'][0], deck['pressed'][1]), lambda x, y, z: y - 10),
                                   (sphere, lambda x, y, z: ((x - 5) ** 2 + (y + 100) ** 2 + (z - 5) ** 2) ** .5 - 100)):
            points, cells = deck['bodies'][body]['points'], deck['bodies'][body]['cells']
            self.assertEqual(len(faces), 64 if body == 0 else 81)
            for cell, side in faces:
                for corner in corners_of[side]:
                    self.assertLess(abs(off(*points[cells[cell][corner]])), 1e-9)
        for body in deck['bodies']:
            for cell in body['cells']:
                a, b, c = ([body['points'][cell[k]][d] - body['points'][cell[0]][d] for d in range(3)] for k in (1, 3, 4))
                self.assertGreater(sum(a[d] * (b[(d + 1) % 3] * c[(d + 2) % 3] - b[(d + 2) % 3] * c[(d + 1) % 3]) for d in range(3)), 0)
        for node, (x, z) in positions.items():
            self.assertEqual(tuple(round(c, 6) for c in deck['bodies'][0]['points'][node - 1]), (x, 0, z))
        self.assertEqual(len(deck['held'][0][1]), 81)


if __name__ == '__main__':
    unittest.main()
