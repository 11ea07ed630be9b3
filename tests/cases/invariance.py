"""One scene, one answer: whatever the number of ranks, the decomposition, the units, the side that it is seen from."""

import functools
import unittest

import fields
import scenes
from program import converged, shipped

CELLS = {'Body box/Cells': '24, 24', 'Decomposition/Blocks': 4, 'Contact circle/Slip bound': 150,
         'Solver/Tolerance': 1e-9}

DECOMPOSITIONS = {'blocks': {},
                  'METIS': {'Decomposition/Method': 'METIS', 'Decomposition/Subdomains': 7},
                  'other seed': {'Decomposition/Method': 'METIS', 'Decomposition/Subdomains': 7,
                                 'Decomposition/Seed': 3},
                  'none': {'Decomposition/Method': 'none'}}


@functools.lru_cache(maxsize=None)
def box(decomposition='blocks', ranks=1, attempt=1):
    return converged(shipped('box_on_circle'), {**CELLS, **DECOMPOSITIONS[decomposition]}, ranks=ranks)


@functools.lru_cache(maxsize=None)
def displacement(decomposition='blocks', ranks=1):
    return fields.field(box(decomposition, ranks).directory, 'displacement')


@functools.lru_cache(maxsize=None)
def bar(unit, force):
    """Box on the circle in other units: lengths in mm / unit, forces in N / force."""
    number = lambda value, length, forces: repr(value * unit ** -length * force ** -forces)
    box_size = number(10., 1, 0)
    case = scenes.box(
        materials={'elastic': {'Young modulus': number(1e5, -2, 1), 'Poisson ratio': '0.35'}},
        bodies={'box': {'Size': box_size + ', ' + box_size, 'Material': 'elastic', 'Thickness': number(1., 1, 0)}},
        obstacles={'disc': {'Center': number(5., 1, 0) + ', ' + number(-20., 1, 0), 'Radius': number(20., 1, 0)}},
        supports={'held': scenes.HELD},
        tractions={'pressed': {'Boundary': 'box/top', 'Traction y': number(-250., -2, 1)}},
        contacts={'circle': {**scenes.CIRCLE, 'Slip bound': number(150., -2, 1)}},
        Decomposition={'Method': 'blocks', 'Blocks': '2', 'Cells per block': '10'},
        Solver={'Tolerance': '1e-6'})
    return converged(case)


class Invariance(unittest.TestCase):

    def assert_close(self, a, b, scale, tolerance, what):
        self.assertLessEqual(abs(a - b), tolerance * scale, '{}: {} and {}'.format(what, a, b))

    def assert_same_contact(self, rows, others, tolerance, traction_tolerance=None):
        """Length-like figures to @p tolerance, tractions to @p traction_tolerance, relative to their largest."""
        self.assertEqual(len(rows), len(others))
        for name in ('x', 'y', 's', 'gap', 'slip', 'pressure', 'tangential_traction'):
            scale = max(abs(row[name]) for row in rows) or 1.
            limit = (traction_tolerance or tolerance) if name in ('pressure', 'tangential_traction') else tolerance
            for row, other in zip(rows, others):
                self.assert_close(row[name], other[name], scale, limit, '{} at x = {}'.format(name, row['x']))
        self.assertEqual([row['status'] for row in rows], [row['status'] for row in others])

    def assert_same(self, result, other, what):
        a, b = result.summary, other.summary
        with self.subTest(what):
            self.assertEqual(a['problem']['cells'], b['problem']['cells'])
            for name in ('max_displacement', 'strain_energy'):
                self.assert_close(a['results'][name], b['results'][name], a['results'][name], 1e-6, name)
            self.assert_same_contact(result.contact, other.contact, 1e-6, 1e-5)

    def test_ranks_do_not_change_the_answer(self):
        for ranks in (2, 4):
            self.assert_same(box(), box(ranks=ranks), '{} ranks'.format(ranks))
            self.assertEqual(box(ranks=ranks).summary['ranks'], ranks)
            self.assertLess(fields.largest_difference(displacement(), displacement(ranks=ranks)), 1e-6)

    def test_decomposition_does_not_change_the_answer(self):
        for method, ranks, subdomains in (('METIS', 2, 7), ('METIS', 4, 7), ('other seed', 2, 7), ('none', 1, 1)):
            what = '{} on {} ranks'.format(method, ranks)
            other = box(method, ranks)
            self.assert_same(box(), other, what)
            self.assertGreaterEqual(other.summary['problem']['subdomains'], subdomains)
            self.assertLess(fields.largest_difference(displacement(), displacement(method, ranks)), 1e-6, what)

    def test_more_ranks_than_subdomains(self):
        self.assert_same(box(), box('none', 3), 'one subdomain on 3 ranks')

    def test_steps_that_are_cut_on_eight_ranks(self):
        """Some ranks took part in an assignment of vectors, others did not: status 1."""
        converged(shipped('lap_joint'), {'Decomposition/Method': 'METIS', 'Decomposition/Subdomains': 8, 'Output/VTU': 'false',
                                         'Load steps/Factors': '1', 'Discretization/Refinements': 0}, ranks=8)

    def test_copies_of_a_node_agree(self):
        values = displacement('METIS', 2)
        self.assertGreater(max(len(copies) for copies in values.values()), 1)
        self.assertLess(fields.largest_difference(values, values), 1e-6)

    def test_same_input_and_ranks_give_the_same_bits(self):
        for method, ranks in (('blocks', 1), ('METIS', 2)):
            one, other = box(method, ranks), box(method, ranks, attempt=2)
            a, b = one.summary, other.summary
            for summary in (a, b):
                del summary['time_s'], summary['memory_mb']
            self.assertEqual(a, b)
            self.assertEqual(one.contact, other.contact)
            self.assertEqual(one.rows('convergence.csv', text=('algorithm',)),
                             other.rows('convergence.csv', text=('algorithm',)))

    def test_units_do_not_change_the_answer(self):
        """Metres and newtons (so pascals), metres and giganewtons, against millimetres and newtons."""
        reference = bar(1., 1.)
        for length, force in ((1e3, 1.), (1e3, 1e9)):
            other = bar(length, force)
            a, b = reference.summary, other.summary
            with self.subTest(length=length, force=force):
                for name in ('hessian_multiplications', 'outer_iterations', 'cg_steps', 'expansion_steps',
                             'proportioning_steps', 'active_constraints'):
                    self.assertEqual(a['solver'][name], b['solver'][name], name)
                stress, work = length ** 2 / force, length * force
                factors = {'max_displacement': length, 'max_von_mises': 1 / stress, 'strain_energy': work}
                for name, factor in factors.items():
                    value = a['results'][name]
                    self.assert_close(value, b['results'][name] * factor, value, 1e-9, name)
                lengths = ('x', 'y', 's', 'gap', 'slip')
                scaled = [{name: value if isinstance(value, str) else value * length if name in lengths else
                           value / stress for name, value in row.items()} for row in other.contact]
                self.assert_same_contact(reference.contact, scaled, 1e-9)

    def test_mirrored_scene_gives_the_mirrored_answer(self):
        def scene(side, x):
            return converged(scenes.box(supports={'held': {**scenes.HELD, 'Boundary': 'box/' + side}},
                                        tractions={'pressed': scenes.PRESSED},
                                        contacts={'circle': {**scenes.CIRCLE, 'Slip bound': '150'}},
                                        obstacles={'disc': {'Center': '{}, -20'.format(x), 'Radius': '20'}},
                                        Decomposition={'Method': 'blocks', 'Blocks': '2', 'Cells per block': '10'},
                                        Solver={'Tolerance': '1e-10'}))
        left, right = scene('left', 5.75), scene('right', 4.25)
        mirrored = right.contact[::-1]
        for row in mirrored:
            row.update({'x': 10 - row['x'], 'tangential_traction': -row['tangential_traction'], 'slip': -row['slip']})
        for row in left.contact + mirrored:
            del row['s']
            row['s'] = row['x']
        self.assert_same_contact(left.contact, [dict(row, s=row['x']) for row in mirrored], 1e-6, 1e-6)

    def test_symmetric_scene_gives_a_symmetric_answer(self):
        result = converged(shipped('box_prescribed'), {'Decomposition/Cells per block': 5, 'Solver/Tolerance': 1e-10},
                           ranks=2)
        mirrored = [dict(row, x=10 - row['x'], s=10 - row['s'], tangential_traction=-row['tangential_traction'],
                         slip=-row['slip']) for row in result.contact[::-1]]
        self.assert_same_contact(result.contact, mirrored, 1e-6)
        pair = result.summary['results']['contact'][0]
        self.assertLess(abs(pair['tangential_force']), 1e-8 * pair['normal_force'])
        self.assertGreater(pair['slip_nodes'], 0)

    def test_load_factor_in_linear_scene_scales_the_answer(self):
        def energy(factor):
            return converged(shipped('box_linear'), {'Decomposition/Cells per block': 5, 'Solver/Tolerance': 1e-10,
                                                     'Traction pressed/Traction y': -250 * factor})
        one, three = energy(1).summary['results'], energy(3).summary['results']
        self.assert_close(three['max_displacement'], 3 * one['max_displacement'], one['max_displacement'], 1e-9, 'u')
        self.assert_close(three['strain_energy'], 9 * one['strain_energy'], one['strain_energy'], 1e-8, 'energy')


if __name__ == '__main__':
    unittest.main()
