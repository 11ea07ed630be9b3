"""Slip bounds, friction coefficients, gaps and loads from nothing to far too much."""

import unittest

from sweep import Extremes, Table, count, pair, scenes, shipped, stack


def held(contact, **more):
    """The stack with its upper body guided along y, so that it needs no friction."""
    text = stack(contact=contact, **more)
    content = text.read_text().replace('set Supports = floor', 'set Supports = floor, guide')
    text.write_text(content + 'subsection Support guide\n  set Boundary = box/left\n  set Displacement x = 0\nend\n')
    return text


class ContactData(Extremes):

    def test_slip_bound(self):
        table = Table('Tresca bound [MPa], upper body guided')
        forces = []
        for bound in ('0', '1e-12', '1e-6', '0.1', '1', '10', '1e3', '1e6', '1e12'):
            result = self.converges(table, bound, held({'Law': 'Tresca', 'Slip bound': bound}), most=60)
            self.assertLessEqual(abs(pair(result)['tangential_force']), float(bound) * 10 * (1 + 1e-6) + 1e-9)
            self.near(pair(result)['normal_force'], 100, 0.2)  # friction at the guide does not act
            forces.append(abs(pair(result)['tangential_force']))
        self.assertLess(forces[0], 1e-9)
        self.near(forces[-1], forces[-2], 1e-6)  # all stick: the bound does not matter
        free = self.converges(table, 'frictionless', held({'Law': 'frictionless'}))
        zero = self.converges(table, '0 again', held({'Law': 'Tresca', 'Slip bound': '0'}))
        self.near(zero.summary['results']['strain_energy'], free.summary['results']['strain_energy'], 1e-6)

    def test_slip_bound_that_the_load_just_reaches(self):
        table = Table('Tresca bound [MPa] against a mean shear of 1 MPa, upper body free')
        for bound in ('1.1', '1.0001'):
            self.in_balance(self.converges(table, bound, stack(contact={'Law': 'Tresca', 'Slip bound': bound})))
        for bound in ('0.9999', '0.5', '0'):
            self.ends(4, table, bound, stack(contact={'Law': 'Tresca', 'Slip bound': bound}), 'body box',
                      'translation along (1, 0)', 'slip bound')

    def test_friction_coefficient(self):
        table = Table('friction coefficient')
        for mu in ('0.101', '0.11', '0.3', '1', '2', '5', '10'):
            result = self.converges(table, 'stack, ' + mu, stack(contact={'Friction coefficient': mu}),
                                    friction=float(mu), most=60)
            self.in_balance(result)
        for mu in ('0', '1e-12', '0.099'):
            self.ends(4, table, 'stack, ' + mu, stack(contact={'Friction coefficient': mu}), 'body box: translation along (',
                      'friction coefficient')
        for mu in ('0', '0.1', '1', '2', '5', '10'):
            self.converges(table, 'Raous block, ' + mu, shipped('raous'), {'Contact ground/Friction coefficient': mu},
                           friction=float(mu), checks=1e-4, most=80)

    def test_gap(self):
        table = Table('gap [mm], upper body held by contact alone')
        energy = {}
        for gap in ('0', '1e-14', '-1e-14', '1e-9', '-1e-9', '1e-3', '1', '1e3'):
            result = self.converges(table, gap, stack(contact={'Gap': gap}), most=30)
            self.in_balance(result)
            energy[gap] = result.summary['results']['strain_energy']
            far = any('times the size of the body' in text for text in result.summary['warnings'])
            self.assertEqual(far, gap == '1e3', result)
        for gap in energy:  # a rigid motion more
            self.near(energy[gap], energy['0'], 1e-6, gap)

    def test_overlap(self):
        """Two squares that overlap and are held top and bottom: pressure E w / (2 h) without side effects."""
        table = Table('overlap [mm], outer sides held in y, nu = 0')
        plain = {'Poisson ratio': '0'}
        for gap in ('1e-14', '0', '-1e-14', '-1e-9', '-1e-6', '-1e-3', '-1', '-5'):
            case = scenes.box(
                materials={'plain': {'Young modulus': '2.1e5', 'Poisson ratio': '0'}},
                bodies={'base': {'Size': '10, 10', 'Cells': '4, 4', 'Material': 'plain'},
                        'box': {'Origin': '0, 10', 'Size': '10, 10', 'Cells': '4, 4', 'Material': 'plain'}},
                supports={'floor': {'Boundary': 'base/bottom', 'Displacement x': '0', 'Displacement y': '0'},
                          'roof': {'Boundary': 'box/top', 'Displacement x': '0', 'Displacement y': '0'}},
                contacts={'joint': {'Slave': 'box/bottom', 'Master': 'base/top', 'Law': 'Coulomb',
                                    'Friction coefficient': '0.3', 'Gap': gap}},
                Decomposition={'Method': 'METIS', 'Subdomains': '4'}, Solver={'Tolerance': '1e-8'})
            result = self.converges(table, gap, case)
            expected = max(0., -float(gap)) * 2.1e5 / 20 * 10
            self.assertLessEqual(abs(pair(result)['normal_force'] - expected), 1e-6 * expected, gap)
            about = ' '.join(result.summary['warnings'])
            self.assertEqual('overlap by' in about, gap == '-5', result)
            self.assertEqual('strain' in about, gap == '-5', result)

    def test_load(self):
        table = Table('factor of the load')
        reference = self.converges(table, '1', stack())
        for factor in ('1e-12', '1e-6', '1e3', '1e6', '1e12'):
            load = {'Traction x': factor, 'Traction y': '-10*{}*(1+x/10)/1.5'.format(factor)}
            result = self.converges(table, factor, stack(load=load))
            self.in_balance(result, 100 * float(factor), 10 * float(factor))
            self.near(result.summary['results']['max_displacement'] / float(factor),
                      reference.summary['results']['max_displacement'], 1e-6)
            self.assertEqual(count(result), count(reference))
            about = ' '.join(result.summary['warnings'])
            for word in ('strain', 'rotation', 'pressure', 'times the size of the body'):
                self.assertEqual(word in about, float(factor) > 1e5 or (float(factor) > 1e2 and word in ("strain", "rotation")),
                                 '{} {}'.format(word, result))

    def test_no_load(self):
        table = Table('no load')
        result = self.converges(table, 'held box over a circle',
                                scenes.box(contacts={'circle': scenes.CIRCLE}, supports={'held': scenes.HELD},
                                           Solver={'Tolerance': '1e-8'}), checks=1e-4, most=30)
        self.assertEqual({row['pressure'] for row in result.contact}, {0.})
        self.assertLess(result.summary['results']['max_displacement'], 1e-7)
        for what, law in (('closed gap, Coulomb', {'Law': 'Coulomb', 'Friction coefficient': '0.3'}),
                          ('closed gap, no friction', {'Law': 'frictionless'}),
                          ('closed gap, Tresca', {'Law': 'Tresca', 'Slip bound': '5'})):
            case = scenes.box(
                bodies={'base': {'Size': '10, 10', 'Cells': '4, 4', 'Material': 'elastic'},
                        'box': {'Origin': '0, 10', 'Size': '10, 10', 'Cells': '4, 4', 'Material': 'elastic'}},
                supports={'floor': {'Boundary': 'base/bottom', 'Displacement x': '0', 'Displacement y': '0'},
                          'side': scenes.HELD},
                contacts={'joint': {'Slave': 'box/bottom', 'Master': 'base/top', **law}},
                Decomposition={'Method': 'METIS', 'Subdomains': '4'})
            result = self.converges(table, what, case, most=5)
            self.assertEqual(result.summary['solver']['fallbacks'], 0)
            self.assertEqual(result.summary['results']['max_displacement'], 0)
            self.assertEqual({row['pressure'] for row in result.contact}, {0.})


if __name__ == '__main__':
    unittest.main()
