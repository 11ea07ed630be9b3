"""Bad input: exit status 2, one message with its remedy from one rank, nothing written, no rank left hanging."""

import pathlib
import unittest

import scenes
from program import PROGRAM, new_path, run, settings, shipped, solve

RANKS = 1, 3


class BadInput(unittest.TestCase):

    def check(self, result, words):
        self.assertEqual(result.status, 2, result)
        self.assertEqual(result.stderr.count('error:'), 1, result)
        self.assertTrue(result.stderr.startswith('error: '), result)
        self.assertEqual(result.stderr.count('\n  remedy: '), 1, result)
        self.assertEqual(len(result.stderr.splitlines()), 2, result)
        for word in words:
            self.assertIn(word, result.stderr, result)

    def refused(self, case, overrides, *words, ranks=(1,)):
        """The case with these settings is refused with a message that holds the words; no output directory remains.
        RANKS for one error of each place that finds errors: command line, every rank alike, one rank alone, output."""
        for n in ranks:
            with self.subTest(ranks=n):
                result = solve(case, overrides, ranks=n)
                self.check(result, words)
                self.assertFalse(result.directory.exists(), '{}\nleft: {}'.format(result, result.files()))

    def refused_box(self, overrides, *words, ranks=(1,)):
        self.refused(shipped('box_on_circle'), {'Decomposition/Cells per block': 4, **overrides}, *words, ranks=ranks)

    # files and command line

    def test_missing_file_names_the_nearest(self):
        self.refused(shipped('box_on_circel'), {}, 'box_on_circel.prm', "did you mean 'box_on_circle.prm'?",
                     ranks=RANKS)

    def test_directory_in_place_of_a_file(self):
        self.refused(str(pathlib.Path(shipped('x')).parent), {}, 'cannot be read as a scene file')

    def test_binary_file(self):
        self.refused(PROGRAM, {}, 'is no text file')

    def test_no_case_file(self):
        for n in RANKS:
            self.check(run(ranks=n), ['no case file'])

    def test_unknown_option_names_the_nearest(self):
        self.check(run(shipped('box_linear'), '--chekc'), ["'--chekc'", "did you mean '--check'?"])

    def test_option_without_its_value(self):
        self.check(run(shipped('box_linear'), '--output'), ['--output'])
        self.check(run(shipped('box_linear'), '--set', ranks=2), ['--set'])

    def test_override_without_a_value(self):
        self.check(run(shipped('box_linear'), '--set', 'Solver/Tolerance'), ['Solver/Tolerance', 'value'])

    def test_unknown_list_format(self):
        self.check(run('--list-parameters', 'jsno'), ["did you mean 'json'?"])

    # names

    def test_unknown_parameter_names_the_nearest(self):
        self.refused_box({'Solver/Tolerence': '1e-6'}, "'Solver/Tolerence'", "did you mean 'Tolerance'?", ranks=RANKS)

    def test_unknown_section_names_the_nearest(self):
        self.refused_box({'Slover/Tolerance': '1e-6'}, "'Slover'", "did you mean 'Solver'?")

    def test_misspelt_line_of_a_file_is_located(self):
        text = pathlib.Path(shipped('box_on_circle')).read_text()
        case = scenes.write('box', text.replace('set Slip bound =', 'set Slip buond ='))
        line = 1 + text[:text.index('set Slip bound =')].count('\n')
        self.refused(case, {}, 'box.prm:{}: '.format(line), "did you mean 'Slip bound'?")

    def test_boundary_that_the_body_does_not_have(self):
        self.refused_box({'Support held/Boundary': 'box/lfet'}, "no boundary 'lfet'", "did you mean 'left'?")

    # values

    def test_negative_modulus(self):
        self.refused_box({'Material elastic/Young modulus': '-1e5'}, 'Material elastic/Young modulus', "'-1e5'", '[1e-20, 1e+20]')

    def test_poisson_ratio_of_a_half(self):
        self.refused_box({'Material elastic/Poisson ratio': '0.5'}, "'0.5'", '(-1, 0.5)')

    def test_poisson_ratio_of_minus_one(self):
        self.refused_box({'Material elastic/Poisson ratio': '-1'}, "'-1'", '(-1, 0.5)')

    def test_zero_blocks(self):
        self.refused_box({'Decomposition/Blocks': '0'}, 'Decomposition/Blocks', "'0'", 'from 1')

    def test_zero_subdomains(self):
        self.refused_box({'Decomposition/Method': 'METIS', 'Decomposition/Subdomains': '0'},
                         'Decomposition/Subdomains', "'0'", 'from 1')

    def test_wrong_number_formats(self):
        for value in ('1e-4x', '1,5e-4', 'small', ''):
            self.refused_box({'Solver/Tolerance': value}, 'Solver/Tolerance', "'{}'".format(value))

    def test_wrong_formula(self):
        self.refused_box({'Traction pressed/Traction y': '-250*(x'}, 'Traction pressed/Traction y')

    def test_formula_that_is_not_finite_at_a_node(self):
        self.refused_box({'Traction pressed/Traction y': '1/(x-x)'}, 'Traction pressed', ranks=RANKS)
        self.refused_box({'Support held/Displacement x': '1/x'}, 'Support held', ranks=(2,))

    def test_negative_slip_bound(self):
        self.refused_box({'Contact circle/Slip bound': '-1'}, 'Contact circle/Slip bound', 'negative')

    def test_slip_bound_formula_that_turns_negative(self):
        self.refused_box({'Contact circle/Slip bound': '100*(8-x)'}, 'Contact circle/Slip bound', 'MPa at (',
                         ranks=RANKS)

    # the scene as a whole

    def test_no_support_and_no_contact(self):
        case = scenes.box(tractions={'pressed': scenes.PRESSED})
        self.refused(case, {}, "nothing holds body 'box'", 'add a support, a foundation or a contact')

    def test_supports_that_contradict_each_other_in_a_corner(self):
        case = scenes.box(supports={'held': scenes.HELD,
                                    'moved': {'Boundary': 'box/bottom', 'Displacement x': '0.1'}})
        self.refused(case, {}, 'both 0 and 0.1 for displacement x at (0, 0)', ranks=RANKS)

    def test_supports_that_contradict_each_other_across_ranks(self):
        case = scenes.box(supports={'held': scenes.HELD, 'moved': {'Boundary': 'box/top', 'Displacement x': '0.1'}},
                          Decomposition={'Method': 'METIS', 'Subdomains': '5', 'Blocks': '1', 'Cells per block': '8'})
        self.refused(case, {}, 'both 0 and 0.1 for displacement x at (0, 10)', ranks=(3,))

    def test_two_supports_of_one_boundary(self):
        case = scenes.box(supports={'held': scenes.HELD, 'again': scenes.HELD})
        self.refused(case, {}, 'Support again', 'Support held')

    # output

    def unwritable(self, directory, *words, ranks=(1,)):
        for n in ranks:
            with self.subTest(ranks=n):
                self.check(run(shipped('box_on_circle'), *settings({'Decomposition/Cells per block': 4}), '--output',
                               directory, ranks=n), words)

    def test_output_directory_is_a_file(self):
        path = new_path('file')
        path.write_text('content')
        self.unwritable(path, str(path), '--output')
        self.assertEqual(path.read_text(), 'content')

    def test_output_directory_below_a_file(self):
        path = new_path('file')
        path.write_text('content')
        self.unwritable(path / 'below', str(path), '--output')

    def test_output_directory_where_nothing_can_be_made(self):
        self.unwritable('/proc/x', '/proc/x', '--output', ranks=RANKS)

    def test_earlier_results_stay_as_they_were(self):
        directory = new_path('output')
        directory.mkdir()
        (directory / 'summary.json').write_text('{}')
        result = run(shipped('box_on_circle'), '--set', 'Contact circle/Slip bound=100*(8-x)', '--set',
                     'Decomposition/Cells per block=4', '--output', directory, ranks=2, directory=directory)
        self.check(result, ['Slip bound'])
        self.assertEqual(result.files(), ['summary.json'])
        self.assertEqual((directory / 'summary.json').read_text(), '{}')


if __name__ == '__main__':
    unittest.main()
