#!/usr/bin/env python3
"""scenes.py N SEED PROGRAM [--server FORK_SERVER] [--keep DIR] [--time SECONDS] [--memory MB] [--jobs N] [--two-ranks PART]: N
mutated scenes, and mesh files in them, through the program. Each run must end with status 0, 2, 3 or 4 within the limits; with one
error and one remedy where it is refused, nothing left half written, and where it converges with an answer that its files themselves
show to be one (answer.py). Scenes are shipped ones, those of scenes/ (every kind of section), solids drawn at random and plates and
blocks from mesh files; lines, values, numbers (also by powers of ten), bytes, included files and settings of any parameter are
mutated. PART of them run on two ranks; with the program of tests/fork_server they do not load the libraries anew. What fails
is kept in DIR (default output/fuzz) under its seed. SECONDS are those of the clock; where a run takes longer on one rank it is made
again, and they are those of its processor time, since other programs may keep the machine busy. Status 1 when any did. Standard library only.
"""

import argparse
import atexit
import concurrent.futures
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
import unicodedata

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'tests' / 'fork_server'))
sys.path.insert(0, str(ROOT / 'tests' / 'random'))
sys.path.insert(0, str(ROOT / 'tests' / 'fuzz'))
import solids  # noqa: E402
from answer import problem_of  # noqa: E402
from fork_server import ForkServer  # noqa: E402

# Shipped scenes that solve in about a second on the meshes that these settings give.
SHIPPED = {
    'box_on_circle': ['Decomposition/Cells per block=3'],
    'box_frictionless': ['Decomposition/Cells per block=3'],
    'box_prescribed': ['Decomposition/Cells per block=3'],
    'box_linear': ['Decomposition/Cells per block=3'],
    'raous': [], 'press_fit': [], 'dome': [], 'ring_on_shaft': [], 'bolted_joint': ['Load steps/Factors=1, 2'], 'arch': [],
    'push_out': [], 'cattaneo_mindlin': [], 'cantilevers': ['Body upper/Cells=40, 4, 3', 'Body lower/Cells=35, 4, 3'],
    'incline': [], 'patch_gmsh': [], 'lap_joint': [], 'circular_punch': [], 'hertz_ball': [],
    'oblique_blocks': ['Body base/Cells=4, 1, 4', 'Body box/Cells=3, 2, 3'], 'patch_solid': [],
    'cube_on_sphere': ['Body cube/Cells=4, 4, 4', 'Decomposition/Method=none'],
}
ODD = ['0', '-1', '1', '1e30', '1e-30', '1e300', 'nan', 'inf', '-0', '1e6', '1e-6', '0.5', '2', '1000000', '10', '', ' ', 'x', 'auto',
       'free', 'all', '*', '1e-320', '4294967296', '1e308*10', '{1/0}', '{x}', '2e-16', '0, 0', '1, 2, 3', '-250*x', 'sin(', 'x/0', 'sqrt(y-5)', 't', '1e9*x', 'true', '\xf6', '\x1b[31m', 'none']
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


NUMBER = r'-?[0-9][0-9.]*(?:e[+-]?[0-9]+)?'


def mutated_values(rng, text, is_mild=False):
    """Numbers of the scene times a factor, mostly (or, mild, nearly always) within what a scene may mean."""
    lines = text.split('\n')
    values = [k for k, line in enumerate(lines) if re.search('=.*[0-9]', line) and not line.startswith('#')]
    for _ in range(rng.randint(1, 4)):
        k = rng.choice(values or [0])
        name, _, value = lines[k].partition('=')
        factor = rng.choice([rng.uniform(0.3, 3), rng.uniform(0.9, 1.1), 10 ** rng.uniform(-2, 2)] if is_mild else
                            [rng.uniform(0.3, 3), rng.uniform(0.9, 1.1), -1, 10 ** rng.uniform(-4, 4), 10 ** rng.uniform(-320, 300)])
        number = rng.choice(list(re.finditer(NUMBER, value)) or [None])
        if number:
            changed = float(number.group()) * factor
            text = str(round(changed)) if '.' not in number.group() and rng.random() < 0.5 and abs(changed) < 1e9 else repr(changed)
            lines[k] = name + '=' + value[:number.start()] + text + value[number.end():]
    return '\n'.join(lines)


def with_include(rng, text, folder):
    """Some of the lines, whole sections or not, in another file."""
    lines = text.split('\n')
    first = rng.randrange(len(lines))
    last = rng.randint(first, len(lines))
    (folder / 'part.prm').write_text('\n'.join(lines[first:last]) + '\n', encoding='utf-8', errors='replace')
    return '\n'.join(lines[:first] + ['include part.prm'] + lines[last:])


def random_solid(rng):
    scene = solids.Scene(rng)
    rng.choice(solids.KINDS)(scene, rng)
    return scene.text()


def block_of_solids(rng):
    """A block of hexahedra or tetrahedra: name of the file, its text, and its part and boundaries (left, top, low)."""
    n = [rng.randint(1, 3) for _ in range(3)]
    node = lambda i, j, k: 1 + i + (n[0] + 1) * (j + (n[1] + 1) * k)
    corners = [(i, j, k) for k in range(n[2] + 1) for j in range(n[1] + 1) for i in range(n[0] + 1)]
    bricks = [[node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k),
               node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)]
              for k in range(n[2]) for j in range(n[1]) for i in range(n[0])]
    is_split = rng.random() < 0.5
    cells = [[b[c] for c in cell] for b in bricks for cell in
             ([(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)] if is_split else [range(8)])]
    if rng.random() < 0.3:
        lines = ['# vtk DataFile Version 3.0', 'block', 'ASCII', 'DATASET UNSTRUCTURED_GRID', 'POINTS {} double'.format(len(corners))]
        lines += [' '.join(map(str, corner)) for corner in corners]
        lines += ['CELLS {} {}'.format(len(cells), sum(1 + len(cell) for cell in cells))]
        lines += [' '.join(map(str, [len(cell)] + [number - 1 for number in cell])) for cell in cells]
        lines += ['CELL_TYPES {}'.format(len(cells))] + ['10' if is_split else '12'] * len(cells)
        return 'block.vtk', '\n'.join(lines) + '\n', ('', '0 where x < 0.01', '0 where y > {}'.format(n[1] - 0.01), '0 where y < 0.01')
    lines = ['*NODE'] + ['{}, {}, {}, {}'.format(number, *corner) for number, corner in enumerate(corners, 1)]
    lines += ['*ELEMENT, TYPE={}, ELSET=block'.format('C3D4' if is_split else 'C3D8')]
    lines += [', '.join(map(str, [number] + cell)) for number, cell in enumerate(cells, 1)]
    for name, d, at in (('left', 0, 0), ('up', 1, n[1]), ('low', 1, 0)):
        lines += ['*NSET, NSET=' + name] + [str(number) for number, corner in enumerate(corners, 1) if corner[d] == at]
    return 'block.inp', '\n'.join(lines) + '\n', ('block', 'left', 'up', 'low')


def scene_of_mesh(rng, folder):
    """A mesh file, in most cases mutated, and a scene with it."""
    is_solid = rng.random() < 0.4
    if is_solid:
        name, data, names = block_of_solids(rng)
        data = data.encode()
    else:
        name = rng.choice(MESHES)
        data = (ROOT / 'tests/mesh/meshes' / name).read_bytes()
        names = ('', *(['2', '2', '1'] if name.endswith('.vtk') else ['foot', 'top_side', 'foot'] if 'gmsh' in name
                       else ['outline', 'right side', 'foot']))
    what = rng.random()
    if what < 0.6 and b'\0' not in data:
        data = mutated_lines(rng, data.decode()).encode('latin1', errors='replace')
    elif what < 0.9:
        data = bytearray(data)
        for _ in range(rng.randint(1, 3)):
            data[rng.randrange(len(data))] = rng.randrange(256)
    (folder / name).write_bytes(bytes(data))
    text = PLATE.format(name, *names)
    if is_solid:
        for before, after in (('half plane', 'half space'), ('0, 0\n', '0, 0, 0\n'), ('0, 1\n', '0, 1, 0\n')):
            text = text.replace(before, after)
        text = 'set Dimension = 3\n' + text.replace('  set Displacement x = 0\n', '  set Displacement x = 0\n  set Displacement z = 0\n')
    return text


def scene_of(rng, folder):
    """Text of a scene to be mutated, and its settings."""
    kind = rng.random()
    if kind < 0.45:
        name = rng.choice(sorted(SHIPPED))
        os.symlink(ROOT / 'meshes', folder.parent / 'meshes')
        return (ROOT / 'prm' / (name + '.prm')).read_text(), SHIPPED[name]
    if kind < 0.6:
        return (ROOT / 'tests/fuzz/scenes' / rng.choice(['plane.prm', 'solid.prm'])).read_text(), []
    if kind < 0.7:
        return random_solid(rng), []
    return scene_of_mesh(rng, folder), []


def make_case(seed, folder, parameters):
    """Writes the case; returns its path and the arguments."""
    rng = random.Random(seed)
    case = folder / 'case.prm'
    text, given = scene_of(rng, folder)
    arguments = [word for setting in given for word in ('--set', setting)]
    what = rng.random()
    if what < 0.35:
        text = mutated_lines(rng, text)
    if 0.3 < what < 0.9:
        text = mutated_values(rng, text, is_mild=what > 0.5)
    if rng.random() < 0.2:
        arguments += ['--set', random_setting(rng, text, parameters)]
    if rng.random() < 0.1:
        text = with_include(rng, text, folder)
    if rng.random() < 0.2:
        arguments += [word for setting in wish_for_accuracy(rng, text) for word in ('--set', setting)]
    case.write_text(text, encoding=rng.choice(['utf-8', 'utf-8', 'latin1']), errors='replace')
    return case, arguments


MOST_UNKNOWNS = 'Adaptivity/Max unknowns=20000'


def wish_for_accuracy(rng, text):
    """Settings that ask for error bars or for refined meshes, to an accuracy that costs little."""
    pairs = re.findall('^ *subsection Contact (.+)$', text, re.MULTILINE)
    goal = 'Goal=' + rng.choice(['max_displacement', 'strain_energy'] + [
        '{}.{}'.format(pair, figure) for pair in pairs for figure in ('max_pressure', 'normal_force', 'tangential_force', 'contact_length')])
    return rng.choice([
        ['Error bars=true'],
        ['Error bars=true', 'Discretization/Degree=2'],
        ['Accuracy={:.2g} %'.format(rng.uniform(5, 25)), MOST_UNKNOWNS],
        ['Accuracy={:.2g} %'.format(rng.uniform(5, 25)), goal, MOST_UNKNOWNS],
        ['Accuracy=draft', 'Mesh=adaptive', MOST_UNKNOWNS],
    ])


def random_setting(rng, text, parameters):
    """Any parameter of any section of the scene, with a word that it allows or an odd one."""
    sections = re.findall('^ *subsection (.+)$', text, re.MULTILINE)
    name = rng.choice(sorted(parameters))
    section, slash, last = name.rpartition('/')
    own = [other for other in sections if other.split(' ')[0] == section.split(' ')[0]]
    if own and ' ' in section:
        section = rng.choice(own)
    return section + slash + last + '=' + rng.choice(parameters[name] if parameters[name] and rng.random() < 0.7 else ODD)


def parameters_of(program):
    """Words that the parameters of the program allow, by name."""
    listed = subprocess.run([program, '--list-parameters', 'json'], capture_output=True, text=True, check=True, env=ENVIRONMENT).stdout
    return {entry['name']: re.sub('.*one of: ', '', entry['allowed']).split(', ') if 'one of: ' in entry['allowed'] else []
            for entry in json.loads(listed)['parameters']}


PATIENCE = 10  # times the limit that a run may take where others keep the machine busy


def limit(memory, seconds=None):
    def set_limits():
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_AS, (memory << 20, memory << 20))
        if seconds:
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    return set_limits


ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1', OMPI_ALLOW_RUN_AS_ROOT='1',
                   OMPI_ALLOW_RUN_AS_ROOT_CONFIRM='1')


def start(arguments, options, ranks):
    """Returns the status, what was printed on standard error as bytes, and whether the time limit was hit."""
    launcher = [str(ROOT / 'scripts' / 'mpirun'), '--shared-cores', '-n', str(ranks)] if ranks > 1 else []
    return wait_for([*launcher, options.started, *arguments], limit(options.memory), options.time)


def wait_for(command, limits, seconds):
    """What start() returns."""
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                               start_new_session=True, preexec_fn=limits, env=ENVIRONMENT)
    try:
        stderr = process.communicate(timeout=seconds)[1]
        return process.returncode, stderr, process.returncode == -signal.SIGXCPU
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return process.returncode, b'', True


def start_patiently(arguments, options, ranks, output):
    """start(); a run that was late is made again alone, with the limit on its own processor time."""
    result = start(arguments, options, ranks)
    if result[2] and ranks == 1:
        shutil.rmtree(output, ignore_errors=True)
        result = wait_for([options.started, *arguments], limit(options.memory, int(options.time)), PATIENCE * options.time)
    return result


def run_one(seed, options):
    """Returns the status and what is wrong with the run, '' when nothing is."""
    work = pathlib.Path(tempfile.mkdtemp(prefix='slipstick-fuzz-'))
    folder = work / 'prm'
    folder.mkdir()
    output = work / 'output'
    problem = ''
    status = None
    try:
        case, arguments = make_case(seed, folder, options.parameters)
        arguments = [str(case), '--output', str(output), *arguments]
        ranks = 2 if random.Random(-seed).random() < options.two_ranks else 1
        status, stderr, is_late = start_patiently(arguments, options, ranks, output)
        errors = stderr.decode(errors='surrogateescape')
        if is_late:
            problem = 'no end within {} s'.format(options.time)
        elif status not in (0, 2, 3, 4):
            problem = 'status {}: {}'.format(status, errors.strip()[-300:])
        elif status == 2 and (errors.count('error: ') != 1 or errors.count('\n  remedy: ') != 1):
            problem = 'no single error with its remedy: ' + errors[:300]
        elif any(unicodedata.category(c) in ('Cc', 'Cs') and c != '\n' for c in errors):
            problem = 'control characters in the message: ' + repr(errors[:300])
        elif output.is_dir() and any(name.endswith('.tmp') for name in os.listdir(output)):
            problem = 'half written files'
        elif status == 0:
            problem = problem_of(output)
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
    parser.add_argument('--two-ranks', type=float, default=0.01)
    options = parser.parse_args()
    options.parameters = parameters_of(options.program)
    options.started = options.program
    if options.server:
        server = ForkServer(options.server, ENVIRONMENT)
        atexit.register(server.close)
        ENVIRONMENT.update(server.variables)
        options.started = server.client
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
