"""Bolts that are tightened, then held: forces as the stiffnesses of bolt and clamped parts share them, separation, clearance,
two bolts at a time; in the plane, of revolution and in space."""

import math
import unittest

import scenes
from program import converged, new_path, run, shipped, solve

YOUNG, LENGTH, PRELOAD = 1e5, 20., 1000.
PULLS = (0, 400, 800, 2000)  # in the load steps t = 1, 2, 3, 4
MATERIALS = {'soft': {'Young modulus': '1e5', 'Poisson ratio': '0'}, 'stiff': {'Young modulus': '1e9', 'Poisson ratio': '0'}}
CLAMPED = {'Displacement x': '0', 'Displacement y': '0'}


def pull(area):
    return '({}*(t==2)+{}*(t==3)+{}*(t==4))/{}'.format(*PULLS[1:], area)


def block(x0, x1, y0, y1, cells, material='soft'):
    return {'Origin': '{}, {}'.format(x0, y0), 'Size': '{}, {}'.format(x1 - x0, y1 - y0), 'Cells': cells, 'Material': material}


def joint(state='plane stress', area=24., offset='0', factors='1, 2, 3, 4', pretensions=None, preload=PRELOAD, **kinds):
    """A bolt 4 mm wide between the ground and a head, which presses two sleeves of 6 mm each; of revolution the half on the
    right, a ring about the bolt."""
    revolved = state == 'axisymmetric'
    bodies = {'bolt': block(0 if revolved else -2, 2, 0, LENGTH, '3, 8'), 'right': block(6, 12, 0, LENGTH, '3, 8'),
              'head': block(0 if revolved else -12, 12, LENGTH, LENGTH + 4, '12, 3', 'stiff')}
    supports = {'foot': {'Boundary': 'bolt/bottom', **CLAMPED}, 'right': {'Boundary': 'right/bottom', **CLAMPED}}
    contacts = {'thread': {'Slave': 'bolt/top', 'Master': 'head/bottom', 'Law': 'bonded'},
                'right': {'Slave': 'right/top', 'Master': 'head/bottom', 'Law': 'frictionless', 'Offset': offset}}
    if not revolved:
        bodies['left'] = block(-12, -6, 0, LENGTH, '3, 8')
        supports['left'] = {'Boundary': 'left/bottom', **CLAMPED}
        contacts['left'] = {**contacts['right'], 'Slave': 'left/top'}
    content = scenes.text(materials=MATERIALS, bodies=bodies, supports=supports, contacts=contacts, plane_state=state,
                          tractions={'pull': {'Boundary': 'head/top', 'Traction y': pull(area)}},
                          **{'Decomposition': {'Method': 'METIS', 'Subdomains': '5'}, 'Solver': {'Tolerance': '1e-8'},
                             'Load steps': {'Factors': factors}, **kinds})
    pretensions = pretensions or {'m4': {'Body': 'bolt', 'Point': '0, 9.1', 'Direction': '0, 2', 'Force': preload}}
    path = new_path('joint.prm')
    path.write_text(with_bolts(content, pretensions))
    return path


def with_bolts(content, pretensions):
    content += 'set Pretensions = {}\n'.format(', '.join(pretensions))
    for name, values in pretensions.items():
        content += 'subsection Pretension {}\n{}end\n'.format(
            name, ''.join('  set {} = {}\n'.format(*entry) for entry in values.items()))
    return content


def shared(load, part):
    """Tension of the bolt: the joint opens when what clamps it is used up."""
    return max(PRELOAD + part * load, load)


class Pretension(unittest.TestCase):

    def solved(self, case, *options, **arguments):
        result = solve(case, *options, **arguments)
        self.assertEqual(result.status, 0, result)
        return result

    def check_shares(self, result, k_bolt, k_clamped, accuracy=2e-3):
        part = k_bolt / (k_bolt + k_clamped)
        steps = result.summary['steps']
        self.assertEqual(len(steps), len(PULLS))
        for load, step, row in zip(PULLS, steps, result.rows('history.csv')):
            bolt = step['pretensions'][0]
            self.assertAlmostEqual(bolt['force'] / shared(load, part), 1, delta=accuracy)
            self.assertAlmostEqual(bolt['shortening'] / (PRELOAD * (1 / k_bolt + 1 / k_clamped)), 1, delta=accuracy)
            self.assertEqual(bolt['tightened'], load == 0)
            clamping = sum(pair['normal_force'] for pair in step['contact'] if pair['pair'] != 'thread')
            self.assertAlmostEqual(clamping, shared(load, part) - load, delta=accuracy * PRELOAD)
            self.assertEqual(row['pretension m4 force'], bolt['force'])
            self.assertEqual(row['pretension m4 shortening'], bolt['shortening'])
        self.assertAlmostEqual(steps[0]['pretensions'][0]['force'] / PRELOAD, 1, delta=1e-8)  # the tolerance of the solver
        # energy of two springs, without that of the head
        springs = PRELOAD**2 / 2 * (1 / k_bolt + 1 / k_clamped)
        self.assertAlmostEqual(steps[0]['strain_energy'] / springs, 1, delta=accuracy)

    def test_in_the_plane(self):
        k_bolt, k_clamped = YOUNG * 4 / LENGTH, YOUNG * 12 / LENGTH
        accuracy_of_stress = 5e-3
        result = self.solved(joint(probes={'axis': {'Body': 'bolt', 'From': '0, 4', 'To': '0, 15', 'Number of points': '12'}}))
        self.check_shares(result, k_bolt, k_clamped)
        # stresses are those of the forces: along the bolt they show nothing of the section
        for row in result.rows('probes.csv', text=('probe',)):
            expected = shared(PULLS[int(row['step'])], k_bolt / (k_bolt + k_clamped)) / 4
            self.assertAlmostEqual(row['stress_yy'] / expected, 1, delta=accuracy_of_stress)
        other = self.solved(joint(), ranks=2)
        for a, b in zip(result.summary['steps'], other.summary['steps']):
            self.assertAlmostEqual(a['pretensions'][0]['force'] / b['pretensions'][0]['force'], 1, delta=1e-6)
        for changes in ({'Discretization': {'Degree': '2'}},
                        {'state': 'plane strain', 'Discretization': {'Element': 'nearly incompressible'}},
                        {'Solver': {'Tolerance': '1e-8', 'Algorithm': 'smalbe'}}):
            self.check_shares(self.solved(joint(**changes)), k_bolt, k_clamped)

    def test_error_bars_leave_the_energy_out(self):
        bars = {bar['quantity']: bar for bar in self.solved(joint(), {'Error bars': 'true'}).summary['error_bars']}
        self.assertIsNone(bars['strain_energy']['error'])
        self.assertEqual(bars['strain_energy']['reason'], 'not estimated with bolts')
        self.assertIsNotNone(bars['max_displacement']['error'])

    def test_of_revolution(self):
        k_bolt, k_clamped = (YOUNG * math.pi * area / LENGTH for area in (4, 12**2 - 6**2))
        self.check_shares(self.solved(joint('axisymmetric', math.pi * 144)), k_bolt, k_clamped)

    def test_in_space(self):
        def cuboid(x0, x1, y0, y1, cells, material='soft'):
            return {'Origin': '{}, {}, 0'.format(x0, y0), 'Size': '{}, {}, 3'.format(x1 - x0, y1 - y0), 'Cells': cells,
                    'Material': material}
        held = {**CLAMPED, 'Displacement z': '0'}
        bolts = {'m4': {'Body': 'bolt', 'Point': '0, 9.1, 0', 'Direction': '0, 1, 0', 'Force': PRELOAD}}
        content = scenes.text(
            materials=MATERIALS, bodies={'bolt': cuboid(-2, 2, 0, LENGTH, '2, 6, 1'), 'left': cuboid(-12, -6, 0, LENGTH, '2, 6, 1'),
                                         'right': cuboid(6, 12, 0, LENGTH, '2, 6, 1'),
                                         'head': cuboid(-12, 12, LENGTH, LENGTH + 4, '12, 2, 1', 'stiff')},
            supports={name: {'Boundary': name + '/bottom', **held} for name in ('bolt', 'left', 'right')},
            contacts={'thread': {'Slave': 'bolt/top', 'Master': 'head/bottom', 'Law': 'bonded'},
                      **{side: {'Slave': side + '/top', 'Master': 'head/bottom', 'Law': 'frictionless'}
                         for side in ('left', 'right')}},
            tractions={'pull': {'Boundary': 'head/top', 'Traction y': pull(72)}},
            **{'Decomposition': {'Method': 'METIS', 'Subdomains': '4'}, 'Solver': {'Tolerance': '1e-8'},
               'Load steps': {'Factors': '1, 2, 3, 4'}})
        path = new_path('space.prm')
        path.write_text(with_bolts('set Dimension = 3\n' + content.split('\n', 1)[1], bolts))
        self.check_shares(self.solved(path), YOUNG * 12 / LENGTH, YOUNG * 36 / LENGTH)

    def test_a_clearance_is_closed_first(self):
        """The shortening is larger by the gap, the forces are the same."""
        bolt = self.solved(joint(offset='0.2', factors='1')).summary['results']['pretensions'][0]
        self.assertAlmostEqual(bolt['force'] / PRELOAD, 1, delta=1e-8)
        self.assertAlmostEqual(bolt['shortening'], 0.2 + PRELOAD * LENGTH / YOUNG * (1 / 4 + 1 / 12), delta=2e-4)

    def test_tightened_in_steps_and_for_longer(self):
        """The force may be a formula of t, and given in later steps, under loads, too."""
        bolts = {'m4': {'Body': 'bolt', 'Point': '0, 9.1', 'Direction': '0, -1', 'Force': '{}*min(t,2)/2'.format(PRELOAD),
                        'Tightened until': '2'}}
        steps = self.solved(joint(pretensions=bolts)).summary['steps']
        for step, force in zip(steps, (500, 1000, 1100, 2000)):
            self.assertAlmostEqual(step['pretensions'][0]['force'] / force, 1, delta=2e-3)

    def test_two_bolts(self):
        bolts = {name: {'Body': name, 'Point': '0, 9.1', 'Direction': '0, 1', 'Force': force}
                 for name, force in (('left', 300), ('right', 500))}
        for factors in ('1', '1, 2'):
            content = joint(pretensions=bolts, factors=factors).read_text()
            for side in ('left', 'right'):  # the sleeves are the bolts, and what was the bolt is clamped
                content = content.replace('set Slave = {}/top\n  set Master = head/bottom\n  set Law = frictionless'.format(side),
                                          'set Slave = {}/top\n  set Master = head/bottom\n  set Law = bonded'.format(side))
            content = content.replace('set Law = bonded', 'set Law = frictionless', 1)
            self.assertEqual(content.count('bonded'), 2)
            path = new_path('two.prm')
            path.write_text(content)
            result = self.solved(path)
            first = result.summary['steps'][0]
            for bolt, force in zip(first['pretensions'], (300, 500)):
                self.assertAlmostEqual(bolt['force'] / force, 1, delta=1e-7)
            thread = [pair for pair in first['contact'] if pair['pair'] == 'thread'][0]
            self.assertAlmostEqual(thread['normal_force'], 800, delta=1e-3)

    def test_clamps_that_bend(self):
        """A clamp is softer than its bolt by far; two and three that share nothing need what one of them needs (status 3 once), and
        so do two bolts, with different forces, in one clamp."""
        def clamps(n, forces=(100,)):
            bodies, contacts, supports, bolts = {}, {}, {}, {}
            for x in (40 * k for k in range(n)):
                plate = 'plate%d' % x
                bodies[plate] = block(x - 12, x + 12, 0, 6, '6, 4', 'steel')
                supports[plate] = {'Boundary': plate + '/left', **CLAMPED}
                for force, at, left in zip(forces, (x + 14, x - 16), (x + 9, x - 16)):  # the second one over the left end
                    name = 's%d' % (at + 100)
                    bodies.update({name: block(at, at + 2, 0, 6, '2, 3', 'steel'), name + 'h': block(left, left + 7, 6, 8, '4, 2', 'steel'),
                                   name + 'f': block(left, left + 7, -2, 0, '4, 2', 'steel')})
                    contacts.update({name + 'bh': {'Slave': name + '/top', 'Master': name + 'h/bottom', 'Law': 'bonded'},
                                     name + 'bf': {'Slave': name + '/bottom', 'Master': name + 'f/top', 'Law': 'bonded'},
                                     name + 'ch': {'Slave': name + 'h/bottom', 'Master': plate + '/top', 'Law': 'frictionless'},
                                     name + 'cf': {'Slave': name + 'f/top', 'Master': plate + '/bottom', 'Law': 'frictionless'}})
                    bolts[name] = {'Body': name, 'Point': '{}, 3'.format(at + 1), 'Direction': '0, 1', 'Force': force}
            content = scenes.text(materials={'steel': {'Young modulus': '2e5', 'Poisson ratio': '0.3'}}, bodies=bodies,
                                  supports=supports, contacts=contacts,
                                  **{'Decomposition': {'Method': 'none'}, 'Solver': {'Tolerance': '1e-8'}})
            path = new_path('clamps.prm')
            path.write_text(with_bolts(content, bolts))
            return self.solved(path).summary
        one = clamps(1)
        for n in (2, 3):
            several = clamps(n)
            self.assertLessEqual(several['solver']['hessian_multiplications'], 2 * one['solver']['hessian_multiplications'])
            for bolt in several['results']['pretensions']:
                self.assertAlmostEqual(bolt['shortening'] / one['results']['pretensions'][0]['shortening'], 1, delta=1e-6)
        for bolt, force in zip(clamps(1, (100, 170))['results']['pretensions'], (100, 170)):
            self.assertAlmostEqual(bolt['force'] / force, 1, delta=1e-7)

    def test_beside_larger_loads(self):
        """The solver measures its error by all loads; the tension is found to its own tolerance."""
        content = scenes.text(materials=MATERIALS, bodies={'bar': block(0, 2, 0, 6, '4, 10')},
                              supports={end: {'Boundary': 'bar/' + end, **CLAMPED} for end in ('bottom', 'top')},
                              tractions={'side': {'Boundary': 'bar/left', 'Traction x': '1000', 'Traction y': '300*y'}},
                              **{'Decomposition': {'Method': 'METIS', 'Subdomains': '4'}})
        path = new_path('small.prm')
        path.write_text(with_bolts(content, {'m1': {'Body': 'bar', 'Point': '1, 3.1', 'Direction': '0, 1', 'Force': '5'}}))
        bolt = self.solved(path).summary['results']['pretensions'][0]
        self.assertAlmostEqual(bolt['force'] / 5, 1, delta=1.01e-4)

    def test_heat_counts(self):
        """A bolt that is heated before it is tightened bears its force all the same; cooled it bears more."""
        content = joint(factors='1, 2').read_text().replace('set Young modulus = 1e5', 'set Thermal expansion = 1e-5\n  set Young modulus = 1e5')
        content += 'set Temperatures = warm\nsubsection Temperature warm\n  set Bodies = bolt\n  set Change = 50*(t==1)\nend\n'
        content = content.replace('/24', '/24*0')
        path = new_path('warm.prm')
        path.write_text(content)
        first, second = (step['pretensions'][0] for step in self.solved(path).summary['steps'])
        self.assertAlmostEqual(first['force'] / PRELOAD, 1, delta=1e-7)
        k_bolt, k_clamped = YOUNG * 4 / LENGTH, YOUNG * 12 / LENGTH
        self.assertAlmostEqual(second['force'] / (PRELOAD + 50e-5 * LENGTH / (1 / k_bolt + 1 / k_clamped)), 1, delta=2e-3)

    def test_resumed_to_the_last_digit(self):
        """What the solver learned of the bolts goes into the restart files."""
        case = joint(factors='1, 2, 3', pretensions={
            'm4': {'Body': 'bolt', 'Point': '0, 9.1', 'Direction': '0, 1', 'Force': '300*t', 'Tightened until': '3'}})
        case.write_text(case.read_text().replace('set Traction y = ', 'set Traction x = t > 4 ? sqrt(-1) : 0\n  set Traction y = '))
        whole = self.solved(case)
        directory = new_path('resumed')
        broken = run(case, '--set', 'Load steps/Factors=1, 2, 5', '--output', directory, directory=directory)
        self.assertEqual(broken.status, 2, broken)
        resumed = run(case, '--resume', '--output', directory, directory=directory)
        self.assertEqual(resumed.status, 0, resumed)
        self.assertEqual(resumed.summary['steps'], whole.summary['steps'])

    def test_shipped_joint(self):
        """The figures in the header of prm/bolted_joint.prm, with cells twice as high: equilibrium, joint diagram of VDI 2230."""
        coarse = {'Body {}/Cells'.format(name): '{}, {}'.format(*cells) for name, cells in (
            ('shank', (12, 40)), ('head', (18, 8)), ('nut', (18, 8)), ('upper plate', (47, 20)), ('lower plate', (47, 20)))}
        steps = converged(shipped('bolted_joint'), {**coarse, 'Output/VTU': 'false'}).summary['steps']
        spread = 0.362 + 0.032 * math.log(40 / 18 / 2) + 0.153 * math.log(60 / 18)
        plates = 2 * math.log((18 + 13) * (18 + 40 * spread - 13) / ((18 - 13) * (18 + 40 * spread + 13))) / (2.1e5 * math.pi * 13 * spread)
        bolt = (40 + 0.5 * 12 + 0.4 * 12) / (2.1e5 * math.pi * 6**2)
        preload, share = 4e4, plates / (plates + bolt)
        self.assertAlmostEqual(steps[0]['pretensions'][0]['shortening'] / (preload * (plates + bolt)), 1, delta=0.04)
        for pull, step in zip((0, 15e3, 30e3, 60e3), steps):
            tension = step['pretensions'][0]['force']
            self.assertAlmostEqual(step['contact'][4]['normal_force'], tension - pull, delta=1e-4 * preload)
            if pull < preload:
                self.assertAlmostEqual(tension - preload, share * pull, delta=0.02 * share * pull + 1e-4 * preload)
        self.assertAlmostEqual(tension, 60e3, delta=1)
        self.assertEqual(step['contact'][4]['contact_nodes'], 0)

    def refused(self, status, words, state='plane stress', **changes):
        bolt = {'Body': 'bolt', 'Point': '0, 9.1', 'Direction': '0, 1', 'Force': PRELOAD, **changes}
        result = run(joint(state, pretensions={'m4': bolt}), directory=new_path('out'))
        self.assertEqual(result.status, status, result)
        for word in words:
            self.assertIn(word, result.stderr)

    def test_bad_input(self):
        self.refused(2, ('Pretension m4/Point', "does not cut body 'bolt'", '-25 to -5', 'between the two ends'), Point='0, 25')
        self.refused(2, ('Pretension m4/Direction', 'has no length', 'for example: 0, 1'), Direction='0, 0')
        self.refused(2, ('Pretension m4/Direction', 'axis of revolution'), Direction='1, 1', state='axisymmetric')
        self.refused(2, ('Pretension m4/Force', 'is negative at t = 1'), Force='-1')
        self.refused(2, ('Pretension m4/Body', 'bolt'), Body='blot')
        self.refused(2, ('Pretension m4/Tightened until', 'never tightened'), **{'Tightened until': '0.5'})

    def test_a_bolt_that_clamps_nothing(self):
        content = joint(factors='1').read_text()
        content = content.replace('set Master = head/bottom\n  set Law = frictionless', 'set Master = head/bottom\n  set Law = frictionless\n  set Reach = 100')
        path = new_path('free.prm')
        path.write_text(content.replace('set Offset = 0', 'set Offset = 50'))
        result = run(path, directory=new_path('out'))
        self.assertEqual(result.status, 4, result)
        self.assertIn('Pretension m4: shortened by the length of the bolt', result.stderr)


if __name__ == '__main__':
    unittest.main()
