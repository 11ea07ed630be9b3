"""Every command of doc/tutorial.md runs and leaves the files that the text names; every scene of --new runs."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / 'tests' / 'fork_server'))
from fork_server import ForkServer  # noqa: E402

PROGRAM = os.environ.get('SLIPSTICK', str(SOURCE / 'build' / 'slipstick'))
FORK_SERVER = os.environ.get('SLIPSTICK_FORK_SERVER')  # tests/fork_server: its runs do not load the libraries anew
TIME_LIMIT = 300
NOT_INSTALLED = 10  # status of scripts whose packages are missing


class Tutorial(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.program, cls.variables = PROGRAM, {}
        if FORK_SERVER:
            server = ForkServer(FORK_SERVER, dict(os.environ, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1'))
            cls.addClassCleanup(server.close)
            cls.program, cls.variables = server.client, server.variables

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.top = pathlib.Path(folder.name)
        for name in ('prm', 'meshes'):
            shutil.copytree(SOURCE / name, self.top / name)
        (self.top / 'build').mkdir()
        (self.top / 'build' / 'slipstick').symlink_to(self.program)
        (self.top / 'scripts').mkdir()
        for name in ('render', 'report', 'study', 'sweep'):
            (self.top / 'scripts' / name).symlink_to(SOURCE / 'scripts' / name)
        # nothing is installed or built here
        for name, script in (('run', 'exec build/slipstick "$@"'), ('setup', 'true')):
            (self.top / 'scripts' / name).write_text('#!/bin/bash\n' + script + '\n')
            (self.top / 'scripts' / name).chmod(0o755)

    def run_command(self, command):
        return subprocess.run(['bash', '-c', command], cwd=self.top, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              timeout=TIME_LIMIT, env=dict(os.environ, **self.variables, SLIPSTICK=self.program, SLIPSTICK_NO_SETUP='1', OMP_NUM_THREADS='1',
                                       OPENBLAS_NUM_THREADS='1'))

    def test_commands(self):
        text = (SOURCE / 'doc' / 'tutorial.md').read_text()
        commands = [line for block in re.findall('```sh\n(.*?)```', text, re.S) for line in block.splitlines()]
        self.assertEqual(len(commands), 11)
        skipped = set()
        for command in commands:
            if command.startswith('gmsh ') and not shutil.which('gmsh'):
                continue  # the mesh that is shipped was made by it
            result = self.run_command(command)
            if result.returncode == NOT_INSTALLED and command.startswith(('scripts/render', 'scripts/report')):
                skipped.add(command)
                continue
            self.assertEqual(result.returncode, 0, (command, result.stdout, result.stderr))
        output = self.top / 'output'
        files = ['tutorial/solution.pvd', 'study_tutorial/study.csv', 'sweep_tutorial/sweep.csv']
        if not skipped:
            files += ['box_on_circle/von_mises.png'] + ['tutorial/' + name for name in ('von_mises.png', 'displacement.png', 'contact.png', 'stress_yy.png', 'von_mises.gif',
                                                      'report.html')]
        for name in files:
            self.assertTrue((output / name).is_file(), name)

    def test_new_scenes(self):
        names = re.findall(r'start from: (.*)', self.run_command('build/slipstick --help | tr -s " \\n" " " | sed "s/ --[a-z]/\\n&/g"').stdout)
        self.assertEqual(len(names), 1)
        expected = {'block': ('foot', 400), 'hertz': ('touch', 7250), 'incline': ('ground', 9.6793), 'pin': ('bearing', None),
                    'shrink': ('fit', None)}
        self.assertEqual([name.strip() for name in names[0].split(',')], sorted(expected))
        for name, (pair, force) in expected.items():
            result = self.run_command('build/slipstick --new {}'.format(name))
            self.assertEqual((result.returncode, result.stdout), (0, '{0}.prm is written; run it: slipstick {0}.prm\n'.format(name)))
            result = self.run_command('build/slipstick {}.prm --quiet'.format(name))
            self.assertEqual(result.returncode, 0, (name, result.stderr))
            summary = __import__('json').loads((self.top / 'output' / name / 'summary.json').read_text())
            found, = (entry for entry in summary['results']['contact'] if entry['pair'] == pair)
            if force:
                self.assertAlmostEqual(found['normal_force'] / force, 1, delta=1e-3)
            if name == 'shrink':  # Lame, as the head of the file says
                self.assertAlmostEqual(found['max_pressure'] / 78.75, 1, delta=0.02)
            if name == 'pin':
                loads = [load['force'][1] for load in summary['results']['loads']]
                self.assertAlmostEqual(found['force'][1] / -sum(loads), 1, delta=1e-6)
        result = self.run_command('build/slipstick --new pin')
        self.assertEqual(result.returncode, 2)
        self.assertIn('pin.prm exists already', result.stderr)
        result = self.run_command('build/slipstick --new pim')
        self.assertEqual(result.returncode, 2)
        self.assertIn("did you mean 'pin'?", result.stderr)


if __name__ == '__main__':
    unittest.main()
