"""Bad meshes, names and pairs of scenes with several bodies: exit status 2, one message with its remedy."""

import unittest

import scenes
from program import SOURCE, new_path, shipped, solve

CYLINDERS = shipped('cattaneo_mindlin')
BOX = shipped('box_on_circle')
MESHES = SOURCE / 'meshes'

MESH = '''$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "side"
2 2 "part"
$EndPhysicalNames
$Nodes
{n_nodes}
{nodes}
$EndNodes
$Elements
{n_elements}
{elements}
$EndElements
'''

SQUARE = ('0 0 0', '10 0 0', '10 10 0', '0 10 0')
SIDE = '1 2 1 1 1 2'  # a line between nodes 1 and 2 on the boundary "side"
RECTANGLE = {'Origin': '0, 0', 'Size': '10, 10', 'Cells': '4, 4', 'Material': 'elastic'}


def mesh(nodes, *cells):
    """Path of a mesh file of version 2.2; cells as type, tags and nodes."""
    path = new_path('bad.msh')
    elements = (SIDE,) + cells
    path.write_text(MESH.format(n_nodes=len(nodes), nodes='\n'.join('{} {}'.format(i + 1, x) for i, x in enumerate(nodes)),
                                n_elements=len(elements),
                                elements='\n'.join('{} {}'.format(i + 1, cell) for i, cell in enumerate(elements))))
    return path


def changed(name, change):
    """Copy of a shipped mesh with other bytes."""
    path = new_path(name)
    path.write_bytes(change((MESHES / name).read_bytes()))
    return path


class MultibodyBadInput(unittest.TestCase):

    def refused(self, case, overrides, *words, ranks=(1,)):
        for n in ranks:
            with self.subTest(ranks=n):
                result = solve(case, overrides, ranks=n)
                self.assertEqual(result.status, 2, result)
                lines = result.stderr.splitlines()
                self.assertEqual([line for line in lines if line.startswith('error: ')], lines[-2:-1], result)
                self.assertTrue(lines[-1].startswith('  remedy: '), result)
                for word in words:
                    self.assertIn(word, result.stderr, result)
                self.assertFalse(result.directory.exists(), result)

    def refused_mesh(self, path, *words, ranks=(1,)):
        case = scenes.box(bodies={'box': {'Shape': 'mesh', 'File': str(path), 'Material': 'elastic'}},
                          supports={'held': {**scenes.HELD, 'Boundary': 'box/side'}},
                          Decomposition={'Method': 'METIS'})
        self.refused(case, {}, str(path), *words, ranks=ranks)

    # names

    def test_part_that_is_not_in_the_mesh(self):
        self.refused(CYLINDERS, {'Body upper/Part': 'uper'}, "no part 'uper'", "did you mean 'upper'?")

    def test_boundary_that_is_not_in_the_mesh(self):
        self.refused(CYLINDERS, {'Contact touch/Slave': 'upper/contct'}, "no boundary 'contct'",
                     "did you mean 'contact'?")

    def test_boundary_of_another_part(self):
        self.refused(shipped('clamp'), {'Contact back/Slave': 'A/back'}, "no boundary 'back'")

    def test_point_that_is_not_in_the_mesh(self):
        self.refused(CYLINDERS, {'Support middle/Point': 'lower midle'}, "no point 'lower midle'",
                     "did you mean 'lower middle'?")

    def test_mesh_file_that_is_not_there(self):
        self.refused(CYLINDERS, {'Body upper/File': 'nowhere.msh'}, "'nowhere.msh'", 'no such file', ranks=(1, 2))

    # files

    def test_truncated_binary_file(self):
        for share in (0.3, 0.6, 0.9):
            path = changed('clamp.msh', lambda content: content[:int(share * len(content))])
            self.refused(shipped('clamp'), {'Body A/File': path}, str(path), 'truncated or corrupt', ranks=(2,))

    def test_binary_file_copied_as_text(self):
        path = changed('bolt.msh', lambda content: content.replace(b'\n', b'\r\n'))
        self.refused(shipped('lap_joint'), {'Body bolt/File': path}, str(path), 'corrupt')

    def test_text_file_that_says_it_is_binary(self):
        path = changed('patch.msh', lambda content: content.replace(b'4.1 0 8', b'4.1 1 8'))
        self.refused(shipped('patch_gmsh'), {'Body lower/File': path, 'Body upper/File': path}, str(path))

    # cells

    def test_cell_that_crosses_itself(self):
        self.refused_mesh(mesh(SQUARE, '3 2 2 2 1 2 4 3'), 'degenerate cell', 'intersects itself', ranks=(1, 2))

    def test_cell_that_is_not_convex(self):
        self.refused_mesh(mesh(('0 0 0', '10 0 0', '2 2 0', '0 10 0'), '3 2 2 2 1 2 3 4'), 'not convex')

    def test_cell_without_area(self):
        self.refused_mesh(mesh(('0 0 0', '10 0 0', '20 0 0', '0 10 0'), '2 2 2 2 1 2 3', '2 2 2 2 1 3 4'), 'no area',
                          '(10, 0)')

    def test_mesh_of_three_dimensions(self):
        self.refused_mesh(mesh(SQUARE[:3] + ('0 0 10',), '4 2 2 2 1 2 3 4'), 'three-dimensional')

    def test_mesh_of_one_dimension(self):
        self.refused_mesh(mesh(SQUARE, '1 2 1 1 2 3'), 'no cells, only 2 lines')

    def test_mesh_out_of_the_plane(self):
        self.refused_mesh(mesh(('0 0 0', '10 0 0', '10 10 7', '0 10 7'), '3 2 2 2 1 2 3 4'), 'z goes from 0 to 7')

    # pairs

    def test_pair_out_of_reach(self):
        self.refused(CYLINDERS, {'Body upper/Translation': '0, 60', 'Contact touch/Reach': 1}, 'Contact touch',
                     'upper/contact and lower/contact do not meet', '60 mm apart', 'Reach', ranks=(1, 2))

    def test_pair_on_one_side(self):
        self.refused(CYLINDERS, {'Contact touch/Slave': 'upper/arc', 'Contact touch/Master': 'upper/contact'},
                     'Contact touch', 'do not face each other')

    FLATS = {'Contact touch/Slave': 'upper/flat', 'Contact touch/Master': 'lower/flat'}  # outer sides, 200 mm apart

    def test_pair_of_sides_that_face_away_from_each_other(self):
        for more in ({}, {'Contact touch/Reach': 1}, {'Contact touch/Law': 'bonded'}, {'Discretization/Degree': 2}):
            self.refused(CYLINDERS, {**self.FLATS, **more}, 'Contact touch: upper/flat and lower/flat face away',
                         '200 mm or more of its own body', 'mirror')

    def test_pair_whose_normals_are_not_opposed_names_the_angle(self):
        result = solve(CYLINDERS, {'Contact touch/Slave': 'upper/arc', 'Contact touch/Master': 'upper/contact'})
        self.assertEqual(result.status, 2, result)
        self.assertRegex(result.stderr, r'normals is 8\d\.\d+ degrees or less; more than 104\.478')

    def test_pair_far_apart_with_an_automatic_reach(self):
        self.refused(CYLINDERS, {'Body upper/Translation': '0, 60'}, 'Contact touch: upper/contact and lower/contact are '
                     'out of reach', 'smallest gap is 60 mm', 'automatic reach is 3.2', 'Contact touch/Reach')

    def test_obstacle_on_the_other_side(self):
        self.refused(BOX, {'Contact circle/Slave': 'box/top'}, 'Contact circle: box/top and obstacle disc face away',
                     '170.538 degrees')

    def test_half_plane_that_is_turned_round(self):
        case = scenes.box(supports={'held': scenes.HELD}, contacts={'ground': {**scenes.CIRCLE, 'Master': 'ground'}},
                          obstacles={'ground': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, -1'}})
        self.refused(case, {}, 'box/bottom and obstacle ground face away', '180 degrees')

    def test_obstacle_out_of_reach(self):
        for reach, words in (('auto', 'automatic reach is 40 mm'), ('5', 'Reach is 5 mm')):
            self.refused(BOX, {'Obstacle disc/Center': '5, -90', 'Contact circle/Reach': reach}, 'out of reach',
                         'smallest gap is 70 mm', words, 'Contact circle/Reach')

    # units

    def warnings(self, case, overrides=None):
        result = solve(case, overrides, options=('--check',))
        return [line for line in (result.stdout + result.stderr).splitlines() if 'same units' in line]

    def test_metres_beside_millimetres_get_a_warning(self):
        for name in ('upper', 'lower'):
            for scale in ('1e-3', '1e3'):
                warning, = self.warnings(CYLINDERS, {'Body {}/Scale'.format(name): scale, 'Contact touch/Reach': 1e6})
                for word in ('warning: body', 'upper', 'lower', 'mm across', 'Scale'):
                    self.assertIn(word, warning)

    def with_moduli(self, below, above, size='10, 10'):
        materials = {name: {'Young modulus': E, 'Poisson ratio': '0.3'} for name, E in (('below', below), ('above', above))}
        return scenes.box(materials=materials,
                          bodies={'lower': {**RECTANGLE, 'Material': 'below'},
                                  'upper': {**RECTANGLE, 'Material': 'above', 'Origin': '0, 10', 'Size': size}},
                          supports={'below': {**scenes.HELD, 'Boundary': 'lower/bottom'}},
                          contacts={'touch': {'Slave': 'upper/bottom', 'Master': 'lower/top', 'Law': 'bonded'}},
                          Decomposition={'Method': 'METIS'})

    def test_pascal_beside_megapascal_gets_a_warning(self):
        for moduli in (('2.1e5', '2.1e11'), ('2.1e11', '7e4')):
            warning, = self.warnings(self.with_moduli(*moduli))
            self.assertIn('MPa', warning)
        self.assertEqual(len(self.warnings(self.with_moduli('2.1e5', '1e10', '0.2, 0.2'))), 1)  # both, each below its limit

    def test_bodies_that_differ_as_parts_do_get_no_warning(self):
        self.assertEqual(self.warnings(self.with_moduli('2.1e5', '2')), [])  # steel and rubber
        self.assertEqual(self.warnings(self.with_moduli('2', '2.1e5')), [])
        self.assertEqual(self.warnings(self.with_moduli('2.1e5', '2.1e5', '0.1, 0.1')), [])
        for scene in ('arch', 'clamp', 'lap_joint', 'raous', 'press_fit', 'hertz', 'cattaneo_mindlin'):
            self.assertEqual(self.warnings(shipped(scene)), [], scene)

    def accepted(self, case, overrides=None):
        result = solve(case, overrides, options=('--check',))
        self.assertEqual(result.status, 0, result)

    def test_pairs_that_meet_later_or_overlap_are_accepted(self):
        self.accepted(CYLINDERS, {'Body upper/Translation': '0, 60', 'Contact touch/Reach': 61})
        self.accepted(CYLINDERS, {'Body upper/Translation': '0, 60', 'Contact touch/Offset': '-60'})
        self.accepted(CYLINDERS, {'Body upper/Translation': '0, 60', 'Contact touch/Gap': '0.01*x^2'})
        self.accepted(CYLINDERS, {'Body upper/Translation': '0, 60', 'Support middle/Displacement y': '30*t'})
        self.accepted(CYLINDERS, {'Body upper/Translation': '0, -0.5'})

    def two(self, upper, **contact):
        """One square below, a body above, pressed down by its top."""
        return scenes.box(bodies={'lower': RECTANGLE, 'upper': {**RECTANGLE, **upper}},
                          supports={'below': {**scenes.HELD, 'Boundary': 'lower/bottom'},
                                    'above': {**scenes.HELD, 'Boundary': 'upper/top'}},
                          contacts={'touch': {'Slave': 'upper/bottom', 'Master': 'lower/top', 'Law': 'frictionless',
                                              **contact}},
                          Decomposition={'Method': 'METIS'})

    def test_deep_and_partial_overlaps_are_accepted(self):
        self.accepted(self.two({'Origin': '0, 6'}))      # flush sides
        self.accepted(self.two({'Origin': '9.5, 6'}))    # a fifth of an edge
        self.accepted(self.two({'Origin': '2, 6', 'Size': '2, 10', 'Cells': '1, 4'}))  # one slave edge
        self.accepted(self.two({'Origin': '-9, 10', 'Cells': '1, 4'}))
        self.accepted(self.two({'Origin': '0, 0.5'}, Slave='upper/*', Master='lower/*'))

    def test_body_behind_is_refused_whichever_side_is_slave(self):
        for sides in (('upper/top', 'lower/bottom'), ('lower/bottom', 'upper/top')):
            case = self.two({'Origin': '0, 12'}, Slave=sides[0], Master=sides[1])
            self.refused(case, {}, 'Contact touch', 'face away', '22 mm', ranks=(2,))

    def test_bodies_that_overlap_without_a_pair(self):
        case = scenes.box(bodies={'a': RECTANGLE, 'b': {**RECTANGLE, 'Origin': '8, 2', 'Size': '10, 5'}},
                          supports={'left': {**scenes.HELD, 'Boundary': 'a/left'},
                                    'right': {**scenes.HELD, 'Boundary': 'b/right'}},
                          Decomposition={'Method': 'METIS'})
        self.refused(case, {}, "bodies 'a' and 'b' overlap", 'pair')


if __name__ == '__main__':
    unittest.main()
