#!/usr/bin/env python3
"""Solids drawn at random: cubes on balls, stacks of blocks, half balls, rings on shafts, rollers, cut by METIS; every scene is
solved at the default tolerance. A tool, not a ctest: 400 scenes of some 2000 unknowns take six minutes of a core.

    tests/random/solids.py [--first SEED] [--scenes N] [--tolerance EPS] [--folder DIR]

One line a scene: seed, kind, exit status, multiplications, outer steps, fallbacks, laws. At the end: how many ended with which
status, median and largest number of multiplications. Exit status: 1 if any scene ended with other than 0 (solved) and 4 (no
equilibrium). SLIPSTICK names the program, by default build/slipstick.
"""

import argparse
import collections
import json
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get('SLIPSTICK', str(SOURCE / 'build' / 'slipstick'))
TIME_LIMIT = 300  # [s] of one scene
HELD = {'Displacement ' + c: 0 for c in 'xyz'}


class Scene:
    def __init__(self, choice):
        self.choice, self.sections, self.names = choice, [], collections.defaultdict(list)

    def add(self, kind, name, values):
        self.names[kind].append(name)
        self.sections.append((kind + ' ' + name, values))

    def material(self, name, modulus, ratio):
        self.add('Material', name, {'Young modulus': modulus, 'Poisson ratio': ratio})

    def cells(self, least, most):
        return ', '.join(str(self.choice.randint(least, most)) for _ in range(3))

    def contact(self, name, slave, master, coefficients, swaps=False):
        if swaps and self.choice.random() < 0.5:
            slave, master = master, slave
        law = self.choice.choice(coefficients)
        values = ({'Law': 'frictionless'} if law is None else
                  {'Law': 'Tresca', 'Slip bound': self.choice.choice([1, 10, 100])} if law == 'Tresca' else
                  {'Law': 'Coulomb', 'Friction coefficient': law})
        self.add('Contact', name, {'Slave': slave, 'Master': master, **values})

    def text(self):
        plurals = {'Body': 'Bodies', 'Body force': 'Body forces'}
        lines = ['set Dimension = 3'] + ['set {} = {}'.format(plurals.get(kind, kind + 's'), ', '.join(names))
                                         for kind, names in self.names.items()]
        cut = {'Method': 'METIS', 'Subdomains': self.choice.choice([2, 3, 5, 8, 12]), 'Seed': self.choice.randint(0, 9)}
        for section, values in self.sections + [('Decomposition', cut)]:
            lines += ['subsection ' + section] + ['  set {} = {}'.format(*item) for item in values.items()] + ['end']
        return '\n'.join(lines) + '\n'


def cube_on_ball(scene, choice):
    radius = choice.choice([5, 20, 100])
    scene.material('soft', 1e5, choice.choice([0, 0.3, 0.45]))
    scene.add('Body', 'cube', {'Shape': 'cuboid', 'Size': '10, 10, 10', 'Cells': scene.cells(4, 9), 'Material': 'soft'})
    scene.add('Obstacle', 'ball', {'Shape': 'ball', 'Radius': radius,
                                   'Center': '{}, {}, {}'.format(choice.uniform(2, 8), -radius, choice.uniform(2, 8))})
    scene.add('Support', 'clamp', {'Boundary': choice.choice(['cube/left', 'cube/top where x<4']), **HELD})
    scene.add('Traction', 'pressed', {'Boundary': 'cube/top', 'Traction y': -choice.choice([1, 50, 500])})
    scene.add('Traction', 'sheared', {'Boundary': 'cube/right', 'Traction x': choice.choice([0, -20]),
                                      'Traction z': choice.choice([0, 10, 50])})
    scene.contact('touch', 'cube/bottom', 'ball', [None, 'Tresca', 0.05, 0.1, 0.3, 0.6, 1, 3])


def stack_of_blocks(scene, choice):
    scene.material('soft', 2e5, 0.3)
    scene.material('other', 2e5 * choice.choice([1e-2, 1, 10, 1e3]), choice.choice([0, 0.3, 0.49]))
    n, y = choice.choice([2, 3, 4]), 0
    for i in range(n):
        size, height = choice.choice([20, 20 - 4 * i]), choice.choice([3, 8])
        scene.add('Body', 'b%d' % i, {'Shape': 'cuboid', 'Size': '{0}, {1}, {0}'.format(size, height), 'Cells': scene.cells(2, 7),
                                      'Material': choice.choice(['soft', 'other']),
                                      'Translation': '{0}, {1}, {2}'.format((20 - size) / 2, y,
                                                                            (20 - size) / 2 + choice.choice([0, 1.3]))})
        y += height
    top = 'b%d/' % (n - 1)
    shear = choice.choice([0, 10, 25])
    scene.add('Support', 'floor', {'Boundary': 'b0/bottom', **HELD})
    scene.add('Traction', 'pressed', {'Boundary': top + 'top', 'Traction y': -100})
    scene.add('Traction', 'sheared', {'Boundary': top + choice.choice(['right', 'front', 'top']), 'Traction z': shear,
                                      'Traction x': choice.choice([0, shear / 2])})
    for i in range(1, n):
        scene.contact('c%d' % i, 'b%d/bottom' % i, 'b%d/top' % (i - 1), [0.3, 0.35, 0.6, 1], swaps=True)


def half_ball_on_block(scene, choice):
    scene.material('soft', 2e5, 0.3)
    scene.material('other', 2e5 * choice.choice([0.1, 1, 10]), 0.3)
    scene.add('Body', 'ball', {'Shape': 'half ball', 'Center': '0, 10, 0', 'Radius': 10, 'Material': 'soft',
                               'Cells around': choice.choice([8, 16, 24])})
    scene.add('Body', 'block', {'Shape': 'cuboid', 'Size': '10, 5, 10', 'Origin': '-5, -5, -5', 'Cells': scene.cells(5, 11),
                                'Material': 'other'})
    scene.add('Support', 'floor', {'Boundary': 'block/bottom', **HELD})
    scene.add('Support', 'driven', {'Boundary': 'ball/flat', 'Displacement x': choice.choice([0, 0.01, 0.05]),
                                    'Displacement y': -choice.choice([0.01, 0.1]), 'Displacement z': choice.choice([0, 0.01])})
    scene.contact('touch', 'ball/surface', 'block/top', [None, 'Tresca', 0.05, 0.1, 0.3, 0.6, 1, 3], swaps=True)


def ring_on_shaft(scene, choice):
    scene.material('soft', 2e5, 0.3)
    scene.material('other', 2e5 * choice.choice([0.1, 1]), 0.3)
    scene.add('Body', 'shaft', {'Shape': 'cylinder', 'Radius': 20 + choice.choice([0.005, 0.02, 0.1]), 'Length': 8,
                                'Cells around': choice.choice([16, 24, 32]), 'Cells along axis': choice.randint(2, 4),
                                'Material': 'soft'})
    scene.add('Body', 'ring', {'Shape': 'tube', 'Radius': choice.choice([30, 40]), 'Inner radius': 20, 'Length': 5,
                               'Center': '0, 0, 1.5', 'Cells around': choice.choice([16, 20, 32]),
                               'Cells along axis': choice.randint(2, 3), 'Material': 'other'})
    turn = choice.choice([0, 1e-4, 1e-3])
    scene.add('Support', 'end', {'Boundary': 'shaft/back', **HELD})
    scene.add('Support', 'driven', choice.choice([
        {'Boundary': 'ring/outer', 'Displacement x': '-%g*y' % turn, 'Displacement y': '%g*x' % turn},
        {'Boundary': 'ring/front', 'Displacement z': choice.choice([0, 0.01])}]))
    scene.contact('fit', 'ring/inner', 'shaft/side', [0.1, 0.3, 0.6, 'Tresca'], swaps=True)


def roller(scene, choice):
    scene.material('soft', 2e5, 0.3)
    scene.add('Body', 'roller', {'Shape': 'cylinder', 'Radius': 5, 'Length': choice.choice([5, 10]), 'Material': 'soft',
                                 'Cells around': choice.choice([16, 24]), 'Cells along axis': choice.randint(2, 6)})
    scene.add('Obstacle', 'bed', choice.choice([{'Shape': 'bore', 'Center': '0, 0.01, 0', 'Radius': 5.01, 'Axis': '0, 0, 1'},
                                                {'Shape': 'half space', 'Point': '0, -5, 0', 'Normal': '0, 1, 0'}]))
    scene.add('Support', 'end', {'Boundary': 'roller/back', 'Displacement z': 0})
    scene.add('Body force', 'weight', {'Bodies': 'roller', 'Force y': -1, 'Force z': choice.choice([0, 0.05])})
    scene.contact('joint', 'roller/side', 'bed', [None, 0.1, 0.5])


KINDS = [cube_on_ball, stack_of_blocks, half_ball_on_block, ring_on_shaft, roller]


def solve(seed, folder, tolerance):
    """Exit status and number of multiplications (None where there is no table)."""
    choice = random.Random(seed)
    scene, kind = Scene(choice), KINDS[seed % len(KINDS)]
    kind(scene, choice)
    case, output = folder / ('%d.prm' % seed), folder / str(seed)
    case.write_text(scene.text())
    command = [PROGRAM, str(case), '--output', str(output)]
    command += ['--set', 'Solver/Tolerance=' + tolerance] if tolerance else []
    try:
        status = subprocess.run(command, capture_output=True, timeout=TIME_LIMIT,
                                env=dict(os.environ, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1')).returncode
    except subprocess.TimeoutExpired:
        status = 'time'
    laws = ' '.join(str(values.get('Friction coefficient', values['Law'])) for section, values in scene.sections
                    if section.startswith('Contact'))
    solver = json.loads((output / 'summary.json').read_text())['solver'] if status in (0, 3) else {}
    print('{:6d} {:20s} {!s:>4} {!s:>6} {!s:>5} {!s:>3}  {}'.format(
        seed, kind.__name__, status, solver.get('hessian_multiplications', '-'), solver.get('outer_iterations', '-'),
        solver.get('fallbacks', '-'), laws), flush=True)
    return status, solver.get('hessian_multiplications')


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument('--first', type=int, default=0)
    options.add_argument('--scenes', type=int, default=100)
    options.add_argument('--tolerance')
    options.add_argument('--folder', type=pathlib.Path)
    given = options.parse_args()
    folder = given.folder or pathlib.Path(tempfile.mkdtemp(prefix='slipstick-solids-'))
    folder.mkdir(parents=True, exist_ok=True)
    results = [solve(seed, folder, given.tolerance) for seed in range(given.first, given.first + given.scenes)]
    counts = [count for status, count in results if status == 0]
    print('exit status: ' + ', '.join('{} of {}'.format(n, status) for status, n in
                                      collections.Counter(status for status, _ in results).items()))
    if counts:
        print('multiplications: median {:g}, largest {}'.format(statistics.median(counts), max(counts)))
    return int(any(status not in (0, 4) for status, _ in results))


if __name__ == '__main__':
    sys.exit(main())
