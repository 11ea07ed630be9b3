"""Solids with curved faces: volumes, shrink fits whose nodes do not match, against closed forms; what polygons leave out."""

import math
import unittest

from program import converged, shipped
from solids import Solids, solid

SHAPES = {
    'half ball': ({'Shape': 'half ball', 'Radius': '10', 'Cells around': '16'}, 2 / 3 * math.pi * 1000, 'flat'),
    'tube': ({'Shape': 'tube', 'Radius': '10', 'Inner radius': '2', 'Length': '5', 'Cells around': '16'}, math.pi * 96 * 5, 'back'),
}
# plane strain
LAME = 2.1e5 / (1 - 0.3 ** 2) * 0.02 / (20 * ((40 ** 2 + 20 ** 2) / (40 ** 2 - 20 ** 2) + 1))
SMOOTH = {'Variables/turn': 0, 'Contact fit/Law': 'frictionless', 'Contact fit/Friction coefficient': 0,
          'Body shaft/Cells along axis': 1, 'Body ring/Cells along axis': 1}


def polygon(*bodies):
    return {'Body {}/Outline'.format(body): 'polygon' for body in bodies}


class CurvedSolids(Solids):

    def volume(self, shape, overrides):
        """As the resultant of a force of 1 N / mm^3."""
        case = solid(bodies={'box': {**SHAPES[shape][0], 'Material': 'elastic'}},
                     supports={'held': {'Boundary': 'box/' + SHAPES[shape][2], 'Displacement x': '0', 'Displacement y': '0', 'Displacement z': '0'}},
                     body_forces={'weight': {'Bodies': 'all', 'Force x': '1'}}, Decomposition={}, Solver={})
        return converged(case, overrides).rows('history.csv')[0]['body force weight Fx']

    def test_volumes(self):
        for shape, (_, exact, _) in SHAPES.items():
            straight = 1 - self.volume(shape, {}) / exact
            bent = 1 - self.volume(shape, {'Discretization/Degree': 2}) / exact
            self.assertGreater(straight, 0.02)
            self.assertLess(abs(bent), 5e-4)

    def pressures(self, shaft, ring, *overrides):
        changed = {**SMOOTH, 'Body shaft/Cells around': shaft, 'Body ring/Cells around': ring}
        for more in overrides:
            changed.update(more)
        result = converged(shipped('ring_on_shaft'), changed)
        warnings = [text for text in result.summary['warnings'] if 'nothing resists' not in text]
        return [row['pressure'] for row in result.contact], warnings

    def test_shrink_fit_whose_nodes_do_not_match(self):
        coarse, warnings = self.pressures(32, 40)
        self.assertEqual(warnings, [])
        self.assertLess(max(coarse) / min(coarse) - 1, 0.003)
        self.assertAlmostEqual(sum(coarse) / len(coarse) / LAME, 1, delta=0.012)
        quadratic, warnings = self.pressures(16, 20, {'Discretization/Degree': 2})
        self.assertEqual(warnings, [])
        for p in quadratic:
            self.assertAlmostEqual(p / LAME, 1, delta=0.005)

    def test_polygons_are_warned_of(self):
        found, warnings = self.pressures(16, 20, polygon('shaft', 'ring'))
        self.assertGreater(max(found), 1.5 * LAME)
        self.assertEqual(len([text for text in warnings if 'plane faces deviate by' in text]), 1)


if __name__ == '__main__':
    unittest.main()
