"""Loads that act on no boundary: rows of conditions.csv, and what --draw makes of them, in the plane and in space."""

import csv
import re
import unittest
from xml.etree import ElementTree

import scenes
from program import converged, new_path, run, shipped

STEEL = {'Young modulus': '2e5', 'Poisson ratio': '0.3', 'Density': '2', 'Thermal expansion': '1e-5'}


def section(kind, name, **values):
    lines = ''.join('  set {} = {}\n'.format(key.replace('_', ' '), value) for key, value in values.items())
    return 'subsection {} {}\n{}end\n'.format(kind, name, lines)


def loaded(state='plane stress'):
    """A bar held at both ends, with all kinds of loads, and a ring beside it."""
    bodies = {'bar': {'Origin': '1, 0', 'Size': '2, 6', 'Cells': '2, 5'}, 'ring': {'Shape': 'ring', 'Center': '20, 0', 'Radius': '4',
                                                                                  'Inner radius': '2', 'Cells': '24, 2'}}
    supports = {name: {'Boundary': boundary, 'Displacement x': '0', 'Displacement y': '0'}
                for name, boundary in (('foot', 'bar/bottom'), ('head', 'bar/top'), ('hub', 'ring/inner'))}
    if state == 'axisymmetric':
        bodies.pop('ring')
        supports.pop('hub')
    text = scenes.text(plane_state=state, materials={'steel': STEEL},
                       bodies={name: {**values, 'Material': 'steel'} for name, values in bodies.items()}, supports=supports,
                       **{'Load steps': {'Factors': '1, 2, 3'}, 'Decomposition': {'Method': 'METIS', 'Subdomains': '3'}})
    text += 'set Body forces = weight, spin\nset Temperatures = heat\nset Pretensions = m8\n'
    text += section('Body force', 'weight', Bodies='all', Force_y='-1*t', **{'Acceleration_y': '-3*t*(t < 3)'})
    text += section('Body force', 'spin', Bodies='bar', Angular_velocity='0.5*t', **({'Axis': '7, 8'} if state != 'axisymmetric' else {}))
    text += section('Temperature', 'heat', Bodies='bar', Change='-10*(t == 2)')
    return scenes.write('loaded', text + section('Pretension', 'm8', Body='bar', Point='2, 3.3', Direction='0, 2',
                                                 Force='1000*t', Tightened_until='2'))


class Rows(unittest.TestCase):
    maxDiff = None

    def rows(self, result):
        with open(result.directory / 'conditions.csv', newline='') as stream:
            return list(csv.DictReader(stream))

    def numbers(self, row, names=('x1', 'y1', 'x2', 'y2', 'value')):
        return [float(row[name]) for name in names]

    def test_where_loads_in_bodies_are(self):
        for ranks in (1, 2):
            rows = self.rows(converged(loaded(), {'Output/VTU': 'false'}, ranks=ranks))
            self.assertEqual({row['value'] for row in rows if row['kind'] == 'support'}, {''})
            found = {(row['kind'], row['name'], row['side'], row['body']): self.numbers(row) for row in rows if row['value']}
            in_ring = found.pop(('body force', 'weight', '', 'ring'))
            self.assertEqual(found, {('body force', 'weight', '', 'bar'): [2, 3, 2, 3, 14],  # (1 + 2*3) t, at t = 2
                                     ('body force', 'spin', 'axis', 'bar'): [7, 8, 7, 8, 1.5],
                                     ('temperature', 'heat', '', 'bar'): [2, 3, 2, 3, -10],
                                     ('pretension', 'm8', 'section', 'bar'): [1, 3.3, 3, 3.3, 2000],
                                     ('pretension', 'm8', 'axis', 'bar'): [2, 0, 2, 6, 2000]})
            self.assertEqual(in_ring[:2], in_ring[2:4])
            self.assertTrue(2 < abs(complex(in_ring[0] - 20, in_ring[1])) < 4, in_ring)  # not in the hole
        rows = self.rows(converged(loaded('axisymmetric'), {'Output/VTU': 'false'}))
        axis, = [row for row in rows if row['name'] == 'spin']
        self.assertEqual(self.numbers(axis), [0, 0, 0, 6, 1.5])

    def test_other_scenes_have_the_columns_that_they_had(self):
        rows = self.rows(converged(shipped('box_on_circle'), {'Decomposition/Cells per block': 2, 'Output/VTU': 'false'}))
        self.assertEqual(list(rows[0]), ['kind', 'name', 'side', 'body', 'x1', 'y1', 'x2', 'y2'])

    def test_in_space(self):
        text = scenes.text(materials={'steel': STEEL}, bodies={'bar': {'Size': '2, 6, 1', 'Cells': '2, 5, 1', 'Material': 'steel'}},
                           supports={end: {'Boundary': 'bar/' + end, **{'Displacement ' + c: '0' for c in 'xyz'}} for end in ('bottom', 'top')},
                           Decomposition={'Method': 'METIS', 'Subdomains': '2'})
        text += 'set Body forces = spin\nset Pretensions = m8\n'
        text += section('Body force', 'spin', Bodies='bar', Angular_velocity='2', Axis='7, 8, 0', Axis_direction='0, 0, 3')
        text += section('Pretension', 'm8', Body='bar', Point='1, 3.3, 0.5', Direction='0, 1, 0', Force='10')
        rows = self.rows(converged(scenes.write('bar', 'set Dimension = 3\n' + text.split('\n', 1)[1]), {'Output/VTU': 'false'}, ranks=2))
        places = {}
        for row in rows:
            if row['value']:
                places[row['kind'], row['side']] = [tuple(self.numbers(row, ['{}{}'.format(c, k) for c in 'xyz'])) for k in (1, 2, 3, 4)]
        self.assertEqual(places['body force', 'axis'], [(7, 8, 0)] + 3 * [(7, 8, 1)])
        self.assertEqual(places['pretension', 'axis'], [(1, 0, 0.5)] + 3 * [(1, 6, 0.5)])
        self.assertEqual(set(places['pretension', 'section']), {(x, 3.3, z) for x in (0, 2) for z in (0, 1)})


class Drawings(unittest.TestCase):

    def drawn(self, case, *options, ranks=1):
        """Elements of the picture by class."""
        file = new_path('pictures') / 'scene.svg'
        result = run(case, '--draw', file, *options, ranks=ranks)
        self.assertEqual((result.status, result.stderr), (0, ''), result)
        found = {}
        for element in ElementTree.parse(file).iter():
            found.setdefault(element.get('class', element.tag.rsplit('}')[-1]), []).append(element)
        return found

    def legend(self, drawn):
        return [element.text for element in drawn['text']]

    def ends(self, element):
        numbers = [float(number) for number in re.findall(r'-?[\d.]+', element.get('d'))]
        return [tuple(numbers[k:k + 2]) for k in range(0, len(numbers), 2)]

    def test_loads_in_bodies(self):
        for ranks in (1, 2):
            drawn = self.drawn(loaded(), ranks=ranks)
            self.assertEqual(self.legend(drawn), ['support foot', 'support head', 'support hub', 'body force weight', 'body force spin',
                                                  'temperature heat', 'pretension m8'])
            self.assertEqual([element.text for element in drawn['label']], ['-10 K'])
            self.assertEqual(len(drawn['turning']), 1)
            self.assertEqual(len(drawn['body force']), 2)  # dots in both bodies
            pixels = 900 / 23  # a mm: from x = 1 to 24
            bar = (40 + pixels, 40 + pixels * 5)  # the middle at (2, 3), below the axis of rotation at y = 8
            dot = drawn['body force'][0]
            self.assertAlmostEqual(float(dot.get('cx')), bar[0], delta=0.02)
            self.assertAlmostEqual(float(dot.get('cy')), bar[1], delta=0.02)
            arrows = [self.ends(element) for element in drawn['arrow']]
            down = [arrow for arrow in arrows if arrow[0][1] < arrow[1][1] and abs(arrow[0][1] - bar[1]) < 0.02]
            self.assertEqual(len(down), 1)  # begins at the dot
            section_y = 40 + pixels * 4.7
            meeting = [arrow for arrow in arrows if abs(arrow[1][1] - section_y) < 0.02 and abs(arrow[1][0] - bar[0]) < 0.02]
            self.assertEqual(sorted(round(arrow[0][1] - section_y) for arrow in meeting), [-45, 45])
            lines = [self.ends(element) for element in drawn['pretension']]
            self.assertEqual(sorted(abs(line[0][0] - line[1][0]) > 1 for line in lines), [False, True])  # axis, section

    def test_probes(self):
        probes = {'middle': {'Body': 'box', 'Point': '5, 5'}, 'cut': {'Body': 'box', 'From': '0, 2', 'To': '10, 4'}}
        drawn = self.drawn(scenes.box(supports={'held': scenes.HELD}, probes=probes), ranks=2)
        self.assertEqual(self.legend(drawn), ['support held', 'probe middle', 'probe cut'])
        dot, line = sorted(drawn['probe'], key=lambda element: element.tag)
        self.assertEqual([float(dot.get(name)) for name in ('cx', 'cy')], [490, 490])  # 900 pixels, a border of 40
        self.assertEqual(self.ends(line), [(40, 760), (940, 580)])

    def test_solids(self):
        cube = shipped('cube_on_sphere')
        small = ('--set', 'Decomposition/Blocks=2', '--set', 'Decomposition/Cells per block=2')
        drawn = self.drawn(cube, *small, ranks=2)
        self.assertEqual(self.legend(drawn), ['contact, slave sphere', 'support clamp', 'traction pressed'])
        faces = [element for element in drawn['path'] if element.get('fill', '').startswith('#')]
        self.assertEqual(len([element for element in faces if element.get('d').endswith('z')]) - 2, 3 * 16)  # two tips of arrows
        for name in ('support', 'traction', 'contact, slave'):
            self.assertEqual(drawn[name][0].get('d').count('z'), 16)
        circle, = drawn['obstacle']
        self.assertGreater(float(circle.get('r')), 3000)  # radius 100 beside a cube of 10
        for arrow in drawn['arrow']:
            (x0, y0), (x1, y1) = self.ends(arrow)
            self.assertEqual(x0, x1)
            self.assertGreater(y1, y0)  # downwards


if __name__ == '__main__':
    unittest.main()
