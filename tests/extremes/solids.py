"""Solids at their extremes: moduli, slabs, single nodes, loose bodies, friction, Poisson ratios. Two blocks whose meshes do not match."""

import contextlib
import io
import math
import sys
import unittest
from random import Random

from sweep import Extremes, Table, pair

import scenes
from program import SOURCE, new_path, shipped

E = 2.1e5
STEEL = {'Young modulus': repr(E), 'Poisson ratio': '0.3'}
FIXED = {'Displacement ' + d: '0' for d in 'xyz'}


def blocks(low=None, high=None, contact=None, size='10, 10, 10', above='10, 10, 10', cells=('5, 4, 5', '4, 3, 4'), at='0, 10, 0', load=None,
           obstacles=None, **sections):
    """The upper block, held by contact alone with the clamped lower one, pressed unevenly by 10 MPa and pushed in an oblique
    direction by 1 MPa."""
    text = scenes.text(
        materials={'soft': {**STEEL, **(low or {})}, 'hard': {**STEEL, **(high or {})}},
        bodies={'low': {'Size': size, 'Cells': cells[0], 'Material': 'soft'},
                'high': {'Size': above, 'Cells': cells[1], 'Origin': at, 'Material': 'hard'}},
        supports={'floor': {'Boundary': 'low/bottom', **FIXED}},
        tractions={'load': {'Boundary': 'high/top', 'Traction x': '0.8', 'Traction z': '0.6', 'Traction y': '-10*(1+x/10)/1.5', **(load or {})}},
        contacts={'joint': {'Slave': 'high/bottom', 'Master': 'low/top', 'Law': 'Coulomb', 'Friction coefficient': '0.3', **(contact or {})}},
        **{'Decomposition': {'Method': 'METIS', 'Subdomains': '4'}, 'Solver': {'Tolerance': '1e-8'}, **sections})
    return scenes.write('solid', '\n'.join(['set Dimension = 3'] + text.split('\n')[1:]))


def dome(rings, error):
    """prm/dome.prm with other rings, its nodes moved at random by so many millimetres."""
    random = Random(1)
    sys.path.insert(0, str(SOURCE / 'meshes'))
    import dome as maker
    maker.RINGS = rings
    text = {}
    for make in (maker.scene, maker.mesh):
        with contextlib.redirect_stdout(io.StringIO()) as stream:
            make()
        text[make.__name__] = stream.getvalue()
    case = new_path('prm')
    for folder in (case, case.parent / 'meshes'):
        folder.mkdir()
    lines = text['mesh'].split('\n')
    first = lines.index('$Nodes') + 2
    for k in range(first, first + int(lines[first - 1])):
        number, *x = lines[k].split()
        lines[k] = ' '.join([number] + [repr(float(c) + error * random.uniform(-1, 1)) for c in x])
    (case.parent / 'meshes' / 'dome.msh').write_text('\n'.join(lines))
    (case / 'dome.prm').write_text(text['scene'])
    return case / 'dome.prm'


ROLLER = """
set Dimension = 3
set Materials = soft
set Bodies = roller
set Obstacles = bed
set Supports = end
set Body forces = weight
set Contacts = joint
subsection Material soft
  set Young modulus = 2e5
  set Poisson ratio = 0.3
end
subsection Body roller
  set Shape = cylinder
  set Radius = 5
  set Length = 5
  set Material = soft
  set Cells around = 24
  set Cells along axis = 2
end
subsection Obstacle bed
  set Shape = half space
  set Point = 0, -5, 0
  set Normal = 0, 1, 0
end
subsection Support end
  set Boundary = roller/back
  set Displacement z = 0
end
subsection Body force weight
  set Bodies = roller
  set Force y = -1
  set Force z = 0.05
end
subsection Contact joint
  set Slave = roller/side
  set Master = bed
  set Law = frictionless
end
subsection Decomposition
  set Method = METIS
  set Subdomains = 12
  set Seed = 6
end
subsection Solver
  set Tolerance = 1e-8
end
"""


class Solids(Extremes):

    def balanced(self, result):
        for found, expected in zip(pair(result)['force'], (-80, 1000, -60)):
            self.near(found, expected, 1e-6)

    def test_stiffness_ratio(self):
        table = Table('stiffness of the upper block over that of the lower one')
        pressure = {}
        for power in (-6, -3, 0, 3, 6):
            result = self.converges(table, '1e{}'.format(power), blocks(high={'Young modulus': repr(E * 10.**power)}), most=250)
            self.balanced(result)
            pressure[power] = pair(result)['max_pressure']
        self.near(pressure[3], pressure[6], 1e-2)
        self.near(pressure[-3], pressure[-6], 1e-2)

    def test_friction_coefficient(self):
        table = Table('friction coefficient; the push needs 0.1')
        for mu in (0.15, 1, 10):
            result = self.converges(table, mu, blocks(contact={'Friction coefficient': repr(mu)}), most=250)
            self.balanced(result)
        for mu in (0, 1e-6):
            self.ends(4, table, mu, blocks(contact={'Friction coefficient': repr(mu)}), 'body high: translation along (0.8, 0')
        for mu in (0.05, 0.09, 0.099):  # it turns while it slides
            self.ends(4, table, mu, blocks(contact={'Friction coefficient': repr(mu)}), 'body high: rotation about')

    def test_poisson_ratio(self):
        table = Table('Poisson ratio')
        for nu in (0, 0.3, 0.49, 0.4999):
            for element in ('standard', 'nearly incompressible')[nu > 0.495:]:  # standard ones lock
                material = {'Poisson ratio': repr(nu)}
                result = self.converges(table, '{} {}'.format(nu, element), blocks(low=material, high=material),
                                        {'Discretization/Element': element}, most=400)
                self.balanced(result)

    def test_slabs(self):
        table = Table('aspect ratio of the upper body, cells along')
        for aspect, cells in ((10, '10, 2, 10'), (100, '20, 1, 20')):
            side, height = 10., 10. / aspect
            scene = blocks(above='{0}, {1}, {0}'.format(side, height), cells=('8, 4, 8', cells))
            for seed in (0, 3):  # 100: sets of seed 6 wander for 740 multiplications (doc/status.md)
                result = self.converges(table, '{} seed {}'.format(aspect, seed), scene, {'Decomposition/Seed': seed}, most=400)
                self.balanced(result)

    def test_driven_roller(self):
        """Its weight drives a roller that nothing else holds onto its bed: it stops where the first gap closes."""
        case = new_path('roller.prm')
        case.write_text(ROLLER)
        result = self.converges(Table('roller on a half space'), 'driven', case, most=100)
        contact, volume = pair(result), 12 * 5**2 * math.sin(math.radians(15)) * 5  # a prism of 24 sides
        self.near(contact['normal_force'], volume, 1e-6)

    def test_forces_that_are_not_unique(self):
        """Stones that stand on the seat and against each other by one edge: 72 of 648 rows depend on others."""
        table = Table('dome at other tolerances')
        for tolerance in (1e-5, 1e-6, 3e-7, 1e-7, 1e-8, 1e-9):
            self.converges(table, tolerance, shipped('dome'), {'Solver/Tolerance': tolerance}, most=300)

    def test_nodes_that_nearly_meet(self):
        """Four stones, meshed one by one, meet at a point: their gaps contradict each other."""
        table = Table('dome of three rings, largest error of node positions [mm]')
        energies = []
        for error in (0, 1e-7, 1e-5):
            result = self.converges(table, error, dome(rings=3, error=error), {'Solver/Tolerance': '1e-8'}, most=500)
            self.assertEqual('contradict each other' in result.stdout, error > 0)
            energies.append(result.summary['results']['strain_energy'])
        for energy in energies[1:]:
            self.near(energy, energies[0], 1e-4)

    def test_one_node(self):
        """A ball without friction that touches in one node."""
        table = Table('ball on one node')
        ball = blocks(contact={'Slave': 'high/surface', 'Law': 'frictionless'}, load={'Boundary': 'high/surface where y > 19', 'Traction x': '0',
                                                                                     'Traction z': '0', 'Traction y': '-1e-3'})
        text = ball.read_text().replace('  set Size     = 10, 10, 10\n  set Cells    = 4, 3, 4\n  set Origin   = 0, 10, 0\n', '')
        begin = text.index('subsection Body high')
        end = text.index('end\n', begin)
        text = text[:begin] + 'subsection Body high\n  set Shape = ball\n  set Center = 5, 15.0, 5\n  set Radius = 5\n  set Cells around = 16\n' \
            '  set Material = hard\n' + text[end:]
        case = new_path('ball.prm')
        case.write_text(text)
        result = self.converges(table, 'ball', case, most=1000)  # many: see doc/status.md
        self.assertEqual(pair(result)['contact_nodes'], 1)


if __name__ == '__main__':
    unittest.main()
