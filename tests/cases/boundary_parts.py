"""Boundaries by condition: `top where x < 5` wherever a boundary is named."""

import unittest

import scenes
from program import converged, run, solve

FLOOR = {'Boundary': 'box/bottom', 'Displacement x': '0', 'Displacement y': '0'}
DOWN = {'Boundary': 'box/top where abs(x-5) < 2.5', 'Traction y': '-10'}


class BoundaryParts(unittest.TestCase):

    def test_a_load_on_a_part(self):
        """The same as a load with a jump on the whole boundary; nodes are where the condition changes."""
        for refinements, ranks in ((0, 1), (1, 2)):
            common = {'supports': {'floor': FLOOR}, 'bodies': {'box': {**scenes.BOX, 'Cells': '8, 4'}},
                      'Discretization': {'Refinements': refinements}, 'Decomposition': scenes.CUT, 'Solver': {'Tolerance': '1e-10'}}
            part = converged(scenes.box(tractions={'down': DOWN}, **common), ranks=ranks)
            whole = converged(scenes.box(tractions={'down': {'Boundary': 'box/top', 'Traction y': '-10*(abs(x-5) < 2.5)'}},
                                         **common), ranks=ranks)
            self.assertAlmostEqual(part.summary['results']['loads'][0]['force'][1], -50, delta=1e-9)
            for key in ('strain_energy', 'max_displacement', 'max_von_mises'):
                self.assertAlmostEqual(part.summary['results'][key] / whole.summary['results'][key], 1, delta=1e-8)
            self.assertEqual([text for text in part.summary['warnings'] if 'changes within' in text], [])
            rows = [row for row in part.rows('conditions.csv', text=('kind', 'name', 'side', 'body')) if row['kind'] == 'traction']
            self.assertEqual((len(rows), min(row['x2'] for row in rows), max(row['x1'] for row in rows)),
                             (4 << refinements, 2.5, 7.5))

    def test_supports_and_contact_on_parts_that_overlap(self):
        """Edges have several names: the whole boundary and parts of it."""
        case = scenes.box(
            bodies={'box': {**scenes.BOX, 'Cells': '4, 4'},
                    'base': {'Origin': '0, -5', 'Size': '10, 5', 'Cells': '4, 2', 'Material': 'elastic'}},
            supports={'floor': {'Boundary': 'base/* where y < -4.9', 'Displacement x': '0', 'Displacement y': '0'},
                      'left': {'Boundary': 'box/left where y > 5', 'Displacement x': '0'}},
            tractions={'down': {'Boundary': 'box/top', 'Traction y': '-10'},
                       'more': {'Boundary': 'box/top where x > 5', 'Traction y': '-1'},
                       'and more': {'Boundary': 'box/top where x > 2.5 && x < 7.5', 'Traction y': '-1'}},
            contacts={'joint': {'Slave': 'box/bottom where x < 5', 'Master': 'base/top', 'Law': 'Coulomb',
                                'Friction coefficient': '0.3'},
                      'other': {'Slave': 'box/bottom where x > 5', 'Master': 'base/top where x > 2.5', 'Law': 'frictionless'}},
            Decomposition=scenes.CUT)
        result = converged(case, ranks=2)
        loads = {one['load']: one['force'][1] for one in result.summary['results']['loads']}
        for name, force in (('down', -100), ('more', -5), ('and more', -5)):
            self.assertAlmostEqual(loads[name], force, delta=1e-9)
        floor = result.summary['results']['supports'][0]['force']
        self.assertAlmostEqual(floor[1], 110, delta=1e-3)
        self.assertAlmostEqual(sum(pair['force'][1] for pair in result.summary['results']['contact']), 110, delta=1e-3)
        self.assertIn('set Boundary = box/top where x > 2.5 && x < 7.5',
                      ' '.join((result.directory / 'parameters.prm').read_text().split()))
        again = converged(result.directory / 'parameters.prm', ranks=2)
        self.assertEqual(again.summary['results'], result.summary['results'])

    def test_where_an_edge_is_cut(self):
        result = converged(scenes.box(supports={'floor': FLOOR}, tractions={'down': {**DOWN, 'Boundary': 'box/top where x < 3'}},
                                      Decomposition=scenes.CUT, bodies={'box': {**scenes.BOX, 'Cells': '4, 4'}}))
        self.assertAlmostEqual(result.summary['results']['loads'][0]['force'][1], -25, delta=1e-9)
        self.assertIn("Traction down: 'x < 3' changes within 1 edge of boundary 'top' of body 'box', such as that around (3.75, 10)",
                      result.stdout)

    def test_what_is_refused(self):
        for boundary, words in (('box/top where x > 10', ('Traction down', 'no edge', "'x > 10'")),
                                ('box/tip where x > 5', ("no boundary 'tip'", "'top'")),
                                ('box/top where x >', ('x >',)),
                                ('box/top where x > 5*t', ('load factor t',)),
                                ('box/top where u > 1', ('u',))):
            for ranks in (1, 2):
                result = solve(scenes.box(supports={'floor': FLOOR}, tractions={'down': {**DOWN, 'Boundary': boundary}},
                                          Decomposition=scenes.CUT), ranks=ranks)
                self.assertEqual(result.status, 2, result)
                for word in words:
                    self.assertIn(word, result.stderr)
        blocks = run(scenes.box(supports={'floor': FLOOR}, tractions={'down': DOWN}), '--check')
        self.assertEqual(blocks.status, 2, blocks)
        self.assertIn('Decomposition/Method', blocks.stderr)


if __name__ == '__main__':
    unittest.main()
