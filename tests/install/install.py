"""What cmake --install and cpack leave works: program, scenes, man page, completion, CMake package, .deb.

The .deb is made without dpkg-shlibdeps, which reads all symbols of deal.II for half a minute, unless SLIPSTICK_SHLIBDEPS is
set (scripts/test-debian sets it)."""

import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get('SLIPSTICK_BUILD_DIR', SOURCE / 'build'))
CMAKE = os.environ.get('CMAKE', 'cmake')
CPACK = os.environ.get('CPACK', 'cpack')
TIME_LIMIT = 400  # [s] of one command; a compiler takes ten on a machine that is not busy
ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1', LC_ALL='C')


def run(*command):
    result = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True, timeout=TIME_LIMIT, env=ENVIRONMENT)
    if result.returncode != 0:
        raise AssertionError('status {}: {}\n{}'.format(result.returncode, command, result.stdout))
    return result.stdout


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.prefix = cls.folder / 'with space'
        run(CMAKE, '--install', BUILD, '--prefix', cls.prefix)
        cls.program = cls.prefix / 'bin' / 'slipstick'
        cls.options = set(re.findall(r'--[a-z][a-z-]*', run(cls.program, '--help')))

    def found(self, pattern):
        files = list(self.prefix.glob(pattern))
        self.assertEqual(len(files), 1, pattern)
        return files[0]

    def test_scene_with_a_mesh_runs(self):
        run(self.program, self.found('share/slipstick/prm/patch_gmsh.prm'), '--quiet', '--output', self.folder / 'out')
        self.assertTrue((self.folder / 'out' / 'summary.json').is_file())

    def test_documents_are_there(self):
        readme = self.found('share/doc/slipstick/README.md')
        for link in re.findall(r'\]\((doc/[^)#]*)\)', readme.read_text()):
            self.assertTrue((readme.parent / link).is_file(), link)

    def test_man_page_has_every_option(self):
        page = self.found('share/man/man1/slipstick.1').read_text()
        listed = set(re.findall(r'--[a-z][a-z-]*', page.replace('\\-', '-')))
        self.assertEqual(listed, self.options)
        if shutil.which('groff'):
            self.assertEqual(run('groff', '-man', '-Tutf8', '-ww', '-z', self.found('share/man/man1/slipstick.1')), '')

    def complete(self, *words):
        """What the bash function offers for the last word."""
        script = ('cd "$1"; source "$2"; PATH="$3:$PATH"; shift 3; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _slipstick; '
                  'printf "%s\\n" "${COMPREPLY[@]}"')
        return run('bash', '-c', script, 'bash', self.prefix / 'share/slipstick/prm',
                   self.found('share/bash-completion/completions/slipstick'), self.program.parent, *words).split('\n')[:-1]

    def test_completion(self):
        self.assertEqual(set(self.complete('slipstick', '--')), self.options)
        self.assertEqual(sorted(self.complete('slipstick', 'hert')), ['hertz.prm', 'hertz_ball.prm', 'hertz_solid.prm'])
        self.assertEqual(self.complete('slipstick', '--list-parameters', 'j'), ['json'])
        self.assertEqual(self.complete('slipstick', 'box_on_circle.prm', '--set', 'Contact circle/Sl'),
                         ['Contact\\ circle/Slave=', 'Contact\\ circle/Slip\\ bound='])

    def test_others_build_on_qp_and_tfeti(self):
        build = self.folder / 'consumer'
        launcher = ['-D', 'CMAKE_CXX_COMPILER_LAUNCHER=' + os.environ['LAUNCHER']] if os.environ.get('LAUNCHER') else []
        run(CMAKE, '-S', SOURCE / 'tests' / 'install' / 'consumer', '-B', build, '-D',
            'CMAKE_PREFIX_PATH={}'.format(self.prefix), '-D', 'DEAL_II_DIR=' + os.environ.get('DEAL_II_DIR', ''), *launcher)
        run(CMAKE, '--build', build)
        self.assertEqual(run(build / 'box').split(), ['1', '-1', '0.5'])
        # 100 N close the gap of 1e-3 mm of 18 springs of 9e4 N/mm with 5 N
        self.assertEqual(run(build / 'bar').strip(), 'status 0, force on the wall 95, displacement of its end 0.001')

    @unittest.skipUnless(shutil.which('dpkg-deb'), 'no dpkg here')
    def test_package_of_debian(self):
        settings = (BUILD / 'CPackConfig.cmake').read_text()
        self.assertIn('set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS "ON")', settings)
        finds_libraries = shutil.which('dpkg-shlibdeps') and os.environ.get('SLIPSTICK_SHLIBDEPS')
        if not finds_libraries:
            settings += 'set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS OFF)\n'
        (self.folder / 'CPackConfig.cmake').write_text(settings)
        run(CPACK, '--config', self.folder / 'CPackConfig.cmake', '-G', 'DEB', '-B', self.folder / 'deb')
        package, = (self.folder / 'deb').glob('*.deb')
        if finds_libraries:
            depends = run('dpkg-deb', '--field', package, 'Depends')
            for library in ('libdeal.ii', 'libcholmod', 'libc6'):
                self.assertIn(library, depends)
        run('dpkg-deb', '--extract', package, self.folder / 'root')
        # what dpkg-shlibdeps looks for packages of
        needed = re.findall(r'NEEDED +(\S+)', run('objdump', '-p', self.folder / 'root' / 'usr' / 'bin' / 'slipstick'))
        for library in ('libdeal', 'libcholmod', 'libc.so'):
            self.assertTrue([name for name in needed if name.startswith(library)], (library, needed))
        share = self.folder / 'root' / 'usr' / 'share'
        self.assertTrue((share / 'man' / 'man1' / 'slipstick.1').is_file())
        run(self.folder / 'root' / 'usr' / 'bin' / 'slipstick', share / 'slipstick' / 'prm' / 'clamp.prm', '--check', '--quiet')


if __name__ == '__main__':
    unittest.main()
