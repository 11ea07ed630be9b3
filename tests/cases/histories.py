"""Runs of many load steps that are interrupted and resumed, and where the conditions of a scene are."""

import csv
import json
import pathlib
import re
import signal
import subprocess
import time
import unittest

import scenes
from program import ENVIRONMENT, PROGRAM, TIME_LIMIT, WORK, converged, launcher, new_path, run, settings, shipped, solve

STEPS = 5000  # more than end in time


def block():
    return scenes.box(name='block', bodies={'box': {**scenes.BOX, 'Cells': '4, 4'}}, supports={'held': scenes.HELD},
                      contacts={'circle': scenes.CIRCLE}, tractions={'pressed': {'Boundary': 'box/top', 'Traction y': '-250*t'}},
                      Decomposition={'Method': 'none'}, **{'Load steps': {'Factors': '0.001:0.001:{}'.format(STEPS / 1000)}})


class Interrupted(unittest.TestCase):
    def interrupt(self, number, ranks):
        """Once the first tables are there. @return status, standard error, output directory."""
        directory = new_path('output')
        process = subprocess.Popen(launcher(ranks) + [PROGRAM, str(block()), '--quiet', '--output', str(directory)],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT, cwd=WORK,
                                   preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
        until = time.monotonic() + TIME_LIMIT
        while not (directory / 'summary.json').is_file():
            self.assertLess(time.monotonic(), until)
            self.assertIsNone(process.poll())
            time.sleep(0.01)
        process.send_signal(number)
        _, message = process.communicate(timeout=TIME_LIMIT)
        return process.returncode, message, directory

    def kept(self, directory):
        """Number of steps in the tables, which agree."""
        summary = json.loads((directory / 'summary.json').read_text())
        self.assertEqual((summary['status'], summary['converged']), ('unfinished', False))
        with open(directory / 'history.csv', newline='') as text:
            history = list(csv.DictReader(text))
        with open(directory / 'contact.csv', newline='') as text:
            steps = {row['step'] for row in csv.DictReader(text)}
        for found in (history, steps):
            self.assertEqual(len(found), len(summary['steps']))
        return len(summary['steps'])

    def test_message_and_tables(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            status, message, directory = self.interrupt(number, 1)
            self.assertEqual(status, -number, message)
            self.assertIn('error: interrupted in load step ', message)
            self.assertIn(' of {}; summary.json, history.csv and contact.csv in {}'.format(STEPS, directory), message)
            said = int(re.search(r'the first (\d+), from which --resume continues$', message.rstrip()).group(1))
            self.assertGreaterEqual(self.kept(directory), said)  # the message changes after the tables

    def test_several_ranks(self):
        status, message, directory = self.interrupt(signal.SIGTERM, 2)
        self.assertNotEqual(status, 0, message)
        self.assertGreater(self.kept(directory), 0)


FAILS = 100  # load factor of a step without equilibrium


def rubbed(factors):
    """A block pressed on another and rubbed there and back, with friction: every step depends on those before. It lifts off at
    its edges in turn, so that contact nodes come and go."""
    return scenes.box(
        name='rubbed', bodies={'box': {**scenes.BOX, 'Cells': '6, 6'},
                               'base': {'Origin': '-5, -5', 'Size': '20, 5', 'Cells': '14, 4', 'Material': 'elastic'}},
        supports={'floor': {'Boundary': 'base/bottom', 'Displacement x': '0', 'Displacement y': '0'}},
        tractions={'down': {'Boundary': 'box/top', 'Traction y': '-100*(1+0.2*x/10*sin(5*t))',
                            'Traction x': '45*sin(2*pi*t) + 1e4*(t > {})'.format(FAILS / 2)}},
        contacts={'joint': {'Slave': 'box/bottom', 'Master': 'base/top', 'Law': 'Coulomb', 'Friction coefficient': '0.5'}},
        probes={'corner': {'Body': 'box', 'Point': '10, 10'}},
        Decomposition={'Method': 'METIS', 'Subdomains': '5'}, Output={'VTU': 'false'},
        **{'Load steps': {'Factors': factors}})


class Resumed(unittest.TestCase):
    TABLES = ('history.csv', 'contact.csv', 'probes.csv', 'convergence.csv')

    def stopped(self, case, ranks=1):
        """By a step that fails. @return the directory, which has the state after one of those before."""
        result = solve(case, ranks=ranks)
        self.assertEqual(result.status, 4, result)
        self.assertIn('restart.bin', result.files())
        self.assertEqual(sum(name.startswith('restart_') for name in result.files()), ranks)
        return result.directory

    def test_to_the_same_answer(self):
        for ranks in (1, 2):
            whole = converged(rubbed('0.04:0.04:0.4'), ranks=ranks)
            self.assertEqual([name for name in whole.files() if 'restart' in name], [])
            stopped = rubbed('0.04:0.04:0.2, {}'.format(FAILS))
            directory = self.stopped(stopped, ranks)
            before = {name: (directory / name).read_bytes() for name in ('summary.json', 'contact.csv', 'restart.bin')}
            case = rubbed('0.04:0.04:0.4')
            others = [({}, 3 - ranks, ('{} rank'.format(ranks), 'this one has {}'.format(3 - ranks))),
                      ({'Contact joint/Friction coefficient': '0.4'}, ranks, ('differs', 'Friction coefficient')),
                      ({'Load steps/Factors': '0.05, 0.1'}, ranks, ('load step 1', 't = 0.04'))]
            for arguments, n, words in others[:4 - ranks]:
                refused = run(case, '--resume', *settings(arguments), '--output', directory, ranks=n, directory=directory)
                self.assertEqual(refused.status, 2, refused)
                for word in words + ('--resume',):
                    self.assertIn(word, refused.stderr)
            for name, content in before.items():
                self.assertEqual((directory / name).read_bytes(), content, name)

            resumed = run(case, '--resume', '--output', directory, ranks=ranks, directory=directory)
            self.assertEqual(resumed.status, 0, resumed)
            self.assertRegex(resumed.stdout, r'resumed +after load step \d+ of 10')
            self.assertNotRegex(resumed.stdout, r'(?m)^load step +1 of 10')
            self.assertRegex(resumed.stdout, r't = 0.4, about \d+ s left')
            for table in self.TABLES:  # to the last digit
                self.assertEqual((directory / table).read_text(), (whole.directory / table).read_text(), table)
            for key in ('status', 'warnings', 'problem', 'residuals', 'error', 'results', 'steps', 'solver'):
                self.assertEqual(resumed.summary[key], whole.summary[key], key)
            self.assertEqual([name for name in resumed.files() if 'restart' in name], [])

            again = run(case, '--resume', '--output', directory, ranks=ranks, directory=directory)
            self.assertEqual(again.status, 2, again)
            self.assertIn('there is no run in', again.stderr)
            self.assertEqual(resumed.summary['status'], 'converged')  # and nothing was lost

    def test_on_a_floor_that_moves(self):
        """The rows of the first load step were used until contact nodes came or went, and those of the last one after --resume."""
        def on_waves(law, factors):
            return scenes.box(
                name='waves', bodies={'box': {**scenes.BOX, 'Cells': '8, 8'}},
                obstacles={'floor': {'Shape': 'function', 'Height': '0.2*sin(0.6*(x - t)) - 0.2'}},
                supports={'wall': {'Boundary': 'box/left', 'Displacement x': '0'}},
                contacts={'rest': {'Slave': 'box/bottom', 'Master': 'floor', **law}},
                tractions={'down': {'Boundary': 'box/top', 'Traction y': '-2000 + 1e5*(t > {})'.format(FAILS / 2)}},
                Solver={'Tolerance': '1e-10'}, Decomposition={'Method': 'none'}, Output={'VTU': 'false'},
                **{'Load steps': {'Factors': factors}})

        smooth = {'Law': 'frictionless'}
        one, many = (converged(on_waves(smooth, factors)) for factors in ('4', '1, 2, 3, 4'))
        for found, right in zip(many.summary['results']['contact'][0]['force'], one.summary['results']['contact'][0]['force']):
            self.assertAlmostEqual(found, right, delta=1e-6 * one.summary['results']['contact'][0]['normal_force'])

        rough = {'Law': 'Coulomb', 'Friction coefficient': '0.1'}
        whole, case = converged(on_waves(rough, '1, 2, 3, 4')), on_waves(rough, '1, 2, 3, 4')
        stopped = solve(on_waves(rough, '1, 2, {}'.format(FAILS)))
        self.assertIn('restart.bin', stopped.files(), stopped)
        resumed = run(case, '--resume', '--output', stopped.directory, directory=stopped.directory)
        self.assertEqual(resumed.status, 0, resumed)
        for table in ('history.csv', 'contact.csv'):
            self.assertEqual((stopped.directory / table).read_text(), (whole.directory / table).read_text(), table)

    def test_other_meshes_and_damage(self):
        mesh = new_path('square.msh')
        mesh.write_text('\n'.join(
            ['$MeshFormat', '2.2 0 8', '$EndMeshFormat', '$PhysicalNames', '3', '1 1 "foot"', '1 2 "head"', '2 3 "all"',
             '$EndPhysicalNames', '$Nodes', '4', '1 0 0 0', '2 10 0 0', '3 10 10 0', '4 0 10 0', '$EndNodes', '$Elements', '3',
             '1 1 2 1 1 1 2', '2 1 2 2 2 3 4', '3 3 2 3 3 1 2 3 4', '$EndElements', '']))
        case = scenes.box(bodies={'box': {'Shape': 'mesh', 'File': str(mesh), 'Refinements': '2', 'Material': 'elastic'}},
                          supports={'foot': {'Boundary': 'box/foot', 'Displacement y': '0'}},
                          tractions={'down': {'Boundary': 'box/head', 'Traction y': '-t', 'Traction x': '(t > 3)'}},
                          Decomposition={'Method': 'none'}, **{'Load steps': {'Factors': '1, 2, 3, 4'}})
        directory = self.stopped(case)
        before = mesh.read_text()
        mesh.write_text(before.replace('3 10 10 0', '3 10 11 0'))
        refused = run(case, '--resume', '--output', directory)
        self.assertEqual(refused.status, 2, refused)
        self.assertIn("square.msh' has changed", refused.stderr)
        mesh.write_text(before)
        state, = directory.glob('restart_*_0000.bin')
        state.write_bytes(state.read_bytes()[:-100])
        refused = run(case, '--resume', '--output', directory)
        self.assertEqual(refused.status, 2, refused)
        self.assertIn('damaged', refused.stderr)
        self.assertTrue((directory / 'history.csv').is_file())

    def test_other_surfaces(self):
        surface = new_path('floor.stl')
        a, b, c, d = '-60 0 60', '60 0 60', '0 0 -60', '0 -40 0'
        surface.write_text('solid floor\n' + ''.join(
            'facet normal 0 1 0\nouter loop\n{}endloop\nendfacet\n'.format(''.join('vertex {}\n'.format(x) for x in triangle))
            for triangle in ((a, b, c), (a, d, b), (b, d, c), (c, d, a))) + 'endsolid floor\n')
        lines = scenes.text(bodies={'box': {'Size': '10, 10, 10', 'Cells': '2, 2, 2', 'Material': 'elastic'}},
                            obstacles={'floor': {'Shape': 'stl', 'File': str(surface)}},
                            supports={'left': {'Boundary': 'box/left', 'Displacement x': '0', 'Displacement z': '0'}},
                            tractions={'down': {'Boundary': 'box/top', 'Traction y': '-10 + 100*(t > 1.5)'}},
                            contacts={'rest': {'Slave': 'box/bottom', 'Master': 'floor', 'Law': 'frictionless'}},
                            Decomposition={'Method': 'none'}, **{'Load steps': {'Factors': '1, 2'}}).split('\n')
        case = scenes.write('on_a_surface', '\n'.join(['set Dimension = 3'] + lines[1:]))
        directory = self.stopped(case)
        surface.write_text(surface.read_text().replace('0 -40 0', '0 -41 0'))
        refused = run(case, '--resume', '--output', directory)
        self.assertEqual(refused.status, 2, refused)
        self.assertIn("floor.stl' has changed", refused.stderr)


class Proportional(unittest.TestCase):
    """Directions of earlier steps are combined again and again: what rounding leaves of their G p grew from step to step, until
    loads were not balanced any more (2236 multiplications, the last three steps by the fallback)."""

    def test_ten_steps(self):
        scene = scenes.box(name='ten steps', bodies={'box': {**scenes.BOX, 'Size': '27, 6', 'Cells': '8, 4'}}, supports={},
                           obstacles={'floor': {'Shape': 'half plane', 'Point': '0, 0', 'Normal': '0, 1'}},
                           tractions={'load': {'Boundary': 'box/top', 'Traction x': '-1.69*t', 'Traction y': '-34.5*t'}},
                           contacts={'joint': {'Slave': 'box/bottom', 'Master': 'floor', 'Law': 'Coulomb',
                                               'Friction coefficient': '0.18'}},
                           Discretization={'Degree': '2'}, **{'Load steps': {'Factors': '0.1:0.1:1'}})
        found = converged(scene, {'Decomposition/Method': 'METIS'}).summary
        self.assertAlmostEqual(found['results']['contact'][0]['tangential_force'], 1.69 * 27, delta=1e-3)
        self.assertLessEqual(found['solver']['hessian_multiplications'], 150)
        self.assertEqual(found['solver']['fallbacks'], 0)


class Unloaded(unittest.TestCase):

    def test_nothing_remains(self):
        """Forces of rounding decided where the body ended: status 3 at 1e-8."""
        for friction, tolerance in (('0.3', '1e-8'), ('0.2', '1e-8'), ('0.3', '1e-4'), ('0.3', '1e-10')):
            result = converged(pathlib.Path(__file__).parent / 'unloaded_cube.prm',
                               {'Contact c/Friction coefficient': friction, 'Solver/Tolerance': tolerance})
            self.assertLess(result.summary['results']['max_displacement'], 1e-12)
            self.assertEqual(len(result.summary['steps']), 2)


class Conditions(unittest.TestCase):
    def test_where_they_are(self):
        for ranks in (1, 2):
            result = converged(shipped('box_on_circle'), {'Decomposition/Cells per block': 2}, ranks=ranks)
            rows = result.rows('conditions.csv', text=('kind', 'name', 'side', 'body'))
            self.assertEqual([(row['kind'], row['name'], row['side'], row['body']) for row in rows],
                             [('support', 'held', '', 'box')] * 8 + [('traction', 'pressed', '', 'box')] * 8 +
                             [('contact', 'circle', 'slave', 'box')] * 8)
            self.assertEqual({(row['x1'], row['x2']) for row in rows[:8]}, {(0, 0)})
            self.assertEqual({(row['y1'], row['y2']) for row in rows[8:16]}, {(10, 10)})
            for row in rows[16:]:  # the body is to the left
                self.assertEqual((row['y1'], row['y2'], row['x2'] - row['x1']), (0, 0, 1.25))

    def test_points(self):
        rows = converged(shipped('hertz'), {'Body cylinder/Refine levels': 0, 'Body block/Refine levels': 0}).rows(
            'conditions.csv', text=('kind', 'name', 'side', 'body'))
        points = {row['name']: (row['x1'], row['y1'], row['x2'], row['y2']) for row in rows if row['name'].startswith('axis')}
        self.assertEqual(points, {'axis above': (0, 50, 0, 50), 'axis below': (0, 0, 0, 0)})


if __name__ == '__main__':
    unittest.main()
