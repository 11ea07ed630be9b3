"""Bodies that nothing holds, or hardly anything: an answer where there is one, else what moves, how, and what to add."""

import math
import unittest

from sweep import FLOOR, QUIET, Extremes, Table, pair, run, scenes, shipped, solve

SQUARE = {'Size': '10, 10', 'Cells': '4, 4', 'Material': 'elastic'}
TWO = {'base': SQUARE, 'box': {**SQUARE, 'Origin': '0, 10'}}
JOINT = {'Slave': 'box/bottom', 'Master': 'base/top', 'Law': 'Coulomb', 'Friction coefficient': '0.3'}
DOWN = {'Boundary': 'box/top', 'Traction y': '-10'}
ROLLER = {'Boundary': 'box/left', 'Displacement x': '0'}
CUT = {'Decomposition': {'Method': 'METIS', 'Subdomains': '5'}, 'Solver': {'Tolerance': '1e-8'}}
PUSHED = 'where the loads push'


def two(**kinds):
    return scenes.box(bodies=TWO, contacts=kinds.pop('contacts', {'joint': JOINT}),
                      supports=kinds.pop('supports', {'floor': FLOOR}), tractions=kinds.pop('tractions', {'down': DOWN}),
                      **CUT, **kinds)


class Supports(Extremes):

    def set_to_zero(self, table, what, case, *words):
        result = self.converges(table, what, case)
        warning, = [text for text in result.summary['warnings'] if text.startswith('nothing resists')]
        for word in words:
            self.assertIn(word, warning)
        return result

    def test_one_body(self):
        table = Table('one body')
        down = {'down': DOWN}
        self.ends(2, table, 'no support at all', scenes.box(tractions=down), "nothing holds body 'box'")
        for what, supports, tractions, words in (
                ('roller, pushed along it', {'a': ROLLER}, down, ('translation along (0, -1)', PUSHED)),
                ('two rollers in line', {'a': ROLLER, 'b': {**ROLLER, 'Boundary': 'box/right'}}, down,
                 ('translation along (0, -1)',)),
                ('pinned in the middle of the foot', {'a': {'Body': 'box', 'Point': '5, 0', 'Displacement x': '0',
                                                            'Displacement y': '0'}},
                 {'s': {'Boundary': 'box/right', 'Traction y': '-3'}}, ('rotation about (5, 0)', PUSHED)),
                ('one point in one direction', {'a': {'Body': 'box', 'Point': '5, 0', 'Displacement y': '0'}},
                 {'s': {'Boundary': 'box/right', 'Traction x': '3'}}, ('one of 2 free motions',))):
            for ranks in (1, 2) if 'pinned' in what else (1,):
                result = self.ends(4, table, '{}, {} rank(s)'.format(what, ranks),
                                   scenes.box(supports=supports, tractions=tractions), 'nothing holds body box: ', *words,
                                   ranks=ranks)
                self.assertEqual(result.summary['status'], 'no equilibrium')
        self.set_to_zero(table, 'roller, nothing along it',
                         scenes.box(supports={'a': ROLLER}, tractions={'s': {'Boundary': 'box/right', 'Traction x': '3'}},
                                    Solver={'Tolerance': '1e-8'}),
                         'body box: translation along (0, 1)')
        enough = scenes.box(supports={'a': ROLLER, 'b': {'Body': 'box', 'Point': '5, 0', 'Displacement y': '0'}},
                            tractions=down, Solver={'Tolerance': '1e-8'})
        self.converges(table, 'roller and one point', enough)
        self.assertEqual(run(enough, '--check').status, 0)

    def test_floating_bodies(self):
        table = Table('two bodies')
        squeezed = {'down': DOWN, 'up': {'Boundary': 'base/bottom', 'Traction y': '10'}}
        self.set_to_zero(table, 'holding only each other, loads balance', two(supports={}, tractions=squeezed),
                         'body base: translation along (1, 0); body box: translation along (1, 0)',
                         'body base: translation along (0, 1); body box: translation along (0, 1)', 'rotation about')
        self.ends(4, table, 'holding only each other, one load', two(supports={}),
                  'body base: translation along (0, -1); body box: translation along (0, -1)', PUSHED)
        held = self.converges(table, 'the same with three supported components', two(
            supports={'a': {'Body': 'base', 'Point': '0, 0', 'Displacement x': '0', 'Displacement y': '0'},
                      'b': {'Body': 'base', 'Point': '10, 0', 'Displacement y': '0'}}, tractions=squeezed))
        self.in_balance(held, 100, 0)
        result = self.converges(table, 'pressed, no tangential load', two())
        self.in_balance(result, 100, 0)
        for law in ({'Law': 'frictionless'}, {'Law': 'Coulomb', 'Friction coefficient': '0'},
                    {'Law': 'Tresca', 'Slip bound': '0'}):
            sliding = {'Slave': 'box/bottom', 'Master': 'base/top', **law}
            self.ends(4, table, 'pressed, {}, pushed'.format(law['Law']),
                      two(contacts={'joint': sliding}, tractions={'down': {**DOWN, 'Traction x': '1'}}),
                      'body box: translation along (1, 0)', without=('body base',))
        result = self.set_to_zero(table, 'pressed, frictionless, not pushed',
                                  two(contacts={'joint': {**JOINT, 'Law': 'frictionless'}}), 'body box: translation along (1, 0)')
        self.in_balance(result, 100, 0)
        self.ends(4, table, 'lifted off', two(tractions={'up': {**DOWN, 'Traction y': '10'}}), 'body box: ')
        tipping = two(tractions={'tip': {**DOWN, 'Traction x': '6'}}, contacts={'joint': {**JOINT, 'Friction coefficient': '5'}})
        for seed in range(4):
            self.ends(4, table, 'tipped over its edge, cut {}'.format(seed), tipping, 'body box: rotation about (10, 10)',
                      overrides={'Decomposition/Seed': seed})
        elsewhere = {'side': {'Boundary': 'base/right', 'Traction x': '1'}}
        for law in ({'Law': 'Coulomb', 'Friction coefficient': '0.3'}, {'Law': 'frictionless'},
                    {'Law': 'Tresca', 'Slip bound': '1'}):
            result = solve(two(contacts={'joint': {**JOINT, **law}}, tractions=elsewhere))
            table.add('free and unloaded, ' + law['Law'], result)
            self.assertEqual(result.status, 0, result)
            warnings = ' '.join(result.summary['warnings'])
            self.assertIn('nothing resists body box: ', warnings)
            self.assertNotIn('body base', warnings)
        self.ends(2, table, 'free, unloaded, no contact', two(contacts={}, tractions=elsewhere),
                  "nothing holds body 'box'")

    def test_heavy_disc_pushed_aside(self):
        """Random scenes 340 and 867. Obstacles that lean by 0.009 cannot hold a third of the weight along x without friction, by
        forces however large. With friction the disc rolls on and rests on two nodes."""
        table = Table('heavy disc pushed aside')

        def disc(radius, cells, material, push, weight, obstacle, contact):
            return scenes.box(
                plane_state='plane strain', materials={'elastic': material},
                bodies={'disc': {'Shape': 'disc', 'Center': '{0}, {0}'.format(radius), 'Radius': radius,
                                 'Cells along arc': cells, 'Material': 'elastic'}},
                obstacles={'ground': obstacle}, contacts={'foot': {'Slave': 'disc/arc', 'Master': 'ground', **contact}},
                body_forces={'weight': {'Bodies': 'all', 'Force x': push, 'Force y': weight}})

        for seed in (3, 7):
            for algorithm in ('semismooth newton', 'smalbe'):
                self.ends(4, table, 'frictionless, cut {}, {}'.format(seed, algorithm), disc(
                    3.843, 20, {'Young modulus': 49112, 'Poisson ratio': 0.44}, -0.4515, -1.1295,
                    {'Shape': 'function', 'Height': '-0.02306*(1-cos(0.3903*x))'}, {'Law': 'frictionless'}),
                    'no contact forces within their bounds', 'body disc: translation along (-1, 0.00', without=('nothing holds',),
                    overrides={'Discretization/Degree': 2, 'Decomposition/Method': 'METIS', 'Decomposition/Subdomains': 2,
                               'Decomposition/Seed': seed, 'Solver/Algorithm': algorithm, 'Solver/Tolerance': 1e-10})
        rolling = disc(1.988, 16, {'Young modulus': 5.5565e7, 'Poisson ratio': 0.073}, 2.963, -23.073,
                       {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'},
                       {'Law': 'Coulomb', 'Friction coefficient': 0.1888, 'Offset': -4.2917e-6})
        cut = {**QUIET, 'Decomposition/Method': 'METIS', 'Decomposition/Subdomains': 2}
        area = 8 * 1.988 ** 2 * math.sin(math.pi / 8)  # of the polygon of 16 edges
        for algorithm in ('semismooth newton', 'smalbe'):
            rests = pair(self.converges(table, 'friction, ' + algorithm, rolling, {**cut, 'Solver/Algorithm': algorithm}))
            self.near(rests['normal_force'], 23.073 * area, 1e-9)
            self.near(rests['tangential_force'], -2.963 * area, 1e-9)

    def test_sliding_mechanism(self):
        """A ram guided between walls, on a slope: frictionless it is driven out, friction or a stop hold it."""
        table = Table('a body between a wall and a slope')
        slope = {'slope': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '-0.5, 1'},
                 'wall': {'Shape': 'half plane', 'Point': '10, 0', 'Normal': '-1, 0'}}

        def ram(mu, wall):
            law = {'Law': 'Coulomb', 'Friction coefficient': mu, 'Gap': '0'}
            contacts = {'below': {'Slave': 'box/bottom', 'Master': 'slope', **law}}
            if wall:
                contacts['beside'] = {'Slave': 'box/right', 'Master': 'wall', **law}
            return scenes.box(obstacles=slope, bodies={'box': SQUARE}, tractions={'down': DOWN}, contacts=contacts, **CUT)

        self.ends(4, table, 'no wall, no friction', ram('0', False), 'body box: translation along (-0.89')
        self.ends(4, table, 'no wall, mu = 0.49', ram('0.49', False), 'body box: translation along (-')
        result = self.converges(table, 'no wall, mu = 0.51', ram('0.51', False))
        carried = pair(result)
        self.near(carried['normal_force'], 100 * 2 / math.sqrt(5), 1e-6)
        self.near(abs(carried['tangential_force']), 100 / math.sqrt(5), 1e-6)
        # the slope drives it to the left, away from the wall
        self.ends(4, table, 'wall behind, no friction', ram('0', True), 'body box: translation along (-0.89')

    def test_incline(self):
        table = Table('incline of 20 degrees, tan 20 = 0.36397')
        for mu in (0.3641, 0.37):
            self.converges(table, 'mu = {}'.format(mu), shipped('incline'), {'Contact upper joint/Friction coefficient': mu},
                           checks=1e-4)
        for joint, moving, resting in (('upper', 'c', ('body a: ', 'body b: ')), ('lower', 'bc', ('body a: ',))):
            for mu in (0.3639, 0.36, 0):
                self.ends(4, table, '{} joint mu = {}'.format(joint, mu), shipped('incline'),
                          *('body {}: translation along ('.format(body) for body in moving),
                          overrides={'Contact {} joint/Friction coefficient'.format(joint): mu},
                          without=resting)

    def test_pairs(self):
        table = Table('pairs of contact')
        self.converges(table, 'one pair', two())
        self.ends(2, table, 'declared twice', two(contacts={'joint': JOINT, 'again': JOINT}),
                  'Contact joint joins the same two sides')
        self.ends(2, table, 'declared twice, sides exchanged',
                  two(contacts={'joint': JOINT, 'again': {**JOINT, 'Slave': 'base/top', 'Master': 'box/bottom'}}),
                  'Contact joint joins the same two sides')
        for what, again in (('as the whole outline', {'Slave': 'box/*', 'Master': 'base/*'}),
                            ('half as the whole outline', {'Slave': 'box/bottom', 'Master': 'base/*'}),
                            ('exchanged, as the whole outline', {'Slave': 'base/*', 'Master': 'box/*'})):
            self.ends(2, table, 'declared twice, ' + what, two(contacts={'joint': JOINT, 'again': {**JOINT, **again}}),
                      'join the same two sides')

    def test_three_bodies_around_a_point(self):
        """Three blocks that stick to each other where they meet: their forces on each other are determined up to a cycle, and
        the summary says so, where and between which pairs, under every cut alike; displacements do not depend on it."""
        table = Table('two blocks side by side on a third, subdomains')
        law = {'Law': 'Coulomb'}

        def blocks(subdomains, apart=0):
            return scenes.box(
                bodies={'base': {**SQUARE, 'Size': '{!r}, 10'.format(20 + apart), 'Cells': '8, 4'}, 'left': {**SQUARE, 'Origin': '0, 10'},
                        'right': {**SQUARE, 'Origin': '{!r}, 10'.format(10 + apart)}},
                supports={'floor': FLOOR}, contacts={
                    'foot left': {'Slave': 'left/bottom', 'Master': 'base/top', 'Friction coefficient': '1', **law},
                    'foot right': {'Slave': 'right/bottom', 'Master': 'base/top', 'Friction coefficient': '1', **law},
                    'between': {'Slave': 'left/right', 'Master': 'right/left', 'Friction coefficient': '1', **law}},
                tractions={'down left': {**DOWN, 'Boundary': 'left/top'}, 'down right': {**DOWN, 'Boundary': 'right/top'},
                           'from left': {'Boundary': 'left/left', 'Traction x': '3'},
                           'from right': {'Boundary': 'right/right', 'Traction x': '-3'}},
                Decomposition={'Method': 'METIS', 'Subdomains': str(subdomains)}, Solver={'Tolerance': '1e-10'})

        energy = None
        for subdomains, ranks in ((3, 1), (5, 1), (9, 1), (9, 2), (14, 2)):
            result = self.converges(table, '{}, {} rank(s)'.format(subdomains, ranks), blocks(subdomains), ranks=ranks)
            split = [text for text in result.summary['warnings'] if 'not their distribution' in text]
            self.assertEqual(len(split), 1, result)
            for word in ('foot left, foot right, between: ', 'the first at (10, 10)'):
                self.assertIn(word, split[0])
            energy = energy or result.summary['results']['strain_energy']
            self.near(result.summary['results']['strain_energy'], energy, 1e-8)
        result = self.converges(table, 'apart: two pairs of two bodies', blocks(5, 0.5))
        self.assertEqual([text for text in result.summary['warnings'] if 'not their distribution' in text], [])

    def test_contact_of_a_body_with_itself(self):
        table = Table('one body in contact with itself')
        held = {'supports': {'held': scenes.HELD}, 'tractions': {'down': DOWN}}
        law = {'Law': 'frictionless'}
        self.ends(2, table, 'a side with itself', scenes.box(contacts={'self': {'Slave': 'box/top', 'Master': 'box/top', **law}},
                                                             **held), 'a boundary cannot be in contact with itself')
        self.ends(2, table, 'its outline', scenes.box(contacts={'self': {'Slave': 'box/*', 'Master': 'box/*', **law}}, **held),
                  'a boundary cannot be in contact with itself')
        self.ends(2, table, 'two far sides', scenes.box(contacts={'self': {'Slave': 'box/top', 'Master': 'box/bottom', **law}},
                                                        **held), 'face away from each other')
        self.ends(2, table, 'two sides at a corner', scenes.box(contacts={'self': {'Slave': 'box/top', 'Master': 'box/right',
                                                                                   **law}}, **held), 'do not face each other')

    def test_slit_that_closes(self):
        """A square ring cut open at one side: its two lips, sides of one body, touch and carry the load."""
        table = Table('lips of a slit, one body')
        # U of three strips 10 wide around a slit 0.01 high, mouth on the right
        xs, ys = (0., 10., 20., 30.), (0., 10., 10.01, 20.01)
        nodes = {(i, j): 4 * j + i + 1 for j in range(4) for i in range(4)}
        cells = [(i, j) for j in range(3) for i in range(3) if not (j == 1 and i > 0)]
        lines = [(1, nodes[i, 1], nodes[i + 1, 1]) for i in (1, 2)] + [(2, nodes[i, 2], nodes[i + 1, 2]) for i in (1, 2)]
        lines += [(3, nodes[i, 0], nodes[i + 1, 0]) for i in range(3)] + [(4, nodes[i, 3], nodes[i + 1, 3]) for i in range(3)]
        path = scenes.new_path('slit.msh')
        elements = ['1 2 {0} {0} {1} {2}'.format(*line) for line in lines]
        elements += ['3 2 9 9 {} {} {} {}'.format(nodes[i, j], nodes[i + 1, j], nodes[i + 1, j + 1], nodes[i, j + 1])
                     for i, j in cells]
        path.write_text('\n'.join(
            ['$MeshFormat', '2.2 0 8', '$EndMeshFormat', '$PhysicalNames', '5', '1 1 "lower lip"', '1 2 "upper lip"',
             '1 3 "foot"', '1 4 "head"', '2 9 "all"', '$EndPhysicalNames', '$Nodes', '16'] +
            ['{} {} {} 0'.format(nodes[i, j], xs[i], ys[j]) for j in range(4) for i in range(4)] +
            ['$EndNodes', '$Elements', str(len(elements))] +
            ['{} {}'.format(n + 1, element) for n, element in enumerate(elements)] + ['$EndElements', '']))
        case = scenes.box(bodies={'box': {'Shape': 'mesh', 'File': str(path), 'Material': 'elastic'}},
                          supports={'foot': {'Boundary': 'box/foot', 'Displacement x': '0', 'Displacement y': '0'}},
                          tractions={'down': {'Boundary': 'box/head', 'Traction y': '-100'}},
                          contacts={'lips': {'Slave': 'box/lower lip', 'Master': 'box/upper lip', 'Law': 'Coulomb',
                                             'Friction coefficient': '0.2'}},
                          Discretization={'Refinements': '2'}, **CUT)
        result = self.converges(table, 'pressed', case)
        self.assertGreater(pair(result)['contact_nodes'], 0)
        self.assertGreater(pair(result)['normal_force'], 100)
        other = self.converges(table, 'pressed, lips exchanged', case, {'Contact lips/Slave': 'box/upper lip',
                                                                        'Contact lips/Master': 'box/lower lip'})
        self.near(pair(other)['normal_force'], pair(result)['normal_force'], 1e-6)


if __name__ == '__main__':
    unittest.main()
