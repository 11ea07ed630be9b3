"""Runs of many load steps that are interrupted, and where the conditions of a scene are."""

import csv
import signal
import subprocess
import time
import unittest

import scenes
from program import ENVIRONMENT, PROGRAM, TIME_LIMIT, WORK, converged, launcher, new_path, shipped

STEPS = 5000  # more than end in time


def block():
    return scenes.box(name='block', bodies={'box': {**scenes.BOX, 'Cells': '4, 4'}}, supports={'held': scenes.HELD},
                      contacts={'circle': scenes.CIRCLE}, tractions={'pressed': {'Boundary': 'box/top', 'Traction y': '-250*t'}},
                      Decomposition={'Method': 'none'}, **{'Load steps': {'Factors': '0.001:0.001:{}'.format(STEPS / 1000)}})


class Interrupted(unittest.TestCase):
    def interrupt(self, number, ranks):
        """Once the first tables are there. @return status, standard error, output directory."""
        directory = new_path('output')
        process = subprocess.Popen(launcher(ranks) + [PROGRAM, str(block()), '--quiet', '--output', str(directory)],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT, cwd=WORK,
                                   preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
        until = time.monotonic() + TIME_LIMIT
        while not (directory / 'summary.json').is_file():
            self.assertLess(time.monotonic(), until)
            self.assertIsNone(process.poll())
            time.sleep(0.01)
        process.send_signal(number)
        _, message = process.communicate(timeout=TIME_LIMIT)
        return process.returncode, message, directory

    def kept(self, directory):
        """Number of steps in the tables, which agree."""
        import json
        summary = json.loads((directory / 'summary.json').read_text())
        self.assertEqual((summary['status'], summary['converged']), ('unfinished', False))
        with open(directory / 'history.csv', newline='') as text:
            history = list(csv.DictReader(text))
        with open(directory / 'contact.csv', newline='') as text:
            steps = {row['step'] for row in csv.DictReader(text)}
        for found in (history, steps):
            self.assertLessEqual(abs(len(found) - len(summary['steps'])), 1)  # files are written one after the other
        return len(summary['steps'])

    def test_message_and_tables(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            status, message, directory = self.interrupt(number, 1)
            self.assertEqual(status, -number, message)
            self.assertIn('error: interrupted in load step ', message)
            self.assertIn(' of {}; summary.json, history.csv and contact.csv in {}'.format(STEPS, directory), message)
            said = int(message.rstrip().rsplit(' ', 1)[1])
            self.assertLessEqual(abs(self.kept(directory) - said), 1)

    def test_several_ranks(self):
        status, message, directory = self.interrupt(signal.SIGTERM, 2)
        self.assertNotEqual(status, 0, message)
        self.assertGreater(self.kept(directory), 0)


class Conditions(unittest.TestCase):
    def test_where_they_are(self):
        for ranks in (1, 2):
            result = converged(shipped('box_on_circle'), {'Decomposition/Cells per block': 2}, ranks=ranks)
            rows = result.rows('conditions.csv', text=('kind', 'name', 'side', 'body'))
            self.assertEqual([(row['kind'], row['name'], row['side'], row['body']) for row in rows],
                             [('support', 'held', '', 'box')] * 8 + [('traction', 'pressed', '', 'box')] * 8 +
                             [('contact', 'circle', 'slave', 'box')] * 8)
            self.assertEqual({(row['x1'], row['x2']) for row in rows[:8]}, {(0, 0)})
            self.assertEqual({(row['y1'], row['y2']) for row in rows[8:16]}, {(10, 10)})
            for row in rows[16:]:  # the body is to the left
                self.assertEqual((row['y1'], row['y2'], row['x2'] - row['x1']), (0, 0, 1.25))

    def test_points(self):
        rows = converged(shipped('hertz'), {'Body cylinder/Refine levels': 0, 'Body block/Refine levels': 0}).rows(
            'conditions.csv', text=('kind', 'name', 'side', 'body'))
        points = {row['name']: (row['x1'], row['y1'], row['x2'], row['y2']) for row in rows if row['name'].startswith('axis')}
        self.assertEqual(points, {'axis above': (0, 50, 0, 50), 'axis below': (0, 0, 0, 0)})


if __name__ == '__main__':
    unittest.main()
