"""Elements and subdomains from the coarsest to the thinnest: aspect ratios, slivers, H/h, METIS cuts, bodies of one element
and contact edges of one node."""

import math
import unittest

from sweep import FLOOR, STEEL, Extremes, Table, count, pair, scenes, stack

SQUARE = {'Size': '10, 10', 'Cells': '4, 4', 'Material': 'elastic'}
TIGHT = {'Tolerance': '1e-8'}
JOINT = {'Slave': 'box/bottom', 'Master': 'base/top', 'Law': 'Coulomb', 'Friction coefficient': '0.3'}


def layers(height, cells, subdomains, load=None):
    """Two layers of steel, 10 mm wide, the upper one pressed and pushed."""
    size = {'Size': '10, {!r}'.format(height), 'Cells': cells, 'Material': 'steel'}
    return scenes.box(materials={'steel': STEEL},
                      bodies={'base': size, 'box': {**size, 'Origin': '0, {!r}'.format(height)}},
                      supports={'floor': FLOOR},
                      tractions={'load': {'Boundary': 'box/top', 'Traction x': '1', 'Traction y': '-10*(1+x/10)/1.5',
                                          **(load or {})}},
                      contacts={'joint': JOINT}, Decomposition={'Method': 'METIS', 'Subdomains': str(subdomains)},
                      Solver=TIGHT)


def on_circle(cells, **decomposition):
    return scenes.box(bodies={'box': {**SQUARE, 'Cells': cells}}, supports={'held': scenes.HELD},
                      tractions={'pressed': scenes.PRESSED}, contacts={'circle': {**scenes.CIRCLE, 'Slip bound': '150'}},
                      Decomposition=decomposition, Solver=TIGHT)


def fan(n, thinness):
    """Path of a mesh of triangles: the square cut into n strips along x, every strip into slivers whose apex is
    @p thinness of the height above the foot."""
    xs = [10. * i / n for i in range(n + 1)]
    points, triangles, lines = [], [], []

    def node(x, y):
        points.append((x, y))
        return len(points)

    columns = [(node(x, 0.), node(x, 10.)) for x in xs]
    for (a, d), (b, c) in zip(columns, columns[1:]):
        apex = node((points[a - 1][0] + points[b - 1][0]) / 2, 10. * thinness)
        triangles += [(a, b, apex), (b, c, apex), (c, d, apex), (d, a, apex)]
        lines += [(1, a, b), (2, d, c)]
    lines += [(3,) + columns[0], (4,) + columns[-1]]
    elements = ['1 2 {0} {0} {1} {2}'.format(*line) for line in lines]
    elements += ['2 2 9 9 {} {} {}'.format(*triangle) for triangle in triangles]
    path = scenes.new_path('fan.msh')
    path.write_text('\n'.join(
        ['$MeshFormat', '2.2 0 8', '$EndMeshFormat', '$PhysicalNames', '5', '1 1 "bottom"', '1 2 "top"', '1 3 "left"',
         '1 4 "right"', '2 9 "all"', '$EndPhysicalNames', '$Nodes', str(len(points))] +
        ['{} {!r} {!r} 0'.format(i + 1, *x) for i, x in enumerate(points)] +
        ['$EndNodes', '$Elements', str(len(elements))] +
        ['{} {}'.format(i + 1, text) for i, text in enumerate(elements)] + ['$EndElements', '']))
    return path


class Meshes(Extremes):

    def test_thin_layers(self):
        """Bodies as thin as their elements: free subdomains bend (L/h)^3 times as much as the layers yield, so that |Pd| says
        little of the answer, and in the end the last digit of the multipliers bends them by more than the answer; the checks
        take the solver on, and gaps are closed by corrections of the displacement. The energy of thin layers is
        proportional to their height."""
        table = Table('two layers of 10 x 1 elements: aspect ratio, subdomains')
        energy = {}
        for height, subdomains in ((10., 8), (1., 8), (0.1, 8), (0.01, 8), (0.001, 8), (0.01, 2), (0.001, 2), (1e-4, 2),
                                   (1e-4, 4), (1e-4, 8), (1e-4, 20), (1e-5, 2), (1e-5, 8)):
            result = self.converges(table, '{:g}, {}'.format(max(height, 1 / height), subdomains),
                                    layers(height, '10, 1', subdomains))
            self.in_balance(result)
            value = result.summary['results']['strain_energy']
            self.near(value, energy.setdefault(height, value), 1e-6, height)
        self.near(energy[1e-5] / energy[1e-4], 0.1, 1e-5)

    def test_thin_elements(self):
        table = Table('aspect ratio of the elements of a square on a circle')
        for cells, subdomains in (('100, 1', 4), ('1, 100', 4), ('400, 1', 1), ('1, 1000', 1)):
            across, up = (int(n) for n in cells.split(','))
            aspect = max(across, up)
            self.converges(table, '{}, {} subdomains ({} cells)'.format(aspect, subdomains, cells),
                           on_circle(cells, Method='METIS', Subdomains=subdomains))

        table = Table('two bodies of one element each: height [mm], 10 mm wide')
        for height in (1e-3, 1e-2, 1e2, 1e3, 1e5):
            result = self.converges(table, '{:g}'.format(height),
                                    layers(height, '1, 1', 2, {'Traction x': '0'} if height > 10 else {}))
            self.in_balance(result, 100, 0 if height > 10 else 10)

    def test_slivers(self):
        table = Table('slivers: triangles of height over base (largest angle)')
        for thinness in (0.1, 1e-2, 1e-3, 1e-4):
            bodies = {'base': SQUARE, 'box': {'Shape': 'mesh', 'File': str(fan(4, thinness)), 'Material': 'elastic',
                                              'Translation': '0, 10'}}
            case = scenes.box(bodies=bodies, supports={'floor': FLOOR}, contacts={'joint': JOINT},
                              tractions={'load': {'Boundary': 'box/top', 'Traction x': '1',
                                                  'Traction y': '-10*(1+x/10)/1.5'}},
                              Decomposition={'Method': 'METIS', 'Subdomains': '3'}, Solver=TIGHT)
            angle = 2 * math.degrees(math.atan(1.25 / (10 * thinness)))
            self.in_balance(self.converges(table, '{:g} ({:.2f} degrees)'.format(4 * thinness, angle), case))

    def test_refinement_of_subdomains(self):
        table = Table('H/h, 2 x 2 blocks')
        needed = {}
        for n in (1, 2, 5, 10, 20, 50, 100, 200):
            case = scenes.box(supports={'held': scenes.HELD}, tractions={'pressed': scenes.PRESSED},
                              contacts={'circle': {**scenes.CIRCLE, 'Slip bound': '150'}},
                              Decomposition={'Method': 'blocks', 'Blocks': '2', 'Cells per block': str(n)}, Solver=TIGHT)
            needed[n] = count(self.converges(table, str(n), case))
        self.assertLess(needed[200], 3 * needed[20])  # logarithmic in H/h

    def test_subdomains(self):
        """Answers do not depend on the cut; multiplications hardly."""
        table = Table('METIS subdomains of a square on a circle, cells of each')
        energy = {}
        for cells, subdomains in (('16, 16', 1), ('16, 16', 2), ('16, 16', 7), ('16, 16', 16), ('16, 16', 64),
                                  ('16, 16', 256), ('90, 90', 1), ('90, 90', 2000)):
            across, _ = (int(n) for n in cells.split(','))
            result = self.converges(table, '{}, {:g}'.format(subdomains, across**2 / subdomains),
                                    on_circle(cells, Method='METIS', Subdomains=subdomains), most=90)
            problem = result.summary['problem']
            self.assertGreaterEqual(problem['subdomains'], subdomains)
            self.assertEqual(problem['kernel_dimension'], 3 * problem['subdomains'])
            value = result.summary['results']['strain_energy']
            self.near(value, energy.setdefault(cells, value), 1e-6, subdomains)

    def test_bodies_of_one_element(self):
        table = Table('elements of the lower and the upper body')
        for below, above in ((1, 1), (1, 5), (5, 1), (2, 1), (1, 40)):
            for degree in (1, 2):
                case = stack(cells=(below, above), Decomposition={'Method': 'METIS', 'Subdomains': 'auto'},
                             Discretization={'Degree': str(degree)})
                result = self.converges(table, '{}, {}, degree {}'.format(below, above, degree), case)
                self.in_balance(result)
        case = scenes.box(bodies={'box': {**SQUARE, 'Cells': '1, 1'}}, supports={'held': scenes.HELD},
                          tractions={'pressed': scenes.PRESSED}, contacts={'circle': scenes.CIRCLE},
                          Decomposition={'Method': 'none'}, Solver=TIGHT)
        result = self.converges(table, 'one on a circle, one of its nodes held', case)
        self.assertEqual(len(result.contact), 2)  # the node that the support holds is listed, too
        self.ends(2, table, 'more subdomains than elements', stack(cells=(1, 1)), 'more than the 2 cells')

    def test_contact_edges_of_one_node(self):
        """A body that stands on the last of its edges, or a part of it: all its weight goes through one or two nodes."""
        table = Table('overlap of two squares [mm]')
        for overlap in (2.5, 1., 0.1, 1e-3, 1e-6, 1e-9):
            case = scenes.box(bodies={'base': SQUARE, 'box': {**SQUARE, 'Origin': '{!r}, 10'.format(10 - overlap)}},
                              supports={'floor': FLOOR, 'side': {'Boundary': 'box/right', 'Displacement x': '0'},
                                        'end': {'Body': 'box', 'Point': '{!r}, 10'.format(20 - overlap),
                                                'Displacement y': '0'}},
                              tractions={'load': {'Boundary': 'box/top', 'Traction y': '-10'}}, contacts={'joint': JOINT},
                              Decomposition={'Method': 'METIS', 'Subdomains': '2'}, Solver=TIGHT)
            result = self.converges(table, '{:g}'.format(overlap), case)
            self.assertGreater(pair(result)['normal_force'], 10)
            self.assertLess(pair(result)['normal_force'], 100)
        one = scenes.box(bodies={'base': {**SQUARE, 'Cells': '1, 1'}, 'box': {**SQUARE, 'Cells': '1, 1', 'Origin': '0, 10'}},
                         supports={'floor': FLOOR, 'right': {'Boundary': 'box/right', 'Displacement x': '0',
                                                             'Displacement y': '0'}},
                         tractions={'load': {'Boundary': 'box/top', 'Traction y': '-10'}}, contacts={'joint': JOINT},
                         Decomposition={'Method': 'none'}, Solver=TIGHT)
        result = self.converges(table, 'one edge, one of its nodes held', one)
        self.assertGreater(pair(result)['normal_force'], 10)
        self.ends(2, table, '0: corner on corner',
                  scenes.box(bodies={'base': SQUARE, 'box': {**SQUARE, 'Origin': '10, 10'}},
                             supports={'floor': FLOOR, 'right': {'Boundary': 'box/right', 'Displacement x': '0'}},
                             contacts={'joint': JOINT}, Decomposition={'Method': 'METIS'}), 'do not meet', 'touch in single points',
                  without=('0 mm apart',))


if __name__ == '__main__':
    unittest.main()
