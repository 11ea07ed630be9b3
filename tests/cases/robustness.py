"""What broke the program once: sizes, limits, odd bytes, full disks. Status 2, one message, nothing half written, no hang."""

import os
import pathlib
import resource
import signal
import subprocess
import unittest

from program import ENVIRONMENT, PROGRAM, WORK, launcher, new_path, run, settings, shipped, solve

SANITIZED = 'SLIPSTICK_SANITIZED' in os.environ  # set by scripts/sanitize
SHADOW = 'AddressSanitizer maps terabytes of shadow memory'

BLOCK = """\
set Materials = s
set Bodies = a
set Supports = x
set Tractions = t
subsection Material s
  set Young modulus = 2.1e5
end
subsection Body a
  set Size = 10, 4
  set Cells = 10, 4
  set Material = s
end
subsection Support x
  set Boundary = a/bottom
  set Displacement x = 0
  set Displacement y = 0
end
subsection Traction t
  set Boundary = a/top
  set Traction y = -1
end
"""


def write(text, name='case.prm'):
    path = new_path(name)
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def limited(case, options=(), **limits):
    """A run on one rank under limits of setrlimit."""
    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
        for name, value in limits.items():
            resource.setrlimit(getattr(resource, name), (value, resource.RLIM_INFINITY))
    directory = new_path('output')
    process = subprocess.run([PROGRAM, str(case), '--output', str(directory), *options], stdin=subprocess.DEVNULL,
                             capture_output=True, text=True, env=ENVIRONMENT, cwd=WORK, timeout=60, preexec_fn=limit)
    return process, directory


class Robustness(unittest.TestCase):

    def refused(self, case, overrides, *words, ranks=1, options=()):
        result = solve(case, overrides, ranks=ranks, options=options)
        self.assertEqual(result.status, 2, result)
        self.assertEqual(result.stderr.count('error: '), 1, result)
        self.assertEqual(result.stderr.count('\n  remedy: '), 1, result)
        self.assertEqual(len(result.stderr.splitlines()), 2, result)
        for word in words:
            self.assertIn(word, result.stderr, result)
        self.assertLess(len(result.stderr), 6000, result)
        self.assertTrue(all(c.isprintable() or c == '\n' for c in result.stderr), repr(result.stderr))
        self.assertFalse(result.directory.exists(), result)
        return result

    def test_sizes_are_estimated_before_anything_is_made(self):
        case = write(BLOCK)
        self.refused(case, {'Body a/Cells': '1000000, 1000000'}, 'about 2e+12 unknowns (Body a: 1e+12 cells', 'Cells', ranks=2)
        self.refused(case, {'Discretization/Refinements': 10, 'Body a/Refinements': 9, 'Body a/Cells': '10, 10'}, 'unknowns')
        self.refused(case, {'Body a/Cells': 'auto', 'Decomposition/Blocks': 1000}, '2.5e+09 cells')
        self.refused(case, {'Body a/Cells': 'auto', 'Decomposition/Blocks': 1000, 'Decomposition/Cells per block': 20},
                     '1e+06 subdomains', 'MB are free', '--force')
        self.refused(case, {'Body a/Refine towards': '*', 'Body a/Refine levels': 10, 'Body a/Cells': '10000, 100'},
                     'most of them by Refine levels', 'unknowns')
        for more in ({'Body cube/Cells': '1000000, 1000000, 1000000'}, {'Decomposition/Blocks': 1000},
                     {'Body cube/Cells': '100, 100, 100', 'Discretization/Degree': 2}):
            self.refused(shipped('cube_on_sphere'), more, 'unknowns', 'Cells')
        # as one subdomain, whose factor grows faster than its unknowns
        self.refused(shipped('cube_on_sphere'), {'Decomposition/Method': 'none', 'Body cube/Cells': '90, 90, 90'}, 'MB are free')
        self.refused(shipped('hertz'), {'Body cylinder/Refinements': 10, 'Discretization/Refinements': 10}, 'unknowns')
        self.refused(shipped('ring_on_shaft'), {'Body shaft/Cells along axis': 1000000}, 'Body shaft: ', 'MB are free')

    @unittest.skipIf(SANITIZED, SHADOW)
    def test_force_overrides_the_estimate_of_memory(self):
        # more than the limit of the process, by the estimate
        case = write(BLOCK.replace('Cells = 10, 4', 'Cells = 2400, 960'))
        options = ('--check', '--quiet')
        refused, _ = limited(case, options, RLIMIT_AS=1600 << 20)
        self.assertEqual(refused.returncode, 2, refused)
        self.assertIn('MB are free', refused.stderr)
        self.assertIn('--force', refused.stderr)

    @unittest.skipIf(SANITIZED, SHADOW)
    def test_memory_that_runs_out_is_no_internal_error(self):
        process, directory = limited(write(BLOCK.replace('Cells = 10, 4', 'Cells = 1200, 480')), ('--force', '--quiet'), RLIMIT_AS=900 << 20)
        self.assertEqual(process.returncode, 2, process)
        self.assertIn('memory', process.stderr)
        self.assertEqual(process.stderr.count('remedy: '), 1, process)
        self.assertEqual([name for name in (os.listdir(directory) if directory.exists() else []) if name.endswith('.tmp')], [])

    @unittest.skipIf(SANITIZED, SHADOW)
    def test_address_space_that_is_too_small(self):
        for megabytes in (600, 700):
            process, directory = limited(write(BLOCK), RLIMIT_AS=megabytes << 20)
            self.assertEqual(process.returncode, 2, process)
            self.assertIn('the address space is limited', process.stderr)
            self.assertFalse(directory.exists())

    def test_disk_that_fills_while_writing(self):
        process, directory = limited(write(BLOCK.replace('10, 4\n  set Mat', '40, 16\n  set Mat')), RLIMIT_FSIZE=8192)
        self.assertEqual(process.returncode, 2, process)
        self.assertIn('File too large', process.stderr)
        self.assertEqual(process.stderr.count('remedy'), 1, process)
        self.assertEqual([name for name in (os.listdir(directory) if directory.exists() else []) if name.endswith('.tmp')], [])

    def test_directory_that_is_gone_and_links_that_are_in_the_way(self):
        directory = new_path('output')
        directory.mkdir()
        target = new_path('precious')
        target.write_text('precious')
        for name in ('.slipstick-probe.tmp', 'summary.json.tmp', 'contact.csv.tmp'):
            os.symlink(target, directory / name)
        result = run(write(BLOCK), '--output', directory, directory=directory)
        self.assertEqual(result.status, 0, result)
        self.assertEqual(target.read_text(), 'precious')
        self.assertEqual([name for name in result.files() if 'tmp' in name], [])

    def test_bytes_that_are_no_text(self):
        self.refused(write(BLOCK.replace('Bodies = a', 'Bodies = Kl\xf6tz').encode('latin1')), {}, 'is not UTF-8', '\\xF6')
        self.refused(write('\x1b[31mred\x07'), {}, '\\x1B[31mred\\x07')
        self.refused(write(BLOCK), {'Body a/Material': 's\x1b[2J'}, '\\x1B')
        commented = write(b'# Kl\xf6tz\n' + BLOCK.encode())
        self.assertEqual(solve(commented).status, 0)

    def test_long_names_and_deep_nesting(self):
        name = 'n' * 30000
        self.refused(write(BLOCK.replace('Bodies = a', 'Bodies = ' + name)), {}, '...')
        self.refused(write('subsection x\n' * 20000), {}, 'nested more than 10 levels deep')
        self.refused(write(BLOCK), {'a/' * 3000 + 'x': 1}, 'nested more than 10 levels deep')

    def test_includes(self):
        case = write('include pipe\n' + BLOCK)
        os.mkfifo(case.parent / 'pipe')
        self.refused(case, {}, "'" + str(case.parent / 'pipe') + "' cannot be read", ranks=2)
        case = write('include 1.prm\n' * 8 + BLOCK, '0.prm')
        for k in range(1, 9):
            (case.parent / '{}.prm'.format(k)).write_text('include {}.prm\n'.format(k + 1) * 8)
        (case.parent / '9.prm').write_text('# the end\n')
        self.refused(case, {}, 'at most 100 files')

    def test_numbers_beyond_arithmetic(self):
        case = write(BLOCK)
        for name, value in (('Material s/Young modulus', '1e300'), ('Body a/Thickness', '1e-308'),
                            ('Traction t/Traction y', '-1e200'), ('Traction t/Traction y', '-1e-200'),
                            ('Traction t/Traction y', '-1e-310'), ('Traction t/Traction y', '-1e100*x'),
                            ('Body a/Translation', '1e300, 0')):
            self.refused(case, {name: value}, name.split('/')[1])
        self.refused(case, {'Body a/Translation': '1e12, 0'}, 'Body a: has an edge of', ranks=2)
        for name, value in (('Material s/Young modulus', '1e27'), ('Material s/Young modulus', '1e-21'),
                            ('Material s/Density', '2e20'), ('Body a/Thickness', '1e21'), ('Body a/Thickness', '1e-21')):
            self.refused(case, {name: value}, name.split('/')[1], '1e+20')
        for name, value in (('Material s/Young modulus', '1e20'), ('Material s/Density', '0'), ('Body a/Thickness', '1e-20')):
            self.assertEqual(solve(case, {name: value}).status, 0)

    def test_obstacles_that_cross_themselves(self):
        contact = BLOCK + ('set Obstacles = p\nset Contacts = c\nsubsection Obstacle p\n  set Shape = polyline\n'
                           '  set Points = {}\nend\nsubsection Contact c\n  set Slave = a/left\n  set Master = p\n'
                           '  set Law = frictionless\nend\n')
        self.refused(write(contact.format('-1 0; -1 4; -3 4; 0 2')), {}, 'crosses or touches itself: edge 1 and edge 3')
        self.refused(write(contact.format('-1 0; -1 4; -1 2')), {}, 'edge 1 and edge 2')

    def test_command_line(self):
        with open('/dev/full', 'w') as full:
            process = subprocess.run([PROGRAM, '--list-parameters'], stdout=full, stderr=subprocess.PIPE, text=True,
                                     env=ENVIRONMENT, timeout=60)
        self.assertEqual(process.returncode, 2)
        self.assertIn('standard output', process.stderr)
        case = write(BLOCK)
        directory = new_path('output')
        self.assertEqual(run('--output', directory, '--', case).status, 0)
        result = run(write(BLOCK, '...prm'))
        self.assertEqual(result.status, 2, result)
        self.assertIn('no output directory can be named after the case file', result.stderr)


if __name__ == '__main__':
    unittest.main()
