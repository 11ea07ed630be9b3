#!/usr/bin/env python3
"""The shipped scenes and random ones on 1 to 8 ranks: the same exit status, and answers that agree. A tool, not a ctest.

    tests/random/ranks.py [--first SEED] [--scenes N] [--solids N] [--ranks 2,3,4,8] [--tolerance 1e-11] [--limit 1e-8]

Plane scenes come from test_random, solids from solids.py, each cut by METIS into 8 subdomains; shipped scenes are run with the
small meshes of tests/cases/shipped_scenes.py. Compared with the run on one rank: energy and largest displacement over
themselves; pressures, tangential tractions, gaps and slips of every contact node over the largest of their kind in the scene
(gaps and slips over the largest displacement). One line a scene: its name, status on one rank, multiplications on each number
of ranks, largest difference and its place. Scenes that a warning says have no unique forces are marked "split" and compared in
energy and displacement alone. Exit status: 1 if a status or an answer differs by more than the limit. SLIPSTICK and TEST_RANDOM
name the programs.
"""

import argparse
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / 'cases'))  # behind: it has another solids.py

import solids  # noqa: E402
from program import SOURCE, Hang, solve  # noqa: E402

TEST_RANDOM = os.environ.get('TEST_RANDOM', str(SOURCE / 'build' / 'tests' / 'random' / 'test_random'))
CUT = {'Decomposition/Method': 'METIS', 'Decomposition/Subdomains': 8}
SMALL = {'Decomposition/Cells per block': 10}
NOTHING, ROUNDED = 1e-14, 1e-7  # of the largest coordinate: displacements that are rounding; gaps have it beside displacements this small
NOT_UNIQUE = re.compile('only the sums? (of the forces )?(are|is) determined')


def scenes(options, folder):
    """Name, case file and settings."""
    for path in sorted((SOURCE / 'prm').glob('*.prm')):
        yield path.stem, path, SMALL
    subprocess.run([TEST_RANDOM, '--first', str(options.first), '--scenes', str(options.scenes), '--write', str(folder)],
                   check=True, stdout=subprocess.DEVNULL)
    for seed in range(options.first, options.first + options.scenes):
        yield 'plane {}'.format(seed), folder / 'scene_{}.prm'.format(seed), CUT
    for seed in range(options.first, options.first + options.solids):
        choice = random.Random(seed)
        scene = solids.Scene(choice)
        solids.KINDS[seed % len(solids.KINDS)](scene, choice)
        path = folder / 'solid_{}.prm'.format(seed)
        path.write_text(scene.text())
        yield 'solid {}'.format(seed), path, {}


def differences(one, other, is_unique):
    """Name and relative size of everything that is compared."""
    a, b = one.summary['results'], other.summary['results']
    extent = max((abs(row[c]) for row in one.contact for c in 'xy'), default=0.) if 'contact.csv' in one.files() else 0.
    if max(a['max_displacement'], b['max_displacement']) < NOTHING * extent:
        return  # nothing moves: what there is, is rounding of coordinates
    for name in ('strain_energy', 'max_displacement'):
        if a[name] != b[name]:
            yield name, abs(a[name] - b[name]) / max(abs(a[name]), abs(b[name]))
    if not is_unique or 'contact.csv' not in one.files():
        return
    rows, others = one.contact, other.contact
    if len(rows) != len(others):
        yield 'number of contact nodes', float('inf')
        return
    if not rows:
        return
    kinds = {'pressure': 'forces', 'gap': 'lengths'}
    kinds.update({name: 'forces' for name in rows[0] if name.startswith('tangential_traction')})
    kinds.update({name: 'lengths' for name in rows[0] if name == 'slip' or name.startswith('slip_increment')})
    scale = {'lengths': max(a['max_displacement'], ROUNDED * extent),
             'forces': max(abs(row[name]) for row in rows for name in row if kinds.get(name) == 'forces')}
    for name, kind in kinds.items():
        difference, pair = max((abs(row[name] - match[name]), row['pair']) for row, match in zip(rows, others))
        if difference > 0:
            yield '{} of {}'.format(name, pair), difference / scale[kind] if scale[kind] > 0 else float('inf')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--first', type=int, default=0)
    parser.add_argument('--scenes', type=int, default=60)
    parser.add_argument('--solids', type=int, default=15)
    parser.add_argument('--ranks', default='2,3,4,5,8')
    parser.add_argument('--tolerance', default='1e-11')
    parser.add_argument('--limit', type=float, default=1e-8)
    options = parser.parse_args()
    n_wrong = n_scenes = 0
    with tempfile.TemporaryDirectory(prefix='slipstick-ranks-') as folder:
        for name, path, more in scenes(options, pathlib.Path(folder)):
            how = {**more, 'Output/VTU': 'false', 'Solver/Tolerance': options.tolerance,
                   'Friction/Tolerance': options.tolerance}
            try:
                runs = [solve(path, how, ranks=ranks) for ranks in [1] + [int(n) for n in options.ranks.split(',')]]
            except Hang as hang:
                print('{}: {}'.format(name, hang), flush=True)
                n_wrong += 1
                continue
            statuses = [run.status for run in runs]
            one = runs[0]
            is_unique = not NOT_UNIQUE.search(one.stdout + one.stderr)
            what, worst, counts = '-', 0., []
            if set(statuses) == {0}:
                counts = [run.summary['solver']['hessian_multiplications'] for run in runs]
                found = [item for other in runs[1:] for item in differences(one, other, is_unique)]
                what, worst = max(found, key=lambda item: item[1], default=(what, worst))
            is_wrong = len(set(statuses)) > 1 or worst > options.limit
            n_wrong, n_scenes = n_wrong + is_wrong, n_scenes + 1
            print('{:18s} {} {:24s} {:9.1e} {}{}{}'.format(
                name, statuses[0] if len(set(statuses)) == 1 else statuses, ' '.join(str(n) for n in counts), worst, what,
                '' if is_unique else ' (split)', '  DIFFERS' if is_wrong else ''), flush=True)
    print('{} scenes, {} differ'.format(n_scenes, n_wrong))
    return int(n_wrong > 0)


if __name__ == '__main__':
    sys.exit(main())
