"""Several bodies, one answer: whatever the order of bodies, pairs, nodes and cells, the cut into subdomains, the units;
within the discretisation also when slave and master change sides."""

import functools
import json
import random
import unittest

from program import SOURCE, converged, new_path, shipped

TIGHT = {'Solver/Tolerance': 1e-11, 'Friction/Tolerance': 1e-11}


@functools.lru_cache(maxsize=None)
def scene(name, overrides=(), ranks=1):
    return converged(shipped(name), {**TIGHT, **dict(overrides)}, ranks=ranks)


def pairs(result):
    return {pair['pair']: pair for pair in result.summary['results']['contact']}


def energy(result):
    return result.summary['results']['strain_energy']


def renumbered(mesh, name):
    """Copy of an ASCII mesh of version 2.2: nodes and cells in another order, nodes under other numbers."""
    lines = mesh.read_text().splitlines()
    chance = random.Random(1)
    nodes, elements = lines.index('$Nodes'), lines.index('$Elements')
    n_nodes, n_elements = int(lines[nodes + 1]), int(lines[elements + 1])
    node_lines = [line.split() for line in lines[nodes + 2:nodes + 2 + n_nodes]]
    numbers = [3 * i + 7 for i in range(n_nodes)]  # with holes
    chance.shuffle(numbers)
    new = {line[0]: str(number) for line, number in zip(node_lines, numbers)}
    node_lines = [' '.join([new[line[0]]] + line[1:]) for line in node_lines]
    chance.shuffle(node_lines)
    element_lines = []
    for line in lines[elements + 2:elements + 2 + n_elements]:
        words = line.split()
        first = 3 + int(words[2])
        element_lines.append(words[1:first] + [new[word] for word in words[first:]])
    chance.shuffle(element_lines)
    element_lines = [' '.join([str(i + 1)] + words) for i, words in enumerate(element_lines)]
    path = new_path(name)
    path.write_text('\n'.join(lines[:nodes + 2] + node_lines + lines[nodes + 2 + n_nodes:elements + 2] + element_lines +
                              lines[elements + 2 + n_elements:]) + '\n')
    return path


class MultibodyInvariance(unittest.TestCase):

    def assert_near(self, a, b, tolerance, what):
        self.assertLessEqual(abs(a - b), tolerance, '{}: {} and {}'.format(what, a, b))

    def assert_same(self, result, other, tolerance=1e-8, length=1., stress=1.):
        """Energies, forces and tractions relative to the largest; @p length, @p stress: one unit of other in those of
        result."""
        force = stress * length ** 2
        self.assert_near(energy(result), energy(other) * force * length, tolerance * energy(result), 'energy')
        a, b = pairs(result), pairs(other)
        self.assertEqual(set(a), set(b))
        largest = max(pair['normal_force'] for pair in a.values())
        for name in a:
            for key in ('normal_force', 'tangential_force'):
                self.assert_near(a[name][key], b[name][key] * force, tolerance * largest, name + ' ' + key)
            for key in ('contact_nodes', 'open_nodes'):
                self.assertEqual(a[name][key], b[name][key], name + ' ' + key)

        def rows(one, size):
            return {(row['pair'], row['step'], round(row['x'] * size, 5) + 0., round(row['y'] * size, 5) + 0.): row
                    for row in one.contact}
        left, right = rows(result, 1.), rows(other, length)
        self.assertEqual(set(left), set(right))
        scale = max(row['pressure'] for row in left.values())
        for place, row in left.items():
            for key in ('pressure', 'tangential_traction'):
                # of single nodes: the sets are those of the forces, the sum of all is ten times as accurate
                self.assert_near(row[key], right[place][key] * stress, 10 * tolerance * scale, '{} {}'.format(place, key))

    def test_order_of_bodies_and_pairs(self):
        backwards = {'Bodies': 'D, C, B, A', 'Contacts': 'back, web, lower flank, upper flank, flange, seat',
                     'Supports': 'hold, symmetry D, symmetry C, symmetry B, symmetry A'}
        self.assert_same(scene('clamp'), scene('clamp', tuple(backwards.items())))

    def test_ranks(self):
        for name in ('clamp', 'cattaneo_mindlin', 'arch'):
            with self.subTest(name):
                self.assert_same(scene(name), scene(name, ranks=3))

    def test_same_input_and_ranks_give_the_same_bits(self):
        """Coulomb friction, default algorithm and tolerance; all that is written but times and memory."""
        case = shipped('clamp'), {'Decomposition/Subdomains': 9}
        for ranks in (1, 2):
            runs = [converged(*case, ranks=ranks) for _ in range(2)]
            summaries = [run.summary for run in runs]
            for summary in summaries:
                self.assertGreater(summary.pop('time_s')['total'], 0)
                self.assertGreater(summary.pop('memory_mb')['peak_total'], 0)
            with self.subTest(ranks=ranks):
                self.assertEqual(summaries[0]['ranks'], ranks)
                self.assertEqual(summaries[0]['solver']['algorithm'], 'semismooth newton')
                self.assertGreater(summaries[0]['solver']['coulomb_iterations'], 1)
                self.assertGreater(summaries[0]['problem']['dual']['equality'], 0)
                one, other = (json.dumps(summary, indent=1).splitlines() for summary in summaries)  # tells -0 from 0
                self.assertEqual(one, other)
                for name in ('contact.csv', 'convergence.csv'):
                    one, other = ((run.directory / name).read_bytes() for run in runs)
                    self.assertTrue(one == other, name + ' differs')

    def test_subdomains_and_seeds(self):
        for overrides in ({'Decomposition/Subdomains': 9}, {'Decomposition/Subdomains': 9, 'Decomposition/Seed': 5}):
            with self.subTest(overrides):
                other = scene('clamp', tuple(overrides.items()), ranks=2)
                self.assertGreaterEqual(other.summary['problem']['subdomains'], 9)
                self.assert_same(scene('clamp'), other)

    def test_numbers_of_nodes_and_cells(self):
        mesh = renumbered(SOURCE / 'meshes' / 'cattaneo_mindlin.msh', 'renumbered.msh')
        other = scene('cattaneo_mindlin', tuple(('Body {}/File'.format(body), str(mesh)) for body in ('upper', 'lower')))
        self.assert_same(scene('cattaneo_mindlin'), other)

    def test_units(self):
        """Metres and pascals against millimetres and megapascals."""
        other = scene('cattaneo_mindlin', (
            ('Body upper/Scale', 1e-3), ('Body lower/Scale', 1e-3), ('Body upper/Thickness', 1e-3),
            ('Body lower/Thickness', 1e-3), ('Material steel/Young modulus', 2.1e11),
            ('Traction above/Traction x', '0.75e6*max(t-1,0)'),
            ('Traction above/Traction y', '-5e6*min(t,1) + 0.0225e9*x*max(t-1,0)'),
            ('Traction below/Traction x', '-0.75e6*max(t-1,0)'),
            ('Traction below/Traction y', '5e6*min(t,1) + 0.0225e9*x*max(t-1,0)')))
        one = scene('cattaneo_mindlin')
        self.assert_same(one, other, length=1e3, stress=1e-6)
        self.assertEqual(one.summary['solver']['hessian_multiplications'],
                         other.summary['solver']['hessian_multiplications'])

    def swapped(self, name, pair, slave, master, tolerance, overrides=()):
        one = scene(name, overrides)
        other = scene(name, overrides + (('Contact {}/Slave'.format(pair), slave),
                                         ('Contact {}/Master'.format(pair), master)))
        self.assert_near(energy(one), energy(other), tolerance * energy(one), name + ' energy')
        a, b = pairs(one)[pair], pairs(other)[pair]
        self.assert_near(a['normal_force'], b['normal_force'], tolerance * a['normal_force'], name + ' force')
        self.assertEqual(a['tangential_force'] > 0, b['tangential_force'] > 0, name)
        return one, other

    def test_swapped_sides(self):
        """To the discretisation: of the rings 16 cells on a quarter, of the clamp 2 mm, of the cylinders 20 cells."""
        self.swapped('press_fit', 'fit', 'shaft/outer', 'ring/inner', 5e-3)
        self.swapped('clamp', 'flange', 'C/flange', 'B/flange', 2e-2)
        self.swapped('cattaneo_mindlin', 'touch', 'lower/contact', 'upper/contact', 2e-3)

    def test_swapped_sides_of_the_patch_test(self):
        self.swapped('patch_gmsh', 'cut', 'lower/interface', 'upper/interface', 1e-9)

    def test_pruned_candidates_do_not_count(self):
        self.assert_same(scene('clamp'), scene('clamp', (('Solver/Prune contact', 'false'),)))


if __name__ == '__main__':
    unittest.main()
