"""What a run leaves, as doc/interface.md promises it."""

import functools
import pathlib
import re
import unittest

import fields
import scenes
from program import converged, run, settings, shipped, solve, new_path

SMALL = {'Decomposition/Cells per block': 6, 'Solver/Tolerance': 1e-6}

NUMBER, COUNT, TEXT, FLAG = (int, float), int, str, bool

SUMMARY = {
    'case': TEXT, 'version': TEXT, 'ranks': COUNT, 'status': TEXT, 'converged': FLAG,
    'problem': {'dimension': COUNT, 'plane_state': TEXT, 'bodies': COUNT, 'subdomains': COUNT, 'primal_dofs': COUNT,
                'kernel_dimension': COUNT, 'cells': COUNT,
                'dual': {'total': COUNT, 'equality': COUNT, 'normal': COUNT, 'tangential': COUNT},
                'contact_candidates': COUNT},
    'solver': {'algorithm': TEXT, 'preconditioner': TEXT, 'dual_operator': TEXT, 'tolerance': NUMBER,
               'hessian_multiplications': COUNT, 'dual_setup_multiplications': COUNT,
               'preconditioner_applications': COUNT, 'outer_iterations': COUNT, 'cg_steps': COUNT,
               'expansion_steps': COUNT, 'proportioning_steps': COUNT, 'coulomb_iterations': COUNT,
               'fallbacks': COUNT, 'active_constraints': COUNT, 'dual_norm': NUMBER},
    'residuals': {'projected_gradient': NUMBER, 'equality': NUMBER, 'interface_jump': NUMBER, 'penetration': NUMBER,
                  'complementarity': NUMBER, 'friction_bound': NUMBER, 'force_balance': NUMBER,
                  'moment_balance': NUMBER},
    'error': {'estimate_energy_relative': NUMBER, 'algebraic_relative': NUMBER},
    'results': {'max_displacement': NUMBER, 'max_von_mises': NUMBER, 'strain_energy': NUMBER,
                'contact': [{'pair': TEXT, 'normal_force': NUMBER, 'tangential_force': NUMBER, 'max_pressure': NUMBER,
                             'contact_length': NUMBER, 'open_nodes': COUNT, 'stick_nodes': COUNT,
                             'slip_nodes': COUNT,
                             'algebraic_error': {'pressure': NUMBER, 'tangential': NUMBER}}]},
    'time_s': {'total': NUMBER, 'startup': NUMBER, 'mesh': NUMBER, 'assembly': NUMBER, 'factorization': NUMBER, 'dual_setup': NUMBER,
               'solve': NUMBER, 'recovery': NUMBER, 'output': NUMBER, 'other': NUMBER},
    'memory_mb': {'peak_rank_max': NUMBER, 'peak_total': NUMBER}}

HELD_NODES = 1  # the corner of the box, which the support holds: no row of contact, but among the nodes
CONTACT_COLUMNS = ['pair', 'slave body', 'x', 'y', 's', 'gap', 'pressure', 'tangential_traction', 'slip', 'status', 'step']


@functools.lru_cache(maxsize=None)
def box():
    return converged(shipped('box_on_circle'), SMALL, ranks=2)


def without_cost(result):
    summary = result.summary
    del summary['time_s'], summary['memory_mb'], summary['case']
    return summary


class Outputs(unittest.TestCase):

    def assert_has(self, value, expected, path):
        if isinstance(expected, dict):
            self.assertIsInstance(value, dict, path)
            for key, part in expected.items():
                self.assertIn(key, value, path)
                self.assert_has(value[key], part, path + '/' + key)
        elif isinstance(expected, list):
            self.assertIsInstance(value, list, path)
            for entry in value:
                self.assert_has(entry, expected[0], path)
        else:
            self.assertIsInstance(value, expected, path)
            self.assertEqual(isinstance(value, bool), expected is FLAG, path)

    def test_all_files_are_there_and_nothing_else(self):
        expected = ['conditions.csv', 'contact.csv', 'contact.pvd', 'contact_000.vtp', 'convergence.csv', 'history.csv', 'parameters.prm',
                    'solution.pvd', 'solution_000.pvtu', 'summary.json'] + ['subdomain_000_{:04}.vtu'.format(i) for i in range(16)]
        self.assertEqual(box().files(), sorted(expected))

    def test_summary_has_every_key_with_its_type(self):
        self.assert_has(box().summary, SUMMARY, '')
        self.assert_has(converged(shipped('box_linear'), SMALL).summary, SUMMARY, 'linear')

    def test_summary_of_a_scene_without_equilibrium_has_every_key(self):
        result = solve(scenes.box(supports={'roller': {'Boundary': 'box/left', 'Displacement x': '0'}}))
        self.assert_has(result.summary, SUMMARY, '')

    def test_summary_says_what_ran(self):
        summary = box().summary
        self.assertEqual([summary['case'], summary['ranks'], summary['status'], summary['converged']],
                         ['box_on_circle', 2, 'converged', True])
        self.assertEqual(summary['version'], run('--version').stdout.split()[-1])
        self.assertEqual(summary['solver']['tolerance'], 1e-6)
        self.assertIn(summary['solver']['dual_operator'], ('explicit', 'implicit'))

    def test_parts_add_up(self):
        summary = box().summary
        dual, time = summary['problem']['dual'], summary['time_s']
        self.assertEqual(dual['total'], dual['equality'] + dual['normal'] + dual['tangential'])
        self.assertAlmostEqual(sum(value for name, value in time.items() if name != 'total') / time['total'], 1, delta=.01)
        self.assertGreater(time['startup'], 0)
        self.assertLess(time['other'], .1 * time['total'])
        self.assertGreater(summary['memory_mb']['peak_total'], summary['memory_mb']['peak_rank_max'])
        pair = summary['results']['contact'][0]
        self.assertEqual(pair['contact_nodes'] + pair['open_nodes'],
                         summary['problem']['contact_candidates'] + HELD_NODES)
        steps = summary['solver']
        self.assertLessEqual(steps['cg_steps'] + steps['expansion_steps'] + steps['proportioning_steps'],
                             steps['hessian_multiplications'])

    def test_contact_line_has_its_columns_in_order_of_arc_length(self):
        rows = box().contact
        self.assertEqual(list(rows[0])[:len(CONTACT_COLUMNS)], CONTACT_COLUMNS)
        self.assertEqual(len(rows), box().summary['problem']['contact_candidates'] + HELD_NODES)
        lengths = [row['s'] for row in rows]
        self.assertEqual(lengths, sorted(lengths))
        for row in rows:
            self.assertAlmostEqual(row['s'], row['x'])
            self.assertIn(row['status'], ('open', 'stick', 'slip'))
            self.assertEqual((row['pair'], row['slave body'], row['y'], row['step']), ('circle', 'box', 0, 0))

    def test_contact_line_adds_up_to_the_summary(self):
        pair, rows = box().summary['results']['contact'][0], box().contact
        width = 10 / 24
        areas = [width / 2 if row['x'] == 10 else width for row in rows]
        self.assertAlmostEqual(sum(row['pressure'] * area for row, area in zip(rows, areas)) / pair['normal_force'], 1)
        self.assertEqual(max(row['pressure'] for row in rows), pair['max_pressure'])
        self.assertEqual(sum(row['status'] == 'slip' for row in rows), pair['slip_nodes'])

    def test_convergence_ends_below_the_tolerance(self):
        rows = box().rows('convergence.csv', text=('algorithm',))
        self.assertEqual({row['algorithm'] for row in rows}, {'semismooth newton'})
        counts = [row['hessian_multiplications'] for row in rows]
        self.assertEqual(counts, sorted(counts))
        self.assertEqual(len(rows), box().summary['solver']['outer_iterations'])
        self.assertLessEqual(max(rows[-1]['projected_gradient'], rows[-1]['equality']), 1e-6)
        self.assertEqual(counts[-1], box().summary['solver']['hessian_multiplications'])

    def test_fields_have_the_promised_arrays(self):
        pieces = fields.pieces(box().directory)
        self.assertEqual(len(pieces), 16)
        arrays = fields.read_vtu(pieces[5])
        parallel = (box().directory / 'solution_000.pvtu').read_text()
        for name in ('displacement', 'stress', 'von_mises', 'principal_stress_1', 'principal_stress_2', 'body',
                     'subdomain', 'rank', 'error_estimate'):
            self.assertIn(name, arrays)
            self.assertEqual(parallel.count('Name="{}"'.format(name)), 1)
        self.assertEqual({value for (value,) in arrays['subdomain']}, {5.})

    def test_fields_agree_with_the_summary(self):
        values = fields.field(box().directory, 'displacement')
        largest = max(sum(x * x for x in value) ** 0.5 for copies in values.values() for value in copies)
        self.assertAlmostEqual(largest / box().summary['results']['max_displacement'], 1, places=6)
        for position, copies in values.items():
            if position[0] == 0:
                for value in copies:
                    self.assertLess(max(map(abs, value)), 1e-5 * box().summary['results']['max_displacement'])

    def test_principal_stresses_fit_the_stress(self):
        for piece in fields.pieces(box().directory)[:2]:
            arrays = fields.read_vtu(piece)
            scale = max(value for (value,) in arrays['von_mises'])
            for stress, (one,), (two,), (mises,) in zip(arrays['stress'], arrays['principal_stress_1'],
                                                        arrays['principal_stress_2'], arrays['von_mises']):
                self.assertGreaterEqual(one, two)
                self.assertAlmostEqual((stress[0] + stress[4] - one - two) / scale, 0, places=5)
                self.assertEqual(stress[1], stress[3])
                self.assertAlmostEqual((one * one + two * two - one * two - mises * mises) / scale ** 2, 0, places=5)

    def test_the_stress_tensor_has_its_zz(self):
        """In plane strain and on bodies of revolution (there the hoop stress): its von Mises stress is that of the file."""
        small = {'Discretization/Refinements': 0, 'Decomposition/Method': 'none'}
        for case, state, has_zz in (('patch_gmsh', 'plane stress', False), ('patch_gmsh', 'plane strain', True),
                                    ('circular_punch', 'axisymmetric', True)):
            with self.subTest(state=state):
                arrays = fields.read_vtu(fields.pieces(converged(shipped(case), {**small, 'Plane state': state}).directory)[0])
                self.assertEqual('hoop_stress' in arrays, state == 'axisymmetric')
                self.assertEqual(any(zz for (zz,) in arrays['stress_zz']), has_zz)
                self.assertEqual([stress[8] for stress in arrays['stress']], [zz for (zz,) in arrays['stress_zz']])
                self.assertEqual(arrays.get('hoop_stress', arrays['stress_zz']), arrays['stress_zz'])
                for s, (mises,) in zip(arrays['stress'], arrays['von_mises']):
                    xx, yy, zz = s[0], s[4], s[8]
                    squares = ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * s[1] ** 2
                    self.assertAlmostEqual(squares ** 0.5 / mises, 1, places=5)

    def test_contact_lines_move_with_their_bodies(self):
        """contact.pvd leads to lines (in space faces) whose displacement is that of the slave body."""
        cube = {'Decomposition/Blocks': 2, 'Decomposition/Cells per block': 2}
        for result in (box(), converged(shipped('box_on_circle'), {**SMALL, 'Discretization/Degree': 2}),
                       converged(shipped('cube_on_sphere'), cube, ranks=2)):
            self.assertEqual(re.findall('file="([^"]*)"', (result.directory / 'contact.pvd').read_text()), ['contact_000.vtp'])
            line = fields.read_vtp(result.directory / 'contact_000.vtp')
            of_body = fields.field(result.directory, 'displacement')
            size = fields.largest(of_body)
            self.assertGreater(len(line['Points']), 12)
            for position, displacement in zip(line['Points'], line['displacement']):
                expected = of_body[tuple(round(x, 4) + 0. for x in position)][0]
                for found, other in zip(displacement, expected):
                    self.assertAlmostEqual(found, other, delta=1e-5 * size)  # of single precision, between copies of the node

    def test_fields_may_be_left_away(self):
        result = converged(shipped('box_on_circle'), {**SMALL, 'Output/VTU': 'false'}, ranks=2)
        self.assertEqual(result.files(), ['conditions.csv', 'contact.csv', 'contact.pvd', 'contact_000.vtp', 'convergence.csv',
                                          'history.csv', 'parameters.prm', 'summary.json'])

    def test_parameters_run_again_give_the_same_result(self):
        for case, overrides in (('box_on_circle', SMALL), ('box_linear', {'Traction pressed/Traction y': '-250*x/10'})):
            first = converged(shipped(case), {'Decomposition/Cells per block': 6, **overrides}, ranks=2)
            again = converged(first.directory / 'parameters.prm', ranks=2)
            self.assertEqual(without_cost(first), without_cost(again))
            self.assertEqual((first.directory / 'parameters.prm').read_text(),
                             (again.directory / 'parameters.prm').read_text())

    def test_override_equals_an_edited_file(self):
        text = pathlib.Path(shipped('box_on_circle')).read_text()
        for old, new in (('set Slip bound = 500', 'set Slip bound = 150'), ('set Cells per block = 50',
                         'set Cells per block = 6'), ('set Tolerance = 1e-4', 'set Tolerance = 1e-6')):
            self.assertEqual(text.count(old), 1)
            text = text.replace(old, new)
        edited = converged(scenes.write('box_on_circle', text))
        overridden = converged(shipped('box_on_circle'), {**SMALL, 'Contact circle/Slip bound': 150})
        self.assertEqual(without_cost(edited), without_cost(overridden))
        self.assertEqual(edited.contact, overridden.contact)

    def test_a_second_run_replaces_the_first(self):
        directory = new_path('output')
        for blocks in (4, 2):
            result = run(shipped('box_on_circle'), *settings({**SMALL, 'Decomposition/Blocks': blocks}), '--output',
                         directory, directory=directory)
            self.assertEqual(result.status, 0, result)
        self.assertEqual(len(fields.pieces(directory)), 4)
        self.assertEqual(result.summary['problem']['subdomains'], 4)
        self.assertFalse([name for name in result.files() if re.search(r'tmp|probe', name)])


if __name__ == '__main__':
    unittest.main()
