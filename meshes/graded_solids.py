#!/usr/bin/python3
"""Hexahedra graded towards the point where a ball touches a block or another ball, the origin: cubes in cubes.

    meshes/graded_solids.py quarter --shells 10          > meshes/hertz_solid.msh      (prm/hertz_solid.prm)
    meshes/graded_solids.py half --shells 11 --two-balls > meshes/mindlin.msh          (prm/mindlin.prm)

Bodies: upper (a square pillar whose lower end is part of a ball, of radius 50 mm) and lower (a block), in one file; with --two-balls
both ends are parts of balls of 100 mm. A quarter has x >= 0 and z >= 0, a half z >= 0; `whole` has both halves. Boundaries, those of the
lower body with "lower" in place of "upper": "upper contact" (what may touch), "upper rest" (of the same face), "upper far" (the other
end), "upper sides", and on the planes of symmetry "upper x" and "upper z".

Around the point lies a cube (a half or quarter of it) of equal cells, around that shells of growing thickness. The number of
elements in the radius of the contact is CORE cells on CORE_SIZE mm. Other meshes: --cells N, --size MM, --shells N, or
change the numbers below. --second-order writes hexahedra of 27 nodes, those of the ball on its surface.
"""

import argparse
import itertools
import math

RADIUS = 50.       # of the ball, half of that of two balls [mm]
EXTENT = 25.       # of both bodies: half width and height [mm]
FIRST_SHELL = 1.3  # its thickness over the edges of the core
CONTACT_SHELLS = 2 # belong to the contact boundaries
NODES = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))  # of Gmsh's hexahedron
# of Gmsh's cells of second order: between which corners their other nodes are
MIDDLES = {4: ((0, 1), (1, 2), (2, 3), (3, 0), range(4)),
           8: ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7), (0, 3, 2, 1),
               (0, 1, 5, 4), (0, 4, 7, 3), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 6, 7), range(8))}
KINDS = {4: 3, 8: 5, 9: 10, 27: 12}  # Gmsh's numbers, by number of nodes


def growth(first, n, total):
    """Of n layers, the first one given, that add up to total."""
    low, high = 1 + 1e-9, 10.
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if first * (middle ** n - 1) / (middle - 1) < total else (low, middle)
    return low


def scales(cells, size, shells):
    """Of the cube at the end of every shell, over the core."""
    first = FIRST_SHELL * size / cells
    g = growth(first, shells, EXTENT - size)
    at, ends = size, [1.]
    for k in range(shells):
        at += first * g ** k
        ends.append(at / size)
    ends[-1] = EXTENT / size
    return ends


class Solid:
    """One body: vertices (x, depth, z) by number, cells, faces with names."""

    def __init__(self, kind, cells, size, shells):
        self.low = [0 if kind == 'quarter' else -cells, 0, -cells if kind == 'whole' else 0]  # of the lattice: x, depth, z
        self.n, self.size, self.ends = cells, size, scales(cells, size, shells)
        self.numbers, self.points, self.cells, self.faces = {}, [], [], []
        for at in itertools.product(*(range(low, cells) for low in self.low)):
            self.cells.append([self.vertex([a + d for a, d in zip(at, corner)], 0) for corner in NODES])
        for axis in range(3):
            for end in {self.low[axis], cells}:
                self.add_side(axis, end)

    def vertex(self, at, shell):
        key = (*at, shell)
        if key not in self.numbers:
            self.numbers[key] = len(self.points)
            self.points.append([a / self.n * self.size * self.ends[shell] for a in at])
        return self.numbers[key]

    def add_side(self, axis, end):
        """Shells on a side of the core, or the boundary there."""
        is_boundary = end == 0
        others = [d for d in range(3) if d != axis]
        for place in itertools.product(*(range(self.low[d], self.n) for d in others)):
            corners = []
            for step in ((0, 0), (1, 0), (1, 1), (0, 1)):
                at = [end] * 3
                for d, p, s in zip(others, place, step):
                    at[d] = p + s
                corners.append(at)
            if is_boundary:
                self.add_face([self.vertex(at, 0) for at in corners], axis, 0)
                continue
            for shell in range(len(self.ends) - 1):
                self.cells.append([self.vertex(at, shell) for at in corners] + [self.vertex(at, shell + 1) for at in corners])
                for k in range(4):
                    p, q = corners[k], corners[(k + 1) % 4]
                    for d in others:
                        if p[d] == q[d] == 0 and self.low[d] == 0:
                            self.add_face([self.vertex(p, shell), self.vertex(q, shell), self.vertex(q, shell + 1),
                                           self.vertex(p, shell + 1)], d, shell + 1)
            self.faces.append(([self.vertex(at, len(self.ends) - 1) for at in corners], 'far' if axis == 1 else 'sides'))

    def add_face(self, vertices, axis, shell):
        """On a plane through the origin."""
        name = ('x', 'contact' if shell <= CONTACT_SHELLS else 'rest', 'z')[axis]
        self.faces.append((vertices, name))


def ball(radius, way):
    """Where a vertex goes: above the point of contact for way = 1."""
    return lambda x, depth, z: (x, way * (depth + (radius - math.sqrt(radius ** 2 - x * x - z * z)) * (1 - depth / EXTENT)), z)


def block(x, depth, z):
    return x, -depth, z


def volume(points):
    """Six times that of the corner at the first of eight points; its sign is what counts."""
    a, b, c = ([points[k][d] - points[0][d] for d in range(3)] for k in (1, 3, 4))
    return sum(a[d] * (b[(d + 1) % 3] * c[(d + 2) % 3] - b[(d + 2) % 3] * c[(d + 1) % 3]) for d in range(3))


def with_middles(solid, nodes, numbers):
    """The nodes of a cell or face of second order; numbers of those in the middle, by the corners that they are between."""
    all_nodes = list(nodes)
    for between in MIDDLES[len(nodes)]:
        key = tuple(sorted(nodes[k] for k in between))
        if key not in numbers:
            numbers[key] = len(solid.points)
            solid.points.append([sum(solid.points[v][d] for v in key) / len(key) for d in range(3)])
        all_nodes.append(numbers[key])
    return all_nodes


def write(bodies, is_second_order):
    """[(name, solid, map)] as Gmsh 2.2."""
    names, nodes, elements = {}, [], []
    for body, solid, place in bodies:
        first, middles = len(nodes), {}
        points = [place(*x) for x in solid.points]
        group = names.setdefault((3, body), len(names) + 1)
        for cell in solid.cells:
            if volume([points[v] for v in cell]) < 0:
                cell = cell[4:] + cell[:4]
            if is_second_order:
                cell = with_middles(solid, cell, middles)
            elements.append((KINDS[len(cell)], group, [first + v + 1 for v in cell]))
        for face, side in solid.faces:
            if is_second_order:
                face = with_middles(solid, face, middles)
            elements.append((KINDS[len(face)], names.setdefault((2, body + ' ' + side), len(names) + 1), [first + v + 1 for v in face]))
        nodes += [place(*x) for x in solid.points]
    print('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}'.format(len(names)))
    for (dimension, name), group in names.items():
        print('{} {} "{}"'.format(dimension, group, name))
    print('$EndPhysicalNames\n$Nodes\n{}'.format(len(nodes)))
    for k, x in enumerate(nodes):
        print(k + 1, *('{:.9g}'.format(c + 0.) for c in x))
    print('$EndNodes\n$Elements\n{}'.format(len(elements)))
    for k, (kind, group, vertices) in enumerate(elements):
        print(k + 1, kind, 2, group, group, *vertices)
    print('$EndElements')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('kind', choices=('quarter', 'half', 'whole'))
    parser.add_argument('--cells', type=int, help='along an edge of the core, of a half or whole from its middle')
    parser.add_argument('--size', type=float, default=.735, help='of the core, from its middle [mm]')
    parser.add_argument('--shells', type=int, default=12)
    parser.add_argument('--two-balls', action='store_true')
    parser.add_argument('--second-order', action='store_true')
    given = parser.parse_args()
    cells = given.cells or {'quarter': 11, 'half': 8, 'whole': 6}[given.kind]
    pair = (ball(2 * RADIUS, 1), ball(2 * RADIUS, -1)) if given.two_balls else (ball(RADIUS, 1), block)
    write([('upper', Solid(given.kind, cells, given.size, given.shells), pair[0]),
           ('lower', Solid(given.kind, cells - 1, given.size, given.shells), pair[1])], given.second_order)


if __name__ == '__main__':
    main()
