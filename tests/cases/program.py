"""Runs slipstick as a user does and reads what it leaves. Standard library only.

Where things are comes from the environment: SLIPSTICK (the program), SLIPSTICK_SOURCE_DIR; without it from the place of
this file and a build in build/. MPIEXEC is read by scripts/mpirun. With SLIPSTICK_FORK_SERVER (tests/fork_server) runs do
not load the libraries anew.
"""

import atexit
import csv
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / 'fork_server'))
from fork_server import ForkServer  # noqa: E402

SOURCE = pathlib.Path(os.environ.get('SLIPSTICK_SOURCE_DIR', pathlib.Path(__file__).resolve().parents[2]))
PROGRAM = os.environ.get('SLIPSTICK', str(SOURCE / 'build' / 'slipstick'))
# Seconds for one run: all of them end within a few, also on a busy machine; a hang is a failure. Sanitizers take longer.
TIME_LIMIT = float(os.environ.get('SLIPSTICK_TIME_LIMIT', 60))

WORK = pathlib.Path(tempfile.mkdtemp(prefix='slipstick-cases-'))
atexit.register(shutil.rmtree, WORK, ignore_errors=True)

ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1')
# Open MPI 4 waits for 1 to 2 s when a rank has returned a status. Slipstick's ranks have all passed MPI_Finalize by then.
NO_GRACE = {'OMPI_MCA_odls_base_sigkill_timeout': '0'}


def shipped(name):
    """A scene of prm/."""
    return str(SOURCE / 'prm' / (name + '.prm'))


def new_path(name):
    """A path that does not exist yet, in a directory of its own."""
    return pathlib.Path(tempfile.mkdtemp(dir=WORK)) / name


def launcher(ranks):
    if ranks == 1:
        return []  # started alone
    return [str(SOURCE / 'scripts' / 'mpirun'), '--shared-cores', '-n', str(ranks)]


class Hang(AssertionError):
    pass


_servers = []


def fork_server():
    """The server of this process, started at its first run; None where none is named."""
    if not _servers and os.environ.get('SLIPSTICK_FORK_SERVER'):
        _servers.append(ForkServer(os.environ['SLIPSTICK_FORK_SERVER'], ENVIRONMENT))
        atexit.register(_servers[0].close)
    return _servers[0] if _servers else None


class Result:
    """What one run printed, returned and wrote."""

    def __init__(self, command, status, stdout, stderr, directory):
        self.command = command
        self.status = status
        self.stdout = stdout
        self.stderr = stderr
        self.directory = directory

    def __str__(self):
        return '{}\nstatus {}\n--- stdout\n{}--- stderr\n{}'.format(
            ' '.join(self.command), self.status, self.stdout, self.stderr)

    @property
    def summary(self):
        return json.loads((self.directory / 'summary.json').read_text())

    @property
    def contact(self):
        """Rows of contact.csv, numbers as numbers."""
        return self.rows('contact.csv', text=('pair', 'slave body', 'status'))

    def rows(self, name, text=()):
        with open(self.directory / name, newline='') as stream:
            return [{key: value if key in text else float(value) for key, value in row.items()}
                    for row in csv.DictReader(stream)]

    def files(self):
        return sorted(path.name for path in self.directory.iterdir()) if self.directory.is_dir() else []


def hang(command, stdout, stderr):
    return Hang('no end after {} s: {}\n{}{}'.format(TIME_LIMIT, ' '.join(command), stdout, stderr))


def run(*arguments, ranks=1, directory=None):
    """slipstick with these arguments, as they are. @p directory: where the caller expects output, for the result."""
    arguments = [str(argument) for argument in arguments]
    command = launcher(ranks) + [PROGRAM] + arguments
    server = fork_server()
    started = launcher(ranks) + [server.client] + arguments if server else command
    process = subprocess.Popen(started, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               env={**ENVIRONMENT, **NO_GRACE, **(server.variables if server else {})}, cwd=WORK,
                               start_new_session=True)
    try:
        stdout, stderr = process.communicate(timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGTERM)  # mpirun ends its ranks
        try:
            stdout, stderr = process.communicate(timeout=10)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            stdout, stderr = process.communicate()
        raise hang(command, stdout, stderr)
    return Result(command, process.returncode, stdout, stderr, directory)


def settings(overrides):
    """{'Section/Name': value} as --set options."""
    return [word for name, value in overrides.items() for word in ('--set', '{}={}'.format(name, value))]


def solve(case, overrides=None, ranks=1, options=()):
    """A run into a new output directory."""
    directory = new_path('output')
    return run(case, *settings(overrides or {}), '--output', directory, *options, ranks=ranks, directory=directory)


def converged(case, overrides=None, ranks=1):
    """The same, and it must converge."""
    result = solve(case, overrides, ranks)
    if result.status != 0:
        raise AssertionError('expected status 0\n{}'.format(result))
    return result
