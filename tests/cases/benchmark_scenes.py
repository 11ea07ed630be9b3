"""Meshes and scenes that benchmarks/families and benchmarks/graded write: areas, outlines, and answers known from statics."""

import math
import pathlib
import sys
import tempfile
import unittest

from program import SOURCE, WORK, converged

sys.path.append(str(SOURCE / 'benchmarks'))
import family_scenes  # noqa: E402
import meshes  # noqa: E402
from scene_files import Variant  # noqa: E402


def area(mesh):
    """Positive for cells that run counterclockwise; the smallest cell, too."""
    areas = [sum(mesh.nodes[a][0] * mesh.nodes[b][1] - mesh.nodes[b][0] * mesh.nodes[a][1]
                 for a, b in zip(cell, cell[1:] + cell[:1])) / 2 for cell in mesh.cells]
    return sum(areas), min(areas)


def solved(scene, overrides=None):
    """Contact pairs of all load steps."""
    result = converged(scene.write(pathlib.Path(tempfile.mkdtemp(dir=WORK))), {'Solver/Tolerance': 1e-8, **(overrides or {})})
    return [pair for step in result.summary['steps'] for pair in step['contact']]


class Meshes(unittest.TestCase):

    def test_areas_of_quadrilaterals_and_triangles(self):
        box = meshes.grid(meshes.graded_both(-3, 0, 5, 10, 0.01), meshes.graded(0, -2, 6, 0.01)[::-1])
        polygon = 12 * math.sin(2 * math.pi / 24) * 25  # 24 corners on radius 5
        for mesh, wanted in ((box, 16), (meshes.disc(5, 24, 3), polygon), (meshes.disc(5, 24, 3, smallest=0.1), polygon),
                             (meshes.ring([2, 3, 5], 24), polygon * (1 - 0.16))):
            for one in (mesh, mesh.split(), mesh.turned(37)):
                total, smallest = area(one)
                self.assertAlmostEqual(total, wanted, places=9)
                self.assertGreater(smallest, 0)
            self.assertEqual(len(mesh.split().cells), 2 * len(mesh.cells))

    def test_boundaries_run_around_the_outline_once(self):
        for mesh in (meshes.grid([0, 1, 3], [0, 1, 2, 4]), meshes.disc(5, 24, 3), meshes.ring([2, 3, 5], 24)):
            once = {}
            for cell in mesh.cells:
                for edge in zip(cell, cell[1:] + cell[:1]):
                    once[frozenset(edge)] = edge if frozenset(edge) not in once else None
            outline = sorted(edge for edge in once.values() if edge)
            self.assertEqual(outline, sorted(edge for lines in mesh.lines.values() for edge in lines))

    def test_smallest_cells_are_as_asked(self):
        points = meshes.graded_both(-5, 0, 5, 50, 0.01)
        self.assertAlmostEqual(min(b - a for a, b in zip(points, points[1:])), 0.01, places=9)
        self.assertEqual((points[0], points[-1], len(points)), (-5, 5, 51))


class Statics(unittest.TestCase):
    """Forces that follow from equilibrium alone."""

    def test_wedge_that_slips_at_both_sides(self):
        width, slope, mu = 2 + 10 * math.tan(math.radians(10)), math.radians(10), 0.1
        right = 50 * width / (mu * (math.cos(slope) - mu * math.sin(slope)) + math.sin(slope) + mu * math.cos(slope))
        left = right * (math.cos(slope) - mu * math.sin(slope))
        for variant in (Variant(), Variant(turn=37., triangles=True)):
            pairs = solved(family_scenes.wedge(variant, n=12, mu=mu), {'Load steps/Factors': 1})
            for pair, wanted in zip(pairs, (left, right)):
                self.assertAlmostEqual(pair['normal_force'] / wanted, 1, places=4)
                self.assertAlmostEqual(abs(pair['tangential_force']) / wanted, mu, places=4)

    def test_wedge_that_stays_jammed(self):
        """Friction locks forces in, which do not end with the load."""
        nearly, unloaded = (solved(family_scenes.wedge(Variant(), n=12, mu=0.3), {'Load steps/Factors': '1, 2, 3, 4, 5, ' + last})
                            for last in ('5.999999', '6'))
        for before, after in zip(nearly, unloaded):
            self.assertGreater(before['normal_force'], 100)
            self.assertAlmostEqual(after['normal_force'] / before['normal_force'], 1, places=4)

    def test_wedge_released(self):
        """Drawn out again: nothing is left, told beside what there was, and at no price of its own."""
        result = converged(family_scenes.wedge(Variant(subdomains=32), mu=0.3, driven='displacement').write(
            pathlib.Path(tempfile.mkdtemp(dir=WORK))), {'Solver/Tolerance': 1e-8})
        steps = result.summary['steps']
        largest = max(pair['normal_force'] for step in steps for pair in step['contact'])
        for pair in steps[-1]['contact']:
            self.assertLess(pair['normal_force'], 1e-8 * largest)
        products = [step['hessian_multiplications'] for step in steps]
        self.assertLess(products[-1], products[0], products)

    def test_ring_twisted_on_its_shaft(self):
        pressure, mu = family_scenes.rigid_bore_pressure(0.01), 0.2
        fitted, twisted = solved(family_scenes.twisted_ring(Variant(exchanged=True), 0.5, (32, 40), mu))
        self.assertAlmostEqual(fitted['max_pressure'] / pressure, 1, delta=0.02)
        self.assertAlmostEqual(abs(twisted['tangential_force']) / (0.5 * mu * pressure * 2 * math.pi * 10), 1, delta=0.02)


if __name__ == '__main__':
    unittest.main()
