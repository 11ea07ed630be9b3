"""Scenes that once gave a wrong answer with status 0 and without a word: the right figure now, or a refusal that names what is
wrong. And what loads, supports and contact pairs come to."""

import math
import pathlib
import re
import unittest

import scenes
from program import converged, new_path, run, shipped, solve

STEEL = {'Young modulus': '2.1e5'}
BAR = {'Size': '10, 4', 'Cells': '10, 4', 'Material': 'elastic'}
FLOOR = {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}
TOUCH = {'Slave': 'bar/bottom', 'Master': 'floor', 'Law': 'frictionless'}
PRESSED = {'Boundary': 'bar/top', 'Traction y': '-1'}  # 10 N
NONE = {'Method': 'none'}


def bar(**kinds):
    kinds = {'materials': {'elastic': STEEL}, 'bodies': {'bar': BAR}, 'Decomposition': NONE,
             'contacts': {'touch': TOUCH}, **kinds}
    if any(contact['Master'] == 'floor' for contact in kinds['contacts'].values()):
        kinds.setdefault('obstacles', {'floor': FLOOR})
    return scenes.box('bar', **kinds)


def cells_mesh(name, xs, ys, is_cell, seat):
    """Quadrilaterals of a lattice; boundary 'bottom' is that at ys[0], 'seat' are edges with upward normal where seat(x, y)."""
    nodes, elements = {}, []

    def node(i, j):
        return nodes.setdefault((i, j), len(nodes) + 1)

    for i in range(len(xs) - 1):
        for j in range(len(ys) - 1):
            if is_cell(i, j):
                elements.append('3 2 9 9 {} {} {} {}'.format(node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)))
                if j == 0:
                    elements.append('1 2 1 1 {} {}'.format(node(i, 0), node(i + 1, 0)))
                if not is_cell(i, j + 1) and seat((xs[i] + xs[i + 1]) / 2, ys[j + 1]):
                    elements.append('1 2 2 2 {} {}'.format(node(i, j + 1), node(i + 1, j + 1)))
    lines = ['$MeshFormat', '2.2 0 8', '$EndMeshFormat', '$PhysicalNames', '2', '1 1 "bottom"', '1 2 "seat"', '$EndPhysicalNames',
             '$Nodes', str(len(nodes))]
    lines += ['{} {!r} {!r} 0'.format(k, xs[i], ys[j]) for (i, j), k in nodes.items()]
    lines += ['$EndNodes', '$Elements', str(len(elements))]
    lines += ['{} {}'.format(k + 1, element) for k, element in enumerate(elements)]
    path = new_path(name)
    path.write_text('\n'.join(lines + ['$EndElements', '']))
    return str(path)


def plate_on_slots(cells, degree, exclude_floor=False, **kinds):
    """A plate on a base with slots 3 mm deep, whose floors belong to the same boundary."""
    xs = [0, 2, 4, 4.5, 6, 8, 10, 12, 14, 15.5, 16, 18, 20]
    deep = {i for i in range(len(xs) - 1) if 4.5 <= xs[i] < 6 or 14 <= xs[i] < 15.5}
    base = cells_mesh('base.msh', xs, [-6, -3, 0], lambda i, j: j == 0 or j == 1 and i not in deep,
                      lambda x, y: y == 0 or not exclude_floor)
    return scenes.box('plate', **{'plane_state': 'plane strain', 'materials': {'elastic': STEEL}, 'bodies': {
        'base': {'Shape': 'mesh', 'File': base, 'Material': 'elastic'},
        'plate': {'Origin': '0, 0', 'Size': '20, 2', 'Cells': '{}, 2'.format(cells), 'Material': 'elastic'}},
        'supports': {'base': {'Boundary': 'base/bottom', 'Displacement x': '0', 'Displacement y': '0'}},
        'tractions': {'weight': {'Boundary': 'plate/top', 'Traction y': '-1'}},
        'contacts': {'seat': {'Slave': 'plate/bottom', 'Master': 'base/seat', 'Law': 'Coulomb', 'Friction coefficient': '0.2'}},
        'Discretization': {'Degree': degree}, 'Decomposition': NONE, **kinds})


def two_bars(upper=None, **kinds):
    """Another bar on top of the first, both held on their far sides."""
    held = {'Displacement x': '0', 'Displacement y': '0'}
    return bar(**{'bodies': {'bar': BAR, 'lid': {**BAR, 'Origin': '0, 4', **(upper or {})}},
                  'supports': {'below': {'Boundary': 'bar/bottom', **held}, 'above': {'Boundary': 'lid/top', **held}},
                  'contacts': {'joint': {'Slave': 'bar/top', 'Master': 'lid/bottom'}}, **kinds})


def disc_on_plate(reach, n=1):
    """The force is 42576.9, 42336.1, 42321.5, 42321.5 N for n = 1, 2, 4, 8 (Outline = polygon: 42360, 42279, 42308)."""
    held = {'Displacement x': '0', 'Displacement y': '0'}
    return scenes.box('disc', materials={'elastic': STEEL}, Decomposition=NONE, bodies={
        'disc': {'Shape': 'half disc', 'Center': '0, 10', 'Radius': '10', 'Cells along arc': 64 * n,
                 'Material': 'elastic'},
        'plate': {'Origin': '-10, -5', 'Size': '20, 5', 'Cells': '{}, {}'.format(40 * n, 6 * n), 'Material': 'elastic'}},
        supports={'push': {'Boundary': 'disc/flat', **held, 'Displacement y': '-0.5'},
                  'base': {'Boundary': 'plate/bottom', **held}},
        contacts={'joint': {'Slave': 'disc/arc', 'Master': 'plate/top', 'Reach': reach}})


def shipped_mesh(name):
    return str(pathlib.Path(__file__).parent / name)


def only(found):
    assert len(found) == 1, found
    return found[0]


def force(result, kind='contact', name=0):
    return result.summary['results'][kind][name]['force']


def pressed_bars(cells, contacts=None, **contact):
    """Poisson's ratio 0: every stress is uniform, 10 MPa, whatever the meshes."""
    return two_bars({'Cells': cells}, materials={'elastic': {'Young modulus': '1000', 'Poisson ratio': '0'}},
                    supports={'below': {'Boundary': 'bar/bottom', 'Displacement y': '0'}, 'left': {'Boundary': 'bar/left', 'Displacement x': '0'},
                              'left above': {'Boundary': 'lid/left', 'Displacement x': '0'}},
                    tractions={'press': {'Boundary': 'lid/top', 'Traction y': '-10'}},
                    contacts=contacts or {'joint': {'Slave': 'bar/top', 'Master': 'lid/bottom', **contact}})


def slit_ring(cells=48, layers=3, half_angle=0.001, **kinds):
    """Radii 8 and 10 mm, degree 2; the sides of the slit are bonded to each other."""
    columns = [half_angle + 2 * (math.pi - half_angle) * i / cells for i in range(cells + 1)]
    nodes = ['{} {!r} {!r} 0'.format(1 + i * (layers + 1) + k, r * math.cos(a), r * math.sin(a))
             for i, a in enumerate(columns) for k, r in enumerate(8 + 2 * k / layers for k in range(layers + 1))]

    def node(i, k):
        return 1 + i * (layers + 1) + k

    elements = ['1 2 2 2 {} {}'.format(node(i, layers), node(i + 1, layers)) for i in range(cells)]
    elements += ['1 2 {0} {0} {1} {2}'.format(which, node(i, k), node(i, k + 1)) for which, i in ((3, 0), (4, cells)) for k in range(layers)]
    elements += ['3 2 5 5 {} {} {} {}'.format(node(i, k), node(i, k + 1), node(i + 1, k + 1), node(i + 1, k))
                 for i in range(cells) for k in range(layers)]
    path = new_path('slit_ring.msh')
    path.write_text('\n'.join(
        ['$MeshFormat', '2.2 0 8', '$EndMeshFormat', '$PhysicalNames', '4', '1 2 "outer"', '1 3 "one"', '1 4 "other"', '2 5 "all"',
         '$EndPhysicalNames', '$Nodes', str(len(nodes))] + nodes + ['$EndNodes', '$Elements', str(len(elements))] +
        ['{} {}'.format(number, element) for number, element in enumerate(elements, 1)] + ['$EndElements', '']))
    return scenes.box('ring', plane_state='plane strain', materials={'elastic': {**STEEL, 'Poisson ratio': '0.3'}}, Decomposition=NONE,
                      bodies={'ring': {'Shape': 'mesh', 'File': path, 'Material': 'elastic'}}, Discretization={'Degree': '2'},
                      contacts={'slit': {'Slave': 'ring/one', 'Master': 'ring/other', 'Law': 'bonded'}},
                      tractions={'press': {'Boundary': 'ring/outer', 'Pressure': '10*(1 + 0.2*(x^2 - y^2)/100)'}},
                      supports={'pin': {'Body': 'ring', 'Point': '-10, 0', 'Displacement x': '0', 'Displacement y': '0'},
                                'guide': {'Body': 'ring', 'Point': '-8, 0', 'Displacement y': '0'}}, **kinds)


class Steps(unittest.TestCase):
    """Steps of the master within an edge of the slave."""

    def test_a_plate_over_slots(self):
        """The floor of the slots pulled the gaps beside them to -0.5 mm."""
        for degree in (1, 2):
            for cells in (7, 9, 20):
                u, force = [], []
                for exclude_floor in (False, True):
                    results = converged(plate_on_slots(cells, degree, exclude_floor)).summary['results']
                    u.append(results['max_displacement'])
                    force.append(results['contact'][0]['normal_force'])
                self.assertAlmostEqual(u[0] / u[1], 1, delta=0.02)
                self.assertLess(u[0], 3e-4)
                self.assertAlmostEqual(force[0], 20, delta=0.01)


class Itself(unittest.TestCase):
    """A clip that a load closes beyond its slit of 1 mm, without a pair between its lips."""

    def clip(self, pull, contact=False):
        text = (pathlib.Path(__file__).parent / 'self_clip.prm').read_text().replace('self_clip.msh', shipped_mesh('self_clip.msh'))
        text = text.replace('-0.5*abs(y)/y', pull + '*abs(y)/y')
        if not contact:
            text = re.sub('subsection Contact lips.*?end\\n', '', text.replace('set Contacts = lips\n', ''), flags=re.S)
        path = new_path('clip.prm')
        path.write_text(text)
        return [text for text in converged(str(path)).summary['warnings'] if 'itself' in text]

    def test_a_clip_that_closes(self):
        text = only(self.clip('-5'))
        self.assertIn('body c passes through itself by 1.75 mm after loading, at (11.4', text)
        self.assertIn('declare a contact pair', text)
        self.assertEqual(self.clip('5'), [])
        self.assertEqual(self.clip('-0.05'), [])
        self.assertEqual(self.clip('-5', contact=True), [])


class EndsOfSides(unittest.TestCase):
    """Nodes at the ends of the slave: beyond the master, on a support, at a corner of the body."""

    CLAMP = {'Displacement x': '0', 'Displacement y': '0'}

    def corner_on_plate(self, lifted, slave='plate/top', master='square/bottom', degree='1', turned=10):
        return converged(scenes.box('plate', plane_state='plane strain', materials={'steel': STEEL}, bodies={
            'square': {'Origin': '0, 0', 'Size': '8, 8', 'Cells': '8, 8', 'Rotation': turned, 'Material': 'steel'},
            'plate': {'Origin': '-10, -8', 'Size': '22, 8', 'Cells': '30, 8', 'Material': 'steel'}},
            supports={'floor': {'Boundary': 'plate/bottom', **self.CLAMP},
                      'hand': {'Boundary': 'square/top', **self.CLAMP, 'Displacement y': lifted}},
            contacts={'pair': {'Slave': slave, 'Master': master}}, Discretization={'Degree': degree},
            Decomposition=NONE, Solver={'Tolerance': '1e-8'})).summary['results']

    def test_a_master_is_not_extended_beyond_its_end(self):
        """The sloping side reached the node beside its end: 1140 and 7239 N between bodies that are apart."""
        for degree in '12':
            for turned in (10, 40):
                results = self.corner_on_plate('0.02', degree=degree, turned=turned)
                self.assertEqual(results['contact'][0]['normal_force'], 0)
                self.assertAlmostEqual(results['max_displacement'], 0.02, delta=1e-9)

    def test_a_corner_is_pressed_along_the_normal_of_the_other_side(self):
        """A plate without friction bore a force along itself: the tangent of half the angle times the normal force."""
        for degree in '12':
            for turned in (3, 10, 40):
                force = self.corner_on_plate('-0.01', 'square/bottom', 'plate/top', degree, turned)['contact'][0]['force']
                self.assertGreater(abs(force[1]), 50)
                self.assertLess(abs(force[0]), 1e-9 * abs(force[1]))

    def test_a_support_holds_the_end_of_both_sides(self):
        """Two plates make one cantilever under 10 N. The row of the held end tied the master's next nodes to each other: 47.4 N."""
        sizes = {'Size': '10, 3', 'Material': 'steel'}
        for cells in (5, 6, 7):
            for law in ('bonded', 'frictionless'):
                summary = converged(scenes.box('cantilever', materials={'steel': STEEL}, bodies={
                    'low': {'Origin': '0, 0', **sizes, 'Cells': '{}, 3'.format(cells)},
                    'high': {'Origin': '0, 3', **sizes, 'Cells': '5, 3'}},
                    supports={'low': {'Boundary': 'low/left', **self.CLAMP}, 'high': {'Boundary': 'high/left', **self.CLAMP}},
                    tractions={'load': {'Boundary': 'high/top', 'Traction y': '-1'}},
                    contacts={'joint': {'Slave': 'high/bottom', 'Master': 'low/top', 'Law': law}},
                    Decomposition=NONE, Solver={'Tolerance': '1e-8'})).summary
                forces = [abs(support['force'][1]) for support in summary['results']['supports']]
                self.assertAlmostEqual(sum(forces), 10, delta=1e-6)
                self.assertLess(max(forces), 7, (cells, law, forces))


class Case(unittest.TestCase):

    def refused(self, case, status, *words, ranks=1):
        result = solve(case, ranks=ranks)
        self.assertEqual(result.status, status, result)
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertIn('remedy: ', result.stderr)
        return result

    def near(self, found, expected, part=1e-9):
        for a, b in zip(found, expected):
            self.assertAlmostEqual(a, b, delta=part * max(map(abs, expected)), msg='{} {}'.format(found, expected))

    def warned(self, result, *words):
        text = [text for text in result.summary['warnings'] if words[0] in text]
        self.assertTrue(text, result.summary['warnings'])
        for word in words:
            self.assertIn(word, text[0])


class NestedMeshes(Case):

    def test_nested_meshes_do_not_match(self):
        """Every slave node has a master node across, but there are more of these: node to node gave 13.2 MPa."""
        for cells in ('10, 4', '20, 4', '30, 4', '5, 4'):
            for degree in (1, 2):
                result = converged(pressed_bars(cells), {'Discretization/Degree': degree, 'Solver/Tolerance': '1e-10'})
                self.assertAlmostEqual(result.summary['results']['max_von_mises'], 10, delta=1e-6, msg=cells)
                self.assertAlmostEqual(only(result.summary['results']['contact'])['max_pressure'], 10, delta=1e-6, msg=cells)


class Held(Case):
    """Contact nodes whose normal motion supports prescribe."""

    def test_prescribed_penetration_is_refused(self):
        down = {'Displacement x': '0', 'Displacement y': '-0.1'}
        for support in ({'Boundary': 'bar/bottom', **down}, {'Boundary': 'bar/bottom', 'Displacement normal': '0.1'},
                        {'Body': 'bar', 'Point': '3, 0', **down}):
            self.refused(bar(supports={'push': support}), 4, 'Support push', 'Contact touch', '0.1 mm inside')

    def test_on_several_ranks_and_in_the_check_alone(self):
        case = bar(supports={'push': {'Boundary': 'bar/bottom', 'Displacement x': '0', 'Displacement y': '-0.1'}})
        self.refused(case, 4, 'Support push', ranks=2)
        self.assertEqual(run(case, '--check').status, 4)

    def test_two_clamped_sides_with_interference_are_refused(self):
        clamp = {'Displacement x': '0', 'Displacement y': '0'}
        case = two_bars(supports={'one': {'Boundary': 'bar/top', **clamp}, 'two': {'Boundary': 'lid/bottom', **clamp}},
                        contacts={'joint': {'Slave': 'bar/top', 'Master': 'lid/bottom', 'Offset': '-0.01'}})
        self.refused(case, 4, 'Support one', 'Support two', 'Contact joint', '0.01 mm inside')

    def test_in_a_later_load_step(self):
        case = bar(supports={'push': {'Boundary': 'bar/bottom', 'Displacement x': '0', 'Displacement y': '1e-3*(1.5-t)'}},
                   tractions={'pressed': PRESSED}, **{'Load steps': {'Factors': '1, 2'}})
        self.refused(case, 4, 'Support push', '0.0005 mm inside')

    def test_where_both_agree_the_reaction_is_shared(self):
        case = bar(supports={'rest': {'Boundary': 'bar/bottom', 'Displacement x': '0', 'Displacement y': '0'}},
                   tractions={'pressed': PRESSED})
        result = converged(case, ranks=2)
        self.near(force(result), [0, 5])
        self.near(force(result, 'supports'), [0, 5])
        self.assertEqual(only(result.summary['results']['contact'])['contact_nodes'], 11)
        self.assertEqual({row['gap'] for row in result.contact}, {0})
        self.warned(result, 'Contact touch', 'only the sum')

    def test_held_apart_it_is_open(self):
        case = bar(supports={'lift': {'Boundary': 'bar/bottom', 'Displacement x': '0', 'Displacement y': '0.1'}},
                   tractions={'pressed': PRESSED})
        result = converged(case)
        self.near(force(result, 'supports'), [0, 10])
        self.assertEqual({(row['gap'], row['status']) for row in result.contact}, {(0.1, 'open')})


class NoLoad(Case):

    def test_friction_bears_nothing_where_nothing_loads(self):
        """A slip bound is there without a pressure; the rounding of gaps was borne by it."""
        for support in ({'Displacement x': '0', 'Displacement y': 'free'}, {'Displacement x': '0', 'Displacement y': '0'}):
            result = converged(shipped('box_prescribed'), {
                **{'Support pressed/' + name: value for name, value in support.items()},
                'Contact circle/Law': 'Tresca', 'Contact circle/Slip bound': '150', 'Decomposition/Cells per block': '3'})
            self.assertEqual({(row['pressure'], row['tangential_traction'], row['slip']) for row in result.contact}, {(0, 0, 0)})
            self.assertEqual(result.summary['results']['max_displacement'], 0)


class BeyondArithmetic(Case):

    def test_stiffnesses_that_double_precision_cannot_tell(self):
        """Ended with a segmentation fault and with status 1."""
        for thickness in ('1e20', '1e16'):
            result = solve(shipped('lap_joint'), {'Body upper plate/Thickness': thickness, 'Friction/Max iterations': 3})
            self.assertEqual(result.status, 2, result)
            self.assertIn('differ by more than double precision can tell', result.stderr)


class Bonded(Case):

    def test_a_bond_to_an_obstacle_reports_its_force(self):
        for ranks in (1, 2):
            result = converged(bar(tractions={'pressed': {**PRESSED, 'Traction x': '0.5'}},
                                   contacts={'touch': {**TOUCH, 'Law': 'bonded'}}), ranks=ranks)
            pair = only(result.summary['results']['contact'])
            self.near(pair['force'], [-5, 10])
            self.near([pair['moment']], [50 + 4 * 5])
            self.near([pair['normal_force'], pair['contact_nodes']], [10, 11])
            self.assertEqual(len(result.contact), 11)

    def test_a_slit_ring_bonded_to_itself_is_solved_until_its_tractions_are_right(self):
        found = [converged(slit_ring(Solver={'Tolerance': tolerance})).summary['results'] for tolerance in ('1e-4', '1e-8')]
        for figure in ('max_displacement', 'strain_energy'):
            self.near([found[0][figure]], [found[1][figure]], 1e-3)
        self.near([found[0]['contact'][0]['normal_force']], [found[1]['contact'][0]['normal_force']], 1e-3)

    def test_tractions_are_right_where_two_bonds_meet(self):
        halves = {part: {'Slave': 'bar/top where x ' + part, 'Master': 'lid/bottom', 'Law': 'bonded'} for part in ('< 4', '> 4')}
        for cells in ('10, 4', '15, 4', '5, 2'):
            result = converged(pressed_bars(cells, halves))
            self.near([pair['max_pressure'] for pair in result.summary['results']['contact']], [10, 10], 1e-4)
            self.near([sum(pair['normal_force'] for pair in result.summary['results']['contact'])], [100], 1e-6)


class SharedSides(Case):

    def test_one_surface_in_two_pairs(self):
        self.refused(bar(tractions={'pressed': PRESSED},
                         contacts={'c': TOUCH, 'd': {**TOUCH, 'Slave': 'bar/*'}}), 2, 'Contact c', 'Contact d')
        self.refused(two_bars(contacts={'c': {'Slave': 'bar/top', 'Master': 'lid/bottom'},
                                        'd': {'Slave': 'lid/*', 'Master': 'bar/top'}}), 2, 'Contact c', 'Contact d')

    def test_neighbours_are_no_such_pairs(self):
        sides = {side: {'Boundary': 'bar/' + side, 'Displacement x': '0'} for side in ('left', 'right')}
        converged(bar(supports=sides, tractions={'pressed': PRESSED},
                      obstacles={'floor': FLOOR, 'wall': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '1, 0'}},
                      contacts={'c': TOUCH, 'd': {**TOUCH, 'Slave': 'bar/left', 'Master': 'wall'}}))


class HeldNodes(Case):
    """Friction at contact nodes that supports hold or move along the surface."""

    def pushed(self, displacement='0.1', **kinds):
        """Poisson's ratio 0, 10 N on a floor with a coefficient of friction of 0.3, the left end moved: all nodes slide."""
        return bar(**{'materials': {'elastic': {**STEEL, 'Poisson ratio': '0'}},
                      'supports': {'push': {'Boundary': 'bar/left', 'Displacement x': displacement}},
                      'tractions': {'pressed': PRESSED}, 'Solver': {'Tolerance': '1e-8'},
                      'contacts': {'touch': {**TOUCH, 'Law': 'Coulomb', 'Friction coefficient': '0.3'}}, **kinds})

    def push(self, case):
        return force(converged(case), 'supports')[0]

    def test_nodes_that_a_support_moves_slide_too(self):
        for degree in (1, 2):
            self.assertAlmostEqual(self.push(self.pushed(Discretization={'Degree': degree})), 3, places=5)
        self.assertAlmostEqual(self.push(self.pushed(Solver={'Algorithm': 'smalbe'})), 3, places=3)
        tresca = {'touch': {**TOUCH, 'Law': 'Tresca', 'Slip bound': '0.3'}}
        self.assertAlmostEqual(self.push(self.pushed(contacts=tresca)), 3, places=5)
        nodes = converged(self.pushed()).contact
        self.assertTrue(all(node['status'] == 'slip' and node['slip'] > 0.09 for node in nodes), nodes)

    def test_friction_follows_a_support_that_turns_back(self):
        there_and_back = self.pushed('0.1*(1-abs(t-1))', **{'Load steps': {'Factors': '0.5, 1, 1.5, 2'}})
        self.assertAlmostEqual(self.push(there_and_back), -3, places=5)

    def test_both_sides_held_where_one_is_moved(self):
        case = self.pushed(
            bodies={'bar': BAR, 'floor': {**BAR, 'Origin': '0, -4'}}, obstacles={},
            supports={'push': {'Boundary': 'bar/left', 'Displacement x': '0.1'}, 'end': {'Boundary': 'floor/left', 'Displacement x': '0'},
                      'base': {'Boundary': 'floor/bottom', 'Displacement y': '0'}},
            contacts={'touch': {'Slave': 'bar/bottom', 'Master': 'floor/top', 'Law': 'Coulomb', 'Friction coefficient': '0.3'}})
        result = converged(case)
        self.assertAlmostEqual(force(result, 'supports')[0], 3, places=5)
        self.assertAlmostEqual(force(result, 'supports', 1)[0], -3, places=5)

    def test_nodes_on_planes_of_symmetry_stick(self):
        """Meshes that do not match: master nodes off the plane have small weights there."""
        nodes = converged(shipped('press_fit'), {'Contact fit/Law': 'Coulomb', 'Contact fit/Friction coefficient': '0.2',
                                                 'Solver/Tolerance': '1e-8'}).contact
        self.assertTrue(all(node['status'] == 'stick' for node in nodes), nodes)
        self.assertEqual([nodes[i]['tangential_traction'] for i in (0, -1)], [0, 0])


class AfterLoading(Case):
    """Geometry that no row of contact watches."""

    def test_a_reach_that_is_too_small(self):
        result = self.refused(disc_on_plate('0.05'), 3, 'Contact joint', 'farther away than the Reach of 0.05 mm')
        wider = re.search(r'Reach to (\S+) mm', result.stderr).group(1)
        self.assertIs(result.summary['converged'], False)
        right = converged(disc_on_plate('auto'))
        self.near(force(converged(disc_on_plate(wider))), force(right), 1e-3)
        self.assertAlmostEqual(force(converged(disc_on_plate('auto', 2)))[1], 42321.5, delta=100)

    def test_an_obstacle_between_two_nodes(self):
        push = {'push': {'Boundary': 'bar/top', 'Displacement x': '0', 'Displacement y': '-0.2'}}
        for obstacle, depth in (({'Center': '4.5, -0.3', 'Radius': '0.3'}, '0.2'),
                                ({'Shape': 'polyline', 'Points': '-9 -3; 1.5 -3; 4.5 0; 7.5 -3; 20 -3'}, '0.2'),
                                ({'Shape': 'function', 'Height': 'exp(-((x-4.5)/0.1)^2) - 1'}, '')):
            case = bar(supports=push, obstacles={'thorn': obstacle}, contacts={'c': {**TOUCH, 'Master': 'thorn'}})
            self.warned(solve(case), 'obstacle thorn is ' + depth, 'inside body bar at (4.5, 0)', 'refine')

    def test_features_much_finer_than_an_edge(self):
        push = {'push': {'Boundary': 'bar/top', 'Displacement x': '0', 'Displacement y': '-0.2'}}
        for obstacle, depth in (({'Center': '4.513, -0.12', 'Radius': '0.02'}, '0.1 mm'),  # wholly inside
                                ({'Center': '4.513, -0.1001', 'Radius': '0.0001'}, '0.1 mm'),
                                ({'Shape': 'polyline', 'Points': '-9 -3; 4.512 -3; 4.513 0; 4.514 -3; 20 -3'}, '0.2 mm'),
                                ({'Shape': 'function', 'Height': 'exp(-((x-4.513)/0.005)^2) - 1'}, '')):
            case = bar(supports=push, obstacles={'thorn': obstacle}, contacts={'c': {**TOUCH, 'Master': 'thorn'}})
            self.warned(solve(case), 'obstacle thorn is ' + depth, 'inside body bar at (4.513', 'refine')

    def test_refined_it_touches(self):
        case = bar(supports={'push': {'Boundary': 'bar/top', 'Displacement x': '0', 'Displacement y': '-0.2'}},
                   bodies={'bar': {**BAR, 'Cells': '80, 32'}},
                   obstacles={'thorn': {'Center': '4.5, -0.3', 'Radius': '0.3'}},
                   contacts={'c': {**TOUCH, 'Master': 'thorn'}})
        result = converged(case)
        self.assertGreater(force(result)[1], 1000)
        self.assertFalse([text for text in result.summary['warnings'] if 'thorn is' in text])

    def test_bodies_that_no_pair_joins(self):
        case = two_bars(contacts={}, tractions={'pressed': {'Boundary': 'bar/left', 'Traction x': '1000'}})
        self.warned(solve(case), 'inside body', 'no contact pair joins the two')


class Loads(Case):

    def resultant(self, load, **kinds):
        result = converged(bar(tractions={'pressed': {'Boundary': 'bar/top', **load}},
                               contacts={'touch': {**TOUCH, 'Law': 'bonded'}}, **kinds))
        sums = only(result.summary['results']['loads'])
        self.near(force(result), [-f for f in sums['force']], 1e-8)
        return sums

    def test_jumps_are_integrated(self):
        for degree in (1, 2):
            sums = self.resultant({'Traction y': '-20*(x>2.3 && x<7.1)'}, Discretization={'Degree': degree})
            self.near(sums['force'] + [sums['moment']], [0, -96, -96 * 4.7])

    def test_a_peak_within_an_edge(self):
        for place in ('4.5', '4.37', '4.013'):
            sums = self.resultant({'Pressure': '1000*exp(-((x-{})/0.005)^2)'.format(place)})
            self.near(sums['force'], [0, -5 * math.sqrt(math.pi)], 1e-6)

    def test_a_formula_without_end_is_warned_of(self):
        case = bar(tractions={'pressed': {'Boundary': 'bar/top', 'Traction y': '-1 + sin(1e7*x)*sin(3e6*x)'}},
                   contacts={'touch': {**TOUCH, 'Law': 'bonded'}})
        self.warned(solve(case), 'traction pressed', 'changes faster')

    def test_body_forces_with_jumps_are_warned_of(self):
        for fy, is_rough in (('-(x>2.3 && x<7.1)', True), ('-1-sin(pi*x/10)', False)):
            result = converged(bar(body_forces={'weight': {'Force y': fy}}, contacts={'touch': {**TOUCH, 'Law': 'bonded'}}))
            if is_rough:
                self.warned(result, 'body force weight', 'changes faster')
            else:
                self.assertEqual(result.summary['warnings'], [])


class FormulasAtNodes(Case):
    """Slip bounds, prescribed displacements and gaps act at nodes: what a formula does between them alone is warned of."""

    def formulas(self, contact=None, support=None, **kinds):
        held = {'hold': {'Boundary': 'bar/left', 'Displacement x': '0', 'Displacement y': '0', **(support or {})}}
        result = converged(bar(supports=held, tractions={'pressed': PRESSED}, contacts={'touch': {**TOUCH, **(contact or {})}},
                               **kinds))
        return result, [text for text in result.summary['warnings'] if 'it is evaluated at nodes only' in text]

    def test_peaks_between_nodes_are_warned_of(self):
        peak = 'exp(-((x-4.37)/0.05)^2)'
        for degree in (1, 2):
            for name, contact, value in (('Slip bound', {'Law': 'Tresca', 'Slip bound': '0.1 + ' + peak}, '1.09 MPa'),
                                         ('Friction coefficient', {'Law': 'Coulomb', 'Friction coefficient': '0.3 - 0.3*' + peak}, ''),
                                         ('Gap', {'Gap': '0.5 - 0.5*' + peak}, ''), ('Gap', {'Gap': '-1e-4*' + peak}, '')):
                with self.subTest(name, degree=degree):
                    result, found = self.formulas(contact, Discretization={'Degree': degree})
                    for word in ('Contact touch/' + name + ': the formula is ' + value, 'at (4.37', 'refine bar there'):
                        self.assertIn(word, only(found))
        result, found = self.formulas(support={'Displacement x': '1e-3*exp(-((y-1.43)/0.05)^2)'})
        self.assertIn('Support hold/Displacement x: the formula is', only(found))
        self.assertIn('at (0, 1.4', only(found))

    def test_where_nodes_see_it_nothing_is_said(self):
        for contact in ({'Law': 'Tresca', 'Slip bound': '0.1 + exp(-((x-4)/1.5)^2)'}, {'Law': 'Tresca', 'Slip bound': '5*(x>3.3)'},
                        {'Gap': 'x^2/200'}, {'Gap': '-1e-5*x*(10-x)'}):
            with self.subTest(contact):
                self.assertEqual(self.formulas(contact)[1], [])
        self.assertEqual(self.formulas(support={'Displacement x': '1e-3*sin(pi*y/4)'})[1], [])
        fine = {'bodies': {'bar': {**BAR, 'Cells': '200, 4'}}}
        self.assertEqual(self.formulas({'Law': 'Tresca', 'Slip bound': '0.1 + exp(-((x-4.37)/0.1)^2)'}, **fine)[1], [])

    def test_also_on_several_ranks_and_in_the_step_where_it_appears(self):
        case = bar(supports={'hold': {'Boundary': 'bar/left', 'Displacement x': '0', 'Displacement y': '0'}},
                   tractions={'pressed': PRESSED}, Decomposition={'Method': 'METIS', 'Subdomains': '4'},
                   contacts={'touch': {**TOUCH, 'Law': 'Tresca', 'Slip bound': '1 + 3*(t-1)*exp(-((x-4.37)/0.05)^2)'}},
                   **{'Load steps': {'Factors': '1, 2'}})
        texts = {only(converged(case, ranks=ranks).summary['warnings']) for ranks in (1, 2, 3)}
        self.assertIn('the formula is 3.97 MPa at (4.375, 0)', only(list(texts)))


class Names(Case):

    def test_all_and_the_star_are_reserved(self):
        self.refused(scenes.box(bodies={'all': scenes.BOX}), 2, "'all' is reserved")


class Resultants(Case):

    def test_every_load_support_foundation_and_pair(self):
        case = bar(materials={'elastic': {**STEEL, 'Density': '1e-3'}},
                   tractions={'side': {'Boundary': 'bar/left', 'Pressure': '2'}},
                   body_forces={'weight': {'Acceleration y': '-100'}},
                   point_loads={'pull': {'Body': 'bar', 'Point': '10, 4', 'Force x': '3', 'Force y': '1'}},
                   supports={'right': {'Boundary': 'bar/right', 'Displacement x': '0'}},
                   foundations={'bed': {'Boundary': 'bar/top', 'Normal stiffness': '1'}})
        for ranks in (1, 2):
            result = converged(case, {'Solver/Tolerance': 1e-10, 'Decomposition/Method': 'METIS',
                                      'Decomposition/Subdomains': 4}, ranks=ranks)
            found = result.summary['results']
            loads = {load['load']: load for load in found['loads']}
            self.near(loads['side']['force'] + [loads['side']['moment']], [8, 0, -16])
            self.near(loads['weight']['force'] + [loads['weight']['moment']], [0, -4, -20])
            self.near(loads['pull']['force'] + [loads['pull']['moment']], [3, 1, 10 - 12])
            self.assertEqual([load['kind'] for load in found['loads']], ['traction', 'body force', 'point load'])
            support, bed, pair = only(found['supports']), only(found['foundations']), only(found['contact'])
            self.near(support['force'], [-11, 0])
            self.assertAlmostEqual(bed['force'][1] + pair['force'][1], 3, delta=1e-7)
            self.assertNotEqual(bed['force'][1], 0)
            self.assertAlmostEqual(support['moment'] + bed['moment'] + pair['moment'], 16 + 20 + 2, delta=1e-6)
            self.assertIn('traction side', result.stdout)
            self.assertIn('forces summed along it {:.6g} N normal'.format(pair['normal_force']), result.stdout)

    def test_history_has_a_row_for_every_step(self):
        result = converged(shipped('cattaneo_mindlin'))
        rows, steps = result.rows('history.csv'), result.summary['steps']
        self.assertEqual([row['t'] for row in rows], [step['load_factor'] for step in steps])
        self.assertGreater(len(rows), 1)
        for row, step in zip(rows, steps):
            for kind, noun in (('supports', 'support'), ('contact', 'pair')):
                for entry in step[kind]:
                    name = {'pair': 'contact'}.get(noun, noun) + ' ' + entry[noun]
                    self.assertEqual([row[name + ' Fx'], row[name + ' Fy'], row[name + ' moment']],
                                     entry['force'] + [entry['moment']])
            total = [sum(entry['force'][d] for kind in ('loads', 'supports') for entry in step[kind]) for d in (0, 1)]
            largest = max(abs(f) for entry in step['loads'] for f in entry['force'])
            for d in (0, 1):
                self.assertAlmostEqual(total[d] / largest, 0, delta=1e-8)


class Resolution(unittest.TestCase):
    """Contacts much smaller than the edges: pressures, and forces that supports determine, are those of the mesh."""

    def warnings(self, *arguments, **kinds):
        found = converged(*arguments, **kinds).summary
        return [text for text in found['warnings'] if 'does not resolve the contact' in text], found

    def test_ball_on_one_node(self):
        scene = pathlib.Path(__file__).parent / 'half_ball.prm'
        for ranks in (1, 2):
            texts, _ = self.warnings(scene, {'Output/VTU': 'false'}, ranks=ranks)
            self.assertRegex(only(texts), r'Contact c: .* \(c: 1 node at \(0, 0, 0\), where nodes are 1\.96 mm apart\)')

    def test_disc(self):
        def disc(edges, push):
            held = {'Displacement x': '0', 'Displacement y': '0'}
            return bar(bodies={'bar': {'Shape': 'half disc', 'Center': '0, 10', 'Radius': '10', 'Cells along arc': edges, 'Material': 'elastic'}},
                       supports={'push': {'Boundary': 'bar/flat', **held, 'Displacement y': push}},
                       contacts={'touch': {**TOUCH, 'Slave': 'bar/arc'}})
        self.assertIn('1 node ', only(self.warnings(disc(32, '-0.001'))[0]))
        texts, found = self.warnings(disc(32, '-0.2'))
        self.assertEqual(texts, [])
        self.assertGreaterEqual(only(found['results']['contact'])['contact_nodes'], 3)

    def test_ball_on_the_axis(self):
        """The axis is no end of the contact: with one node in contact the force was 1.7 times as large, without a word."""
        held = {'Displacement x': '0', 'Displacement y': '0'}

        def ball(push):
            return scenes.box('ball', plane_state='axisymmetric', Decomposition={'Method': 'METIS'}, bodies={
                'ball': {'Shape': 'quarter disc', 'Center': '0, 10', 'Radius': '10', 'Cells along arc': '12', 'Material': 'elastic'},
                'block': {'Origin': '0, -15', 'Size': '25, 15', 'Cells': '15, 8', 'Material': 'elastic'}},
                supports={'base': {'Boundary': 'block/bottom', **held}, 'load': {'Boundary': 'ball/flat', **held, 'Displacement y': push}},
                contacts={'c': {'Slave': 'ball/arc', 'Master': 'block/top', 'Law': 'frictionless'}})
        self.assertRegex(only(self.warnings(ball('-0.05'))[0]), r'Contact c: .* \(c: 1 node at \(0, 0\), where nodes are 1\.308 mm apart\)')
        self.assertEqual(self.warnings(ball('-0.6'))[0], [])

    def test_contacts_that_bear_nothing(self):
        """Forces of rounding size, of either sign, have no resolution."""
        case = scenes.box('bar', Decomposition=NONE, materials={'elastic': {'Young modulus': '1000', 'Poisson ratio': '0'}},
                          bodies={'bar': {'Size': '4, 3', 'Cells': '5, 3', 'Material': 'elastic'}}, obstacles={'floor': FLOOR},
                          foundations={'bed': {'Boundary': 'bar/top', 'Normal stiffness': '2', 'Tangential stiffness': '1'}},
                          tractions={'pull': {'Boundary': 'bar/top', 'Traction x': '1.5*t', 'Traction y': '-10*cos(pi*t/2)'}},
                          contacts={'touch': {**TOUCH, 'Law': 'Coulomb', 'Friction coefficient': '0.4'}})
        self.assertEqual(self.warnings(case)[0], [])
        unloaded = disc_on_plate('5')
        self.assertEqual(self.warnings(unloaded, {'Support push/Displacement y': '-0.5*max(0,2-t)+0.1*max(0,t-1)', 'Load steps/Factors': '1, 2'})[0], [])

    def test_corners_are_named_elsewhere(self):
        """A bar that stands on its corner alone: the contact is as small as it is, on any mesh."""
        held = {'Displacement x': '0', 'Displacement y': '0'}
        texts, found = self.warnings(bar(bodies={'bar': {**BAR, 'Origin': '0, 0.4', 'Rotation': '-2'}}, supports={
            'top': {'Boundary': 'bar/top', **held, 'Displacement y': '-0.1'}}))
        self.assertIn(only(found['results']['contact'])['contact_nodes'], (1, 2))
        self.assertEqual(texts, [])


class NeighbouringPairs(unittest.TestCase):
    """A contact divided into two pairs, which meet at a node that both bodies have: the same answer as for one pair."""

    def blocks(self, contacts, push='8.1', cells=('2, 2', '2, 2'), kinds=None, ranks=1):
        load = {'Boundary': 'up/top', 'Pressure': '30', 'Traction x': push}
        return solve(scenes.box('blocks', **{
            'plane_state': 'plane strain', 'Decomposition': NONE, 'materials': {'elastic': STEEL}, 'contacts': contacts,
            'bodies': {'low': {'Size': '20, 10', 'Cells': cells[0], 'Material': 'elastic'},
                       'up': {'Origin': '0, 10', 'Size': '20, 5', 'Cells': cells[1], 'Material': 'elastic'}},
            'supports': {'ground': {'Boundary': 'low/bottom', 'Displacement x': '0', 'Displacement y': '0'}},
            'tractions': {'load': load}, 'Solver': {'Tolerance': '1e-10'}, **(kinds or {})}), ranks=ranks)

    def parts(self, left, right, master='low/top'):
        return {name: {'Slave': 'up/bottom where ' + part, 'Master': master + ' where ' + part if '/' in master else master, **law}
                for name, part, law in (('left', 'x<10', left), ('right', 'x>10', right))}

    def assert_same(self, whole, parts, normal_force=600):
        self.assertEqual((whole.status, parts.status), (0, 0), (whole, parts))
        self.assertEqual(parts.summary['warnings'], [])
        a, b = whole.summary['results'], parts.summary['results']
        for name in ('max_displacement', 'strain_energy', 'max_von_mises'):
            self.assertAlmostEqual(a[name] / b[name], 1, delta=1e-7)
        for name in ('normal_force', 'tangential_force', 'contact_length'):
            self.assertAlmostEqual(sum(pair[name] for pair in b['contact']) / a['contact'][0][name], 1, delta=1e-7)
        self.assertAlmostEqual(max(pair['max_pressure'] for pair in b['contact']) / a['contact'][0]['max_pressure'], 1, delta=1e-7)
        for name in ('pressure_norm', 'traction_norm'):
            self.assertAlmostEqual(sum(pair[name]**2 for pair in b['contact']) / a['contact'][0][name]**2, 1, delta=1e-7)

    def test_friction_of_both(self):
        laws = {'Coulomb': {'Friction coefficient': '0.3'}, 'Tresca': {'Slip bound': '9'},
                'cohesion': {'Cohesion': '3', 'Friction coefficient': '0.2', 'Shear limit': '20'}}
        for name, numbers in laws.items():
            law = {'Law': name, **numbers}
            for cells in (('2, 2', '2, 2'), ('6, 2', '8, 2')):
                with self.subTest(law=name, cells=cells):
                    whole = {'whole': {'Slave': 'up/bottom', 'Master': 'low/top', **law}}
                    self.assert_same(self.blocks(whole, cells=cells),
                                     self.blocks(self.parts(law, law), cells=cells, ranks=2 if name == 'Coulomb' else 1))

    def test_on_an_obstacle(self):
        law = {'Law': 'Coulomb', 'Friction coefficient': '0.3'}
        floor = {'obstacles': {'floor': {'Shape': 'half plane', 'Point': '0, 10', 'Normal': '0, 1'}},
                 'supports': {}, 'bodies': {'up': {'Origin': '0, 10', 'Size': '20, 5', 'Cells': '2, 2', 'Material': 'elastic'}}}
        def on_floor(contacts):
            return solve(scenes.box('floor', plane_state='plane strain', Decomposition=NONE, materials={'elastic': STEEL},
                                    tractions={'load': {'Boundary': 'up/top', 'Pressure': '30', 'Traction x': '8.1'}},
                                    contacts=contacts, Solver={'Tolerance': '1e-10'}, **floor))
        self.assert_same(on_floor({'whole': {'Slave': 'up/bottom', 'Master': 'floor', **law}}),
                         on_floor(self.parts(law, law, 'floor')))

    def test_friction_of_one(self):
        """A node that is half frictionless bears half of the friction, which counts for the other pair."""
        result = self.blocks(self.parts({'Law': 'frictionless'}, {'Law': 'Coulomb', 'Friction coefficient': '0.3'}), '1')
        self.assertEqual(result.status, 0, result)
        left, right = result.summary['results']['contact']
        self.assertEqual(left['tangential_force'], 0)
        self.assertAlmostEqual(right['tangential_force'], -20, delta=1e-6)
        rows = [row for row in result.contact if row['x'] == 10]
        self.assertEqual([row['pair'] for row in rows], ['left', 'right'])
        self.assertAlmostEqual(rows[0]['pressure'] / rows[1]['pressure'], 1, delta=1e-12)
        self.assertLessEqual(abs(rows[1]['tangential_traction']), 0.3 * rows[1]['pressure'] * (1 + 1e-9))

    def test_bond_beside_friction(self):
        """The pressure of the common node is that of its neighbours, in both pairs."""
        result = self.blocks(self.parts({'Law': 'bonded'}, {'Law': 'Coulomb', 'Friction coefficient': '0.3'}), '0', ('20, 5', '20, 5'))
        self.assertEqual(result.status, 0, result)
        left, right = result.summary['results']['contact']
        for pair in (left, right):
            self.assertAlmostEqual(pair['normal_force'], 300, delta=1e-6)
        pressures = {row['pair']: row['pressure'] for row in result.contact if row['x'] == 10}
        self.assertAlmostEqual(pressures['left'] / pressures['right'], 1, delta=1e-12)
        pulled = self.blocks(self.parts({'Law': 'bonded'}, {'Law': 'Coulomb', 'Friction coefficient': '0.3'}), '0', ('20, 5', '20, 5'),
                             {'tractions': {'load': {'Boundary': 'up/top where x>15', 'Traction y': '3'}}})
        left_pulled, right_pulled = pulled.summary['results']['contact']
        self.assertAlmostEqual(left_pulled['normal_force'], -15, delta=1e-6)  # the bond alone
        self.assertEqual([right_pulled['normal_force'], right_pulled['tangential_force'], right_pulled['max_pressure']], [0, 0, 0])
        for row in pulled.contact + result.contact:
            if row['pair'] == 'right':
                self.assertLessEqual(abs(row['tangential_traction']), 0.3 * row['pressure'] + 1e-9)
        beside = [row['pressure'] for row in result.contact if row['x'] in (9, 11)]
        self.assertAlmostEqual(pressures['left'] / beside[0], 1, delta=0.02)


class Sides(unittest.TestCase):

    def test_bonds_across_gaps(self):
        texts = converged(shipped('hertz'), {'Contact touch/Law': 'bonded'}).summary['warnings']
        self.assertEqual(len([text for text in texts if 'Contact touch: it bonds across a gap of ' in text]), 1, texts)

    def test_slaves_that_are_finer_and_stiffer(self):
        """Said before the solve; not where the sides are exchanged, or equally stiff."""
        def said(slave, master, modulus):
            steel, pad = {'Origin': '0, 10', 'Size': '20, 5', 'Cells': '30, 5'}, {'Size': '20, 10', 'Cells': '10, 5'}
            case = scenes.box('pad', plane_state='plane strain', Decomposition=NONE,
                              materials={'steel': STEEL, 'pad': {'Young modulus': modulus, 'Poisson ratio': '0.3'}},
                              bodies={'steel': {**steel, 'Material': 'steel'}, 'pad': {**pad, 'Material': 'pad'}},
                              supports={'ground': {'Boundary': 'pad/bottom', 'Displacement x': '0', 'Displacement y': '0'},
                                        'guide': {'Boundary': 'steel/left', 'Displacement x': '0'}},
                              tractions={'load': {'Boundary': 'steel/top', 'Pressure': '0.1'}},
                              contacts={'c': {'Slave': slave, 'Master': master, 'Law': 'frictionless'}})
            return [text for text in converged(case).summary['warnings'] if 'exchange Slave and Master' in text]

        text = only(said('steel/bottom', 'pad/top', '20'))
        self.assertRegex(text, r'\(2\.1e\+05 and 20 MPa\) and finer \(edges of 0\.6\d+ and 2 mm\)')
        self.assertEqual(said('pad/top', 'steel/bottom', '20'), [])
        self.assertEqual(said('steel/bottom', 'pad/top', '2e5'), [])


class DisplacedForces(unittest.TestCase):
    """Forces in balance on the undeformed body, but not where the displacements take them."""

    def warnings(self, push, obstacles, masters, ranks=1):
        case = scenes.box('disc', plane_state='plane strain', Decomposition={'Method': 'METIS', 'Subdomains': '3'},
                          materials={'elastic': {'Young modulus': '1e4', 'Poisson ratio': '0.3'}},
                          bodies={'d': {'Shape': 'disc', 'Radius': '10', 'Cells along arc': '192', 'Material': 'elastic'}},
                          obstacles=obstacles, body_forces={'w': {'Force x': push, 'Force y': '-0.3'}},
                          contacts={name: {'Slave': 'd/arc', 'Master': name, 'Law': 'Coulomb', 'Friction coefficient': '0.5'}
                                    for name in masters})
        return [text for text in converged(case, ranks=ranks).summary['warnings'] if 'leave a moment' in text]

    def test_a_disc_that_rolls_away(self):
        """Nothing but the arm of the normal forces stops it, since the contact moves along its arc: no equilibrium exists."""
        plane = {'floor': {'Shape': 'half plane', 'Point': '0, -10', 'Normal': '0, 1'}}
        for ranks in (1, 2):
            text = only(self.warnings('0.015', plane, ['floor'], ranks=ranks))
            self.assertRegex(text, r'^Body d: .* leave a moment of [0-9.]+ N mm, [0-9.]+ times the moments that hold it')
            moment, ratio = (float(x) for x in re.search(r'of ([0-9.]+) N mm, ([0-9.]+) times', text).groups())
            push = 0.015 * math.pi * 10**2
            self.assertAlmostEqual(moment / (push * 10), 1, delta=0.1)  # the arm of the push about the floor is 10 mm
            self.assertGreater(ratio, 1)

    def test_a_disc_that_is_wedged(self):
        groove = {'left': {'Shape': 'half plane', 'Point': '-7.0710678, -7.0710678', 'Normal': '1, 1'},
                  'right': {'Shape': 'half plane', 'Point': '7.0710678, -7.0710678', 'Normal': '-1, 1'}}
        self.assertEqual(self.warnings('0.015', groove, ['left', 'right']), [])


if __name__ == '__main__':
    unittest.main()
