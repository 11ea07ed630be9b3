"""scripts/study on a small scene: its table, the sentence, going on after an interruption, closed forms, wrong input."""

import csv
import importlib.machinery
import importlib.util
import shlex
import signal
import subprocess
import sys
import time
import unittest

import measured  # noqa: F401  the path of tests/cases
import scenes
from program import ENVIRONMENT, PROGRAM, SOURCE, TIME_LIMIT, WORK, converged, fork_server, new_path

LADDER = ('--refinements', '0,1', '--degrees', '1,2', '--tolerances', '1e-2,1e-4', '--subdomains', 'auto,4', '--adaptive', '20',
          '--ranks', '1')
RUNS = 2 * 2 * (2 + 1 + 1) + 2 * 3 + 2 + 3  # one more number of subdomains and algorithm for each mesh and degree; presets;
# adaptive meshes; reference


def case():
    return scenes.box(name='box', contacts={'circle': scenes.CIRCLE}, supports={'held': scenes.HELD},
                      tractions={'pressed': scenes.PRESSED}, bodies={'box': {**scenes.BOX, 'Cells': '6, 6'}},
                      Decomposition={'Method': 'none'})


def command(*arguments):
    return [sys.executable, '-B', str(SOURCE / 'scripts' / 'study'), *map(str, arguments)]


server = fork_server()
ENVIRONMENT = dict(ENVIRONMENT, **(dict(server.variables, SLIPSTICK=server.client) if server else {'SLIPSTICK': PROGRAM}))


def study(*arguments):
    return subprocess.run(command(*arguments), env=ENVIRONMENT, cwd=WORK, capture_output=True, text=True,
                          timeout=200 * TIME_LIMIT / 60)


def rows(directory):
    with open(directory / 'study.csv', newline='') as stream:
        return list(csv.DictReader(stream))


def the_script():
    loader = importlib.machinery.SourceFileLoader('study_script', str(SOURCE / 'scripts' / 'study'))
    script = importlib.util.module_from_spec(importlib.util.spec_from_loader('study_script', loader))
    loader.exec_module(script)
    return script


class Study(unittest.TestCase):

    def test_ladder_sentence_and_resumption(self):
        scene, directory = case(), new_path('study')
        arguments = (scene, *LADDER, '--accuracy', '0.05', '--output', directory)
        process = subprocess.Popen(command(*arguments), env=ENVIRONMENT, cwd=WORK, stderr=subprocess.PIPE, text=True)
        for line in process.stderr:  # interrupted after its third run
            if line.startswith('study: [3/'):
                break
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
        process.stderr.close()
        self.assertEqual(process.wait(timeout=TIME_LIMIT), 130, rest)
        kept = rows(directory)
        self.assertGreaterEqual(len(kept), 3)
        self.assertLess(len(kept), RUNS)
        with open(directory / 'study.csv', 'a') as stream:
            stream.write('torn,0,1')  # as a machine that stops leaves it

        result = study(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        found = rows(directory)
        self.assertEqual(len(found), RUNS)
        self.assertEqual([row['time_s'] for row in found[:len(kept)]], [row['time_s'] for row in kept], 'solved again')
        self.assertEqual({row['status'] for row in found}, {'converged'})
        without = [row for row in found if not row['error']]
        self.assertEqual([(row['refinements'], row['degree'], row['preset'], row['tolerance']) for row in without],
                         [(level, '2', 'reference run', '1e-08') for level in '012'])  # one refinement beyond all others
        presets = {(row['refinements'], row['preset']): (row['degree'], row['tolerance']) for row in found}
        for refinements in '01':
            self.assertEqual(presets[refinements, 'draft'], ('1', 'auto'))
            self.assertEqual(presets[refinements, 'engineering'], ('1', '0.0001'))
            self.assertEqual(presets[refinements, 'reference'], ('2', '1e-08'))
        levels = [float(row['strain_energy']) for row in without]
        reference = levels[2]
        ratio = (levels[1] - levels[0]) / (levels[2] - levels[1])
        floor = abs(levels[2] - levels[1]) / (min(ratio, 16) - 1 if ratio > 1 else 1) / abs(reference)
        for row in found:
            if row['error']:
                self.assertAlmostEqual(float(row['error']), abs(float(row['strain_energy']) / reference - 1),
                                       delta=1e-3 * float(row['error']) + 1e-15)
                if abs(float(row['error']) / floor - 1) > 1e-3:  # of first order, the mesh before the last has this error itself
                    self.assertEqual(row['below_floor'], 'yes' if float(row['error']) < floor else 'no')
        good = [row for row in found if row['error'] and float(row['error']) + floor <= 0.05]
        best = min(good, key=lambda row: float(row['time_s']))
        mesh = 'adaptive mesh from ' if best['preset'].endswith('%') else ''  # which is fastest depends on the machine
        self.assertIn('degree {degree}, {mesh}{refinements} refinements'.format(mesh=mesh, **best), result.stdout)
        self.assertIn(best['time_s'] + ' s', result.stdout)
        self.assertIn('which is known to {:.2g} % itself'.format(100 * floor), result.stdout)
        flags = result.stdout.splitlines()[-1]
        self.assertIn('--set Discretization/Refinements={refinements} --set Discretization/Degree={degree} '.format(**best), flags)
        figures = converged(scene, dict(word.split('=', 1) for word in shlex.split(flags) if word != '--set')).summary
        self.assertAlmostEqual(figures['results']['strain_energy'] / float(best['strain_energy']), 1, delta=1e-6)
        self.assertIn('table and plot: {}'.format(directory), result.stderr)
        self.assertEqual((directory / 'study.txt').read_text(), result.stdout)
        drawn = (directory / 'study.png').is_file()
        self.assertTrue(drawn or 'study.png not drawn' in result.stderr, result.stderr)

        again = time.monotonic()
        result = study(*arguments)  # nothing is left to solve
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr.count('converged, from'), RUNS)
        self.assertLess(time.monotonic() - again, 30)

        scene.write_text(scene.read_text().replace('500', '400'))
        result = study(*arguments)  # another scene
        self.assertEqual(result.returncode, 2)
        self.assertIn('is of another scene', result.stderr)
        self.assertEqual(len(rows(directory)), RUNS)

    def test_error_of_the_reference(self):
        script = the_script()
        for p in (1, 2, 3):  # q = 1 + h^p, h = 1, 1/2, 1/4
            self.assertAlmostEqual(script.richardson([2, 1 + 2.**-p, 1 + 4.**-p], 2), 4.**-p)
        self.assertEqual(script.richardson([1, 2, 1.5], 2), 0.5)  # not monotone
        self.assertEqual(script.richardson([3, 2], 2), 1)
        self.assertEqual(script.richardson([3], 2), float('inf'))

    def test_knobs_of_the_presets_are_those_of_the_program(self):
        script = the_script()
        for preset, knobs in script.PRESETS.items():
            lines = converged(case(), {'Accuracy': preset}).directory.joinpath('parameters.prm').read_text().splitlines()
            section, found = [], {}
            for words in (line.split() for line in lines):
                if words[:1] == ['subsection']:
                    section.append(' '.join(words[1:]))
                elif words == ['end']:
                    section.pop()
                elif words[:1] == ['set']:
                    name, _, value = ' '.join(words[1:]).partition('=')
                    found['/'.join([*section, name.strip()])] = value.strip()
            self.assertEqual({name: found[name] for name in knobs}, knobs)
            self.assertEqual(found['Accuracy'], preset)

    def test_closed_form_out_of_reach(self):
        directory = new_path('study')
        result = study(case(), '--refinements', '0', '--degrees', '1', '--tolerances', '1e-4', '--subdomains', 'auto',
                       '--algorithms', 'auto', '--presets', '', '--adaptive', '', '--ranks', '1', '--reference', 'circle.max_pressure=1', '--output', directory)
        self.assertEqual(result.returncode, 0, result.stderr)
        row, = rows(directory)
        self.assertAlmostEqual(float(row['error']) / abs(float(row['circle.max_pressure']) - 1), 1, delta=1e-3)
        self.assertIn('none of 1 runs gives circle.max_pressure to 1 % of the closed form', result.stdout)

    def test_wrong_input(self):
        for arguments, message in ((('missing.prm',), 'is no file'), ((case(), '--degrees', '3'), 'out of range'),
                                   ((case(), '--reference', 'x'), 'KEY=VALUE'),
                                   ((case(), '--presets', 'best'), 'draft, engineering, reference'),
                                   ((case(), '--quantity', 'nothing', '--ranks', '1', '--output', new_path('s')), 'unknown'),
                                   ((case(), '--set', 'Sover/Tolerance=1', '--ranks', '1', '--output', new_path('s')),
                                    'was refused')):
            result = study(*arguments)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(message, result.stderr)


if __name__ == '__main__':
    unittest.main()
