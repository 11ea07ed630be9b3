"""Obstacles in space from .stl files: against the ball that they approximate, ASCII and binary, placed, damaged."""

import math
import os
import pathlib
import struct
import unittest

from program import converged, new_path, shipped, solve
from solids import Solids, text, turned

COARSE = {'Decomposition/Cells per block': 4}
FIGURES = ((0, 'max_displacement'), (3, 'max_pressure'), (4, 'normal_force'))


def sphere(n, radius=100., center=(5, -100, 5)):
    """Triangles, counter-clockwise from outside, n rings closer to each other towards the top."""
    around = 2 * n
    polar = [math.pi * (k / n) ** 2 for k in range(n + 1)]

    def point(k, j):
        theta, phi = polar[k], 2 * math.pi * (j % around) / around
        ring = 0 if k in (0, n) else radius * math.sin(theta)
        return (center[0] + ring * math.cos(phi), center[1] + radius * math.cos(theta), center[2] - ring * math.sin(phi))

    triangles = []
    for k in range(n):
        for j in range(around):
            corners = point(k, j), point(k + 1, j), point(k + 1, j + 1), point(k, j + 1)
            if k < n - 1:
                triangles.append((corners[0], corners[1], corners[2]))
            if k > 0:
                triangles.append((corners[0], corners[2], corners[3]))
    return triangles


def binary(triangles, name='solid of a program that begins so'):
    facets = (struct.pack('<12fH', 0, 0, 0, *(x for corner in triangle for x in corner), 0) for triangle in triangles)
    return name.encode().ljust(80) + struct.pack('<I', len(triangles)) + b''.join(facets)


def ascii(triangles):
    lines = ['solid ball']
    for triangle in triangles:
        lines += ['  facet normal 0 0 0', '    outer loop']
        lines += ['      vertex {!r} {!r} {!r}'.format(*corner) for corner in triangle]
        lines += ['    endloop', '  endfacet']
    return ('\n'.join(lines + ['endsolid ball']) + '\n').encode()


def stl(content):
    path = new_path('obstacle.stl')
    path.write_bytes(content)
    return path


def against(path, **more):
    """cube_on_sphere.prm with the surface in place of the ball."""
    lines = pathlib.Path(shipped('cube_on_sphere')).read_text().split('subsection Obstacle sphere')
    rest = lines[1][lines[1].index('end\n') + 4:]
    values = {'Shape': 'stl', 'File': path, **more}
    section = ''.join('  set {} = {}\n'.format(name, value) for name, value in values.items())
    case = new_path('surface.prm')
    case.write_text(lines[0] + 'subsection Obstacle sphere\n' + section + 'end\n' + rest)
    return case


class Surfaces(Solids):

    def test_finer_triangles_approach_the_ball(self):
        expected, counts = self.figures(converged(shipped('cube_on_sphere'), COARSE))
        errors = []
        for n in (24, 96):
            found, nodes = self.figures(converged(against(stl(binary(sphere(n)))), COARSE))
            errors.append([abs(found[k] / expected[k] - 1) for k, _ in FIGURES])
        for k, (_, name) in enumerate(FIGURES):
            self.assertLess(errors[1][k], 0.012, (name, errors))
            self.assertLess(errors[1][k], errors[0][k] / 5, (name, errors))
        self.assertEqual(nodes, counts)

    def test_ascii_scaled_and_turned_is_the_same(self):
        triangles = sphere(12)
        expected, counts = self.figures(converged(against(stl(ascii(triangles))), COARSE))
        back = [tuple(turned([x / 1000 for x in corner], -30, [1, 2, 2])) for triangle in triangles for corner in triangle]
        moved = [tuple(a - b for a, b in zip(x, (0.001, 0.002, 0.003))) for x in back]
        # moved back after the rotation
        shift = turned([1, 2, 3], 30, [1, 2, 2])
        placed = against(stl(ascii(list(zip(*[iter(moved)] * 3)))), Scale=1000, Rotation=30, **{'Rotation axis': '1, 2, 2',
                                                                                                'Translation': text(shift)})
        for case, ranks in ((placed, 2), (against(stl(binary(triangles))), 1)):
            found, n = self.figures(converged(case, COARSE, ranks=ranks))
            self.assertEqual(n, counts)
            self.near(found, expected, 1e-5)  # binary files have seven digits

    def test_a_run_can_be_repeated_from_its_parameters(self):
        result = converged(against(stl(binary(sphere(12)))), COARSE)
        again = converged(result.directory / 'parameters.prm')
        self.near(self.figures(again)[0], self.figures(result)[0], 1e-12)

    def test_normals_point_to_the_nearest_point(self):
        """Of the faces, edges and corners of a tetrahedron below the cube, found by trying many."""
        tip = [(5., -.01, 5.), (1., -4., 1.), (9., -5., 2.), (4., -3., 9.)]

        def volume(a, b, c, d):
            u, v, w = ([x[k] - a[k] for k in range(3)] for x in (b, c, d))
            return sum(u[k] * (v[(k + 1) % 3] * w[(k + 2) % 3] - v[(k + 2) % 3] * w[(k + 1) % 3]) for k in range(3))

        triangles = []
        for face in ((0, 1, 3), (0, 3, 2), (0, 2, 1), (1, 2, 3)):
            corners = [tip[k] for k in face]
            outside = volume(*corners, tip[6 - sum(face)]) < 0
            triangles.append(corners if outside else corners[::-1])
        n = 80
        tried = [[sum(weight * corner[d] for weight, corner in zip((i / n, j / n, 1 - (i + j) / n), triangle)) for d in range(3)]
                 for triangle in triangles for i in range(n + 1) for j in range(n + 1 - i)]
        law = {'Contact sphere/Law': 'frictionless', 'Solver/Prune contact': 'false'}
        rows = converged(against(stl(ascii(triangles))), {**COARSE, **law}).contact
        self.assertEqual(len(rows), 81)
        self.assertGreater(sum(row['pressure'] > 0 for row in rows), 0)
        for row in rows:
            x = [row[d] for d in 'xyz']
            ray = min(([a - b for a, b in zip(y, x)] for y in tried), key=lambda r: sum(a * a for a in r))
            length = math.sqrt(sum(a * a for a in ray))
            if length > 0.5:
                self.near([row['normal_' + d] for d in 'xyz'], [a / length for a in ray], 0.1 / length)

    def test_damaged_files_are_refused(self):
        triangles = sphere(6)
        good = binary(triangles)
        hole = triangles[:20] + triangles[21:]
        twisted = triangles[:20] + [triangles[20][::-1]] + triangles[21:]
        lines = ascii(triangles).decode().split('\n')
        for content, *words in (
                (binary(hole), 'is not closed', 'belongs to 1 triangle', 'and 2 other edges', 'close its holes'),
                (binary(twisted), 'is not oriented', 'normals consistent'),
                (good[:-7], 'truncated', 'export it again'), (b'', 'is no STL file'), (b'PK\x03\x04', 'is no STL file'),
                (binary([]), 'has 0 triangles'), (binary([triangles[0]] * 5), 'is not closed', '5 triangles'),
                (good[:100] + struct.pack('<f', math.inf) + good[104:], 'not a finite number'),
                ('\n'.join(lines[:3] + ['      vertex 1 zwei 3'] + lines[4:]).encode(), 'line 4', 'three numbers'),
                ('\n'.join(lines[:4] + lines[5:]).encode(), 'line 7', '2 corners'),
                ('\n'.join(lines[:4] + ['color 1 2 3'] + lines[4:]).encode(), 'line 5', "'color'"),
                ('\n'.join(lines[:10]).encode(), 'within a facet')):
            with self.subTest(words):
                self.refused(against(stl(content)), COARSE, 'obstacle.stl', *words)
        big = stl(good[:80] + struct.pack('<I', 2000001))
        os.truncate(big, 84 + 50 * 2000001)
        self.refused(against(big), COARSE, 'obstacle.stl', '2000001 triangles', 'coarser')
        path = stl(good)
        self.refused(against('nowhere.stl'), COARSE, "File = 'nowhere.stl'", 'there is no such file')
        self.refused(against(path, Radius=2), COARSE, 'Radius', 'has no meaning for this shape')
        self.refused(shipped('cube_on_sphere'), {'Obstacle sphere/File': path}, 'has no meaning for this shape')
        self.refused(against(path, **{'Rotation axis': '0, 0, 0'}), COARSE, 'no length')
        self.refused(shipped('cube_on_sphere'), {'Obstacle sphere/Shape': 'stl', 'Obstacle sphere/Center': '0, 0, 0',
                                                 'Obstacle sphere/Radius': 1}, 'File is not set')
        inside_out = binary([triangle[::-1] for triangle in triangles])
        self.refused(against(stl(inside_out)), COARSE, 'face away from each other')


if __name__ == '__main__':
    unittest.main()
