"""Meshes that the benchmarks write themselves: tensor grids (graded, mapped), rings, discs; as Gmsh 2.2 files."""

import math


class Mesh:
    """Nodes (x, y), cells (3 or 4 node indices, counterclockwise) and boundaries (name: node pairs)."""

    def __init__(self, nodes, cells, lines):
        self.nodes, self.cells, self.lines = nodes, cells, lines

    def mapped(self, function):
        """Nodes moved to function(x, y)."""
        return Mesh([function(x, y) for x, y in self.nodes], self.cells, self.lines)

    def turned(self, degrees):
        """Rotated counterclockwise about the origin."""
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        return self.mapped(lambda x, y: (c * x - s * y, s * x + c * y)) if degrees else self

    def split(self):
        """Quadrilaterals cut into triangles, along their shorter diagonal; of equal ones, in turn the one and the other."""
        triangles = []
        for number, (a, b, c, d) in enumerate(self.cells):
            p, q = math.dist(self.nodes[a], self.nodes[c]), math.dist(self.nodes[b], self.nodes[d])
            if p < q * (1 - 1e-9) or (p < q * (1 + 1e-9) and number % 2):
                triangles += [(a, b, c), (a, c, d)]
            else:
                triangles += [(a, b, d), (b, c, d)]
        return Mesh(self.nodes, triangles, self.lines)

    def write(self, file_name, body):
        """One body; its physical name and those of its boundaries are the names given."""
        names = list(self.lines)
        elements = [f"1 2 {tag} {tag} {a + 1} {b + 1}" for tag, name in enumerate(names, 1) for a, b in self.lines[name]]
        surface = len(names) + 1
        for cell in self.cells:
            kind = 3 if len(cell) == 4 else 2
            elements.append(f"{kind} 2 {surface} {surface} " + " ".join(str(node + 1) for node in cell))
        with open(file_name, "w", encoding="ascii") as file:
            file.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{surface}\n")
            file.writelines(f'1 {tag} "{name}"\n' for tag, name in enumerate(names, 1))
            file.write(f'2 {surface} "{body}"\n$EndPhysicalNames\n$Nodes\n{len(self.nodes)}\n')
            file.writelines(f"{i} {x!r} {y!r} 0\n" for i, (x, y) in enumerate(self.nodes, 1))
            file.write(f"$EndNodes\n$Elements\n{len(elements)}\n")
            file.writelines(f"{i} {element}\n" for i, element in enumerate(elements, 1))
            file.write("$EndElements\n")


def uniform(start, end, n):
    return [start + (end - start) * i / n for i in range(n + 1)]


def graded(start, end, n, smallest):
    """n cells in geometric progression; the first one, at `start`, has the length `smallest` (or all are equal)."""
    length = abs(end - start)
    if smallest >= length / n:
        return uniform(start, end, n)
    low, high = 1., (length / smallest) ** (1 / (n - 1))  # the sum exceeds its largest term
    for _ in range(200):
        ratio = (low + high) / 2
        if ratio == 1 or smallest * (ratio ** n - 1) / (ratio - 1) < length:
            low = ratio
        else:
            high = ratio
    points = [0.]
    for i in range(n):
        points.append(points[-1] + smallest * low ** i)
    return [start + (end - start) * point / points[-1] for point in points]


def graded_both(start, middle, end, n, smallest):
    """n cells (even), smallest at `middle`, towards both ends."""
    left = graded(middle, start, n // 2, smallest)
    return left[::-1] + graded(middle, end, n - n // 2, smallest)[1:]


def grid(xs, ys, names=None):
    """Tensor grid with boundaries left, right, bottom, top; names(side, x, y) of a middle of an edge renames parts."""
    nx, ny = len(xs) - 1, len(ys) - 1
    nodes = [(x, y) for y in ys for x in xs]

    def node(i, j):
        return j * (nx + 1) + i

    cells = [(node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)) for j in range(ny) for i in range(nx)]
    edges = [("bottom", node(i, 0), node(i + 1, 0)) for i in range(nx)]
    edges += [("right", node(nx, j), node(nx, j + 1)) for j in range(ny)]
    edges += [("top", node(i + 1, ny), node(i, ny)) for i in range(nx)]
    edges += [("left", node(0, j + 1), node(0, j)) for j in range(ny)]
    lines = {}
    for side, a, b in edges:
        if names:
            side = names(side, (nodes[a][0] + nodes[b][0]) / 2, (nodes[a][1] + nodes[b][1]) / 2)
        lines.setdefault(side, []).append((a, b))
    return Mesh(nodes, cells, lines)


def ring(radii, n, start=0.):
    """Polar grid, n cells around, boundaries inner and outer; its first ray is at `start` [degrees]."""
    angles = [math.radians(start) + 2 * math.pi * i / n for i in range(n)]
    nodes = [(r * math.cos(a), r * math.sin(a)) for r in radii for a in angles]
    cells = [(j * n + i, (j + 1) * n + i, (j + 1) * n + (i + 1) % n, j * n + (i + 1) % n)
             for j in range(len(radii) - 1) for i in range(n)]
    last = (len(radii) - 1) * n
    return Mesh(nodes, cells, {"inner": [((i + 1) % n, i) for i in range(n)],
                               "outer": [(last + i, last + (i + 1) % n) for i in range(n)]})


def disc(radius, n, layers, core=0.42, smallest=None):
    """Butterfly grid, n cells around (a multiple of 4), boundary arc; `smallest`: radial length of the outermost cells."""
    m = n // 4
    spread = [core * radius * math.tan(math.pi / 4 * (2 * i / m - 1)) for i in range(m + 1)]
    core_mesh = grid(spread, spread)
    nodes, cells = list(core_mesh.nodes), list(core_mesh.cells)
    inner = [a for side in ("bottom", "right", "top", "left") for a, _ in core_mesh.lines[side]]
    around = order_around(inner, nodes)
    parts = graded(1, 0, layers, smallest / (radius * (1 - core))) if smallest else uniform(1, 0, layers)
    parts = parts[::-1]
    previous = around
    for part in parts[1:]:
        first = len(nodes)
        for a in around:
            x, y = nodes[a]
            scale = radius / math.hypot(x, y)
            nodes.append((x * (1 + part * (scale - 1)), y * (1 + part * (scale - 1))))
        current = list(range(first, first + n))
        cells += [(previous[i], current[i], current[(i + 1) % n], previous[(i + 1) % n]) for i in range(n)]
        previous = current
    return Mesh(nodes, cells, {"arc": [(previous[i], previous[(i + 1) % n]) for i in range(n)]})


def order_around(indices, nodes):
    """By angle about the origin."""
    return sorted(indices, key=lambda a: math.atan2(nodes[a][1], nodes[a][0]))
