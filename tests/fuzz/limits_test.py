"""The limits of scenes.py: a run that only waits for a busy machine is no fault, one that computes without end is."""

import argparse
import pathlib
import sys
import unittest
import unittest.mock

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import scenes  # noqa: E402

NOWHERE = pathlib.Path('/nonexistent')


def is_late(script):
    options = argparse.Namespace(started=sys.executable, time=1, memory=2048)
    return scenes.start_patiently(['-c', script], options, 1, NOWHERE)[2]


class Limits(unittest.TestCase):

    def test_waiting_is_no_fault(self):
        self.assertFalse(is_late('import time; time.sleep(2)'))

    def test_computing_without_end_is(self):
        self.assertTrue(is_late('while True: pass'))

    @unittest.mock.patch.object(scenes, 'PATIENCE', 4)
    def test_waiting_without_end_is(self):
        self.assertTrue(is_late('import time; time.sleep(1000)'))


if __name__ == '__main__':
    unittest.main()
