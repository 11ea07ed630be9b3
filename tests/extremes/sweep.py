"""What the tests of extremes share: scenes, a table of what every run cost and left, and checks of a run's files that do
not rely on what the program says of itself."""

import math
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / 'cases'))

import scenes  # noqa: E402
from program import SOURCE, run, shipped, solve  # noqa: E402,F401

QUIET = {'Output/VTU': 'false'}
RESIDUALS = ('interface_jump', 'penetration', 'complementarity', 'friction_bound', 'tension', 'nodal_equilibrium',
             'force_balance', 'moment_balance')

STEEL = {'Young modulus': '2.1e5', 'Poisson ratio': '0.3'}
FLOOR = {'Boundary': 'base/bottom', 'Displacement x': '0', 'Displacement y': '0'}
SIZE = 10.  # edge of a square [mm]
PRESSURE, SHEAR = 10., 1.  # means over the top of the stack [MPa]


def stack(base=None, box=None, contact=None, cells=(6, 4), load=None, unit=1., thickness=1., force=1., **sections):
    """Two squares, 10 x 10 mm, the upper one (box) held by contact with the clamped lower one (base) alone, pressed
    unevenly by 10 MPa and pushed sideways by 1 MPa. Non-matching when @p cells differ. @p unit: mm in a unit of length,
    @p force: N in a unit of force."""
    length = lambda value: repr(value / unit)
    stress = lambda value: repr(value * unit**2 / force)
    materials = {}
    for name, given in (('soft', base), ('hard', box)):
        given = {**STEEL, **(given or {})}
        materials[name] = {**given, 'Young modulus': stress(float(given['Young modulus']))}
    n_base, n_box = (n if isinstance(n, str) else '{0}, {0}'.format(n) for n in cells)
    size = '{0}, {0}'.format(length(SIZE))
    load = load or {'Traction x': stress(SHEAR),
                    'Traction y': '-{}*(1+x/{})/1.5'.format(stress(PRESSURE), length(SIZE))}
    return scenes.box(
        materials=materials,
        bodies={'base': {'Size': size, 'Cells': n_base, 'Material': 'soft', 'Thickness': length(thickness)},
                'box': {'Origin': '0, ' + length(SIZE), 'Size': size, 'Cells': n_box, 'Material': 'hard',
                        'Thickness': length(thickness)}},
        supports={'floor': FLOOR}, tractions={'load': {'Boundary': 'box/top', **load}},
        contacts={'joint': {'Slave': 'base/top' if cells[0] > cells[1] else 'box/bottom',
                            'Master': 'box/bottom' if cells[0] > cells[1] else 'base/top',
                            'Law': 'Coulomb', 'Friction coefficient': '0.3', **(contact or {})}},
        **{'Decomposition': {'Method': 'METIS', 'Subdomains': '4'}, 'Solver': {'Tolerance': '1e-8'}, **sections})


class Table:
    """A line a run, as it goes: what was asked, the status, multiplications with F, what is left."""

    HEAD = '{:44} {:>6} {:>6} {:>5} {:>9} {:>9}  {}'

    def __init__(self, title):
        print('\n' + title)
        print(self.HEAD.format('', 'status', 'F', 'fall', 'asked', 'residual', 'largest check of the displacement'))

    def add(self, what, result, remark=''):
        if not (result.directory / 'summary.json').exists():
            print(self.HEAD.format(what, result.status, '', '', '', '', remark or first_line(result.stderr)), flush=True)
            return
        summary = result.summary
        solver, residuals = summary['solver'], summary['residuals']
        if summary['status'] == 'no equilibrium':
            print(self.HEAD.format(what, result.status, '', '', '', '', remark or first_line(result.stderr)), flush=True)
            return
        largest = max(RESIDUALS, key=lambda name: math.inf if residuals[name] is None else residuals[name])
        value = residuals[largest]
        print(self.HEAD.format(what, result.status, solver['hessian_multiplications'], solver['fallbacks'],
                               '{:.1e}'.format(solver['tolerance']),
                               '{:.1e}'.format(max(residuals['projected_gradient'], residuals['equality'])),
                               '{} {}  {}'.format(largest, 'not a number' if value is None else '{:.1e}'.format(value),
                                                  remark)), flush=True)


def first_line(text):
    return text.splitlines()[0] if text else ''


def count(result):
    return result.summary['solver']['hessian_multiplications']


def pair(result, name=None):
    pairs = result.summary['results']['contact']
    return pairs[0] if name is None else next(p for p in pairs if p['pair'] == name)


def figures(result):
    """summary.json without what a clock or the machine says."""
    summary = dict(result.summary)
    del summary['time_s'], summary['memory_mb']
    return summary


def audit(result, tolerance, friction=None):
    """Of contact.csv alone: nothing penetrates, nothing pulls, an open gap carries nothing, tractions stay in the cone,
    sliding goes against friction. @return the largest violation, relative to displacement and traction."""
    if 'contact.csv' not in result.files():
        return 0.
    rows = [row for row in result.contact if not math.isinf(row['slip_bound'])]
    if not rows:
        return 0.
    length = max(result.summary['results']['max_displacement'], 1e-3 * max(abs(row['gap']) for row in rows)) or 1.
    stress = max(max(abs(row['pressure']), abs(row['tangential_traction'])) for row in rows) or 1.
    worst = 0.
    for row in rows:
        p, q, gap, slip = (row[name] for name in ('pressure', 'tangential_traction', 'gap', 'slip'))
        work = q * slip if 'traction_z' not in row else sum(row['traction_' + d] * row['slip_' + d] for d in 'xyz')  # per area
        bound = min(row['slip_bound'] if friction is None else friction * max(p, 0.), 2 * stress)
        worst = max(worst, -gap / length, -p / stress, abs(p * gap) / (stress * length), (abs(q) - bound) / stress,
                    (bound * abs(slip) + work) / (stress * length) if bound < math.inf else 0.)
    if not worst <= tolerance:
        raise AssertionError('contact.csv violates the laws of contact by {:.2e}, allowed is {:.0e}\n{}'.format(
            worst, tolerance, result))
    return worst


class Extremes(unittest.TestCase):
    """Of a run: converged with figures that hold, or ended with a status and the words that explain it."""

    def converges(self, table, what, case, overrides=None, checks=1e-5, ranks=1, friction=None, most=None):
        """Status 0, every residual below @p checks, contact.csv within the laws of contact, at most @p most
        multiplications."""
        result = solve(case, {**QUIET, **(overrides or {})}, ranks=ranks)
        table.add(what, result)
        self.assertEqual(result.status, 0, result)
        residuals = result.summary['residuals']
        for name in RESIDUALS:
            self.assertIsNotNone(residuals[name], '{} {}'.format(name, result))
            self.assertLess(residuals[name], checks, '{} of {}\n{}'.format(name, what, result))
        audit(result, checks, friction)
        if most is not None:
            self.assertLessEqual(count(result), most, what)
        return result

    def ends(self, status, table, what, case, *words, overrides=None, ranks=1, without=()):
        """This status, with these words on standard error and a remedy."""
        result = solve(case, {**QUIET, **(overrides or {})}, ranks=ranks)
        table.add(what, result)
        self.assertEqual(result.status, status, result)
        for word in words + ('remedy: ',):
            self.assertIn(word, result.stderr, result)
        for word in without:
            self.assertNotIn(word, result.stderr, result)
        return result

    def near(self, value, expected, part, what=''):
        self.assertLessEqual(abs(value - expected), part * abs(expected), '{} {} {}'.format(what, value, expected))

    def in_balance(self, result, normal=100., tangential=10., part=1e-6, name=None):
        """The joint carries the loads, by statics."""
        carried = pair(result, name)
        self.near(carried['normal_force'], normal, part, 'normal force')
        self.assertLessEqual(abs(abs(carried['tangential_force']) - tangential), part * normal, 'tangential force')
