"""Where the largest stress is, and whether it grows without limit there under refinement."""

import math
import unittest

from program import converged, new_path
from scenes import stretched


class Singular(unittest.TestCase):

    def peak(self, case, ranks=1):
        result = converged(case, ranks=ranks)
        at = result.summary['results']['max_von_mises_at']
        return result, at['body'], at['position'], result.summary['results']['singular']

    def test_point_supports_and_loads(self):
        points = {'a': {'Body': 'box', 'Point': '0, 0', 'Displacement x': '0', 'Displacement y': '0'},
                  'b': {'Body': 'box', 'Point': '10, 0', 'Displacement y': '0'}}
        down = {'down': {'Boundary': 'box/top', 'Traction y': '-1-x/100'}}
        for ranks in (1, 2):
            result, body, position, why = self.peak(stretched(supports=points, tractions=down), ranks)
            self.assertEqual((body, position, why), ('box', [10, 0], 'the point support b'))
            self.assertIn('(10, 0), the point support b, where it grows without limit', result.stdout)
            error = result.summary['error']
            self.assertLess(abs(error['largest_at']['position'][1]), 1)
            self.assertGreater(error['largest_part'], 0.1)

    def test_ends_of_supports(self):
        clamp = {'wall': {'Boundary': 'box/left', 'Displacement x': '0', 'Displacement y': '0'}}
        _, _, position, why = self.peak(stretched(supports=clamp))
        self.assertEqual((position[0], why), (0, 'the end of a support'))

    def test_ends_of_bonds(self):
        """A small block bonded to the middle of a larger one makes a re-entrant corner with it; two of the same width do not.
        Bonded to a rigid line, it ends like a clamp."""
        def bonded(width):
            return stretched(bodies={'box': {'Size': '10, 10', 'Cells': '10, 10', 'Material': 'elastic'},
                                     'block': {'Origin': '{}, 10'.format(5 - width / 2), 'Size': '{}, 5'.format(width),
                                               'Cells': '{}, 6'.format(width), 'Material': 'elastic'}},
                             supports={'foot': {'Boundary': 'box/bottom', 'Displacement x': '0', 'Displacement y': '0'}},
                             tractions={'push': {'Boundary': 'block/top', 'Traction x': '10'}},
                             contacts={'joint': {'Slave': 'block/bottom', 'Master': 'box/top', 'Law': 'bonded'}})
        for ranks in (1, 2):
            _, _, position, why = self.peak(bonded(4), ranks)
            self.assertEqual((position[1], why), (10, 'an end of the bond joint'))
            self.assertIn(position[0], (3, 7))
        summary = converged(bonded(4), {'Error bars': 'true'}).summary
        regular, = (bar for bar in summary['error_bars'] if bar['quantity'] == 'max_regular_von_mises')
        self.assertEqual(regular['note'].count('an end of the bond joint'), 4)  # two of each body
        _, _, position, why = self.peak(bonded(10))
        self.assertEqual((position[1], why), (0, 'the end of a support'))
        rigid = stretched(obstacles={'wall': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}}, supports={},
                          contacts={'base': {'Slave': 'box/bottom', 'Master': 'wall', 'Law': 'bonded'}},
                          tractions={'push': {'Boundary': 'box/top', 'Traction x': '10'}})
        _, _, position, why = self.peak(rigid)
        self.assertEqual((position[1], why), (0, 'an end of the bond base'))

    def test_regular_places(self):
        bent = {'pull': {'Boundary': 'box/right', 'Traction x': '10*y'}}
        _, _, position, why = self.peak(stretched(tractions=bent))
        self.assertIsNone(why)
        self.assertEqual(position[1], 10)
        quarter = stretched(bodies={'box': {'Shape': 'quarter ring', 'Inner radius': '5', 'Radius': '20',
                                            'Cells': '8, 12', 'Material': 'elastic'}},
                            supports={'start': {'Boundary': 'box/start', 'Displacement normal': '0'},
                                      'end': {'Boundary': 'box/end', 'Displacement normal': '0'}},
                            tractions={'pull': {'Boundary': 'box/outer', 'Traction x': '10*x/20'}})
        _, _, position, why = self.peak(quarter)  # a hole is no re-entrant corner
        self.assertIsNone(why)
        self.assertAlmostEqual(position[1], 5, delta=1e-9)

    def test_a_re_entrant_corner(self):
        """An L of three squares."""
        path = new_path('l_shape.msh')
        n, nodes, quads, left, top = 4, {}, [], [], []
        for i in range(2 * n):
            for j in range(2 * n):
                if i >= n and j >= n:
                    continue
                corners = [nodes.setdefault(key, len(nodes) + 1)
                           for key in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
                quads.append(corners)
        for i in range(n):
            top.append((nodes[i, 2 * n], nodes[i + 1, 2 * n]))
        right = [(nodes[2 * n, j], nodes[2 * n, j + 1]) for j in range(n)]
        lines = ['$MeshFormat', '2.2 0 8', '$EndMeshFormat', '$PhysicalNames', '3', '1 1 "top"', '1 2 "right"', '2 3 "part"',
                 '$EndPhysicalNames', '$Nodes', str(len(nodes))]
        lines += ['{} {} {} 0'.format(k, x, y) for (x, y), k in nodes.items()]
        elements = [(1, 1, line) for line in top] + [(1, 2, line) for line in right] + [(3, 3, quad) for quad in quads]
        lines += ['$EndNodes', '$Elements', str(len(elements))]
        lines += ['{} {} 2 {} {} {}'.format(k + 1, kind, tag, tag, ' '.join(map(str, e)))
                  for k, (kind, tag, e) in enumerate(elements)]
        path.write_text('\n'.join(lines + ['$EndElements', '']))
        case = stretched(bodies={'box': {'Shape': 'mesh', 'File': path, 'Material': 'elastic'}},
                         supports={'top': {'Boundary': 'box/top', 'Displacement x': '0', 'Displacement y': '0'}},
                         tractions={'down': {'Boundary': 'box/right', 'Traction y': '-1'}})
        _, _, position, why = self.peak(case)
        self.assertEqual(why, 'a re-entrant corner')
        self.assertLess(math.dist(position, [4, 4]), 1.01)


if __name__ == '__main__':
    unittest.main()
