"""Values at points and along lines, and accumulated slip, against closed forms."""

import unittest

import scenes
from program import converged, run

PROBES = {'tip': {'Body': 'box', 'Point': '10, 3.3'},
          'along': {'Body': 'box', 'From': '0, 0', 'To': '10, 10', 'Number of points': '5'}}


def stretched(**kinds):
    return scenes.stretched(**{'probes': PROBES, **kinds})


class Probes(unittest.TestCase):

    def near(self, found, expected):
        for f, e in zip(found, expected, strict=True):
            self.assertAlmostEqual(float(f), e, delta=1e-9)

    def test_uniform_tension(self):
        for ranks in (1, 2):
            for degree in (1, 2):
                result = converged(stretched(Discretization={'Degree': degree}), {'Solver/Tolerance': '1e-12'}, ranks=ranks)
                history = result.rows('history.csv')
                for step, t in enumerate((1, 2)):
                    self.near([history[step]['probe tip ux'], history[step]['probe tip uy']],
                              [0.1 * t, -0.0025 * t * 3.3])
                found = result.rows('probes.csv', text=('probe',))
                self.assertEqual(len(found), 2 * (1 + 5))
                for row in found:
                    t, x, y = row['t'], row['x'], row['y']
                    self.near([row[name] for name in ('u_x', 'u_y', 'stress_xx', 'stress_yy', 'stress_xy', 'von_mises')],
                              [0.01 * t * x, -0.0025 * t * y, 10 * t, 0, 0, 10 * t])
                last = [row for row in found if row['probe'] == 'along'][-1]
                self.near([last['s'], last['x'], last['y']], [200 ** 0.5, 10, 10])
                tip, = result.summary['steps'][0]['probes']
                self.assertEqual((tip['probe'], tip['position']), ('tip', [10, 3.3]))
                self.near(tip['displacement'] + tip['stress'], [0.1, -0.00825, 10, 0, 0, 0])
                self.assertIn('probe tip at (10, 3.3): displacement (0.2, -0.0165) mm', result.stdout)

    def test_places_that_are_none(self):
        for probe, words in (({'Body': 'box', 'Point': '11, 3'}, "(11, 3) is not on body 'box'"),
                             ({'Body': 'box', 'From': '0, 0', 'To': '10, 10.5'}, '(9.8, 10.29) is not on'),
                             ({'Body': 'box', 'From': '0, 0'}, 'Probe p: To is not set'),
                             ({'Body': 'box', 'Point': '1, 1', 'To': '2, 2'}, 'is given in addition to a line'),
                             ({'Body': 'bax', 'Point': '1, 1'}, 'bax'), ({'Point': '1, 1'}, 'Probe p: Body is not set')):
            result = run(stretched(probes={'p': probe}), '--check', ranks=1 + (len(words) > 10))
            self.assertEqual(result.status, 2, result)
            self.assertIn(words, result.stderr)

    def test_slip_adds_up(self):
        """A block pressed on the rigid floor is driven along it at its top: its foot slides by 0.01 a step."""
        case = scenes.box('slides', materials={'elastic': scenes.SOFT},
                          bodies={'box': {'Size': '10, 10', 'Cells': '4, 4', 'Material': 'elastic'}},
                          obstacles={'floor': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}},
                          supports={'top': {'Boundary': 'box/top', 'Displacement x': '0.01*min(t, 4-t)', 'Displacement y': '0'}},
                          contacts={'foot': {'Slave': 'box/bottom', 'Master': 'floor', 'Law': 'Coulomb',
                                             'Friction coefficient': '0', 'Offset': '-0.01'}},
                          **{'Load steps': {'Factors': '0, 1, 2, 3'}, 'Solver': {'Tolerance': '1e-10'}, 'Decomposition': scenes.CUT})
        contact = converged(case).contact
        for step, (slip, total) in enumerate(((0, 0), (0.01, 0.01), (0.01, 0.02), (-0.01, 0.01))):
            # the tangent of the foot runs along x, that of a normal that points down
            middle, = [row for row in contact if row['step'] == step and row['x'] == 5]
            self.near([middle['slip'], middle['total_slip']], [slip, total])


if __name__ == '__main__':
    unittest.main()
