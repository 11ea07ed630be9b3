"""What a new user tries first, against closed forms: a pin in its hole, two plates, a wedge driven in ten steps, an O-ring, meshes of
other tools. The shrink fit (Lame) and two gear flanks (Hertz) are in curves.py."""

import math
import unittest

import scenes
from curves import lattice
from program import SOURCE, converged, solve

YOUNG, POISSON = 2.1e5, 0.3
STEEL = {'Young modulus': str(YOUNG), 'Poisson ratio': str(POISSON)}
NONE = {'Method': 'none'}
QUIET = {'Output/VTU': 'false'}


def pairs(result, step=-1):
    return {pair['pair']: pair for pair in result.summary['steps'][step]['contact']}


class Pin(unittest.TestCase):

    def test_hertz(self):
        """The pressed arc is small beside the radii, 10 and 10.5 mm; the load is that of half its width of 1.5 mm."""
        modulus, radius, half = YOUNG / 2 / (1 - POISSON ** 2), 10 * 10.5 / 0.5, 1.5
        load = math.pi * modulus * half ** 2 / 4 / radius
        largest = 2 * load / math.pi / half
        case = scenes.box(
            'pin', plane_state='plane strain', materials={'steel': STEEL}, Decomposition=NONE, bodies={
                'pin': {'Shape': 'disc', 'Radius': '10', 'Cells along arc': '200', 'Material': 'steel'},
                'plate': {'Shape': 'ring', 'Center': '0, 0.5', 'Inner radius': '10.5', 'Radius': '60', 'Cells': '240, 40', 'Material': 'steel'}},
            supports={'middle': {'Body': 'pin', 'Point': '0, 0', 'Displacement x': '0', 'Displacement y': '0'},
                      'upright': {'Body': 'pin', 'Point': '0, 10', 'Displacement x': '0'},
                      'guide': {'Body': 'plate', 'Point': '0, 60.5', 'Displacement x': '0'}},
            tractions={'pull': {'Boundary': 'plate/outer', 'Traction y': '{!r}'.format(load / (2 * math.pi * 60))}},
            contacts={'bearing': {'Slave': 'plate/inner', 'Master': 'pin/arc', 'Law': 'frictionless'}})
        for degree in (1, 2):
            with self.subTest(degree=degree):
                result = converged(case, {**QUIET, 'Discretization/Degree': degree, 'Body pin/Refine towards': 'arc',
                                          'Body pin/Refine levels': 2 - degree, 'Body plate/Refine towards': 'inner',
                                          'Body plate/Refine levels': 2 - degree})
                bearing = pairs(result)['bearing']
                self.assertAlmostEqual(bearing['force'][1] / -load, 1, delta=1e-3)  # the plate leans on the pin
                self.assertAlmostEqual(bearing['max_pressure'] / largest, 1, delta=0.02)
                self.assertAlmostEqual(bearing['contact_length'] / (2 * half), 1, delta=0.12)  # an element at either end


class Plates(unittest.TestCase):

    def case(self, shear):
        held = {'Boundary': 'lower/bottom', 'Displacement y': '0'}
        return scenes.box('plates', materials={'steel': STEEL}, Decomposition=NONE, bodies={
            'lower': {'Size': '20, 4', 'Cells': '20, 4', 'Material': 'steel'},
            'upper': {'Origin': '0, 4', 'Size': '20, 4', 'Cells': '27, 5', 'Material': 'steel'}},
            supports={'ground': {**held, 'Displacement x': '0'} if shear else held, 'corner': {'Body': 'lower', 'Point': '0, 0', 'Displacement x': '0'}},
            tractions={'press': {'Boundary': 'upper/top', 'Traction y': '-10', 'Traction x': str(shear)}},
            contacts={'joint': {'Slave': 'upper/bottom', 'Master': 'lower/top', 'Law': 'Coulomb', 'Friction coefficient': '0.2'}})

    def test_uniform_pressure(self):
        result = converged(self.case(0), {**QUIET, 'Solver/Tolerance': '1e-10'})
        self.assertEqual({row['status'] for row in result.contact}, {'stick'})
        for row in result.contact:
            self.assertAlmostEqual(row['pressure'], 10, delta=1e-7)
        down, aside = 10 / YOUNG * 8, POISSON * 10 / YOUNG * 20
        self.assertAlmostEqual(result.summary['results']['max_displacement'] / math.hypot(down, aside), 1, delta=1e-8)

    def test_friction_bears_its_coefficient_times_the_load(self):
        joint = pairs(converged(self.case(0.97 * 2), QUIET))['joint']
        for found, wanted in zip(joint['force'], (-0.97 * 0.2 * 200, 200)):
            self.assertAlmostEqual(found / wanted, 1, delta=1e-4)
        beyond = solve(self.case(1.03 * 2), QUIET)
        self.assertEqual(beyond.status, 4, beyond)
        self.assertIn('body upper: translation along (', beyond.stderr)


class Wedge(unittest.TestCase):
    ANGLE, FRICTION = math.radians(10), 0.1  # half of that between the flanks; less than its tangent: it does not jam

    def case(self):
        tangent, cosine, sine = (f(self.ANGLE) for f in (math.tan, math.cos, math.sin))
        mesh = lattice('wedge.msh', lambda u, v: ((2 + 10 * u * tangent) * (2 * v - 1), 10 * u), 16, 8, ('left', 'right'))
        return scenes.box('wedge', materials={'steel': STEEL}, Decomposition=NONE,
                          bodies={'wedge': {'Shape': 'mesh', 'File': str(mesh), 'Material': 'steel'}},
                          obstacles={side: {'Shape': 'half plane', 'Point': '{}, 0'.format(2 * sign), 'Normal': '{!r}, {!r}'.format(-sign * cosine, sine)}
                                     for side, sign in (('left flank', -1), ('right flank', 1))},
                          tractions={'ram': {'Boundary': 'wedge/* where y > 9.99', 'Pressure': '5*min(t, 20-t)'}},
                          contacts={side: {'Slave': 'wedge/' + side, 'Master': side + ' flank', 'Law': 'Coulomb',
                                           'Friction coefficient': str(self.FRICTION)} for side in ('left', 'right')},
                          **{'Load steps': {'Factors': '1:1:19'}})

    def test_driven_in_ten_steps_and_drawn_back(self):
        """The force at the ram is 2 N (sin a + mu cos a) inwards, and 2 N (sin a - mu cos a) when all slips back."""
        result = converged(self.case(), {**QUIET, 'Solver/Tolerance': '1e-8'})
        sine, rubbed = math.sin(self.ANGLE), self.FRICTION * math.cos(self.ANGLE)
        n_back = 0
        for step, row in enumerate(result.rows('history.csv')):
            ram, normal = -row['traction ram Fy'], [side['normal_force'] for side in pairs(result, step).values()]
            self.assertAlmostEqual(ram / (5 * min(row['t'], 20 - row['t']) * 2 * (2 + 10 * math.tan(self.ANGLE))), 1, delta=1e-9)
            self.assertAlmostEqual(normal[0] / normal[1], 1, delta=1e-5)
            inwards, back = (ram / (2 * (sine + sign * rubbed)) for sign in (1, -1))
            if row['t'] <= 10:
                self.assertAlmostEqual(normal[0] / inwards, 1, delta=1e-5)
            elif all(side['stick_nodes'] == 0 for side in pairs(result, step).values()):
                n_back += 1
                self.assertAlmostEqual(normal[0] / back, 1, delta=1e-5)
            else:  # friction turns round
                self.assertTrue(inwards < normal[0] < back, (step, normal, inwards, back))
        self.assertGreaterEqual(n_back, 2)


class ORing(unittest.TestCase):

    def test_section_between_two_plates(self):
        """Rubber, plane strain: half width of Hertz and way of the plates (Johnson, Contact mechanics, 5.57)."""
        young, poisson, radius, force = 5, 0.49, 2.65, 0.2
        compliance = (1 - poisson ** 2) / (math.pi * young)
        half = math.sqrt(4 * force * radius * compliance)
        way = force * compliance * (2 * math.log(4 * radius / half) - 1)  # of each
        case = scenes.box(
            'ring', plane_state='plane strain', materials={'rubber': {'Young modulus': young, 'Poisson ratio': poisson}}, Decomposition=NONE,
            bodies={'ring': {'Shape': 'disc', 'Radius': radius, 'Cells along arc': '160', 'Refine towards': 'arc', 'Refine levels': '2',
                             'Material': 'rubber'}},
            supports={'middle': {'Body': 'ring', 'Point': '0, 0', 'Displacement x': '0', 'Displacement y': '0'},
                      'upright': {'Body': 'ring', 'Point': '0, {}'.format(radius), 'Displacement x': '0'}},
            obstacles={'floor': {'Shape': 'half plane', 'Point': '0, -{}'.format(radius), 'Normal': '0, 1'},
                       'lid': {'Shape': 'half plane', 'Point': '0, {}'.format(radius), 'Normal': '0, -1'}},
            contacts={'below': {'Slave': 'ring/arc', 'Master': 'floor', 'Law': 'frictionless', 'Offset': '-{!r}'.format(way)},
                      'above': {'Slave': 'ring/arc', 'Master': 'lid', 'Law': 'frictionless', 'Offset': '-{!r}'.format(way)}},
            Discretization={'Element': 'nearly incompressible'})
        result = converged(case, QUIET)
        for pair in pairs(result).values():
            self.assertAlmostEqual(pair['normal_force'] / force, 1, delta=0.02)
            self.assertAlmostEqual(pair['max_pressure'] / (2 * force / math.pi / half), 1, delta=0.02)
            self.assertAlmostEqual(pair['contact_length'] / (2 * half), 1, delta=0.12)


class OtherTools(unittest.TestCase):

    def test_uniform_pressure_on_a_rigid_floor(self):
        """A block of 2 x 1 mm by its names in Abaqus' format and .unv, by its numbers in .vtk, with and without mid nodes."""
        for file, part, foot, top in (('gmsh_curved.inp', 'block', 'foot', 'top_side'), ('gmsh.unv', 'block', 'foot', 'top_side'),
                                      ('gmsh_curved.unv', 'block', 'foot', 'top_side'), ('gmsh.vtk', '3', '1', '2'),
                                      ('gmsh_curved.vtk', '3', '1', '2')):
            case = scenes.box(
                'block', materials={'steel': STEEL}, Decomposition=NONE,
                bodies={'block': {'Shape': 'mesh', 'File': str(SOURCE / 'tests' / 'mesh' / 'meshes' / file), 'Part': part, 'Material': 'steel'}},
                supports={'corner': {'Body': 'block', 'Point': '0, 0', 'Displacement x': '0'}},
                obstacles={'floor': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}},
                tractions={'press': {'Boundary': 'block/' + top, 'Pressure': '10'}},
                contacts={'foot': {'Slave': 'block/' + foot, 'Master': 'floor', 'Law': 'frictionless'}})
            for degree in (1, 2):
                with self.subTest(file=file, degree=degree):
                    result = converged(case, {**QUIET, 'Solver/Tolerance': '1e-10', 'Discretization/Degree': degree})
                    for row in result.contact:
                        self.assertAlmostEqual(row['pressure'], 10, delta=1e-7)
                    largest = 10 / YOUNG * math.hypot(1, 2 * POISSON)
                    self.assertAlmostEqual(result.summary['results']['max_displacement'] / largest, 1, delta=1e-8)


if __name__ == '__main__':
    unittest.main()
