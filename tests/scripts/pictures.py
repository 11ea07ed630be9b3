"""scripts/render and scripts/report on the folder of a small run. Status 77 (skipped) where what it needs is not installed."""

import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / 'scripts'
sys.path.insert(0, str(SCRIPTS))
try:
    import matplotlib.pyplot
    import numpy
    from results import contact_plot, fields, film, folder, formula, painters, pictures, probe_plot, report_page, scene_drawing, solids
except ImportError as error:
    print('skipped: {}; scripts/setup --render'.format(error))
    sys.exit(77)

import run_folder


class WithRun(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.place = pathlib.Path(temporary.name)

    def run_of(self, **what):
        return folder.Run(run_folder.write(self.place / 'run', **what))


class ContactSurfaces(WithRun):
    def test_polygons_of_any_number_of_corners_are_drawn_whole(self):
        """Around corners of triangles of degree 2 there are five to eight middles of edges."""
        run = self.run_of()
        angles = numpy.arange(6) * math.pi / 3
        x = numpy.concatenate([numpy.stack([numpy.cos(angles), numpy.sin(angles)], axis=1), [[2., 0], [2., 1]]])
        array = '<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="ascii">{}</DataArray>'
        (run.folder / 'contact_000.vtp').write_text(
            '<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="8" NumberOfPolys="2"><Points>{}</Points><Polys>{}{}</Polys>'
            '</Piece></PolyData></VTKFile>'.format(
                array.format('Float64', 'points', 3, ' '.join('{} {} 0'.format(*row) for row in x)),
                array.format('Int64', 'connectivity', 1, '0 1 2 3 4 5 0 6 7'), array.format('Int64', 'offsets', 1, '6 9')))
        triangles = solids.ContactSurfacePainter(run).triangles(0, 8)
        self.assertEqual(triangles.shape, (5, 3))
        sides = x[triangles[:, 1:]] - x[triangles[:, :1]]
        area = abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]).sum() / 2
        self.assertAlmostEqual(area, 1.5 * math.sqrt(3) + 0.5)
        self.assertEqual(len(solids.ContactSurfacePainter(run).triangles(1, 8)), 0)  # no such file


class Formulas(unittest.TestCase):
    def test_as_muparser_evaluates_them(self):
        for text, expected in (('-20*(x>-8 && x<8)', -20), ('2^3', 8), ('x < 0 ? 1 : y < 0 ? 2 : 3', 3), ('t*sin(pi/2)', 0.5),
                               ('max(1, (x > 0 ? 7 : 8))', 7), ('-250', -250)):
            self.assertAlmostEqual(formula.value(text, 1, 2, 0.5), expected, msg=text)
        for text in ('__import__("os")', 'x +', 'unknown(1)', '1/0', 'free'):
            self.assertIsNone(formula.value(text), text)


class Fields(WithRun):
    def test_hoop_and_radial_stress(self):
        grid = self.run_of().grid(1)
        radial, hoop = (fields.values(name, grid) for name in ('radial', 'hoop'))
        self.assertEqual((radial[1], hoop[1]), (100, 20))  # at (1, 0) the radius is along x
        self.assertEqual((radial[3], hoop[3]), (20, 100))  # at (0, 1) along y
        self.assertAlmostEqual(radial[2], 60, places=4)
        self.assertTrue(numpy.isnan(radial[0]))  # the centre has none

    def test_what_is_not_there_is_named(self):
        with self.assertRaisesRegex(ValueError, 'principal_stress_1'):
            fields.values('principal_stress_1', self.run_of().grid(0))


class Pictures(WithRun):
    def painter(self, name='von_mises', run=None, **options):
        return pictures.Painter(run or self.run_of(), name, pictures.Options(**options))

    def test_true_scale_where_contact_is_open(self):
        self.assertEqual(self.painter(run=self.run_of(statuses=('open', 'stick'))).factor, 1)
        small = self.run_of(strain=1e-4)
        self.assertEqual(self.painter('displacement', small).factor, 200)
        self.assertEqual(self.painter('displacement', small, scale=3).factor, 3)

    def test_load_factors_of_ranges(self):
        run = self.run_of()
        run.scene.values['Load steps/Factors'] = '0:0.25:1, 2'
        self.assertEqual(run.scene.load_factors(), [0, 0.25, 0.5, 0.75, 1, 2])
        self.assertEqual(run.factors, [0.5, 1])  # of the steps that there are

    def test_gaps_that_are_given_are_not_magnified(self):
        run = self.run_of()
        run.scene.values['Contact joint/Offset'] = '-0.1'
        self.assertTrue(run.scene.has_given_gaps())

    def test_overlaps_of_the_geometry_are_not_magnified(self):
        """A ring shrunk on a shaft, drawn 200 times, would be far from it."""
        class Run:
            scene = type('Scene', (), {'has_given_gaps': staticmethod(lambda: False)})
            contact = [{'status': 'stick', 'initial_gap': '-0.02'}, {'status': 'slip', 'initial_gap': '0'}]
            is_open_anywhere, largest_closed_gap = folder.Run.is_open_anywhere, folder.Run.largest_closed_gap

        class Grid:
            points, displacement = numpy.array([[0, 0], [80, 0]]), numpy.array([[0.012, 0], [0, 0]])

        run = Run()
        self.assertEqual(pictures.magnification(run, [Grid], None), 1)
        self.assertEqual(pictures.magnification(run, [Grid], 7), 7)
        for row in run.contact:
            row['initial_gap'] = '1e-9'
        self.assertEqual(pictures.magnification(run, [Grid], None), 200)

    def test_all_steps_have_the_same_colours_and_axes(self):
        painter = self.painter()
        self.assertAlmostEqual(painter.limits[0], 5, delta=0.1)  # of the first step
        self.assertAlmostEqual(painter.limits[1], 12, delta=0.1)  # of the last
        axes = [painter.draw(step).axes[0] for step in (0, 1)]
        self.assertEqual(axes[0].get_xlim(), axes[1].get_xlim())
        self.assertEqual(axes[0].collections[0].get_clim(), axes[1].collections[0].get_clim())

    def test_colours_are_as_deep_as_magnitudes(self):
        painter = self.painter(limits=[-2000, 20])
        low, zero, high = (painter.colours()(place)[:3] for place in (0., 2000 / 2020, 1.))
        self.assertGreater(low[2] - low[0], 0.4)  # deep blue
        self.assertLess(max(high) - min(high), 0.1)  # 20 of 2000 is next to grey
        self.assertLess(max(zero) - min(zero), 0.05)

    def test_title_says_step_and_t_and_where_the_largest_value_is(self):
        first, second, third = self.painter().lines_of_title(0)
        self.assertIn('step 0 (0 to 1), t = 0.5', first)
        self.assertEqual(second, 'largest 6 MPa at (2, 0)')
        self.assertEqual(third, 'displacements in true scale')
        self.assertEqual(fields.place(numpy.array([-1e-17, 0.25])), '(0, 0.25)')

    def test_box_is_of_the_scene_before_loading(self):
        painter = self.painter(box=[-0.1, 1.1, -0.1, 1.1])
        self.assertAlmostEqual(painter.limits[1], 11, delta=0.1)  # x = 1, which moves to 1.1
        self.assertEqual(painter.largest(1)[0], 11)
        with self.assertRaisesRegex(ValueError, 'nothing of the scene'):
            self.painter(box=[5, 6, 5, 6])

    def test_symbols(self):
        axes = self.painter().draw(1).axes[0]
        kinds = [type(patch).__name__ for patch in axes.patches]
        self.assertEqual(kinds.count('FancyArrowPatch'), 2, kinds)  # the traction and the motion of the tip
        self.assertEqual(kinds.count('Polygon'), 3, kinds)  # obstacle, wall, tip
        bare = self.painter(with_symbols=False).draw(1).axes[0]
        self.assertEqual(len(bare.patches), 0)

    def test_symbols_of_bodies(self):
        """Weight and heat stand in the middle of the bodies that they act on, bolts at their sections."""
        run = self.run_of()
        run.scene.values.update({
            'Bodies': 'left, right', 'Materials': 'steel', 'Body forces': 'weight, spin', 'Temperatures': 'sun, day',
            'Pretensions': 'm8', 'Material steel/Density': '2', 'Body left/Material': 'steel', 'Body right/Material': 'steel',
            'Body force weight/Bodies': 'all', 'Body force weight/Acceleration y': '-10*t', 'Body force weight/Force x': '0',
            'Body force spin/Bodies': 'left', 'Body force spin/Angular velocity': '3', 'Body force spin/Axis': '0.5, 0.5',
            'Temperature sun/Bodies': 'right', 'Temperature sun/Change': '50*t', 'Temperature day/Bodies': 'all',
            'Temperature day/Change': '-10', 'Pretension m8/Point': '0.5, 0.5', 'Pretension m8/Direction': '0, 2'})
        axes = self.painter(run=run, scale=0).draw(1).axes[0]
        arrows = [patch for patch in axes.patches if type(patch).__name__ == 'FancyArrowPatch']
        ends = [[tuple(numpy.round(point, 6)) for point in patch._posA_posB] for patch in arrows]
        length = 0.06 * 2
        for tail in ((0.5, 0.5), (1.5, 0.5)):
            self.assertIn([tail, (tail[0], round(tail[1] - length, 6))], ends)
        self.assertIn([(0.5, 0.62), (0.5, 0.5)], ends)  # the bolt
        self.assertIn([(0.5, 0.38), (0.5, 0.5)], ends)
        self.assertEqual(len(arrows), 2 + 2 + 2 + 1)  # traction and motion, weight, bolt, spin
        self.assertEqual(sorted((text.get_text(), text.get_position()) for text in axes.texts),
                         [('+40 K', (1.5, 0.5)), ('-10 K', (0.5, 0.5))])
        labels = [text.get_text() for text in self.painter(run=run).draw(1).legends[0].get_texts()]
        for label in ('body force', 'change of temperature', 'pretension'):
            self.assertIn(label, labels)

    def test_nothing_is_cut_or_covered(self):
        for figure in (self.painter().draw(0), contact_plot.ContactPainter(self.run_of()).draw(0)):
            figure.canvas.draw()
            whole = figure.bbox
            boxes = [text.get_window_extent() for text in figure.texts] + [figure.legends[0].get_window_extent()]
            for box in boxes:
                self.assertTrue(whole.x0 <= box.x0 and box.x1 <= whole.x1 and whole.y0 <= box.y0 and box.y1 <= whole.y1, box)
            for axes in figure.axes:
                for box in boxes:
                    self.assertFalse(axes.get_window_extent().overlaps(box))


class Films(WithRun):
    def test_gif_and_mp4(self):
        files, remark = film.make(pictures.Painter(self.run_of(), 'von_mises', pictures.Options()), 2, self.place / 'film')
        self.assertEqual((self.place / 'film.gif').read_bytes()[:6], b'GIF89a')
        self.assertEqual(len(files) == 2, not remark)

    def test_without_ffmpeg(self):
        painter = contact_plot.ContactPainter(self.run_of())
        which, film.shutil.which = film.shutil.which, lambda name: None
        self.addCleanup(setattr, film.shutil, 'which', which)
        files, remark = film.make(painter, 2, self.place / 'film')
        self.assertEqual([file.name for file in files], ['film.gif'])
        self.assertIn('ffmpeg', remark)


class Probes(WithRun):
    def run_with_probes(self):
        run = self.run_of()
        (run.folder / 'probes.csv').write_text(run_folder.PROBES)
        return run

    def test_values_along_lines_and_over_steps(self):
        """Lines show their step, points all steps; rounding is left out; the axes are those of all steps."""
        painter = probe_plot.ProbePainter(self.run_with_probes())
        for step, t in enumerate(run_folder.FACTORS):
            axes = painter.draw(step).axes
            curves = [{line.get_label(): (list(line.get_xdata()), list(line.get_ydata())) for line in one.lines
                       if not line.get_label().startswith('_')} for one in axes]
            self.assertEqual(curves[0], {'u_x': ([0, 1, 2], [0, 0.1 * t, 0.2 * t])})
            self.assertEqual(sorted(curves[1]), ['stress_xx', 'stress_yy', 'von_mises'])
            self.assertEqual(curves[1]['stress_xx'][1], [100 * t] * 3)
            self.assertEqual(curves[2], {'u_x': ([0.5, 1], [0.1, 0.2])})
            self.assertGreater(axes[1].get_ylim()[1], 100)
            self.assertIn('across, from (0, 0.5) to (2, 0.5)', axes[0].get_title())
            self.assertIn('end, at (2, 0.5)', axes[2].get_title())

    def test_they_are_in_the_scene_and_in_the_report(self):
        run = self.run_with_probes()
        figure = scene_drawing.draw(run)
        self.assertIn('probe', [text.get_text() for text in figure.legends[0].get_texts()])
        self.assertEqual([text.get_text() for text in figure.axes[0].texts], ['across', 'end'])
        self.assertIn([[0, 0.5], [2, 0.5]], [line.get_xydata().tolist() for line in figure.axes[0].lines])
        self.assertEqual(report_page.page(run).count('<img '), 6)

    def test_runs_without_probes(self):
        painter = probe_plot.ProbePainter(self.run_of())
        self.assertEqual((painter.probes, painter.draw(0)), ({}, None))


class Solids(WithRun):
    def painter(self, name):
        run = folder.Run(run_folder.write_solid(self.place / 'run'))
        return painters.field_painter(run, name, pictures.Options(), painters.grids(run))

    def test_every_step_is_drawn(self):
        painter = self.painter('von_mises')
        self.assertEqual(painter.limits, [5, 11])
        for step, largest in ((0, '5.5'), (1, '11')):
            painter.draw(step)
            first, second, _ = painter.lines_of_title(step)
            self.assertIn('step {} (0 to 1), t = {:g}'.format(step, run_folder.FACTORS[step]), first)
            self.assertIn('largest magnitude {} MPa'.format(largest), second)

    def test_a_constant_has_a_scale_that_can_be_read(self):
        low, high = self.painter('principal_stress_1').limits
        self.assertAlmostEqual(low, 6.93, delta=0.001)
        self.assertAlmostEqual(high, 7.07, delta=0.001)


class Report(WithRun):
    def rows(self, text):
        return [re.sub('<[^>]*>', ' ', row).split() for row in re.findall('<tr.*?</tr>', text)]

    def test_everything_is_on_the_page(self):
        text = report_page.page(self.run_of())
        self.assertEqual(re.findall('(?:src|href)="(?!data:image/png;base64,)', text), [])  # no other file
        self.assertEqual(text.count('<img '), 5)  # scene, history, two fields, contact; the tip has no force
        self.assertIn('Contact joint: &lt;something&gt; &amp; more', text)
        rows = self.rows(text)
        for row in ('traction pull 60 0 -42', 'support wall -60 0 42', 'sum 0 0 0', 'joint 100 5 100 1 2 2 0 0', 'solve 0.75 s'):
            self.assertIn(row.split(), rows)
        self.assertIn('5 %', text)  # the estimated error

    def test_forces_over_displacements(self):
        """Of a support that is moved its reaction, of a probe the loads along the same axis."""
        run = self.run_of()
        (run.folder / 'history.csv').write_text('t,traction pull Fx,traction pull Fy,support wall Fx,support tip Fy,probe end ux,probe end uy\n'
                                                '0.5,30,0,-30,7,0.1,0\n1,60,1e-12,-60,5,0.2,1e-15\n')
        curves = []
        with unittest.mock.patch.object(report_page, 'picture', lambda figure, alt: curves.extend(
                (line.get_label(), list(line.get_xdata()), list(line.get_ydata())) for line in figure.axes[0].lines) or alt):
            self.assertEqual(report_page.loop_plot(run), 'forces over displacements')
        self.assertEqual(curves, [('traction pull Fx over probe end ux', [0.1, 0.2], [30, 60]),
                                  ('support wall Fx over probe end ux', [0.1, 0.2], [-30, -60]),
                                  ('support tip Fy over support tip uy', [0.005, 0.01], [7, 5])])

    def test_bolts(self):
        run = self.run_of()
        self.assertNotIn('Bolts', report_page.page(run))
        run.scene.values.update({'Pretensions': 'm8', 'Pretension m8/Body': 'left', 'Pretension m8/Point': '0.5, 0.25',
                                 'Pretension m8/Direction': '0, 2', 'Pretension m8/Force': '4000*t*(y > 0.2 ? 1 : 0)'})
        tensions = ((1999.9, True), (2100, False))  # asked for at t = 0.5, then held
        for step, (force, is_tightened) in zip(run.summary['steps'], tensions):
            step['pretensions'] = [{'pretension': 'm8', 'force': force, 'shortening': 0.0125, 'tightened': is_tightened}]
        run.summary['results']['pretensions'] = run.summary['steps'][-1]['pretensions']
        text = report_page.page(run)
        self.assertIn('<h2>Bolts</h2>', text)
        self.assertIn('m8 left 0.5, 0.25 0, 2 0.5 2000 1999.9 2100 0.0125'.split(), self.rows(text))

    def test_error_bars(self):
        run = self.run_of()
        self.assertNotIn('Error bars', report_page.page(run))
        run.summary['error_bars'] = [{'quantity': 'joint.max_pressure', 'value': 100., 'error': 1.25, 'unit': 'MPa'},
                                     {'quantity': 'max_displacement', 'value': 0.01, 'error': 2e-4, 'unit': 'mm'},
                                     {'quantity': 'tip.force_x', 'value': 3., 'error': None, 'unit': 'N', 'reason': 'held by a point'}]
        text = report_page.page(run)
        rows = self.rows(text)
        self.assertTrue(any(row[:1] == ['joint'] and '1.2' in row and '\u00b1' in row for row in rows), rows)
        self.assertTrue(any(row[:2] == ['largest', 'displacement'] and row[-3:] == ['\u00b1', '0.0002', 'mm'] for row in rows), rows)
        self.assertIn('tip.force_x 3 none: held by a point N'.split(), rows)
        painter = painters.field_painter(run, 'displacement', pictures.Options(), painters.grids(run))
        self.assertIn('\u00b1 0.0002 mm', painter.lines_of_title(len(painter.grids) - 1)[1])
        self.assertNotIn('\u00b1', painter.lines_of_title(0)[1])  # bars are of the last step
        contact = painters.contact_painter(run)
        for step, bars in ((contact.steps[-1], 1), (contact.steps[0], 0)):
            figure = contact.draw(step)
            self.assertEqual(len(figure.axes[0].containers), bars)
            matplotlib.pyplot.close(figure)

    def test_forces_that_do_not_balance_show(self):
        run = self.run_of()
        run.summary['results']['supports'][0]['force'][0] = -59
        self.assertIn('sum 1 0 0'.split(), self.rows(report_page.page(run)))

    def test_what_is_no_solution_is_marked(self):
        run = self.run_of()
        run.summary.update(status='not converged', converged=False)
        self.assertIn('the results below are not a solution', report_page.page(run))

    def test_in_a_browser(self):
        browser = shutil.which('chromium') or shutil.which('google-chrome')
        if not browser:
            self.skipTest('no Chromium')
        run = run_folder.write(self.place / 'run')
        result = subprocess.run([sys.executable, str(SCRIPTS / 'report'), str(run)], stdout=subprocess.PIPE, text=True, timeout=120)
        self.assertEqual((result.returncode, result.stdout), (0, 'report: {}\n'.format(run / 'report.html')))
        result = subprocess.run([browser, '--headless', '--no-sandbox', '--disable-gpu', '--user-data-dir={}'.format(self.place / 'profile'),
                                 '--dump-dom', (run / 'report.html').as_uri()], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                text=True, timeout=120)
        self.assertIn('Balance of loads and reactions', result.stdout)
        self.assertEqual(result.stdout.count('</table>'), 4)  # none is left open


class Needs(WithRun):
    """With a Matplotlib that cannot be imported until scripts/setup, a stand-in, has run."""

    def render(self, setup, **environment):
        run, scripts, lacking = run_folder.write(self.place / 'run'), self.place / 'scripts', self.place / 'lacking'
        shutil.copytree(SCRIPTS / 'results', scripts / 'results', ignore=shutil.ignore_patterns('__pycache__'))
        shutil.copy(SCRIPTS / 'render', scripts / 'render')
        lacking.mkdir()
        (lacking / 'matplotlib.py').write_text('raise ImportError("no matplotlib here")\n')
        (scripts / 'setup').write_text('#!/bin/bash\necho "$*" >>{0}/asked\n{1}\n'.format(self.place, setup.format(lacking)))
        (scripts / 'setup').chmod(0o755)
        return subprocess.run([sys.executable, str(scripts / 'render'), str(run), '--field', 'von_mises'], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=120,
                              env={**os.environ, 'PYTHONPATH': str(lacking), 'PYTHONDONTWRITEBYTECODE': '1', **environment})

    def asked(self):
        file = self.place / 'asked'
        return file.read_text().splitlines() if file.is_file() else []

    def test_they_are_installed_once_and_the_pictures_drawn(self):
        result = self.render('rm {}/matplotlib.py', SLIPSTICK_NO_SETUP='')
        self.assertEqual((result.returncode, self.asked()), (0, ['--render']), result)
        self.assertTrue((self.place / 'run' / 'von_mises.png').is_file())

    def test_what_setup_does_not_mend_ends(self):
        result = self.render('true', SLIPSTICK_NO_SETUP='')
        self.assertEqual((result.returncode, self.asked()), (10, ['--render']), result)
        self.assertIn('scripts/setup --render', result.stderr)

    def test_nothing_is_installed_where_that_is_not_wanted(self):
        result = self.render('true', SLIPSTICK_NO_SETUP='1')
        self.assertEqual((result.returncode, self.asked()), (10, []), result)
        self.assertIn('no matplotlib here', result.stderr)


class CommandLine(WithRun):
    def render(self, *arguments):
        return subprocess.run([sys.executable, str(SCRIPTS / 'render'), *map(str, arguments)], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=120)

    def test_pictures_and_messages(self):
        run = run_folder.write(self.place / 'run')
        (run / 'probes.csv').write_text(run_folder.PROBES)
        result = self.render(run, self.place / 'png', '--field', 'hoop,displacement_x', '--centre', '0,0.5')
        self.assertEqual(result.returncode, 0, result)
        self.assertEqual(sorted(file.name for file in (self.place / 'png').iterdir()),
                         ['contact.png', 'displacement_x.png', 'hoop.png', 'probes.png'])
        for arguments, message in ((['--field', 'nothing'], "no field 'nothing'"), (['--step', '7'], 'steps 0 to 1'),
                                   (['--pairs', 'x'], "no pair 'x'"), (['--box', '1,0,0,1'], 'X0 < X1')):
            result = self.render(run, self.place / 'png', *arguments)
            self.assertEqual(result.returncode, 2, result)
            self.assertIn(message, result.stderr)


if __name__ == '__main__':
    unittest.main()
