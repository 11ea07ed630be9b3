#!/usr/bin/python3
"""Sector of a bolted flange, cut in two by a plane of symmetry: from the middle of a bolt to the middle between two.

    meshes/flange.py > meshes/flange.msh        (prm/flange.prm; hexahedra, Gmsh 2.2)

The axis is z, the bolt at (CIRCLE, 0). Bodies: neck (a pipe with its flange, above), gasket, cover (a plate, below), bolt (with head, above,
and nut). Boundaries of each, as far as it has them: "neck bolt plane" (y = 0) and "neck mid plane" (between two bolts), "neck bottom", "neck
top" (of the flange), "neck wetted" (what the pressure acts on), "neck end" (of the pipe), "bolt upper seat" and "bolt lower seat" (of head and
nut), "neck rest".

--fine N divides all cells into N^3.
"""

import argparse
import math

BOLTS = 8
BORE, PIPE, RIM = 50., 57., 110.            # radii [mm]: of the bore, of the pipe, of flange and cover
THICKNESS, PIPE_LENGTH = 30., 60.           # of flange and of cover; of the pipe above the flange
CIRCLE, HOLE = 90., 9.                      # radius of the circle of bolts, of their holes
SHANK, HEAD, HEAD_HEIGHT = 8., 12., 10.     # radii of the bolt
GASKET_INNER, GASKET_OUTER, GASKET = 57., 76., 2.  # radii and thickness
BOX = 70.                                   # a block of cells around the hole begins at this radius
SECTOR = math.pi / BOLTS
SQUARE = ((0, 0), (1, 0), (1, 1), (0, 1))
TOLERANCE = 1e-6


def polar(r, angle):
    return r * math.cos(angle), r * math.sin(angle)


def mixed(a, b, share):
    return tuple(p + share * (q - p) for p, q in zip(a, b))


class Section:
    """Quadrilaterals across the axis: blocks that are joined where their nodes coincide."""

    def __init__(self):
        self.points, self.number, self.cells = [], {}, []

    def vertex(self, point):
        key = tuple(round(c, 6) + 0. for c in point)
        if key not in self.number:
            self.number[key] = len(self.points)
            self.points.append(key)
        return self.number[key]

    def add_block(self, place, n, m):
        """n x m cells; place(s, t) with both from 0 to 1."""
        at = [[self.vertex(place(i / n, j / m)) for j in range(m + 1)] for i in range(n + 1)]
        for i in range(n):
            for j in range(m):
                cell = [at[i + a][j + b] for a, b in SQUARE]
                a, b, d = (self.points[cell[k]] for k in (0, 1, 3))
                turned = (b[0] - a[0]) * (d[1] - a[1]) < (b[1] - a[1]) * (d[0] - a[0])
                self.cells.append(cell[::-1] if turned else cell)

    def add_arc(self, inner, outer, first, last, radial, around):
        self.add_block(lambda s, t: polar(inner + s * (outer - inner), first + t * (last - first)), radial, around)

    def sides(self):
        """Edges of single cells."""
        edges = {}
        for cell in self.cells:
            for k in range(4):
                edge = cell[k], cell[(k + 1) % 4]
                edges.setdefault(tuple(sorted(edge)), []).append(edge)
        return [found[0] for found in edges.values() if len(found) == 1]


def around_hole(section, fine):
    """From BOX to the rim: rings about the hole within a block, and the rest of the sector beside it."""
    corner = SECTOR / 2

    def outline(t):
        """Of the block, t = 0 on the rim, 1 towards the axis, both on y = 0."""
        if t < .25:
            return polar(RIM, 4 * t * corner)
        return polar(RIM + (BOX - RIM) * (2 * t - .5), corner) if t < .75 else polar(BOX, 4 * (1 - t) * corner)

    def circle(radius):
        return lambda t: (CIRCLE + radius * math.cos(math.pi * t), radius * math.sin(math.pi * t))

    section.add_block(lambda s, t: mixed(circle(HOLE)(t), circle(HEAD)(t), s), 2 * fine, 16 * fine)
    section.add_block(lambda s, t: mixed(circle(HEAD)(t), outline(t), s), 3 * fine, 16 * fine)
    section.add_arc(BOX, RIM, corner, SECTOR, 8 * fine, 4 * fine)


def flange_section(fine):
    section = Section()
    section.add_arc(BORE, PIPE, 0, SECTOR, 2 * fine, 8 * fine)
    section.add_arc(PIPE, BOX, 0, SECTOR, 3 * fine, 8 * fine)
    around_hole(section, fine)
    return section


def cover_section(fine):
    """The tip of the sector is cut into three quadrilaterals, by lines from its middle to those of its sides."""
    section = flange_section(fine)
    arc = lambda t: polar(BORE, t * SECTOR)
    tip, middle = (0., 0.), polar(BORE * .6, SECTOR / 2)
    half = polar(BORE / 2, 0), polar(BORE / 2, SECTOR)
    n = 4 * fine
    section.add_block(lambda s, t: mixed(mixed(tip, half[0], s), mixed(half[1], middle, s), t), n, n)
    section.add_block(lambda s, t: mixed(mixed(half[0], middle, t), arc(t / 2), s), n, n)
    section.add_block(lambda s, t: mixed(mixed(half[1], middle, t), arc(1 - t / 2), s), n, n)
    return section


def bolt_section(fine):
    """Half a disc: a block in its middle, rings about that."""
    section = Section()
    n, half = 2 * fine, SHANK / 3
    circle = lambda radius, t: (CIRCLE + radius * math.cos(math.pi * t), radius * math.sin(math.pi * t))

    def outline(t):
        """Of the block, as far around as the circle."""
        if t < .25:
            return CIRCLE + half, 4 * t * half
        return (CIRCLE + half * (1 - 4 * (t - .25)), half) if t < .75 else (CIRCLE - half, 4 * (1 - t) * half)

    section.add_block(lambda s, t: (CIRCLE + half * (2 * s - 1), half * t), 2 * n, n)
    section.add_block(lambda s, t: mixed(outline(t), circle(SHANK, t), s), n, 4 * n)
    section.add_block(lambda s, t: circle(SHANK + s * (HOLE - SHANK), t), fine, 4 * n)
    section.add_block(lambda s, t: circle(HOLE + s * (HEAD - HOLE), t), n, 4 * n)
    return section


class Body:
    """Layers of a section along z; cells where keep(x, y, z) says so of their middle."""

    def __init__(self, name, section, heights, side, keep=lambda *middle: True):
        self.name, self.section, self.heights, self.side = name, section, heights, side
        self.kept = {(k, c) for k in range(len(heights) - 1) for c in range(len(section.cells)) if keep(*self.middle(k, c))}

    def middle(self, layer, cell):
        corners = [self.section.points[v] for v in self.section.cells[cell]]
        return (*(sum(x) / 4 for x in zip(*corners)), (self.heights[layer] + self.heights[layer + 1]) / 2)

    def vertex(self, v, layer):
        return (*self.section.points[v], self.heights[layer])

    def hexahedra(self):
        for k, c in sorted(self.kept):
            yield [self.vertex(v, k + up) for up in (0, 1) for v in self.section.cells[c]]

    def faces(self):
        """Those on the boundary, with their names."""
        seen = {}
        for k, c in sorted(self.kept):
            cell = self.section.cells[c]
            low, high = ([self.vertex(v, k + up) for v in cell] for up in (0, 1))
            for face in [low, high] + [[low[i], low[(i + 1) % 4], high[(i + 1) % 4], high[i]] for i in range(4)]:
                seen.setdefault(frozenset(face), []).append(face)
        for found in seen.values():
            if len(found) == 1:
                yield self.name_of(found[0]), found[0]

    def name_of(self, face):
        on = lambda distance: all(abs(distance(*vertex)) < TOLERANCE for vertex in face)
        if on(lambda x, y, z: y):
            return 'bolt plane'
        if on(lambda x, y, z: x * math.sin(SECTOR) - y * math.cos(SECTOR)):
            return 'mid plane'
        if on(lambda x, y, z: z - self.heights[0]) or on(lambda x, y, z: z - self.heights[-1]):
            is_low = abs(face[0][2] - self.heights[0]) < TOLERANCE
            return self.side(*(sum(x) / 4 for x in zip(*face)), 'bottom' if is_low else 'top')
        return self.side(*(sum(x) / 4 for x in zip(*face)), 'rest')


def heights(*ends_and_cells):
    """From end, cells, end, cells, ..., end."""
    result = [ends_and_cells[0]]
    for k in range(1, len(ends_and_cells), 2):
        first, n, last = ends_and_cells[k - 1:k + 2]
        result += [first + (last - first) * i / n for i in range(1, n + 1)]
    return result


def bodies(fine):
    """The gasket lies between z = 0 and GASKET."""
    upper, lower = GASKET + THICKNESS, -THICKNESS
    inside = lambda x, y: math.hypot(x, y) < GASKET_INNER

    def of_neck(x, y, z, side):
        if side == 'bottom':
            return 'wetted' if inside(x, y) else side
        if side == 'top':
            return 'end'
        if abs(z - upper) < TOLERANCE:
            return 'top'
        return 'wetted' if math.hypot(x, y) < (BORE + PIPE) / 2 else side

    def of_cover(x, y, z, side):
        return 'wetted' if side == 'top' and inside(x, y) else side

    def of_gasket(x, y, z, side):
        return 'wetted' if side == 'rest' and math.hypot(x, y) < (GASKET_INNER + GASKET_OUTER) / 2 else side

    def of_bolt(x, y, z, side):
        radius = math.hypot(x - CIRCLE, y)
        for seat, height in (('upper seat', upper), ('lower seat', lower)):
            if abs(z - height) < TOLERANCE and radius > HOLE:
                return seat
        return 'rest'

    gasket = Section()
    gasket.add_arc(GASKET_INNER, GASKET_OUTER, 0, SECTOR, 5 * fine, 8 * fine)
    return [Body('neck', flange_section(fine), heights(GASKET, 4 * fine, upper, 8 * fine, upper + PIPE_LENGTH), of_neck,
                 lambda x, y, z: z < upper or math.hypot(x, y) < PIPE),
            Body('gasket', gasket, heights(0, fine, GASKET), of_gasket),
            Body('cover', cover_section(fine), heights(lower, 4 * fine, 0), of_cover),
            Body('bolt', bolt_section(fine), heights(lower - HEAD_HEIGHT, 2 * fine, lower, 8 * fine, upper, 2 * fine, upper + HEAD_HEIGHT), of_bolt,
                 lambda x, y, z: not lower < z < upper or math.hypot(x - CIRCLE, y) < SHANK)]


def write(parts):
    groups, nodes, elements = {}, {}, []
    group = lambda *key: groups.setdefault(key, len(groups) + 1)

    def numbers(body, points):
        return [nodes.setdefault((body.name, point), len(nodes) + 1) for point in points]

    for body in parts:
        for cell in body.hexahedra():
            elements.append((5, group(3, body.name), numbers(body, cell)))
        for name, face in body.faces():
            elements.append((3, group(2, body.name + ' ' + name), numbers(body, face)))
    print('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}'.format(len(groups)))
    for (dimension, name), k in groups.items():
        print('{} {} "{}"'.format(dimension, k, name))
    print('$EndPhysicalNames\n$Nodes\n{}'.format(len(nodes)))
    for (_, point), k in nodes.items():
        print(k, *('{:.9g}'.format(c) for c in point))
    print('$EndNodes\n$Elements\n{}'.format(len(elements)))
    for k, (kind, of, vertices) in enumerate(elements):
        print(k + 1, kind, 2, of, of, *vertices)
    print('$EndElements')


if __name__ == '__main__':
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument('--fine', type=int, default=1)
    write(bodies(options.parse_args().fine))
