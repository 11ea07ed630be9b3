#!/usr/bin/env python3
"""faults.py N SEED PROGRAM: N runs under faults of the machine, drawn by seed: a rank that is killed, a limit on the size of files
or on the address space, an output directory that is removed or made read-only by force, no space on the device. None may hang,
end with status 1 (unless killed), or leave a half file under a final name. Status 1 when one did. Standard library only.
"""

import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
TIME_LIMIT = 60  # s, on a busy machine
ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1', OMPI_MCA_rmaps_base_oversubscribe='1',
                   OMPI_ALLOW_RUN_AS_ROOT='1', OMPI_ALLOW_RUN_AS_ROOT_CONFIRM='1', OMPI_MCA_mpi_yield_when_idle='1')


def ranks_of(launcher, program):
    """Processes of the program below this launcher."""
    found = []
    for entry in pathlib.Path('/proc').iterdir():
        if entry.name.isdigit():
            try:
                parent = int((entry / 'stat').read_text().rsplit(')', 1)[1].split()[1])
                if parent == launcher and os.path.realpath(entry / 'exe') == os.path.realpath(program):
                    found.append(int(entry.name))
            except OSError:
                pass
    return found


def half_files(output):
    """Files under final names that do not read to their end."""
    bad = []
    for path in output.glob('*') if output.is_dir() else []:
        try:
            if path.suffix == '.json':
                json.loads(path.read_text())
            elif path.suffix in ('.vtu', '.pvtu', '.pvd', '.vtp'):
                xml.etree.ElementTree.parse(path)
            elif path.suffix == '.csv' and not path.read_text().endswith('\n'):
                bad.append(path.name)
        except (ValueError, xml.etree.ElementTree.ParseError):
            bad.append(path.name)
    return bad


def one(seed, program):
    rng = random.Random(seed)
    fault = rng.choice(['kill', 'file size', 'address space', 'directory', 'stack'])
    work = pathlib.Path(tempfile.mkdtemp(prefix='slipstick-faults-'))
    output = work / 'output'
    case = rng.choice(['box_on_circle', 'raous', 'press_fit'])
    size = ['--set', 'Decomposition/Cells per block={}'.format(rng.choice([5, 10, 20]))] if case == 'box_on_circle' else []
    command = [program, str(ROOT / 'prm' / (case + '.prm')), '--output', str(output)] + size
    value = {'file size': 2 ** rng.randint(8, 20), 'address space': rng.randint(560, 1400) << 20,
             'stack': 2 ** rng.randint(16, 22)}.get(fault, 0)
    if fault == 'kill':
        command = ['mpirun', '-n', '2', '--quiet', '--oversubscribe'] + command

    def limits():
        if fault == 'file size':
            resource.setrlimit(resource.RLIMIT_FSIZE, (value, resource.RLIM_INFINITY))
        elif fault == 'address space':
            resource.setrlimit(resource.RLIMIT_AS, (value, resource.RLIM_INFINITY))
        elif fault == 'stack':
            resource.setrlimit(resource.RLIMIT_STACK, (max(value, 1 << 18), resource.RLIM_INFINITY))

    what = 'seed {}: {}{} {}'.format(seed, fault, ' ' + str(value) if value else '', case)
    try:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                   start_new_session=True, preexec_fn=limits, env=ENVIRONMENT)
        time.sleep(rng.uniform(0.1, 1.5) if fault in ('kill', 'directory') else 0)
        if fault == 'kill':
            ranks = ranks_of(process.pid, program)
            if ranks:
                os.kill(rng.choice(sorted(ranks)), signal.SIGKILL)
        elif fault == 'directory':
            shutil.rmtree(output, ignore_errors=True)
        try:
            errors = process.communicate(timeout=TIME_LIMIT)[1].decode(errors='replace')
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return what + ': no end'
        allowed = {0, 2, 3} if fault != 'kill' else {0, 137, 2}
        if process.returncode not in allowed:
            return '{}: status {}: {}'.format(what, process.returncode, errors[-300:])
        if process.returncode == 2 and fault != 'kill' and errors.count('error: ') != 1:
            return what + ': ' + errors[-300:]
        bad = half_files(output)
        return '{}: half written: {}'.format(what, bad) if bad else ''
    finally:
        shutil.rmtree(work, ignore_errors=True)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    n, seed, program = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
    problems = [problem for k in range(seed, seed + n) for problem in [one(k, program)] if problem]
    for problem in problems:
        print(problem)
    print('{} runs under faults from seed {}: {} with a fault'.format(n, seed, len(problems)))
    return 1 if problems else 0


if __name__ == '__main__':
    sys.exit(main())
