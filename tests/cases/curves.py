"""Contact of arcs: shrink fits, a pin with clearance and gear flanks, nodes that do not match, against Lame and Hertz."""

import math
import unittest

import scenes
from program import converged, new_path

STEEL = """
set Materials = steel
subsection Material steel
  set Young modulus = 2.1e5
  set Poisson ratio = 0.3
end
subsection Solver
  set Tolerance = 1e-8
end
subsection Output
  set VTU = false
end
"""

FIT = STEEL + """
set Plane state = plane stress
set Bodies = shaft, hub
set Supports = centre, no rotation
set Contacts = fit
subsection Body shaft
  set Shape = disc
  set Radius = 20.02
  set Cells along arc = {shaft}
  set Material = steel
end
subsection Body hub
  {hub}
  set Material = steel
end
subsection Support centre
  set Body = shaft
  set Point = 0, 0
  set Displacement x = 0
  set Displacement y = 0
end
subsection Support no rotation
  set Body = shaft
  set Point = 20.02, 0
  set Displacement y = 0
end
subsection Contact fit
  set Slave = hub/inner
  set Master = shaft/arc
  set Law = Coulomb
  set Friction coefficient = 0.15
end
"""
# disc of radius 20.02 in a ring from 20 to 40: interference times E (c^2 - b^2) / (2 b c^2)
LAME = 2.1e5 * 0.02 * (40 ** 2 - 20 ** 2) / (2 * 20 * 40 ** 2)

FLANKS = STEEL + """
set Plane state = plane strain
set Bodies = driver, driven
set Supports = root, push
set Contacts = mesh
subsection Body driver
  set Shape = mesh
  set File = {driver}
  set Material = steel
end
subsection Body driven
  set Shape = mesh
  set File = {driven}
  set Material = steel
end
subsection Support root
  set Boundary = driven/back
  set Displacement x = 0
  set Displacement y = 0
end
subsection Support push
  set Boundary = driver/back
  set Displacement x = 0.02
  set Displacement y = 0
end
subsection Contact mesh
  set Slave = driver/flank
  set Master = driven/flank
  set Law = Coulomb
  set Friction coefficient = 0.1
end
"""


def write(name, text):
    path = new_path(name)
    path.write_text(text)
    return path


def lattice(name, point, n, m, bounds, closed=False, second_order=False):
    """Gmsh 2.2 file of n x m quadrilaterals; point(u, v) in [0, 1]^2, counterclockwise; bounds: name of the sides v = 0 and
    v = 1."""
    step = 2 if second_order else 1
    nodes, number = [], {}

    def node(i, j):
        i = i % (step * n) if closed else i
        if (i, j) not in number:
            number[i, j] = len(nodes) + 1
            nodes.append(point(i / (step * n), j / (step * m)))
        return number[i, j]

    elements = []
    for i in range(n):
        for j in range(m):
            a, b, c, d = step * i, step * (i + 1), step * j, step * (j + 1)
            cell = [node(a, c), node(b, c), node(b, d), node(a, d)]
            if second_order:
                cell += [node(a + 1, c), node(b, c + 1), node(a + 1, d), node(a, c + 1)]
            elements.append('{} 2 9 9 '.format(16 if second_order else 3) + ' '.join(map(str, cell)))
        for k, j in ((1, 0), (2, step * m)):
            elements.append('1 2 {} {} {} {}'.format(k, k, node(step * i, j), node(step * (i + 1), j)))
    lines = ['$MeshFormat', '2.2 0 8', '$EndMeshFormat', '$PhysicalNames', '2', '1 1 "{}"'.format(bounds[0]),
             '1 2 "{}"'.format(bounds[1]), '$EndPhysicalNames', '$Nodes', str(len(nodes))]
    lines += ['{} {!r} {!r} 0'.format(k + 1, x, y) for k, (x, y) in enumerate(nodes)]
    lines += ['$EndNodes', '$Elements', str(len(elements))]
    lines += ['{} {}'.format(k + 1, element) for k, element in enumerate(elements)]
    return write(name, '\n'.join(lines + ['$EndElements', '']))


def hub_mesh(around, across, second_order):
    def point(u, v):
        r, angle = 20 + 20 * v, -2 * math.pi * u
        return r * math.cos(angle), r * math.sin(angle)
    return lattice('hub.msh', point, around, across, ('inner', 'outer'), closed=True, second_order=second_order)


def flank_mesh(radius, side, n, second_order=False):
    """Body on one side of x = 0 with a flank through the origin, +-30 degrees of a circle; finer at the origin."""
    def point(u, v):
        t = 2 * u - 1
        angle = math.pi / 6 * (0.15 * t + 0.85 * t ** 3)
        x, y = radius * (1 - math.cos(angle)), radius * math.sin(angle)
        x += (9 - x) * v ** 1.8
        return side * x, -side * y
    return lattice('flank.msh', point, n, 14, ('flank', 'back'), second_order=second_order)


class Curves(unittest.TestCase):

    def pressure_error(self, hub, shaft, **overrides):
        case = write('fit.prm', FIT.format(hub=hub, shaft=shaft))
        result = converged(case, {key.replace('_', ' '): value for key, value in overrides.items()})
        for name in ('force_balance', 'moment_balance', 'nodal_equilibrium'):
            self.assertLess(result.summary['residuals'][name], 1e-10, name)
        return max(abs(row['pressure'] / LAME - 1) for row in result.contact), result

    def ring(self, around, across):
        return 'set Shape = ring\n set Inner radius = 20\n set Radius = 40\n set Cells = {}, {}'.format(around, across)

    def file(self, around, across, second_order=False):
        return 'set Shape = mesh\n set File = {}'.format(hub_mesh(around, across, second_order))

    def test_shrink_fit_of_built_in_shapes(self):
        for degree, bound in ((1, 2e-3), (2, 1e-3)):
            with self.subTest(degree=degree):
                options = {'Discretization/Degree': degree}
                coarse, _ = self.pressure_error(self.ring(40, 6), 32, **options)
                fine, _ = self.pressure_error(self.ring(80, 12), 64, **options)
                self.assertLess(fine, bound)
                self.assertLess(fine, coarse / 2)

    def test_shrink_fit_of_a_mesh_file(self):
        for second_order in (False, True):
            for degree in (1, 2):
                with self.subTest(second_order=second_order, degree=degree):
                    hub = self.file(40, 6, second_order)
                    options = {'Discretization/Degree': degree}
                    coarse, _ = self.pressure_error(hub, 32, **options)
                    fine, _ = self.pressure_error(hub, 32, **options, **{'Discretization/Refinements': 1})
                    self.assertLess(fine, 2e-3)
                    self.assertLess(fine, coarse / 2)

    def test_polygons_are_wrong_and_warned_of(self):
        case = write('fit.prm', FIT.format(hub=self.ring(80, 12), shaft=64))
        result = converged(case, {'Body hub/Outline': 'polygon', 'Body shaft/Outline': 'polygon'})
        self.assertGreater(max(row['pressure'] for row in result.contact), 1.5 * LAME)
        warnings = [text for text in result.summary['warnings'] if 'from an arc' in text]
        self.assertEqual(len(warnings), 1, result)
        for part in ('Contact fit', 'Outline = smooth', 'edges deviate by'):
            self.assertIn(part, warnings[0])
        smooth = converged(case)
        self.assertFalse([text for text in smooth.summary['warnings'] if 'from an arc' in text])

    def test_chords_are_not_taken_for_bodies_inside_each_other(self):
        text = FIT.format(hub=self.ring(40, 6), shaft=32).replace('20.02', '19.99')
        text = text.replace('Supports = centre', 'Supports = bearing, centre')
        text = text.replace('Point = 0, 0\n  set Displacement x = 0', 'Point = 0, 0\n  set Displacement x = 0.05')
        text += 'subsection Support bearing\n set Boundary = hub/outer\n set Displacement x = 0\n set Displacement y = 0\nend'
        result = converged(write('pin.prm', text))
        self.assertGreater(max(row['pressure'] for row in result.contact), 1)
        self.assertFalse([text for text in result.summary['warnings'] if 'inside body' in text])

    def hertz_error(self, degree, refinements, second_order=False):
        """Error of the pressure in L2 and of its largest value against Hertz with the force that was found."""
        case = write('flanks.prm', FLANKS.format(driver=flank_mesh(15, -1, 40, second_order),
                                                 driven=flank_mesh(20, 1, 46, second_order)))
        result = converged(case, {'Discretization/Degree': degree, 'Discretization/Refinements': refinements})
        force = result.summary['results']['contact'][0]['normal_force']
        modulus, radius = 2.1e5 / 2 / (1 - 0.3 ** 2), 1 / (1 / 15 + 1 / 20)
        largest = math.sqrt(force * modulus / (math.pi * radius))
        half = 2 * force / (math.pi * largest)
        hertz = [largest * math.sqrt(max(0, 1 - (row['y'] / half) ** 2)) for row in result.contact]
        error = sum((row['pressure'] - p) ** 2 for row, p in zip(result.contact, hertz)) / sum(p * p for p in hertz)
        return math.sqrt(error), abs(max(row['pressure'] for row in result.contact) / largest - 1)

    def test_rings_of_thin_cells(self):
        """Cells thin compared with the rise of their arc became straight: 3.2 % of the weight, and 10 % of a displacement, were
        missing without a word."""
        for cells in ('24, 2', '24, 8', '24, 24'):
            ring = scenes.box('ring', plane_state='plane stress', materials={'steel': {'Young modulus': '2.1e5', 'Poisson ratio': '0.3', 'Density': '7.85e-9'}}, bodies={
                'ring': {'Shape': 'ring', 'Inner radius': '8', 'Radius': '10', 'Cells': cells, 'Material': 'steel'}},
                body_forces={'g': {'Bodies': 'ring', 'Acceleration y': '-9810'}},
                supports={'bore': {'Boundary': 'ring/inner', 'Displacement x': '0', 'Displacement y': '0'}},
                Discretization={'Degree': 2}, Decomposition={'Method': 'METIS', 'Subdomains': '3'}, Output={'VTU': 'false'})
            weight = 7.85e-9 * 9810 * math.pi * (10 ** 2 - 8 ** 2)
            for settings in ({}, {'Accuracy': '1 %', 'Goal': 'strain_energy'}):
                results = converged(ring, settings).summary['results']
                self.assertAlmostEqual(results['supports'][0]['force'][1] / weight, 1, delta=1e-4)
                self.assertAlmostEqual(results['strain_energy'] / 4.6071e-12, 1, delta=1e-3)

    def test_gear_flanks(self):
        for degree, second_order in ((1, False), (2, True)):
            with self.subTest(degree=degree, second_order=second_order):
                errors = [self.hertz_error(degree, refinements, second_order) for refinements in (0, 2)]
                self.assertLess(errors[1][0], 0.02, errors)
                self.assertLess(errors[1][1], 0.01, errors)
                self.assertLess(errors[1][0], errors[0][0] / 3, errors)


if __name__ == '__main__':
    unittest.main()
