"""A scene of rectangles solved without slipstick: elements, contact rows and solver of its own, in plain Python.

It shares no line with the program and none with the dense solver of test_random, which takes K, f and B from the program:
this one reads the .prm, integrates its own elements over its own lattices, writes its own rows, and finds the solution by
an active set method on the unknowns of contact nodes (all others condensed). Only what `Scene` reads is understood;
anything else in the file raises NotUnderstood.

Rectangles in lattices of bilinear or biquadratic elements; sides along the axes in contact with each other (biorthogonal
mortar, all of the slave side covered), with half planes and circles; frictionless, Tresca, Coulomb, bonded; supports,
tractions and body forces. Standard library only.
"""

import math
import re

# integrals of the shape functions of an edge of length 1, by their number
PARTS = {2: (0.5, 0.5), 3: (1 / 6, 4 / 6, 1 / 6)}
GAUSS = {2: ((-3**-0.5, 1.), (3**-0.5, 1.)), 3: ((-0.6**0.5, 5 / 9), (0., 8 / 9), (0.6**0.5, 5 / 9))}


class NotUnderstood(Exception):
    pass


# ------------------------------------------------------------------------------------------------- reading


def sections(text):
    """Settings at the top, and of the sections by name; what is read is taken out by Settings.take."""
    top, current, inner = {}, None, {}
    for line in text.splitlines():
        line = line.strip()
        if line.startswith('subsection '):
            current = inner.setdefault(line[len('subsection '):], {})
        elif line == 'end':
            current = None
        elif line.startswith('set '):
            name, value = (word.strip() for word in line[4:].split('=', 1))
            (top if current is None else current)[name] = value
        elif line and not line.startswith('#'):
            raise NotUnderstood(line)
    return top, inner


def names(top, key):
    return [name.strip() for name in top.pop(key, '').split(',') if name.strip()]


def numbers(text):
    return [float(word) for word in text.split(',')]


def formula(text):
    """A function of x and y."""
    if not re.fullmatch(r'[-+*/().\d\sexyE]*', text):
        raise NotUnderstood(text)
    code = compile(text.strip(), '<formula>', 'eval')
    return lambda x, y: float(eval(code, {'__builtins__': {}}, {'x': x, 'y': y}))  # nosec: letters are checked


class Lattice:
    """A body: nodes, elements of degree 1 or 2, boundary edges; unknowns 2 i and 2 i + 1 of node i."""

    def __init__(self, values, material, degree, plane_strain, first):
        if values.pop('Shape', 'rectangle') != 'rectangle':
            raise NotUnderstood('shape')
        self.degree, self.first = degree, first
        (x0, y0), (w, h) = numbers(values.pop('Origin', '0, 0')), numbers(values.pop('Size'))
        self.n = tuple(int(n) for n in numbers(values.pop('Cells')))
        self.thickness = float(values.pop('Thickness', 1))
        if values:
            raise NotUnderstood(values)
        self.cell = (w / self.n[0], h / self.n[1])
        self.columns, self.rows = (degree * n + 1 for n in self.n)
        # the corners of the rectangle as they are given, so that sides of two bodies meet
        self.at = [(x0 + w * (i / (self.columns - 1)), y0 + h * (j / (self.rows - 1)))
                   for j in range(self.rows) for i in range(self.columns)]
        young, ratio = material
        if plane_strain:
            young, ratio = young / (1 - ratio**2), ratio / (1 - ratio)
        stiff = young / (1 - ratio**2)
        self.law = ((stiff, stiff * ratio, 0), (stiff * ratio, stiff, 0), (0, 0, stiff * (1 - ratio) / 2))

    def node(self, i, j):
        return self.first + j * self.columns + i

    def elements(self):
        """Nodes of every element, row by row."""
        p = self.degree
        for j in range(self.n[1]):
            for i in range(self.n[0]):
                yield [self.node(p * i + a, p * j + b) for b in range(p + 1) for a in range(p + 1)]

    def side(self, name):
        """Direction along it (0: x), nodes in that direction."""
        along = {'bottom': 0, 'top': 0, 'left': 1, 'right': 1}[name]
        last = (self.columns - 1, self.rows - 1)
        if along == 0:
            return 0, [self.node(i, last[1] if name == 'top' else 0) for i in range(self.columns)]
        return 1, [self.node(last[0] if name == 'right' else 0, j) for j in range(self.rows)]


def shape(degree, s):
    """Lagrange polynomials on [-1, 1] and their derivatives."""
    if degree == 1:
        return (0.5 * (1 - s), 0.5 * (1 + s)), (-0.5, 0.5)
    return (0.5 * s * (s - 1), 1 - s * s, 0.5 * s * (s + 1)), (s - 0.5, -2 * s, s + 0.5)


class Node:
    """A contact node: its pair, law and weights, positive on the slave; forces once they are known."""

    def __init__(self, pair, at, weights, normal, gap, area, law, bound, mu):
        self.pair, self.at, self.weights, self.direction, self.gap = pair, at, weights, normal, gap
        self.area, self.law, self.bound, self.mu = area, law, bound, mu
        self.rows = {}  # 'normal', 'tangential'

    def traction(self, kind):
        """[MPa]; 0 where supports leave the row nothing to say."""
        return self.rows[kind].force / self.area if kind in self.rows else 0.


class Scene:
    """K, f, held unknowns and contact rows."""

    def __init__(self, text):
        top, inner = sections(text)
        plane_strain = top.pop('Plane state') == 'plane strain'
        inner.pop('Friction', None)
        self.degree = int(inner.pop('Discretization')['Degree'])
        materials = {name: inner.pop('Material ' + name) for name in names(top, 'Materials')}
        self.bodies, n = {}, 0
        for name in names(top, 'Bodies'):
            values = dict(inner.pop('Body ' + name))
            material = materials[values.pop('Material')]
            body = Lattice(values, (float(material['Young modulus']), float(material['Poisson ratio'])), self.degree,
                           plane_strain, n)
            self.bodies[name] = body
            n += len(body.at)
        self.at = [x for body in self.bodies.values() for x in body.at]
        self.K, self.f = [[0.] * (2 * n) for _ in range(2 * n)], [0.] * (2 * n)
        for body in self.bodies.values():
            self.add_stiffness(body)
        for name in names(top, 'Body forces'):
            self.add_weight(inner.pop('Body force ' + name))
        for name in names(top, 'Tractions'):
            self.add_traction(inner.pop('Traction ' + name))
        self.held = {}
        for name in names(top, 'Supports'):
            self.add_support(inner.pop('Support ' + name))
        self.obstacles = {name: inner.pop('Obstacle ' + name) for name in names(top, 'Obstacles')}
        self.contacts = []  # one a contact node
        for name in names(top, 'Contacts'):
            self.add_contact(name, inner.pop('Contact ' + name))
        if top or inner:
            raise NotUnderstood((top, list(inner)))

    def add_stiffness(self, body):
        p, (w, h) = body.degree, body.cell
        rule = GAUSS[p + 1]
        size = 2 * (p + 1)**2
        element = [[0.] * size for _ in range(size)]
        for s, ws in rule:
            for t, wt in rule:
                (n_x, d_x), (n_y, d_y) = shape(p, s), shape(p, t)
                gradients = [(d_x[a] * n_y[b] * 2 / w, n_x[a] * d_y[b] * 2 / h) for b in range(p + 1) for a in range(p + 1)]
                weight = ws * wt * w * h / 4 * body.thickness
                strains = [row for gx, gy in gradients for row in ((gx, 0., gy), (0., gy, gx))]
                stresses = [tuple(sum(c * e for c, e in zip(line, strain)) for line in body.law) for strain in strains]
                for i, e in enumerate(strains):
                    for j, sigma in enumerate(stresses):
                        element[i][j] += weight * (e[0] * sigma[0] + e[1] * sigma[1] + e[2] * sigma[2])
        for nodes in body.elements():
            unknowns = [2 * i + c for i in nodes for c in (0, 1)]
            for i, row in zip(unknowns, element):
                for j, value in zip(unknowns, row):
                    self.K[i][j] += value

    def add_weight(self, values):
        if values.pop('Bodies') != 'all':
            raise NotUnderstood('bodies of a body force')
        force = float(values.pop('Force x')), float(values.pop('Force y'))
        for body in self.bodies.values():
            p, (w, h) = body.degree, body.cell
            part = PARTS[p + 1]
            for nodes in body.elements():
                for k, i in enumerate(nodes):
                    for c in (0, 1):
                        self.f[2 * i + c] += force[c] * part[k % (p + 1)] * part[k // (p + 1)] * w * h * body.thickness

    def edges(self, boundary):
        """Thickness, direction, and the edges of a side: (nodes, from, to)."""
        name, side = boundary.split('/')
        body = self.bodies[name]
        along, nodes = body.side(side)
        p = body.degree
        cut = [nodes[k:k + p + 1] for k in range(0, len(nodes) - 1, p)]
        return body.thickness, along, [(edge, self.at[edge[0]][along], self.at[edge[-1]][along]) for edge in cut]

    def add_traction(self, values):
        thickness, along, edges = self.edges(values.pop('Boundary'))
        functions = [formula(values.pop('Traction ' + c, '0')) for c in 'xy']
        if values:
            raise NotUnderstood(values)
        for nodes, begin, end in edges:
            for s, weight in GAUSS[3]:
                place = list(self.at[nodes[0]])
                place[along] = (begin + end) / 2 + s * (end - begin) / 2
                for i, n in zip(nodes, shape(self.degree, s)[0]):
                    for c in (0, 1):
                        self.f[2 * i + c] += n * weight * (end - begin) / 2 * thickness * functions[c](*place)

    def add_support(self, values):
        name, side = values.pop('Boundary').split('/')
        _, nodes = self.bodies[name].side(side)
        for c, letter in enumerate('xy'):
            text = values.pop('Displacement ' + letter, '')
            if text:
                for i in nodes:
                    self.held[2 * i + c] = formula(text)(*self.at[i])
        if values:
            raise NotUnderstood(values)

    # --------------------------------------------------------------------------------------------- contact

    def add_contact(self, name, values):
        slave, master, law = (values.pop(key) for key in ('Slave', 'Master', 'Law'))
        offset = float(values.pop('Offset', 0))
        bound = float(values.pop('Slip bound')) if law == 'Tresca' else 0.
        mu = float(values.pop('Friction coefficient')) if law == 'Coulomb' else 0.
        discretization = values.pop('Discretization', 'auto')
        if values or law not in ('frictionless', 'Tresca', 'Coulomb', 'bonded'):
            raise NotUnderstood((law, values))
        rows = self.on_obstacle(slave, self.obstacles[master]) if master in self.obstacles else \
            self.on_body(slave, master, discretization == 'auto')
        for place, weights, normal, gap, area, traction_area in rows:
            self.contacts.append(Node(name, place, weights, normal, gap + offset, traction_area, law, bound * area, mu))

    def on_obstacle(self, slave, obstacle):
        thickness, _, edges = self.edges(slave)
        area = {}
        for nodes, begin, end in edges:
            for i, fraction in zip(nodes, PARTS[len(nodes)]):
                area[i] = area.get(i, 0.) + fraction * (end - begin) * thickness
        for i, size in area.items():
            x, y = self.at[i]
            if obstacle['Shape'] == 'half plane':
                (px, py), (nx, ny) = numbers(obstacle['Point']), numbers(obstacle['Normal'])
                length = math.hypot(nx, ny)
                normal, gap = (-nx / length, -ny / length), ((x - px) * nx + (y - py) * ny) / length
            elif obstacle['Shape'] == 'circle':
                (cx, cy), radius = numbers(obstacle['Center']), float(obstacle['Radius'])
                length = math.hypot(cx - x, cy - y)
                normal, gap = ((cx - x) / length, (cy - y) / length), length - radius
            else:
                raise NotUnderstood(obstacle['Shape'])
            yield (x, y), {i: 1.}, normal, gap, size, size

    def on_body(self, slave, master, matching):
        """Test functions phi = diag(<T>) <T T'>^-1 T on the covered part <.> of every edge; T are the shape functions, on
        quadratic edges that are covered in part the linear ones. @param matching: node to node where nodes are opposite."""
        thickness, along, edges = self.edges(slave)
        other, along_there, opposite = self.edges(master)
        if along != along_there:
            raise NotUnderstood('sides across each other')
        across = 1 - along
        normal = [0., 0.]
        normal[across] = 1. if slave.endswith(('top', 'right')) else -1.
        gap = normal[across] * (self.at[opposite[0][0][0]][across] - self.at[edges[0][0][0]][across])
        size, full, weights = {}, {}, {}
        for nodes, begin, end in edges:
            parts = [(max(begin, first), min(end, last), theirs, first, last) for theirs, first, last in opposite]
            parts = [part for part in parts if part[1] - part[0] > 1e-12 * (end - begin)]
            covered = sum(part[1] - part[0] for part in parts)
            n = self.degree + 1 if covered > (1 - 1e-9) * (end - begin) else 2
            tests = nodes if n == len(nodes) else [nodes[0], nodes[-1]]
            for i, part in zip(nodes, PARTS[len(nodes)]):
                full[i] = full.get(i, 0.) + part * (end - begin)
            if not parts:
                continue
            mass, length, mine, theirs_ = [[0.] * n for _ in range(n)], [0.] * n, {}, {}
            for low, high, theirs, first, last in parts:
                for s, weight in GAUSS[3]:
                    x, dx = (low + high) / 2 + s * (high - low) / 2, weight * (high - low) / 2
                    T = shape(n - 1, 2 * (x - begin) / (end - begin) - 1)[0]
                    for a in range(n):
                        length[a] += dx * T[a]
                        for b in range(n):
                            mass[a][b] += dx * T[a] * T[b]
                    for sums, keys, at in ((mine, nodes, 2 * (x - begin) / (end - begin) - 1),
                                           (theirs_, theirs, 2 * (x - first) / (last - first) - 1)):
                        for k, value in zip(keys, shape(self.degree, at)[0]):
                            sums.setdefault(k, [0.] * n)
                            sums[k] = [old + dx * value * t for old, t in zip(sums[k], T)]
            dual = [solved([row[:] for row in mass], [length[a] if b == a else 0. for b in range(n)]) for a in range(n)]
            for i, phi, d in zip(tests, dual, length):
                size[i] = size.get(i, 0.) + d
                row = weights.setdefault(i, {})
                for sign, sums in ((1., mine), (-1., theirs_)):
                    for k, with_tests in sums.items():
                        row[k] = row.get(k, 0.) + sign * sum(p * v for p, v in zip(phi, with_tests))
        if matching:
            nearest = {i: min((k for theirs, _, _ in opposite for k in theirs),
                              key=lambda k: abs(self.at[k][along] - self.at[i][along])) for i in weights}
            if all(abs(self.at[k][along] - self.at[i][along]) < 1e-6 * size[i] for i, k in nearest.items()):
                weights = {i: {i: size[i], k: -size[i]} for i, k in nearest.items()}
        for i, row in weights.items():
            thin = min(thickness, other)
            yield (self.at[i], {k: w / size[i] for k, w in row.items() if abs(w) > 1e-11 * size[i]}, tuple(normal), gap,
                   size[i] * thin, max(size[i], full[i] / 2) * thin)


# ------------------------------------------------------------------------------------------------- dense algebra


def solved(A, b):
    """Gauss with pivots; A and b are used up. @throws ZeroDivisionError when A is singular."""
    n = len(b)
    scale = max(max(map(abs, row)) for row in A)
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(A[i][k]))
        if abs(A[pivot][k]) < 1e-13 * scale:
            raise ZeroDivisionError('singular')
        A[k], A[pivot], b[k], b[pivot] = A[pivot], A[k], b[pivot], b[k]
        row, rest = A[k], A[k][k + 1:]
        for i in range(k + 1, n):
            if A[i][k] != 0.:
                factor = A[i][k] / row[k]
                A[i][k + 1:] = [a - factor * r for a, r in zip(A[i][k + 1:], rest)]
                b[i] -= factor * b[k]
    x = [0.] * n
    for k in reversed(range(n)):
        x[k] = (b[k] - sum(a * y for a, y in zip(A[k][k + 1:], x[k + 1:]))) / A[k][k]
    return x


def condense(A, b, keep):
    """Schur complement on the unknowns of `keep`, and a function from these to all unknowns."""
    inner = [i for i in range(len(b)) if i not in set(keep)]
    order = inner + keep
    M = [[A[i][j] for j in order] + [b[i]] for i in order]
    for k in range(len(inner)):
        row, pivot = M[k], M[k][k]
        for i in range(k + 1, len(order)):
            if M[i][k] != 0.:
                factor = M[i][k] / pivot
                M[i][k + 1:] = [a - factor * r for a, r in zip(M[i][k + 1:], row[k + 1:])]
    m = len(inner)

    def expand(kept):
        x = [0.] * m + list(kept)
        for k in reversed(range(m)):
            x[k] = (M[k][-1] - sum(a * y for a, y in zip(M[k][k + 1:-1], x[k + 1:]))) / M[k][k]
        result = [0.] * len(order)
        for i, value in zip(order, x):
            result[i] = value
        return result

    return [row[m:-1] for row in M[m:]], [row[-1] for row in M[m:]], expand


# ------------------------------------------------------------------------------------------------- solution


class Row:
    """b u <= c (normal), |force| <= bound (tangential), b u = c (bonded)."""

    def __init__(self, kind, b, c, node):
        self.kind, self.b, self.c, self.node = kind, b, c, node
        self.force = 0.
        self.state = 'stick' if kind == 'tangential' else 'closed'

    def bound(self):
        """Of the tangential force, with the forces of the step before."""
        if self.node.law != 'Coulomb':
            return self.node.bound
        return self.node.mu * max(0., self.node.rows['normal'].force) if 'normal' in self.node.rows else 0.

    def next_state(self, past):
        """@param past: force plus stiffness times what the row leaves open."""
        if self.kind == 'normal':
            return 'closed' if past > 0 else 'open'
        if self.kind == 'bonded':
            return 'closed'
        if self.node.law == 'Coulomb' and self.bound() <= 0:
            return 'open'
        return 'stick' if abs(past) < self.bound() else 1 if past > 0 else -1


def rows_of(scene, free):
    """Rows on the free unknowns; of a node the tangential one only where the normal one leaves it something to say."""
    rows = []
    for node in scene.contacts:
        nx, ny = node.direction
        for kind, direction in (('normal', (nx, ny)), ('tangential', (-ny, nx))):
            b, c = {}, node.gap if kind == 'normal' and node.law != 'bonded' else 0.
            for i, weight in node.weights.items():
                for d in (0, 1):
                    value = weight * direction[d]
                    if abs(value) < 1e-14:
                        continue
                    if 2 * i + d in scene.held:
                        c -= value * scene.held[2 * i + d]
                    else:
                        b[free[2 * i + d]] = value
            is_said = len(b) == 1 and 'normal' in node.rows and list(node.rows['normal'].b) == list(b)
            if b and not is_said and not (kind == 'tangential' and node.law == 'frictionless'):
                node.rows[kind] = Row('bonded' if node.law == 'bonded' else kind, b, c, node)
        rows += node.rows.values()
    return rows


def equations(S, g, rows, stiffness):
    """Equilibrium of the kept unknowns, and one equation a row by its state; all of the size of the stiffness."""
    m, n = len(g), len(g) + len(rows)
    place = {id(row): m + k for k, row in enumerate(rows)}
    A, b = [row + [0.] * len(rows) for row in S] + [[0.] * n for _ in rows], list(g) + [0.] * len(rows)
    for row in rows:
        k = place[id(row)]
        for i, value in row.b.items():
            A[i][k] += value
        if row.state in ('closed', 'stick'):
            for i, value in row.b.items():
                A[k][i] = value * stiffness
            b[k] = row.c * stiffness
        else:
            A[k][k] = stiffness
            if row.state != 'open' and row.node.law == 'Coulomb':
                A[k][place[id(row.node.rows['normal'])]] = -row.state * row.node.mu * stiffness
            elif row.state != 'open':
                b[k] = row.state * row.node.bound * stiffness
    return A, b


def active_set(S, g, rows):
    """The kept unknowns, forces into the rows: sets from the solution of the step before until they repeat."""
    stiffness = max(S[i][i] for i in range(len(S)))
    for _ in range(100):
        x = solved(*equations(S, g, rows, stiffness))
        for row, force in zip(rows, x[len(g):]):
            row.force = force
        states = [row.next_state(row.force + stiffness * (sum(v * x[i] for i, v in row.b.items()) - row.c)) for row in rows]
        if states == [row.state for row in rows]:
            return x[:len(g)]
        for row, state in zip(rows, states):
            row.state = state
    raise ArithmeticError('the sets do not settle')


def solve(scene):
    """The contact nodes with their forces, the strain energy [N mm], the largest displacement [mm]."""
    free = {i: k for k, i in enumerate(i for i in range(len(scene.f)) if i not in scene.held)}
    K = [[scene.K[i][j] for j in free] for i in free]
    f = [scene.f[i] - sum(scene.K[i][j] * value for j, value in scene.held.items()) for i in free]
    rows = rows_of(scene, free)
    keep = sorted({i for row in rows for i in row.b})
    place = {i: k for k, i in enumerate(keep)}
    for row in rows:
        row.b = {place[i]: value for i, value in row.b.items()}
    S, g, expand = condense(K, f, keep)
    u = dict(scene.held)
    u.update(zip(free, expand(active_set(S, g, rows))))
    values = [u[i] for i in range(len(scene.f))]
    energy = 0.5 * sum(x * sum(k * y for k, y in zip(line, values) if k) for x, line in zip(values, scene.K))
    return scene.contacts, energy, max(math.hypot(*values[i:i + 2]) for i in range(0, len(values), 2))
