"""Errors of the solver in pressures and tangential tractions: presets against a solution at 1e-11 on the same mesh, and the
estimates of summary.json (algebraic_error of every pair) against these errors."""

import math
import pathlib
import sys
import tempfile
import unittest

import measured  # noqa: F401  the path of tests/cases
from program import SOURCE, WORK, converged, shipped

sys.path.append(str(SOURCE / 'benchmarks'))
import family_scenes  # noqa: E402
from scene_files import Variant  # noqa: E402

SHARP = {'Solver/Tolerance': 1e-11, 'Friction/Tolerance': 1e-11}
PRESETS = {'engineering': {'Solver/Tolerance': 1e-4, 'Friction/Tolerance': 1e-6},
           'draft': {'Accuracy': 'draft', 'Solver/Tolerance': 'auto'}}
ADMISSIBLE = {'engineering': 0.01, 'draft': 0.05}  # of the norms of pressures and of tangential tractions
LEAST = 0.01, 1e-3  # of both norms of the pair, and of those of the pair that bears most: smaller ones count as so much
EFFECTIVITY = 0.2, 8


def areas(nodes):
    """Of the nodes of a pair; in the plane by their distances along the boundary."""
    if 'area' in nodes[0]:
        return [row['area'] for row in nodes]
    at = [row['s'] for row in nodes]
    return [(b - a) / 2 for a, b in zip(at[:1] + at, at[1:] + at[-1:])]


def traction(row):
    """(pressure, tangential vector)"""
    if 'area' in row:
        return row['pressure'], [row['traction_' + axis] for axis in 'xyz']
    return row['pressure'], [row['tangential_traction']]


def pairs(rows):
    """Nodes of {(step, pair)}, by place along the boundary."""
    found = {}
    for row in rows:
        found.setdefault((row['step'], row['pair']), []).append(row)
    return {key: sorted(nodes, key=lambda row: (row['s'], row['x'], row['y'], row.get('z', 0))) for key, nodes in found.items()}


def norms(nodes, others):
    """L2 norms of pressures and tangential tractions, and of the differences from those of the others."""
    squares = [0.] * 4
    place = lambda row: tuple(round(row[axis], 8) for axis in 'xyz' if axis in row)  # noqa: E731
    by_place = {place(row): row for row in nodes}
    for area, other in zip(areas(others), others):
        p, t = traction(other)
        q, s = traction(by_place[place(other)]) if place(other) in by_place else (0., [0.] * len(t))
        for k, value in enumerate((p * p, sum(c * c for c in t), (p - q)**2, sum((c - d)**2 for c, d in zip(t, s)))):
            squares[k] += area * value
    return [math.sqrt(square) for square in squares]


def errors(result, exact):
    """Worst of all pairs and steps: {'pressure': (error, estimate), 'tangential': ...}, and the ratios of both where the error is
    more than rounding."""
    wanted = pairs(exact.contact)
    found = {key: norms(nodes, wanted[key]) for key, nodes in pairs(result.contact).items()}
    worst, ratios = {'pressure': (0., 0.), 'tangential': (0., 0.)}, []
    before = 0.
    for number, step in enumerate(result.summary['steps']):
        of_step = {pair: values for (at, pair), values in found.items() if at == number}
        largest = max((math.hypot(*values[:2]) for values in of_step.values()), default=0)
        for pair in step['contact']:
            values = of_step.get(pair['pair'])
            if not values or largest == 0:
                continue
            least = max(LEAST[0] * math.hypot(*values[:2]), LEAST[1] * largest, 0.01 * before)
            for k, name in enumerate(worst):
                error, estimate = values[2 + k] / max(values[k], least), pair['algebraic_error'][name]
                worst[name] = max(worst[name][0], error), max(worst[name][1], estimate)
                if error > 1e-6:
                    ratios.append(estimate / error)
        before = max(before, largest)
    return worst, ratios


def family(scene, **arguments):
    return scene(Variant(), **arguments).write(pathlib.Path(tempfile.mkdtemp(dir=WORK)))


SCENES = {  # name: (scene, settings)
    'driven roller': (lambda: family(family_scenes.half_roller), {}),
    'fretting pad': (lambda: family(family_scenes.pad, steps=(1, 2)), {}),
    'ring turned on a shaft': (lambda: family(family_scenes.twisted_ring), {}),
    'Cattaneo, Mindlin': (lambda: shipped('cattaneo_mindlin'), {}),
    'hertz': (lambda: shipped('hertz'), {}),
    'lap_joint': (lambda: shipped('lap_joint'), {}),
    'press_fit': (lambda: shipped('press_fit'), {}),
    'clamp': (lambda: shipped('clamp'), {}),
    'box_on_circle': (lambda: shipped('box_on_circle'), {}),
    'cube_on_sphere': (lambda: shipped('cube_on_sphere'), {}),
    'oblique_blocks': (lambda: shipped('oblique_blocks'), {}),
    'ring_on_shaft': (lambda: shipped('ring_on_shaft'), {'Body shaft/Cells around': 24, 'Body ring/Cells around': 24}),
}


def compare(name, presets=tuple(PRESETS)):
    """{preset: what errors() gives, multiplications}"""
    make, settings = SCENES[name]
    scene = make()
    exact = converged(scene, {**settings, **SHARP, 'Solver/Prune contact': 'false'})
    found = {}
    for preset in presets:
        result = converged(scene, {**settings, **PRESETS[preset]})
        found[preset] = (*errors(result, exact), result.summary['solver']['hessian_multiplications'])
    return found


class Tractions(unittest.TestCase):

    def test_errors_and_their_estimates(self):
        """Tangential tractions of the roller were 19 % off, since errors were compared with the pressures."""
        for name in ('driven roller', 'ring turned on a shaft', 'Cattaneo, Mindlin', 'cube_on_sphere', 'oblique_blocks'):
            for preset, (worst, ratios, _) in compare(name).items():
                with self.subTest(name, preset=preset):
                    for quantity, (error, estimate) in worst.items():
                        self.assertLess(error, ADMISSIBLE[preset], quantity)
                        self.assertLess(estimate, ADMISSIBLE[preset], quantity)
                    for ratio in ratios:
                        self.assertGreater(ratio, EFFECTIVITY[0])
                        self.assertLess(ratio, EFFECTIVITY[1])


if __name__ == '__main__':
    unittest.main()
