"""The verification cases (doc/verification.md): every function solves one and returns what is compared with its closed
form or published figure. Used by the tests beside it, on small meshes, and by scripts/verification on fine ones.
Lengths in mm, moduli and tractions in MPa, forces in N for a thickness of 1 mm. Errors are relative unless they say
elements."""

import bisect
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / 'cases'))

import energy  # noqa: E402
import scenes  # noqa: E402
from program import converged, shipped, solve  # noqa: E402

QUIET = {'Output/VTU': 'false'}
# Every answer passes the checks that slipstick makes of it and prints; here they are compared with limits.
CHECKS = {'interface_jump': 1e-6, 'penetration': 1e-5, 'complementarity': 1e-5, 'friction_bound': 1e-5,
          'force_balance': 1e-6, 'moment_balance': 1e-6}


# Settings of every run, the last word; with them answers need not meet CHECKS (presets of Accuracy: doc/accuracy.md).
OVERRIDES = {}
RANKS = 2


def checked(case, overrides=None, vtu=False):
    result = converged(case, {**({} if vtu else QUIET), **(overrides or {}), **OVERRIDES}, ranks=RANKS)
    if OVERRIDES:
        return result
    for name, limit in CHECKS.items():
        value = result.summary['residuals'][name]
        if value is None or not value < limit:
            raise AssertionError('{} {} above {}\n{}'.format(name, value, limit, result))
    return result


def cost(result):
    summary = result.summary
    return {'unknowns': summary['problem']['primal_dofs'], 'products': summary['solver']['hessian_multiplications'],
            'products_of_steps': [step['hessian_multiplications'] for step in summary['steps']],
            'time': summary['time_s']['total'], 'memory': summary['memory_mb']['peak_total']}


def integral(f, nodes):
    """Of f(value, x) along the polygon through nodes (x, value), by Gauss points of every piece."""
    total = 0
    for (x0, v0), (x1, v1) in zip(nodes, nodes[1:]):
        for t, weight in energy.GAUSS:
            total += weight * (x1 - x0) * f(v0 + t * (v1 - v0), x0 + t * (x1 - x0))
    return total


def l2_error(nodes, exact):
    """Relative error in L2 of a nodal function, linear between the nodes, over all of them."""
    return math.sqrt(integral(lambda v, x: (v - exact(x))**2, nodes) / integral(lambda v, x: exact(x)**2, nodes))


def root(x):
    return math.sqrt(max(0., x))


# Hertz

class Hertz:
    """Closed form for two half planes, plane strain, Poisson ratio 0.3."""

    def __init__(self, radius, force, moduli):
        compliance = sum(0.91 / modulus for modulus in moduli)
        self.a = math.sqrt(4 * force * radius * compliance / math.pi)
        self.p0 = 2 * force / (math.pi * self.a)

    def pressure(self, x):
        return self.p0 * root(1 - (x / self.a)**2)


def fitted_half_width(nodes):
    """From p^2 = p0^2 (1 - x^2 / a^2), least squares over the nodes above a fifth of the largest pressure: it is not
    rounded to whole nodes as the length of the contact is."""
    largest = max(p for x, p in nodes)
    pairs = [(x * x, p * p) for x, p in nodes if p > largest / 5]
    mean = [sum(values) / len(pairs) for values in zip(*pairs)]
    slope = (sum((x - mean[0]) * (p - mean[1]) for x, p in pairs) / sum((x - mean[0])**2 for x, p in pairs))
    return math.sqrt(mean[0] - mean[1] / slope)


def cylinder_on_block(exact, overrides):
    result = checked(shipped('hertz'), {'Solver/Tolerance': 1e-8, **overrides})
    pair = result.summary['results']['contact'][0]
    rows = result.contact
    touching = [row['x'] for row in rows if row['pressure'] > 0]
    degree = int(overrides.get('Discretization/Degree', 1))
    h = degree * (touching[-1] - touching[0]) / (len(touching) - 1)  # an element of degree 2 has two intervals
    nodes = [(row['x'], row['pressure']) for row in rows]
    return {'p0': pair['max_pressure'], 'a': pair['contact_length'] / 2, 'fitted_a': fitted_half_width(nodes), 'h': h,
            'across': 2 * exact.a / h, 'p0_error': pair['max_pressure'] / exact.p0 - 1,
            'a_error_elements': (pair['contact_length'] / 2 - exact.a) / h,
            'force_error': sum(p * (b[0] - a[0]) / 2 for a, b in zip(nodes, nodes[1:]) for p in (a[1], b[1])) /
                           (math.pi * exact.a * exact.p0 / 2) - 1,
            'l2_error': l2_error([node for node in nodes if abs(node[0]) < 3 * exact.a], exact.pressure),
            'nodes': nodes, 'exact': exact, **cost(result)}


def both(levels):
    return {'Body cylinder/Refine levels': levels, 'Body block/Refine levels': levels}


def hertz(refinements=0, degree=1, levels=2, cells=40):
    """prm/hertz.prm; @p cells along the arc, those of the block in proportion."""
    n = round(cells * 24 / 40)
    return cylinder_on_block(Hertz(50, 7250, (2.1e5, 2.1e5)),
                             {**both(levels), 'Discretization/Refinements': refinements, 'Discretization/Degree': degree,
                              'Body cylinder/Cells along arc': cells, 'Body block/Cells': '{}, {}'.format(2 * n, n)})


ROLLER = 6.21, 3585.37  # a, p0 as published: Konter 2006


def roller(refinements=0, degree=1):
    """NAFEMS CGS-1: steel cylinder, radius 50, 35 kN/mm, on an aluminium block of 200 x 200."""
    measured = cylinder_on_block(Hertz(50, 35000, (2.1e5, 7e4)),
                                 {**both(2), 'Discretization/Refinements': refinements, 'Discretization/Degree': degree,
                                  'Material block/Young modulus': 7e4, 'Traction load/Pressure': 350,
                                  'Body block/Origin': '-100, -200', 'Body block/Size': '200, 200',
                                  'Body block/Cells': '48, 48'})
    return {**measured, 'a_error': measured['fitted_a'] / ROLLER[0] - 1,
            'a_error_elements': (measured['a'] - ROLLER[0]) / measured['h'], 'p0_error': measured['p0'] / ROLLER[1] - 1}


# Cattaneo-Mindlin

class CattaneoMindlin:
    """P = 1000 N/mm, R' = 50, steel, mu = 0.3; share = Q / (mu P)."""

    def __init__(self, share=0.5):
        self.hertz = Hertz(50, 1000, (2.1e5, 2.1e5))
        self.c = self.hertz.a * math.sqrt(1 - share)

    def traction(self, x):
        a, c = self.hertz.a, self.c
        return 0.3 * self.hertz.p0 * (root(1 - (x / a)**2) - c / a * root(1 - (x / c)**2))


def compared_with_cattaneo_mindlin(result, share, degree):
    exact = CattaneoMindlin(share)
    rows = [row for row in result.contact if row['step'] == 1]
    touching = [row['x'] for row in rows if row['pressure'] > 0]
    stick = [row['x'] for row in rows if row['status'] == 'stick']
    h = degree * (max(touching) - min(touching)) / (len(touching) - 1)
    nodes = sorted((row['x'], abs(row['tangential_traction'])) for row in rows)
    middle = min(nodes, key=lambda node: abs(node[0]))
    return {'h': h, 'across': 2 * exact.hertz.a / h, 'stick': (min(stick), max(stick)), 'c': exact.c,
            'stick_error_elements': max(abs(max(stick) - exact.c), abs(min(stick) + exact.c)) / h,
            'l2_error': l2_error(nodes, exact.traction), 'middle_error': middle[1] / exact.traction(0) - 1,
            'p0_error': max(row['pressure'] for row in rows) / exact.hertz.p0 - 1,
            'shear_error': abs(result.summary['results']['contact'][0]['tangential_force']) / (300 * share) - 1,
            'nodes': nodes, 'exact': exact, **cost(result)}


def cattaneo_mindlin(cells=40, levels=3, degree=1, share=0.5, length=30):
    """Two blocks of 30 x 15 (@p length, its half) with the gap x^2 / 2R' of the half planes of the closed form,
    meshes that do not match; the middle of the upper one is held by contact and friction alone."""
    depth, shear = length / 2, 300 * share
    turned = '{}*x'.format(12 * shear * depth / length**3)  # turns the moment of the shear over both depths back

    def block(y, n, towards):
        return {'Origin': '{}, {}'.format(-length / 2, y), 'Size': '{}, {}'.format(length, depth),
                'Cells': '{}, {}'.format(n, n // 2), 'Refine towards': towards, 'Refine levels': levels,
                'Material': 'elastic'}

    case = scenes.box(
        name='cattaneo_mindlin', plane_state='plane strain',
        materials={'elastic': {'Young modulus': '2.1e5', 'Poisson ratio': '0.3'}},
        bodies={'upper': block(0, cells, 'bottom'), 'lower': block(-depth, round(1.15 * cells), 'top')},
        supports={'begin': {'Body': 'lower', 'Point': '{}, {}'.format(-length / 2, -depth),
                             'Displacement x': '0', 'Displacement y': '0'},
                  'end': {'Body': 'lower', 'Point': '{}, {}'.format(length / 2, -depth), 'Displacement y': '0'}},
        tractions={'above': {'Boundary': 'upper/top', 'Traction x': '{}*max(t-1,0)'.format(shear / length),
                             'Traction y': '{}*min(t,1)+{}*max(t-1,0)'.format(-1000 / length, turned)},
                   'below': {'Boundary': 'lower/bottom', 'Traction x': '{}*max(t-1,0)'.format(-shear / length),
                             'Traction y': '{}*min(t,1)+{}*max(t-1,0)'.format(1000 / length, turned)}},
        contacts={'touch': {'Slave': 'upper/bottom', 'Master': 'lower/top', 'Law': 'Coulomb',
                            'Friction coefficient': '0.3', 'Gap': 'x*x/100'}},
        Discretization={'Degree': degree}, Decomposition={'Method': 'METIS', 'Subdomains': '4'},
        Solver={'Tolerance': '1e-8'}, **{'Load steps': {'Factors': '1, 2'}})
    return compared_with_cattaneo_mindlin(checked(case), share, degree)


def cattaneo_mindlin_cylinders(overrides=None, degree=2):
    """prm/cattaneo_mindlin.prm: two curved bodies."""
    result = checked(shipped('cattaneo_mindlin'), {'Solver/Tolerance': 1e-8, 'Discretization/Degree': degree,
                                                   **(overrides or {})})
    return compared_with_cattaneo_mindlin(result, 0.5, degree)


# Raous

RAOUS_PUBLISHED = {0: 28.6, 1.25: 27.2, 5: 22.8, 7.5: 19.8, 11.25: 15.0}  # u_x [um] by x
RAOUS_CONVERGED = {0: 28.602, 1.25: 27.225, 5: 22.867, 7.5: 19.807, 11.25: 15.413}  # bilinear elements, 128 x 128


def raous(cells=32, degree=1):
    result = checked(shipped('raous'), {'Body block/Cells': '{0}, {0}'.format(cells), 'Discretization/Degree': degree,
                                        'Solver/Tolerance': 1e-8})
    rows = result.contact

    def where(status):
        return [row['x'] for row in rows if row['status'] == status]
    displacement = {x: 1e3 * abs(min(rows, key=lambda row: abs(row['x'] - x))['slip']) for x in RAOUS_PUBLISHED}
    return {'h': 40 / cells, 'u': displacement, 'open': max(where('open')), 'slip': max(where('slip')),
            'stick': min(where('stick')), **cost(result)}


# rigid flat punch

def flat_punch(cells=40, levels=2, degree=1):
    """Half of a block of 40 x 20, drawn against a flat punch of half width 1: its gap is that of a wedge of slope 10
    outside, far above the displacement. @p cells along 20 mm; a multiple of 20 puts the corner on a node."""
    case = scenes.box(
        name='punch', plane_state='plane strain',
        obstacles={'plane': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}},
        bodies={'block': {'Size': '20, 20', 'Cells': '{0}, {0}'.format(cells), 'Refine towards': 'bottom',
                          'Refine levels': levels, 'Material': 'elastic'}},
        supports={'axis': {'Boundary': 'block/left', 'Displacement x': '0'},
                  'far': {'Boundary': 'block/top', 'Displacement y': '-0.01'}},
        contacts={'touch': {'Slave': 'block/bottom', 'Master': 'plane', 'Law': 'frictionless', 'Gap': '10*max(x-1,0)'}},
        Discretization={'Degree': degree}, Decomposition={'Method': 'METIS', 'Subdomains': '4'},
        Solver={'Tolerance': '1e-10'})
    result = checked(case)
    force = 2 * result.summary['results']['contact'][0]['normal_force']
    rows = [(row['x'], row['pressure']) for row in result.contact if row['x'] < 1 - 1e-9]
    errors = [(x, p * math.pi * math.sqrt(1 - x * x) / force - 1) for x, p in rows]
    return {'error': max(abs(e) for x, e in errors if x <= 0.8), 'h': rows[1][0] * degree, 'force': force, 'nodes': rows,
            'last': max(row['x'] for row in result.contact if row['pressure'] > 0), **cost(result)}


# block on an incline

def incline(friction, degree=1):
    """The stack of prm/incline.prm on 20 degrees; every pair with this coefficient."""
    return solve(shipped('incline'), {**QUIET, 'Solver/Tolerance': 1e-9, 'Discretization/Degree': degree,
                                      **{'Contact {}/Friction coefficient'.format(pair): friction
                                         for pair in ('ground', 'lower joint', 'upper joint')}}, ranks=2)


# manufactured solution

WAVE = math.pi / 10


def manufactured_strain(x, y):
    """Of u = (sin k x sin k y, sin 2 k x sin k y) / 1000 on the box of 10 x 10, k = pi / 10: zero on its outline."""
    k = WAVE
    return (1e-3 * k * math.cos(k * x) * math.sin(k * y), 1e-3 * k * math.sin(2 * k * x) * math.cos(k * y),
            1e-3 * (k * math.sin(k * x) * math.cos(k * y) + 2 * k * math.cos(2 * k * x) * math.sin(k * y)))


def manufactured(cells, degree, plane_state='plane strain', method='METIS'):
    """Body force -div sigma of that displacement. Errors: relative, in the energy norm and, at the nodes, in L2."""
    material = energy.Elasticity(1e5, 0.35, plane_state == 'plane strain')
    k, a, b, g = WAVE, material.a, material.b, material.g
    sx, sy, s2x = 'sin({}*x)'.format(k), 'sin({}*y)'.format(k), 'sin({}*x)'.format(2 * k)
    cx, cy, c2x = 'cos({}*x)'.format(k), 'cos({}*y)'.format(k), 'cos({}*x)'.format(2 * k)
    # -(a u_xx + g u_yy + (b + g) v_xy) and -(a v_yy + g v_xx + (b + g) u_xy)
    fx = '{}*{}*{}-({})*{}*{}'.format(1e-3 * k * k * (a + g), sx, sy, 2e-3 * k * k * (b + g), c2x, cy)
    fy = '{}*{}*{}-({})*{}*{}'.format(1e-3 * k * k * (a + 4 * g), s2x, sy, 1e-3 * k * k * (b + g), cx, cy)
    case = scenes.box(
        name='manufactured', plane_state=plane_state,
        bodies={'box': {'Size': '10, 10', 'Cells': '{0}, {0}'.format(cells), 'Material': 'elastic'}},
        supports={'outline': {'Boundary': 'box/*', 'Displacement x': '0', 'Displacement y': '0'}},
        Discretization={'Degree': degree}, Solver={'Tolerance': '1e-10'},
        Decomposition={'Method': method, **({'Subdomains': '5'} if method == 'METIS' else {})})
    case.write_text('set Body forces = source\n' + case.read_text() + 'subsection Body force source\n  set Force x = {}\n'
                    '  set Force y = {}\nend\n'.format(fx, fy))
    result = checked(case, vtu=True)
    field = energy.Field(result.directory, energy.Rectangle((0, 0), (10, 10), (cells, cells)), degree)
    norm = math.sqrt(energy.squared({key: (0, 0) for key in field.values}, field, material, manufactured_strain))
    difference = total = 0
    for (i, j), (u, v) in field.values.items():
        x, y = 10 * i / field.n[0], 10 * j / field.n[1]
        ux, uy = 1e-3 * math.sin(k * x) * math.sin(k * y), 1e-3 * math.sin(2 * k * x) * math.sin(k * y)
        difference += (u - ux)**2 + (v - uy)**2
        total += ux**2 + uy**2
    return {'h': 10 / cells, 'energy_error': energy.error(field, material, manufactured_strain) / norm,
            'nodal_error': math.sqrt(difference / total), **cost(result)}


# receding contact of a layer

def layer(kind, cells, degree, fields=True):
    """Half of a layer of 16 x 2, pressed by a smooth pressure on the middle half of its top; its ends lift off. @p kind:
    on a rigid plane (obstacle), on an equal layer through meshes that match (matching, node to node) or do not (mortar,
    3 cells to 2). No gap before loading, no singular corner: the solution is smooth but for the end of the contact, as
    in a contact of Hertz. For layer_errors(), which compares pressures alone without @p fields."""
    elastic = {'elastic': {'Young modulus': '1e5', 'Poisson ratio': '0.3'}}
    below = {'obstacle': 0, 'matching': cells, 'mortar': cells * 3 // 2}[kind]
    bodies = {'layer': {'Size': '8, 2', 'Cells': '{}, {}'.format(4 * cells, cells), 'Material': 'elastic'}}
    supports = {'axis': {'Boundary': 'layer/left', 'Displacement x': '0'}}
    rectangles = [energy.Rectangle((0, 0), (8, 2), (4 * cells, cells), 0)]
    kinds = {}
    if below:
        bodies['base'] = {'Origin': '0, -2', 'Size': '8, 2', 'Cells': '{}, {}'.format(4 * below, below),
                          'Material': 'elastic'}
        for side, component in (('left', 'x'), ('right', 'x'), ('bottom', 'y')):
            supports['base ' + side] = {'Boundary': 'base/' + side, 'Displacement ' + component: '0'}
        rectangles.append(energy.Rectangle((0, -2), (8, 2), (4 * below, below), 1))
    else:
        kinds['obstacles'] = {'plane': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}}
    case = scenes.box(
        name='layer', plane_state='plane strain', materials=elastic, bodies=bodies, supports=supports,
        tractions={'load': {'Boundary': 'layer/top', 'Pressure': '50*(1+cos(pi*min(x/4,1)))'}},
        contacts={'touch': {'Slave': 'layer/bottom', 'Master': 'base/top' if below else 'plane', 'Law': 'frictionless',
                            'Discretization': {'matching': 'node to node', 'mortar': 'mortar'}.get(kind, 'auto')}},
        Discretization={'Degree': degree}, Decomposition={'Method': 'METIS', 'Subdomains': '4'},
        Solver={'Tolerance': '1e-10'}, **kinds)
    result = checked(case, vtu=fields)
    found = [energy.Field(result.directory, rectangle, degree) for rectangle in rectangles] if fields else []
    return {'h': 2 / cells, 'fields': found, 'strain_energy': result.summary['results']['strain_energy'],
            'nodes': [(row['x'], row['pressure']) for row in result.contact],
            'estimate': result.summary['error']['estimate_energy_relative'], **cost(result)}


LAYER_MATERIAL = energy.Elasticity(1e5, 0.3, True)


def layer_errors(measured, reference):
    """Of one mesh against a finer one that is nested in it, relative: energy norm, displacement (nodes)."""
    pairs = list(zip(measured['fields'], reference['fields'], strict=True))
    squared = sum(energy.distance(a, b, LAYER_MATERIAL) for a, b in pairs)
    difference = total = 0
    for a, b in pairs:
        coarse = a.on(b)
        for key, value in b.values.items():
            difference += sum((x - y)**2 for x, y in zip(coarse[key], value))
            total += sum(y**2 for y in value)
    return {'energy': math.sqrt(squared / (2 * reference['strain_energy'])),
            'displacement': math.sqrt(difference / total)}


def layer_pressure_error(measured, reference):
    """The same in L2 of the pressure."""
    coarse, finer = sorted(measured['nodes']), sorted(reference['nodes'])

    def interpolated(x):
        i = min(max(bisect.bisect([node[0] for node in coarse], x), 1), len(coarse) - 1)
        (x0, p0), (x1, p1) = coarse[i - 1], coarse[i]
        return p0 + (p1 - p0) * (x - x0) / (x1 - x0)
    return math.sqrt(integral(lambda p, x: (p - interpolated(x))**2, finer) / integral(lambda p, x: p * p, finer))
