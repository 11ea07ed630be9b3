"""Energy norm of errors, of displacement fields on rectangles of equal cells, from the .vtu files of a run.

Nothing of slipstick but its output goes in: shape functions, quadrature and elasticity are written out here, in plain
Python. The files hold single precision, so that errors below 1e-5 of the energy norm cannot be seen."""

import functools
import math

import fields

# Gauss points and weights on (0, 1)
GAUSS = [((1 + sign * math.sqrt(3 / 7 + side * 2 / 7 * math.sqrt(6 / 5))) / 2, (18 - side * math.sqrt(30)) / 72)
         for sign in (-1, 1) for side in (-1, 1)]


class Rectangle:
    """One body: origin, size, cells along x and y, and its place in the list of bodies."""

    def __init__(self, origin, size, cells, body=0):
        self.origin, self.size, self.cells, self.body = origin, size, cells, body


class Elasticity:
    """Isotropic, per unit thickness: energy density sigma : epsilon of strains (xx, yy, 2 xy)."""

    def __init__(self, modulus, ratio, plane_strain):
        if plane_strain:
            modulus, ratio = modulus / (1 - ratio**2), ratio / (1 - ratio)
        self.a = modulus / (1 - ratio**2)
        self.b = ratio * self.a
        self.g = modulus / (2 * (1 + ratio))

    def stress(self, exx, eyy, gxy):
        return self.a * exx + self.b * eyy, self.b * exx + self.a * eyy, self.g * gxy

    def density(self, exx, eyy, gxy):
        sxx, syy, sxy = self.stress(exx, eyy, gxy)
        return sxx * exx + syy * eyy + sxy * gxy


def lagrange(degree, x):
    """Values and derivatives of the shape functions on equidistant nodes of (0, 1)."""
    if degree == 1:
        return [1 - x, x], [-1, 1]
    return [(1 - 2 * x) * (1 - x), 4 * x * (1 - x), x * (2 * x - 1)], [4 * x - 3, 4 - 8 * x, 4 * x - 1]


class Field:
    """Nodal displacements of one rectangle."""

    def __init__(self, directory, rectangle, degree):
        self.rectangle, self.degree = rectangle, degree
        self.n = tuple(degree * cells for cells in rectangle.cells)
        self.h = tuple(size / cells for size, cells in zip(rectangle.size, rectangle.cells))
        self.values = {}
        for piece in fields.pieces(directory):
            arrays = fields.read_vtu(piece)
            if round(arrays['body'][0][0]) != rectangle.body:
                continue
            for position, value in zip(arrays['Points'], arrays['displacement']):
                key = tuple(round((x - origin) / size * n) for x, origin, size, n in
                            zip(position, rectangle.origin, rectangle.size, self.n))
                self.values[key] = value[:2]
        expected = (self.n[0] + 1) * (self.n[1] + 1)
        if len(self.values) != expected:
            raise AssertionError('{} nodes in place of {}'.format(len(self.values), expected))

    def on(self, finer):
        """The same function by its values at the nodes of a finer field (nested cells)."""
        def table(axis):
            rows = []
            for i in range(finer.n[axis] + 1):
                x = i * self.rectangle.cells[axis] / finer.n[axis]
                cell = min(int(x), self.rectangle.cells[axis] - 1)
                rows.append((self.degree * cell, lagrange(self.degree, x - cell)[0]))
            return rows
        tables = table(0), table(1)
        values = {}
        for i, j in finer.values:
            (first, along), (second, across) = tables[0][i], tables[1][j]
            u = v = 0
            for l, b in enumerate(across):
                for k, a in enumerate(along):
                    if a * b:
                        value = self.values[first + k, second + l]
                        u += a * b * value[0]
                        v += a * b * value[1]
            values[i, j] = u, v
        return values


@functools.lru_cache(maxsize=None)
def points(degree):
    """Quadrature on the unit square: weight, position, derivatives of all shape functions along x and y."""
    result = []
    for x, wx in GAUSS:
        for y, wy in GAUSS:
            (vx, dx), (vy, dy) = lagrange(degree, x), lagrange(degree, y)
            result.append((wx * wy, (x, y), [a * b for b in vy for a in dx], [a * b for b in dy for a in vx]))
    return result


def squared(values, field, elasticity, exact=None):
    """Twice the energy of the nodal values on the mesh of the field, of their difference from @p exact(x, y) -> strains
    (xx, yy, 2 xy) where given."""
    degree, (hx, hy) = field.degree, field.h
    total = 0
    for j in range(field.rectangle.cells[1]):
        for i in range(field.rectangle.cells[0]):
            nodes = [values[degree * i + k, degree * j + l] for l in range(degree + 1) for k in range(degree + 1)]
            for weight, (x, y), along, across in points(degree):
                exx = sum(a * node[0] for a, node in zip(along, nodes)) / hx
                eyy = sum(b * node[1] for b, node in zip(across, nodes)) / hy
                gxy = (sum(b * node[0] for b, node in zip(across, nodes)) / hy +
                       sum(a * node[1] for a, node in zip(along, nodes)) / hx)
                if exact:
                    origin = field.rectangle.origin
                    ex = exact(origin[0] + (i + x) * hx, origin[1] + (j + y) * hy)
                    exx, eyy, gxy = exx - ex[0], eyy - ex[1], gxy - ex[2]
                total += weight * elasticity.density(exx, eyy, gxy)
    return total * hx * hy


def error(field, elasticity, exact):
    """Energy norm of the error, from the exact strains."""
    return math.sqrt(squared(field.values, field, elasticity, exact))


def distance(field, finer, elasticity):
    """Square of the energy norm of the difference of two fields on nested meshes."""
    coarse = field.on(finer)
    difference = {key: (coarse[key][0] - value[0], coarse[key][1] - value[1]) for key, value in finer.values.items()}
    return squared(difference, finer, elasticity)


def rate(coarse, fine, ratio=2):
    """Observed order from two errors on meshes that differ by this ratio."""
    return math.log(coarse / fine) / math.log(ratio)


def slope(sizes, errors):
    """Observed order over a whole ladder: least squares in logarithms."""
    x, y = [math.log(size) for size in sizes], [math.log(value) for value in errors]
    mean = sum(x) / len(x)
    return sum((a - mean) * b for a, b in zip(x, y)) / sum((a - mean)**2 for a in x)
