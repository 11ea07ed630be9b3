"""The functions that scripts/ share, scripts/mpirun and cmake/linker.cmake, with stand-ins for dpkg, mpirun and linkers."""

import os
import pathlib
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ.get('SLIPSTICK_SOURCE_DIR', pathlib.Path(__file__).resolve().parents[2]))

# What Open MPI 5 writes of its own when ranks return a status.
REPORT = '''--------------------------------------------------------------------------
prterun detected that one or more processes exited with non-zero status,
thus causing the job to be terminated. The first process to do so was:

   Process name: [prterun-host-2701@1,0]
   Exit code:    2
--------------------------------------------------------------------------
'''
OTHER = REPORT.replace('prterun detected that one or more processes exited with non-zero status',
                       'There are not enough slots available in the system')


class WithFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def stand_in(self, name, script):
        """An executable NAME that comes first in the PATH of bash() below."""
        file = self.folder / 'bin' / name
        file.parent.mkdir(exist_ok=True)
        file.write_text('#!/bin/bash\n' + script)
        file.chmod(0o755)
        return file

    def run_command(self, *command, **environment):
        return subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, cwd=self.folder, timeout=60,
                              env=dict(os.environ, PATH='{}:{}'.format(self.folder / 'bin', os.environ['PATH']), **environment))

    def bash(self, commands):
        """After the first lines of every script."""
        return self.run_command('bash', '-c', 'set -euo pipefail; source "{}/scripts/common.sh"; {}'.format(SOURCE, commands))


class Packages(WithFolder):
    def missing(self, listing, wanted):
        self.stand_in('dpkg-query', 'cat <<END\n{}END\nexit 1\n'.format(listing))
        result = self.bash('missing_packages ' + wanted)
        self.assertEqual(result.returncode, 0, result)
        return result.stdout.split()

    def test_all_are_missing_where_none_is_installed(self):
        self.assertEqual(self.missing('', 'g++ cmake'), ['g++', 'cmake'])

    def test_removed_packages_are_missing(self):
        self.assertEqual(self.missing('installed g++\nconfig-files cmake\nnot-installed ccache\n', 'g++ cmake ccache'),
                         ['cmake', 'ccache'])

    def test_nothing_is_missing_where_all_are_installed(self):
        self.assertEqual(self.missing('installed g++\ninstalled cmake\n', 'cmake g++'), [])


class Logged(WithFolder):
    def test_waits_for_its_reader(self):
        # a reader that is late: the log is complete all the same when the function returns
        result = self.bash('progress() {{ sleep 0.3; cat >"$1"; }}; logged cat "{0}" echo word; cat "{0}"'.format(self.folder / 'log'))
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, 'word\n', ''))

    def test_failure_shows_what_matters(self):
        for options in ('set -o pipefail', 'set +o pipefail'):  # benchmarks call it without
            result = self.bash(options + '; logged cat "{}" bash -c "echo because; exit 3"; echo goes on'.format(self.folder / 'log'))
            self.assertEqual((result.returncode, result.stdout), (10, ''), result)
            self.assertTrue(result.stderr.startswith('because\n'), result)


class Launcher(WithFolder):
    def launch(self, script, *arguments):
        return self.run_command(SOURCE / 'scripts' / 'mpirun', *arguments, MPIEXEC=str(self.stand_in('launcher', script)))

    def test_report_below_the_error_is_left_out(self):
        result = self.launch('echo out; echo "error: mine" >&2; cat >&2 <<END\n{} \nEND\nexit 2\n'.format(REPORT), '-n', 2)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (2, 'out\n', 'error: mine\n'))

    def test_other_messages_stay(self):
        result = self.launch('cat >&2 <<END\n{}END\nexit 1\n'.format(OTHER), '-n', 2)
        self.assertEqual((result.returncode, result.stderr), (1, OTHER))

    def test_is_the_process_that_a_signal_reaches(self):
        result = self.launch('kill -TERM $$; sleep 60', '-n', 1)
        self.assertEqual(result.returncode, -15)

    def test_runs_at_the_same_time_share_no_folder(self):
        # Open MPI 4 removes a shared one while another run is about to use it
        show = 'echo $OMPI_MCA_orte_tmpdir_base; ls -d $OMPI_MCA_orte_tmpdir_base; touch $OMPI_MCA_orte_tmpdir_base/left'
        folders = []
        for _ in range(2):
            result = self.launch(show, '-n', 1)
            name, seen = result.stdout.split()
            self.assertEqual((seen, result.stderr), (name, ''))
            self.assertFalse(pathlib.Path(name).exists(), name)
            folders.append(name)
        self.assertNotEqual(*folders)

    def test_arguments_and_settings_for_both_launchers(self):
        show = 'printf "%s|" "$@"; echo; env | grep -E "policy|quiet|idle" | sort'
        alone = self.launch(show, '-n', 3, 'program', 'with space')
        self.assertEqual(alone.stdout, '-n|3|program|with space|\nOMPI_MCA_orte_execute_quiet=1\n'
                         'PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe\n')
        shared = self.launch(show, '--shared-cores', '-n', 3)
        for setting in ('OMPI_MCA_hwloc_base_binding_policy=none', 'PRTE_MCA_hwloc_default_binding_policy=none'):
            self.assertIn(setting, shared.stdout.splitlines())


class Linker(WithFolder):
    def flags(self, linker):
        """Those of deal.II's package, and of its target, that are left."""
        (self.folder / 'targets.cmake').write_text(
            'add_library(dealii::dealii INTERFACE IMPORTED)\n'
            'set_target_properties(dealii::dealii PROPERTIES INTERFACE_LINK_OPTIONS "-rdynamic;-fuse-ld={};-Wl,-z,relro")\n'
            .format(linker))
        (self.folder / 'CMakeLists.txt').write_text(
            'cmake_minimum_required(VERSION 3.20)\nproject(trial NONE)\n'
            'set(DEAL_II_LINKER_FLAGS "-rdynamic -fuse-ld={} -Wl,-z,relro")\n'
            'set(DEAL_II_TARGET_CONFIG "${{CMAKE_SOURCE_DIR}}/targets.cmake")\n'
            'include("{}/cmake/linker.cmake")\n'
            'if(NOT DEAL_II_TARGET_CONFIG_INCLUDED)\ninclude("${{DEAL_II_TARGET_CONFIG}}")\nendif()\n'
            'get_target_property(options dealii::dealii INTERFACE_LINK_OPTIONS)\n'
            'message(NOTICE "found: ${{DEAL_II_LINKER_FLAGS}}: ${{options}}")\n'.format(linker, SOURCE))
        result = self.run_command('cmake', '-S', self.folder, '-B', self.folder / linker)
        self.assertEqual(result.returncode, 0, result)
        return [line for line in result.stderr.splitlines() if line.startswith('found: ')][0]

    def test_linker_that_is_not_there_is_not_asked_for(self):
        flags = self.flags('nosuchlinker')
        self.assertNotIn('fuse', flags)
        self.assertEqual(flags.count('-rdynamic'), 2)
        self.assertEqual(flags.count('relro'), 2)

    def test_linker_that_is_there_stays(self):
        self.stand_in('ld.present', '')
        self.assertEqual(self.flags('present').count('-fuse-ld=present'), 2)


class TestDebian(WithFolder):
    def refused(self, *arguments, **environment):
        result = self.run_command(SOURCE / 'scripts' / 'test-debian', *arguments, **environment)
        self.assertEqual(result.stdout, '')
        return result.returncode, result.stderr

    def test_release_is_named(self):
        for arguments in ([], ['11'], ['-L', 'qp']):
            status, message = self.refused(*arguments)
            self.assertEqual(status, 2)
            self.assertIn('12 or 13', message)

    @unittest.skipUnless(os.geteuid() == 0, 'needs root')
    def test_folder_of_others_is_left_alone(self):
        for name in ('debootstrap', 'unshare', 'git'):
            self.stand_in(name, 'while [[ $1 == --* ]]; do shift; [[ $1 == private ]] && shift; done; exec "$@"\n')
        other = self.folder / 'other'
        other.mkdir()
        (other / 'file').write_text('')
        status, message = self.refused('13', SLIPSTICK_CHROOT=str(other))
        self.assertEqual(status, 10)
        self.assertIn(str(other), message)
        self.assertTrue((other / 'file').exists())


if __name__ == '__main__':
    unittest.main()
