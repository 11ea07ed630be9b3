"""scripts/sweep on the stack on an incline: its table, where there is no solution, wrong input."""

import csv
import math
import subprocess
import sys
import unittest

import measured  # noqa: F401  the path of tests/cases
from program import ENVIRONMENT, PROGRAM, SOURCE, TIME_LIMIT, WORK, new_path, shipped

ENVIRONMENT = dict(ENVIRONMENT, SLIPSTICK=PROGRAM)
FRICTION = 'Contact ground/Friction coefficient'


def sweep(*arguments):
    return subprocess.run([sys.executable, '-B', str(SOURCE / 'scripts' / 'sweep'), *map(str, arguments)], env=ENVIRONMENT, cwd=WORK,
                          capture_output=True, text=True, timeout=10 * TIME_LIMIT)


class Sweep(unittest.TestCase):

    def test_incline_slides_below_the_angle_of_friction(self):
        directory = new_path('sweep')
        result = sweep(shipped('incline'), '--vary', FRICTION + '=0.35:0.01:0.38', '--quantity', 'ground.tangential_force', '--output', directory)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout, 'sweep: {}\n'.format(directory))
        with open(directory / 'sweep.csv', newline='') as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual([row[FRICTION] for row in rows], ['0.35', '0.36', '0.37', '0.38'])
        self.assertEqual([row['status'] for row in rows], ['no equilibrium'] * 2 + ['converged'] * 2)  # tan 20 degrees = 0.364
        self.assertEqual(rows[0]['ground.tangential_force'], '')
        weight = 2.5e-9 * 9810 * 8400 * 50  # prm/incline.prm
        for row in rows[2:]:
            self.assertAlmostEqual(abs(float(row['ground.tangential_force'])), weight * math.sin(math.radians(20)), places=3)
        drawn = (directory / 'sweep.png').is_file()
        self.assertTrue(drawn or 'sweep.png not drawn' in result.stderr, result.stderr)

    def test_wrong_input(self):
        for arguments, message in ((('missing.prm', '--vary', 'a=1'), 'is no file'), ((shipped('incline'), '--vary', 'x'), 'NAME=VALUES'),
                                   ((shipped('incline'), '--vary', FRICTION + '=1:-1:3'), 'FIRST:STEP:LAST'),
                                   ((shipped('incline'), '--vary', 'Contact ground/Frition=1', '--output', new_path('s')), 'refused')):
            result = sweep(*arguments)
            self.assertEqual(result.returncode, 2, result)
            self.assertIn(message, result.stderr)


if __name__ == '__main__':
    unittest.main()
