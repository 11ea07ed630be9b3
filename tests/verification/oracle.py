"""The fewest multiplications with which any fixed tolerance delivers a total error within 5 % of that at 1e-10: the least that
Tolerance = auto could need if it knew the errors. The discretisation error is the estimate at 1e-10 (its effectivity:
doc/accuracy.md), the algebraic one the energy norm of the distance to the displacement at 1e-10, summed over the subdomains of
the .vtu files by code of its own. Standard library only."""

import math
import re

import measured  # noqa: F401  the path of tests/cases
import fields
from program import converged, shipped, solve

TOTAL = 1.05
# total^2 = discretisation^2 + algebraic^2
PART = math.sqrt(TOTAL**2 - 1)
STEPS_PER_DECADE = 4
FIRST, LAST = 0.5, 1e-8
GAUSS = ((1 - 1 / math.sqrt(3)) / 2, (1 + 1 / math.sqrt(3)) / 2)


def sections(path, kind):
    """{name: {key: value}} of the subsections `kind name` of a .prm."""
    text = path.read_text() if hasattr(path, 'read_text') else open(path).read()
    return {name.strip(): dict(re.findall(r'^\s*set ([\w ]+?)\s*= *(.*?)\s*$', content, re.M))
            for name, content in re.findall(r'^subsection {} (.+?)\n(.*?)^end'.format(kind), text, re.M | re.S)}


def materials(case):
    """Of every body: (sigma : epsilon as a, b, g of tests/verification/energy.py, thickness)."""
    text = re.sub(r'\\\n', ' ', open(case).read())
    is_strain = re.search(r'^set Plane state\s*= *plane strain', text, re.M) is not None
    names = re.search(r'^set Bodies\s*= *(.*)$', text, re.M).group(1).split(',')
    found, bodies = sections(case, 'Material'), sections(case, 'Body')
    result = []
    for name in names:
        body = bodies[name.strip()]
        material = found[body['Material']]
        modulus, ratio = float(material['Young modulus']), float(material['Poisson ratio'])
        if is_strain:
            modulus, ratio = modulus / (1 - ratio**2), ratio / (1 - ratio)
        a = modulus / (1 - ratio**2)
        result.append((a, ratio * a, modulus / (2 * (1 + ratio)), float(body.get('Thickness', 1))))
    return result


def squared(points, values, material):
    """Energy of a triangle or quadrilateral (its corners) with these nodal displacements."""
    a, b, g, thickness = material
    places = ((1 / 3, 1 / 3, 0.5),) if len(points) == 3 else tuple((x, y, 0.25) for x in GAUSS for y in GAUSS)
    total = 0.
    for x, y, weight in places:
        slopes = ((-1, -1), (1, 0), (0, 1)) if len(points) == 3 else ((y - 1, x - 1), (1 - y, -x), (y, x), (-y, 1 - x))
        j = [[sum(s[k] * p[i] for s, p in zip(slopes, points)) for k in (0, 1)] for i in (0, 1)]
        d = [[sum(s[k] * v[i] for s, v in zip(slopes, values)) for k in (0, 1)] for i in (0, 1)]
        area = j[0][0] * j[1][1] - j[0][1] * j[1][0]
        ux, uy = ((d[i][0] * j[1][1] - d[i][1] * j[1][0]) / area for i in (0, 1))
        uxy, vxy = ((d[i][1] * j[0][0] - d[i][0] * j[0][1]) / area for i in (0, 1))
        exx, eyy, gxy = ux, vxy, uxy + uy
        total += weight * abs(area) * thickness * (a * (exx**2 + eyy**2) + 2 * b * exx * eyy + g * gxy**2)
    return total


def displacements(directory):
    """Of the last step, piece by piece: points, displacement, cells (corners), body of each."""
    pvd = (directory / 'solution.pvd').read_text()
    last = re.findall(r'file="([^"]*)"', pvd)[-1]
    result = []
    for piece in re.findall(r'Piece Source="([^"]*)"', (directory / last).read_text()):
        arrays = fields.read_vtu(directory / last.rpartition('/')[0] / piece if '/' in last else directory / piece)
        nodes, begin, cells = [n[0] for n in arrays['connectivity']], 0, []
        for (end,), (kind,) in zip(arrays['offsets'], arrays['types']):
            cells.append(nodes[begin:begin + (3 if kind in (5, 22) else 4)])
            begin = end
        result.append((arrays['Points'], arrays['displacement'], cells, [round(b[0]) for b in arrays['body']]))
    return result


def norm(one, other, of_bodies):
    """Energy norm of the difference (other: None for zero), jumps between subdomains left out."""
    total = 0.
    for k, (points, u, cells, bodies) in enumerate(one):
        v = other[k][1] if other else None
        for cell, body in zip(cells, bodies):
            values = [tuple(u[n][i] - (v[n][i] if v else 0.) for i in (0, 1)) for n in cell]
            total += squared([points[n] for n in cell], values, of_bodies[body])
    return math.sqrt(total)


def least(name, overrides, say=lambda text: None):
    """Multiplications at 1e-8, with auto, with the ladder (none: no tolerance will do), the least of these two; algebraic
    errors over the estimate of auto and ladder."""
    case = shipped(name)
    run = lambda tolerance: solve(case, {**overrides, 'Solver/Tolerance': tolerance}, ranks=1)
    count = lambda result: result.summary['solver']['hessian_multiplications']
    reference = converged(case, {**overrides, 'Solver/Tolerance': '1e-10'})
    field, of_bodies = displacements(reference.directory), materials(case)
    size = norm(field, None, of_bodies)
    estimate = reference.summary['error']['estimate_energy_relative']
    part = lambda result: norm(displacements(result.directory), field, of_bodies) / size / estimate
    auto = run('auto')
    shares = {'1e-8': count(run('1e-8')), 'auto': count(auto), 'part of auto': part(auto), 'ladder': None, 'part': math.inf}
    tolerance, before = FIRST, None
    while tolerance >= LAST * 0.99:
        result = run('{:.4g}'.format(tolerance))
        if result.status == 0 and count(result) != before:
            before = count(result)
            at = part(result)
            say('{} {:.1e}: {} multiplications, algebraic error {:.2f} of the estimate'.format(name, tolerance, before, at))
            if at <= PART:
                shares.update(ladder=before, tolerance=tolerance, part=at)
                break
        tolerance /= 10**(1 / STEPS_PER_DECADE)
    shares['least'] = min(count for count, at in ((shares['auto'], shares['part of auto']),
                                                  (shares['ladder'] or math.inf, shares['part']),
                                                  (shares['1e-8'], 0)) if at <= PART)
    return shares


if __name__ == '__main__':
    import sys
    from program import SOURCE
    scenes = re.search(r'^SCENES = (\{.*?\]\})$', open(str(SOURCE / 'scripts' / 'verification')).read(), re.M | re.S).group(1)
    for name, variants in eval(scenes).items():
        for more in variants:
            if len(sys.argv) > 1 and name not in sys.argv[1:]:
                continue
            print(name, more, least(name, more, lambda text: print('   ', text, flush=True)), flush=True)
