"""Options that do not solve, and how much a run prints."""

import json
import re
import unittest
from xml.etree import ElementTree

from program import WORK, new_path, run, settings, shipped

SMALL = settings({'Decomposition/Cells per block': 4})


class CommandLine(unittest.TestCase):

    def succeeds(self, *arguments, ranks=1):
        result = run(*arguments, ranks=ranks)
        self.assertEqual(result.status, 0, result)
        self.assertEqual(result.stderr, '', result)
        return result.stdout

    def test_help_goes_to_standard_output_once(self):
        for ranks in (1, 3):
            text = self.succeeds('--help', ranks=ranks)
            self.assertEqual(text.count('Usage:'), 1)
            for option in ('--set', '--output', '--check', '--list-parameters', '--quiet', '--verbose', '--version'):
                self.assertIn(option, text)

    def test_version(self):
        for ranks in (1, 3):
            self.assertRegex(self.succeeds('--version', ranks=ranks), r'\Aslipstick \d+\.\d+\.\d+\n\Z')

    def test_list_parameters_as_text_is_the_default(self):
        text = self.succeeds('--list-parameters', ranks=2)
        self.assertEqual(text, self.succeeds('--list-parameters', 'text'))
        for word in ('Slip bound', 'MPa', 'Poisson ratio', '0.5', 'Cells per block'):
            self.assertIn(word, text)

    def test_list_parameters_as_a_scene_that_can_be_checked(self):
        case = new_path('listed.prm')
        case.write_text(self.succeeds('--list-parameters', 'prm'))
        result = run(case, '--check', *SMALL, *settings({'Contact circle/Slip bound': 10}), ranks=2)
        self.assertEqual(result.status, 0, result)

    def test_list_parameters_as_json(self):
        listed = json.loads(self.succeeds('--list-parameters', 'json', ranks=2))
        text = json.dumps(listed)
        for word in ('Slip bound', 'MPa', 'default'):
            self.assertIn(word, text)

    def test_list_parameters_as_latex(self):
        self.assertIn('\\item', self.succeeds('--list-parameters', 'latex'))

    def test_check_solves_nothing_and_writes_nothing(self):
        for ranks in (1, 2):
            directory = new_path('output')
            before = sorted(WORK.glob('*'))
            text = self.succeeds(shipped('box_on_circle'), *SMALL, '--check', '--output', directory, ranks=ranks)
            self.assertFalse(directory.exists())
            self.assertEqual(sorted(WORK.glob('*')), before)
            for word in ('box', 'bottom', 'top', 'left', 'right', 'kernel 48', '16 normal', '16 tangential'):
                self.assertIn(word, text)
            self.assertNotIn('outer', text)

    def test_drawing(self):
        for ranks in (1, 2):
            file = new_path('pictures') / 'scene.svg'
            text = self.succeeds(shipped('box_on_circle'), *SMALL, '--draw', file, ranks=ranks)
            self.assertIn('picture of the scene: {}'.format(file), text)
            self.assertNotIn('outer', text)
            drawn = {}
            for element in ElementTree.parse(file).iter():
                drawn.setdefault(element.get('class', element.tag.rsplit('}')[-1]), []).append(element)
            self.assertEqual({element.text for element in drawn['text']}, {'support held', 'traction pressed', 'contact, slave circle'})
            (held,), (pressed,), (slave,) = drawn['support'], drawn['traction'], drawn['contact, slave']
            points = [[float(number) for number in re.findall(r'[-\d.]+', one.get('d'))] for one in (held, pressed, slave)]
            self.assertEqual(set(points[0][::2]), {40})  # left
            self.assertEqual(set(points[1][1::2]), {40})  # top
            self.assertEqual(set(points[2][1::2]), {940})  # bottom
            circle, = [one for one in drawn['obstacle'] if one.get('r')]
            self.assertEqual([float(circle.get(key)) for key in ('cx', 'cy', 'r')], [490, 2740, 1800])
            self.assertGreater(len(drawn['arrow']), 3)
            for arrow in drawn['arrow']:
                x0, y0, x1, y1 = [float(number) for number in re.findall(r'[-\d.]+', arrow.get('d'))]
                self.assertEqual((x1 - x0, y1), (0, 40))
                self.assertLess(y0, y1)  # downwards
            self.assertEqual(drawn['mesh'][0].get('d').count('z'), 256)

    def test_quiet_prints_nothing(self):
        directory = new_path('output')
        self.assertEqual(self.succeeds(shipped('box_on_circle'), *SMALL, '--quiet', '--output', directory, ranks=2), '')
        self.assertTrue((directory / 'summary.json').exists())

    def test_last_lines_name_the_figures_and_the_file_to_open(self):
        directory = new_path('output')
        text = self.succeeds(shipped('box_on_circle'), *SMALL, '--output', directory, ranks=2)
        summary = json.loads((directory / 'summary.json').read_text())
        last = '\n'.join(text.splitlines()[-5:])
        for word in (str(directory / 'solution.pvd'), '{} F-multiplications'.format(
                summary['solver']['hessian_multiplications']), 'largest pressure', 'stick', 'slip', 'open',
                     'equilibrium error'):
            self.assertIn(word, last)

    def test_output_goes_below_the_working_directory_by_default(self):
        self.succeeds(shipped('box_linear'), *SMALL, '--quiet', *settings({'Output/VTU': 'false'}))
        self.assertTrue((WORK / 'output' / 'box_linear' / 'summary.json').exists())


if __name__ == '__main__':
    unittest.main()
