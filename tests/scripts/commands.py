"""Every command in README.md and doc/*.md is run, or is known to be run elsewhere; options of synopses are those of the programs.

Those of doc/tutorial.md are run by tutorial.py."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import shutil
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / 'tests' / 'fork_server'))
from fork_server import ForkServer  # noqa: E402

PROGRAM = os.environ.get('SLIPSTICK', str(SOURCE / 'build' / 'slipstick'))
BUILD = os.environ.get('SLIPSTICK_BINARY_DIR', str(SOURCE / 'build'))
FORK_SERVER = os.environ.get('SLIPSTICK_FORK_SERVER')  # tests/fork_server: for the many runs of scripts/sweep
TIME_LIMIT = 300
NOT_INSTALLED = 10  # status of scripts whose packages are missing
START = re.compile(r'(scripts/|build/|cmake |mpirun |srun |sudo |apt-get |slipstick |benchmarks/|ctest )')

# What is not run here, and where it is.
ELSEWHERE = {
    r'scripts/test$': 'this is what runs the tests',
    r'(sudo )?scripts/test-debian ': 'takes an hour and root; its functions: functions.py',
    r'scripts/setup( --render)?$': 'installs packages; its functions: functions.py',
    r'scripts/verification ': 'takes hours; the same cases on small meshes: tests/verification',
    r'scripts/study ': 'takes minutes; tutorial.py runs a small study, tests/verification/study.py its functions',
    r'scripts/(sanitize|fuzz --coverage) ': 'another build of everything',
    r'benchmarks/': 'takes minutes to hours',
    r'build/tests/random/': 'named in status.md because it fails',
    r'cmake ': 'configures, builds or installs: how these tests came to be; tests/install',
    r'srun ': 'a cluster',
    r'apt-get ': 'installs packages',
}


def commands_of(text):
    """Of indented and fenced blocks, and in backquotes."""
    blocks = re.findall('```\\w*\n(.*?)```', text, re.S)
    plain = re.sub('```.*?```', '', text, flags=re.S)
    lines = [line[4:] for line in plain.splitlines() if re.match(' {4}\\S', line)] + [line for block in blocks for line in block.splitlines()]
    lines = [re.split(r'\s+#\s', line)[0].strip() for line in lines]
    prose = '\n'.join(line for line in plain.splitlines() if not re.match(' {4}\\S', line))
    lines += [code.replace('\n', ' ').replace('\\|', '|') for code in re.findall('`([^`]+)`', prose)]
    return list(dict.fromkeys(line for line in lines if START.match(line) and ' ' in line))


def is_synopsis(command):
    return re.search(r'[A-Z]{2,}[A-Z_]*\.prm|\[|\b(CASE|NAME|N|P|DIR)\b|\.\.\.', command) is not None


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.top = pathlib.Path(cls.folder.name)
        for name in ('prm', 'meshes'):
            shutil.copytree(SOURCE / name, cls.top / name)
        (cls.top / 'build').mkdir()
        (cls.top / 'build' / 'slipstick').symlink_to(PROGRAM)
        (cls.top / 'scripts').mkdir()
        for path in (SOURCE / 'scripts').iterdir():
            if path.name != 'run':
                (cls.top / 'scripts' / path.name).symlink_to(path)
        # nothing is installed or built here: scripts/run without that
        (cls.top / 'scripts' / 'run').write_text(
            '#!/bin/bash\nn=1; rest=()\nwhile [ $# -gt 0 ]; do\n  if [ "$1" = --ranks ]; then n=$2; shift 2; else rest+=("$1"); shift; fi\n'
            'done\nexec scripts/mpirun --shared-cores -n $n build/slipstick "${rest[@]}"\n')
        (cls.top / 'scripts' / 'run').chmod(0o755)
        cls.addClassCleanup(cls.folder.cleanup)
        cls.sweeps = {'SLIPSTICK': PROGRAM}
        if FORK_SERVER:
            server = ForkServer(FORK_SERVER, dict(os.environ, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1'))
            cls.addClassCleanup(server.close)
            cls.sweeps = dict(server.variables, SLIPSTICK=server.client)
        cls.documents = {path.name: path.read_text() for path in [SOURCE / 'README.md', *sorted((SOURCE / 'doc').glob('*.md'))]}

    def run_command(self, command):
        environment = dict(os.environ, **self.sweeps, SLIPSTICK_NO_SETUP='1', OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1',
                           PATH='{}:{}'.format(self.top / 'build', os.environ['PATH']))
        if command.startswith('mpirun '):
            command = 'scripts/mpirun --shared-cores ' + command.split(' ', 1)[1]  # also as root, and with few cores
        return subprocess.run(['bash', '-c', command], cwd=self.top, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              timeout=TIME_LIMIT, env=environment)

    def commands(self):
        for name, text in self.documents.items():
            if name != 'tutorial.md':
                for command in commands_of(text):
                    yield name, command

    def test_they_run(self):
        done = {command for command in commands_of(self.documents['tutorial.md']) if command.startswith('scripts/render')}
        for name, command in self.commands():
            label = re.match(r'scripts/test -L (\w+)', command)
            if is_synopsis(command) or command in done or label or any(re.match(known, command) for known in ELSEWHERE):
                continue
            done.add(command)
            result = self.run_command(command)
            if result.returncode == NOT_INSTALLED and command.startswith(('scripts/render', 'scripts/report')):
                continue
            self.assertEqual(result.returncode, 0, (name, command, result.stdout, result.stderr))
        self.assertGreaterEqual(len(done), 10, done)

    def test_labels_exist(self):
        labels = {match.group(1) for _, command in self.commands() for match in [re.match(r'scripts/test -L (\w+)', command)] if match}
        self.assertGreaterEqual(len(labels), 4)
        # ctest --print-labels would overwrite the log of the tests that are running
        known = {label for path in pathlib.Path(BUILD).glob('tests/*/*.cmake')
                 for labels in re.findall(r'LABELS \W*([\w;]+)', path.read_text()) for label in labels.split(';')}
        for label in labels:
            self.assertIn(label, known)

    def test_options_of_synopses_exist(self):
        """In interface.md every script has a line with its options."""
        n = 0
        for line in self.documents['interface.md'].splitlines():
            match = re.match(r'\| `(scripts/(render|report|study|sweep|gallery|verification|fuzz)) ?([^`]*)`', line)
            if not match:
                continue
            result = self.run_command(match.group(1) + ' --help')
            if result.returncode == NOT_INSTALLED:
                continue
            for option in re.findall(r'--[a-z-]+', match.group(3)):
                self.assertIn(option, result.stdout + result.stderr, match.group(1))
                n += 1
        self.assertGreater(n, 5)

    def test_scene_of_readme_runs_as_it_stands(self):
        section = self.documents['README.md'].split('## The scene')[1].split('This is a complete scene')[0]
        (self.top / 'readme.prm').write_text('\n'.join(line[4:] for line in section.splitlines() if line.startswith('    ')))
        result = self.run_command('build/slipstick readme.prm')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('contact circle: largest pressure', result.stdout)


if __name__ == '__main__':
    unittest.main()
