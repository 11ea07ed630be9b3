"""Where the largest stress is, and whether it grows without limit there under refinement."""

import math
import unittest

from program import converged, new_path
from scenes import stretched
from solids import solid


class Peaks(unittest.TestCase):

    def peak(self, case, ranks=1):
        result = converged(case, ranks=ranks)
        at = result.summary['results']['max_von_mises_at']
        return result, at['body'], at['position'], result.summary['results']['singular']


class SingularPoints(Peaks):

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


class SingularEdges(Peaks):
    """The same in space, where they are edges of the mesh."""

    def bar_at(self, case, name='max_regular_von_mises'):
        bar, = (bar for bar in converged(case, {'Error bars': 'true'}).summary['error_bars'] if bar['quantity'] == name)
        return bar

    def test_edges_of_supports(self):
        foot = {'foot': {'Boundary': 'box/bottom', **{'Displacement ' + axis: '0' for axis in 'xyz'}}}
        push = {'push': {'Boundary': 'box/top', 'Traction x': '1'}}
        case = solid(supports=foot, tractions=push)
        for ranks in (1, 2):  # some of the edges are at cuts
            _, _, position, why = self.peak(case, ranks)
            self.assertEqual((position[0] % 2, position[1], why), (0, 0, 'the edge of a support'))
        self.assertEqual(self.bar_at(case)['note'].count('the edge of a support of body box'), 1)
        self.assertIn('the edge of a support', self.bar_at(case, 'max_von_mises')['reason'])
        symmetry = {side: {'Boundary': 'box/' + side, 'Displacement ' + axis: '0'}
                    for axis, side in (('x', 'left'), ('y', 'bottom'), ('z', 'back'))}
        _, _, _, why = self.peak(solid(supports=symmetry, tractions={'pull': {'Boundary': 'box/right', 'Traction x': '1+y'}}))
        self.assertIsNone(why)

    def test_edges_of_bonds(self):
        """A small block bonded to a larger one, and blocks of the same size, whose sides go on straight."""
        def bonded(size):
            return solid(bodies={'box': {'Size': '6, 6, 6', 'Cells': '6, 6, 6', 'Material': 'elastic'},
                                 'block': {'Origin': '{0}, 6, {0}'.format(3 - size / 2), 'Size': '{0}, 4, {0}'.format(size),
                                           'Cells': '3, 3, 3', 'Material': 'elastic'}},
                         supports={'foot': {'Boundary': 'box/bottom', **{'Displacement ' + axis: '0' for axis in 'xyz'}}},
                         tractions={'push': {'Boundary': 'block/top', 'Traction x': '1'}},
                         contacts={'joint': {'Slave': 'block/bottom', 'Master': 'box/top', 'Law': 'bonded'}})
        for ranks in (1, 2):
            _, _, position, why = self.peak(bonded(2), ranks)
            self.assertEqual((position[1], why), (6, 'an edge of the bond joint'))
        note = self.bar_at(bonded(2))['note']
        for body in ('box', 'block'):
            self.assertIn('an edge of the bond joint of body ' + body, note)
        _, _, position, why = self.peak(bonded(6))
        self.assertEqual((position[1], why), (0, 'the edge of a support'))
        rigid = solid(obstacles={'wall': {'Shape': 'half space', 'Point': '0, 0, 0', 'Normal': '0, 1, 0'}},
                      contacts={'base': {'Slave': 'box/bottom', 'Master': 'wall', 'Law': 'bonded'}},
                      tractions={'push': {'Boundary': 'box/top', 'Traction x': '1'}})
        _, _, position, why = self.peak(rigid)
        self.assertEqual((position[1], why), (0, 'an edge of the bond base'))

    def test_re_entrant_edges(self):
        """An L of hexahedra, bent; the bore of a tube is none."""
        n, nodes, cells, top, right = 3, {}, [], [], []
        for k in range(2):
            for i in range(2 * n):
                for j in range(2 * n):
                    if i < n or j < n:
                        cells.append([nodes.setdefault((i + a, j + b, k + c), len(nodes) + 1)
                                      for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))])
            for i in range(n):
                top.append([nodes[i + a, 2 * n, k + c] for a, c in ((0, 0), (0, 1), (1, 1), (1, 0))])
                right.append([nodes[2 * n, i + b, k + c] for b, c in ((0, 0), (1, 0), (1, 1), (0, 1))])
        elements = [(3, 1, face) for face in top] + [(3, 2, face) for face in right] + [(5, 3, cell) for cell in cells]
        path = new_path('l_solid.msh')
        path.write_text('\n'.join(
            ['$MeshFormat', '2.2 0 8', '$EndMeshFormat', '$PhysicalNames', '3', '2 1 "top"', '2 2 "right"', '3 3 "part"',
             '$EndPhysicalNames', '$Nodes', str(len(nodes))] +
            ['{} {} {} {}'.format(number, *x) for x, number in nodes.items()] + ['$EndNodes', '$Elements', str(len(elements))] +
            ['{} {} 2 {} {} {}'.format(k + 1, kind, tag, tag, ' '.join(map(str, e)))
             for k, (kind, tag, e) in enumerate(elements)] + ['$EndElements', '']))
        case = solid(bodies={'box': {'Shape': 'mesh', 'File': path, 'Material': 'elastic'}},
                     supports={'top': {'Boundary': 'box/top', **{'Displacement ' + axis: '0' for axis in 'xyz'}}},
                     tractions={'down': {'Boundary': 'box/right', 'Traction y': '-1'}})
        _, _, position, why = self.peak(case)
        self.assertEqual(why, 'a re-entrant edge')
        self.assertLess(math.dist(position[:2], [n, n]), 1.01)
        tube = solid(bodies={'box': {'Shape': 'tube', 'Inner radius': '3', 'Radius': '9', 'Length': '2', 'Cells around': '8',
                                     'Material': 'elastic'}},
                     supports={'hold': {'Boundary': 'box/back', 'Displacement z': '0'}},
                     tractions={'press': {'Boundary': 'box/inner', 'Pressure': '1+x*x/10'}})
        _, _, _, why = self.peak(tube)  # eight plane faces around a round bore
        self.assertIsNone(why)


if __name__ == '__main__':
    unittest.main()
