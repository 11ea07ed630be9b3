#!/usr/bin/env python3
"""scenes.py N SEED PROGRAM [--server FORK_SERVER] [--keep DIR] [--time SECONDS] [--memory MB] [--jobs N]: N mutated scenes, and
mesh files in them, through the program. Each run must end with status 0, 2, 3 or 4 within the limits; with one error and one remedy
where it is refused, nothing left half written, and where it converges with an answer that its files themselves show to be one: loads,
supports, foundations and contact with obstacles are in balance; no tension, no penetration, no pressure at a gap, no friction beyond
its bound. With the program of tests/fork_server runs do not load the libraries anew. What fails is kept in DIR (default output/fuzz)
under its seed. Status 1 when any did. Standard library only.
"""

import argparse
import concurrent.futures
import csv
import json
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'tests' / 'fork_server'))
from fork_server import ForkServer  # noqa: E402

# Shipped scenes that solve in about a second on the meshes that these settings give.
SHIPPED = {
    'box_on_circle': ['Decomposition/Cells per block=3'],
    'box_frictionless': ['Decomposition/Cells per block=3'],
    'box_prescribed': ['Decomposition/Cells per block=3'],
    'box_linear': ['Decomposition/Cells per block=3'],
    'raous': [], 'press_fit': [], 'incline': [], 'patch_gmsh': [], 'lap_joint': [], 'circular_punch': [], 'hertz_ball': [],
    'oblique_blocks': ['Body base/Cells=4, 1, 4', 'Body box/Cells=3, 2, 3'], 'patch_solid': [],
    'cube_on_sphere': ['Body cube/Cells=4, 4, 4', 'Decomposition/Method=none'],
}
ODD = ['0', '-1', '1', '1e30', '1e-30', '1e300', 'nan', 'inf', '-0', '1e6', '1e-6', '0.5', '2', '1000000', '10', '', ' ', 'x', 'auto',
       'free', 'all', '*', '0, 0', '1, 2, 3', '-250*x', 'sin(', 'x/0', 'sqrt(y-5)', 't', '1e9*x', 'true', '\xf6', '\x1b[31m', 'none']
PLATE = """\
set Materials = steel
set Bodies = plate
set Supports = left
set Obstacles = floor
set Tractions = top
set Contacts = low
subsection Material steel
  set Young modulus = 1000
end
subsection Body plate
  set Shape = mesh
  set File = {}
  set Part = {}
  set Material = steel
end
subsection Obstacle floor
  set Shape = half plane
  set Point = 0, 0
  set Normal = 0, 1
end
subsection Support left
  set Boundary = plate/{}
  set Displacement x = 0
end
subsection Traction top
  set Boundary = plate/{}
  set Traction y = -1
end
subsection Contact low
  set Slave = plate/{}
  set Master = floor
  set Law = Coulomb
  set Friction coefficient = 0.3
end
"""
MESHES = ['gmsh.vtk', 'gmsh.unv', 'gmsh_curved.inp', 'two_parts_msh41.msh', 'two_parts_msh22.bin.msh', 'mixed.msh']


def mutated_lines(rng, text):
    lines = text.split('\n')
    for _ in range(rng.randint(1, 4)):
        k = rng.randrange(len(lines))
        what = rng.randrange(8)
        if what == 0:
            del lines[k]
        elif what == 1:
            lines.insert(rng.randrange(len(lines) + 1), lines[k])
        elif what == 2:
            other = rng.randrange(len(lines))
            lines[k], lines[other] = lines[other], lines[k]
        elif what in (3, 4) and '=' in lines[k]:
            lines[k] = lines[k].split('=')[0] + '= ' + rng.choice(ODD)
        elif what in (5, 6):  # a number of another line
            numbers = re.findall(r'-?[0-9][0-9.e+-]*', '\n'.join(lines))
            if numbers:
                lines[k] = re.sub(r'-?[0-9][0-9.e+-]*', lambda _: rng.choice(numbers + ODD), lines[k], count=1)
        elif lines[k]:
            at = rng.randrange(len(lines[k]))
            lines[k] = lines[k][:at] + rng.choice(['', chr(rng.randrange(256)), lines[k]]) + lines[k][at + 1:]
        if not lines:
            lines = ['']
    return '\n'.join(lines)


def make_case(seed, folder):
    """Writes the case; returns its path and the arguments."""
    rng = random.Random(seed)
    case = folder / 'case.prm'
    arguments = []
    if rng.random() < 0.6:
        name = rng.choice(sorted(SHIPPED))
        text = (ROOT / 'prm' / (name + '.prm')).read_text()
        os.symlink(ROOT / 'meshes', folder.parent / 'meshes')
        for setting in SHIPPED[name]:
            arguments += ['--set', setting]
    else:
        name = rng.choice(MESHES)
        data = (ROOT / 'tests/mesh/meshes' / name).read_bytes()
        mesh = folder / name
        if rng.random() < 0.7 and b'\0' not in data:
            mesh.write_text(mutated_lines(rng, data.decode()), encoding='latin1', errors='replace')
        else:
            data = bytearray(data)
            for _ in range(rng.randint(1, 3)):
                data[rng.randrange(len(data))] = rng.randrange(256)
            mesh.write_bytes(bytes(data))
        numbers = name.endswith('.vtk')
        text = PLATE.format(name, '', *(['2', '2', '1'] if numbers else ['foot', 'top_side', 'foot'] if 'gmsh' in name
                                        else ['outline', 'right side', 'foot']))
    if rng.random() < 0.8 or name not in MESHES:
        text = mutated_lines(rng, text)
    case.write_text(text, encoding=rng.choice(['utf-8', 'latin1']), errors='replace')
    if rng.random() < 0.2:
        arguments += ['--set', rng.choice(['Discretization/Degree', 'Discretization/Refinements', 'Solver/Tolerance',
                                           'Decomposition/Subdomains', 'Load steps/Factors']) + '=' + rng.choice(ODD)]
    return case, arguments


def settings_of(path):
    """{'Section/Name': value} of the parameters that a run has written."""
    settings, sections = {}, []
    for line in path.read_text(errors='replace').split('\n'):
        word, _, rest = line.strip().partition(' ')
        if word == 'subsection':
            sections.append(rest.strip())
        elif word == 'end' and sections:
            sections.pop()
        elif word == 'set' and '=' in rest:
            name, value = rest.split('=', 1)
            settings['/'.join(sections + [name.strip()])] = value.strip()
    return settings


def check_balance(summary, settings):
    """All that acts on the bodies from outside, relative to the sum of magnitudes, and to the rounding of stresses."""
    rounding = 1e-12 * (summary['results']['max_von_mises'] or 0)  # on 1 mm^2
    outside = [entry['force'] for kind in ('loads', 'supports', 'foundations') for entry in summary['results'].get(kind) or []]
    obstacles = [name.strip() for name in settings.get('Obstacles', '').split(',')]
    for pair in summary['results'].get('contact') or []:
        if settings.get('Contact {}/Master'.format(pair['pair'])) in obstacles:
            outside.append(pair['force'])
    for components in zip(*outside):
        if abs(sum(components)) > 1e-3 * sum(abs(c) for force in outside for c in force) + rounding:
            return 'forces are out of balance: ' + str(outside)
    return ''


def check_contact(path, results):
    """What contact.csv says against the conditions of contact, relative to its largest numbers, which are rounding where they
    are a tiny part of the stress or of the displacements."""
    with open(path, newline='') as stream:
        rows = list(csv.DictReader(stream))
    stress, displacement = results['max_von_mises'], results['max_displacement']
    for step in {row['step'] for row in rows}:
        for pair in {row['pair'] for row in rows}:
            own = [row for row in rows if row['step'] == step and row['pair'] == pair]
            if not own or any(row['slip_bound'] == 'inf' for row in own):  # bonded
                continue
            number = lambda row, key: float(row[key])
            largest = max(abs(number(row, 'pressure')) + abs(number(row, 'tangential_traction')) for row in own)
            if largest < 1e-5 * stress:
                continue
            for row in own:
                place = ' at ' + row['x'] + ', ' + row['y'] + ' of ' + pair
                if number(row, 'pressure') < -1e-3 * largest:
                    return 'tension' + place
                if abs(number(row, 'tangential_traction')) > number(row, 'slip_bound') + 1e-2 * largest:
                    return 'friction beyond its bound' + place
                if number(row, 'gap') < -1e-2 * displacement:
                    return 'penetration' + place
                if number(row, 'gap') > 1e-2 * displacement and number(row, 'pressure') > 1e-2 * largest:
                    return 'pressure across a gap' + place
    return ''


def limit(memory):
    def set_limits():
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_AS, (memory << 20, memory << 20))
    return set_limits


ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1', OMPI_ALLOW_RUN_AS_ROOT='1',
                   OMPI_ALLOW_RUN_AS_ROOT_CONFIRM='1')
of_thread = threading.local()


def start(arguments, options):
    """Returns the status, what was printed on standard error as bytes, and whether the time limit was hit."""
    if options.server and all(argument.isprintable() for argument in arguments):
        if not hasattr(of_thread, 'server'):
            of_thread.server = ForkServer(options.server, ENVIRONMENT)
        status, _, stderr, is_late = of_thread.server.run(arguments, os.getcwd(), options.time, options.memory)
        return status, stderr, is_late
    process = subprocess.Popen([options.program, *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, start_new_session=True, preexec_fn=limit(options.memory), env=ENVIRONMENT)
    try:
        stderr = process.communicate(timeout=options.time)[1]
        return process.returncode, stderr, False
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return process.returncode, b'', True


def run_one(seed, options):
    """Returns the status and what is wrong with the run, '' when nothing is."""
    work = pathlib.Path(tempfile.mkdtemp(prefix='slipstick-fuzz-'))
    folder = work / 'prm'
    folder.mkdir()
    output = work / 'output'
    problem = ''
    status = None
    try:
        case, arguments = make_case(seed, folder)
        arguments = [str(case), '--output', str(output), *arguments]
        status, stderr, is_late = start(arguments, options)
        errors = stderr.decode(errors='surrogateescape')
        if is_late:
            problem = 'no end within {} s'.format(options.time)
        elif status not in (0, 2, 3, 4):
            problem = 'status {}: {}'.format(status, errors.strip()[-300:])
        elif status == 2 and (errors.count('error: ') != 1 or errors.count('\n  remedy: ') != 1):
            problem = 'no single error with its remedy: ' + errors[:300]
        elif any(not c.isprintable() and c != '\n' for c in errors):
            problem = 'control characters in the message: ' + repr(errors[:300])
        elif output.is_dir() and any(name.endswith('.tmp') for name in os.listdir(output)):
            problem = 'half written files'
        elif status == 0:
            summary = json.loads((output / 'summary.json').read_text())
            if not summary['converged']:
                problem = 'status 0 of a run that did not converge'
            elif any(value is None or value > 1e-3 for value in summary['residuals'].values()):
                problem = 'status 0 with residuals ' + str(summary['residuals'])
            else:
                problem = check_balance(summary, settings_of(output / 'parameters.prm'))
                if not problem and (output / 'contact.csv').exists():
                    problem = check_contact(output / 'contact.csv', summary['results'])
        if problem:
            kept = options.keep / str(seed)
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(folder, kept)
            (kept / 'command').write_text(' '.join([options.program, *arguments]) + '\n' + problem + '\n', errors='replace')
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return status, problem


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('n', type=int)
    parser.add_argument('seed', type=int)
    parser.add_argument('program')
    parser.add_argument('--server')
    parser.add_argument('--keep', type=pathlib.Path, default=ROOT / 'output/fuzz')
    parser.add_argument('--time', type=float, default=60)
    parser.add_argument('--memory', type=int, default=2048)
    parser.add_argument('--jobs', type=int, default=os.cpu_count())
    options = parser.parse_args()
    options.keep.mkdir(parents=True, exist_ok=True)
    statuses = {}
    n_bad = 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for seed, (status, problem) in zip(range(options.seed, options.seed + options.n),
                                           pool.map(lambda seed: run_one(seed, options),
                                                    range(options.seed, options.seed + options.n))):
            statuses[status] = statuses.get(status, 0) + 1
            if problem:
                n_bad += 1
                print('seed {}: {}'.format(seed, problem.encode('ascii', 'backslashreplace').decode()), flush=True)
    print('{} mutated scenes from seed {}: {}; {} with a fault{}'.format(
        options.n, options.seed, ', '.join('status {}: {}'.format(*entry) for entry in sorted(statuses.items(), key=str)), n_bad,
        ' (kept in {})'.format(options.keep) if n_bad else ''))
    return 1 if n_bad else 0


if __name__ == '__main__':
    sys.exit(main())
