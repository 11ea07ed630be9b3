"""answer.py accepts what the program writes of a block pushed along a floor, in the plane and in space, and finds what was changed
in it: a check that finds nothing would be worth nothing."""

import csv
import json
import pathlib
import re
import shutil
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[0] = str(HERE.parent / 'cases')  # has another scenes.py than this directory
sys.path.append(str(HERE))
import scenes  # noqa: E402
import solids  # noqa: E402
from answer import problem_of  # noqa: E402
from program import converged, new_path  # noqa: E402

SLIDING = {'touch': {'Slave': 'box/bottom', 'Master': 'floor', 'Law': 'Coulomb', 'Friction coefficient': '0.3'}}
DRIVEN = {'driven': {'Boundary': 'box/top', 'Displacement x': '0.05', 'Displacement y': '-0.01'}}
SHARP = {'Tolerance': '1e-8'}
ELASTIC = {'elastic': {'Young modulus': '1e4', 'Poisson ratio': '0.3'}}


def plane():
    return scenes.box(materials=ELASTIC, supports=DRIVEN, contacts=SLIDING, Decomposition={'Method': 'none'}, Solver=SHARP,
                      bodies={'box': {'Size': '10, 4', 'Cells': '10, 4', 'Material': 'elastic'}},
                      obstacles={'floor': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}})


def solid():
    return solids.solid(materials=ELASTIC, supports={'driven': {**DRIVEN['driven'], 'Displacement z': '0'}}, contacts=SLIDING, Solver=SHARP,
                        bodies={'box': {'Size': '10, 4, 10', 'Cells': '5, 2, 5', 'Material': 'elastic'}},
                        obstacles={'floor': {'Shape': 'half space', 'Point': '0, 0, 0', 'Normal': '0, 1, 0'}})


class Answers(unittest.TestCase):

    def setUp(self):
        self.outputs = [converged(case()).directory for case in (plane, solid)]

    def found(self, what, change, output):
        """@param change of a copy of the output directory."""
        copy = new_path('changed')
        shutil.copytree(output, copy)
        change(copy)
        self.assertIn(what, problem_of(copy))

    def test_right_answers_pass(self):
        for output in self.outputs:
            self.assertEqual(problem_of(output), '')

    def test_changed_tables_are_found(self):
        for output in self.outputs:
            with open(output / 'contact.csv', newline='') as stream:
                rows = list(csv.DictReader(stream))
            largest = max(float(row['pressure']) for row in rows)
            slip = max((i for i, row in enumerate(rows) if row['status'] == 'slip'), key=lambda i: float(rows[i]['pressure']))
            for what, column, value in (('tension', 'pressure', -largest), ('penetration', 'gap', -0.03),
                                        ('pressure across a gap', 'gap', 0.03), ('friction beyond its bound', 'slip_bound', 0),
                                        ('beyond the coefficient', 'pressure', 1e-3 * largest)):
                def change(copy):
                    changed = [dict(row) for row in rows]
                    changed[slip][column] = repr(value)
                    with open(copy / 'contact.csv', 'w', newline='') as stream:
                        writer = csv.DictWriter(stream, rows[0])
                        writer.writeheader()
                        writer.writerows(changed)
                with self.subTest(what):
                    self.found(what, change, output)

            def turned(copy):
                names = [name for name in rows[0] if name == 'slip' or name.startswith('slip_') and name != 'slip_bound']
                with open(copy / 'contact.csv', 'w', newline='') as stream:
                    writer = csv.DictWriter(stream, rows[0])
                    writer.writeheader()
                    writer.writerows([{**row, **{name: repr(-float(row[name])) for name in names}} for row in rows])
            self.found('friction along the slip', turned, output)

    def test_changed_summaries_are_found(self):
        def set_converged(summary):
            summary['converged'] = False

        def set_force(summary):
            summary['results']['supports'][0]['force'][0] *= 1.1

        def set_moment(summary):
            support = summary['results']['supports'][0]
            support['moment'] = [1.5 * m for m in support['moment']] if isinstance(support['moment'], list) else 1.5 * support['moment']

        def set_residual(summary):
            summary['residuals']['penetration'] = 0.2
        for output in self.outputs:
            for what, change in (('did not converge', set_converged), ('forces are out', set_force), ('moments are out', set_moment),
                                 ('residuals', set_residual)):
                def rewrite(copy):
                    summary = json.loads((copy / 'summary.json').read_text())
                    change(summary)
                    (copy / 'summary.json').write_text(json.dumps(summary))
                self.found(what, rewrite, output)

    def test_places_are_compared_with_the_obstacles(self):
        for output, point in zip(self.outputs, ('0, 0', '0, 0, 0')):
            def raised(copy):
                path = copy / 'parameters.prm'
                text = path.read_text()
                changed = re.sub('(Point +)= ' + point, r'\1= ' + point.replace('0', '0.02'), text)
                self.assertNotEqual(text, changed)
                path.write_text(changed)
            self.found('inside of floor', raised, output)


if __name__ == '__main__':
    unittest.main()
