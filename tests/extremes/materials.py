"""Moduli of two bodies up to 1e9 apart, Poisson ratios up to 0.49999, units and thicknesses over twelve decades."""

import unittest

from sweep import Extremes, Table, count, pair, stack

E = 2.1e5
SCALES = ('hessian_multiplications', 'outer_iterations', 'cg_steps', 'active_constraints', 'fallbacks')


class Materials(Extremes):

    def test_stiffness_ratio(self):
        """The hard body becomes rigid: beyond 1e3 the answer changes by the ratio alone, the pressures not at all."""
        table = Table('stiffness of the upper body over that of the lower one')
        energy, pressure = {}, {}
        for power in (-8, -6, -3, 0, 3, 6, 9):
            result = self.converges(table, '1e{}'.format(power), stack(box={'Young modulus': repr(E * 10.**power)}), most=110)
            self.in_balance(result)
            self.assertEqual(any('same units' in text for text in result.summary['warnings']), abs(power) > 5, result)
            energy[power] = result.summary['results']['strain_energy']
            pressure[power] = pair(result)['max_pressure']
        self.near(energy[6], energy[9], 1e-5)
        self.near(energy[3], energy[9], 1e-2)
        self.near(energy[-6], energy[-8] * 1e-2, 1e-5)  # all in the soft box
        self.near(pressure[-8], pressure[-6], 1e-5)
        self.near(pressure[9], pressure[6], 1e-5)

    def test_stiffness_ratio_for_other_subdomains(self):
        """Faces were solved to more than the residual that tells slip from stick, or not at all (decision 0166)."""
        table = Table('the same for small ratios, seeds of METIS')
        for power, seeds in ((-7, (1, 7)), (-8, range(12)), (-9, range(12))):
            case = stack(box={'Young modulus': repr(E * 10.**power)})
            counts = [count(self.converges(table, '1e{} {}'.format(power, seed), case, {'Decomposition/Seed': seed}, most=100))
                      for seed in seeds]
            self.assertLessEqual(sum(counts), 50 * len(counts), power)

    def test_stiffness_ratio_beyond_rounding(self):
        """At 1e-9 rounding of the soft box would show in the stresses of the base (1e-3) if it were not overcome."""
        table = Table('the same at 1e-9')
        right = pair(self.converges(table, '1e-6', stack(box={'Young modulus': repr(E * 1e-6)}), most=100))['max_pressure']
        case = stack(box={'Young modulus': repr(E * 1e-9)})
        for algorithm, most in (('auto', 100), ('smalbe', 100000)):
            result = self.converges(table, '1e-9 ' + algorithm, case, {'Solver/Algorithm': algorithm}, most=most)
            self.near(pair(result)['max_pressure'], right, 1e-4)

    def test_stiffness_ratio_with_smalbe(self):
        table = Table('the same with SMALBE')
        for power, most in ((-6, 1200), (-3, 600), (3, 600), (9, 600)):
            case = stack(box={'Young modulus': repr(E * 10.**power)})
            result = self.converges(table, '1e{}'.format(power), case, {'Solver/Algorithm': 'smalbe'}, most=most)
            self.in_balance(result)

    def test_poisson_ratio(self):
        """A layer between rigid walls, pressed through contact: locking elements let it yield far too little."""
        table = Table('Poisson ratio in plane strain')
        for ratio in (0, 0.3, 0.45, 0.49, 0.499, 0.49999):
            motion = {}
            for element, degree in (('standard', 1), ('nearly incompressible', 1), ('nearly incompressible', 2)):
                material = {'Poisson ratio': repr(ratio)}
                result = self.converges(
                    table, '{} {} degree {}'.format(ratio, element, degree), stack(base=material, box=material),
                    {'Plane state': 'plane strain', 'Discretization/Element': element, 'Discretization/Degree': degree})
                self.in_balance(result)
                warned = any('lock' in text for text in result.summary['warnings'])
                self.assertEqual(warned, element == 'standard' and ratio > 0.495, result)
                motion[element, degree] = result.summary['results']['strain_energy']
            self.near(motion['nearly incompressible', 1], motion['nearly incompressible', 2], 0.06, ratio)
            if ratio > 0.499:
                self.assertLess(motion['standard', 1], 0.9 * motion['nearly incompressible', 2])

    def scales(self, table, what, reference, other, length, force):
        """The same iterates, and figures that differ by units alone."""
        a, b = reference.summary, other.summary
        for name in SCALES:
            self.assertEqual(a['solver'][name], b['solver'][name], '{} {}'.format(what, name))
        for name, unit in (('max_displacement', length), ('max_von_mises', force / length**2),
                           ('strain_energy', force * length)):
            self.near(b['results'][name] * unit, a['results'][name], 1e-9, '{} {}'.format(what, name))
        for name in ('normal_force', 'tangential_force'):
            self.near(pair(other)[name] * force, pair(reference)[name], 1e-9, '{} {}'.format(what, name))

    def test_units(self):
        table = Table('unit of length [mm], unit of force [N]')
        reference = self.converges(table, '1, 1', stack())
        for length, force in ((1e-6, 1), (1e-3, 1), (1e3, 1), (1e6, 1), (1, 1e-6), (1, 1e6), (1e3, 1e9), (25.4, 4.448)):
            other = self.converges(table, '{:g}, {:g}'.format(length, force), stack(unit=length, force=force))
            self.scales(table, (length, force), reference, other, length, force)

    def test_thickness(self):
        """Loads are tractions: forces and energy grow with the thickness, displacements do not."""
        table = Table('thickness [mm]')
        reference = self.converges(table, '1', stack())
        for thickness in (1e-6, 1e-3, 1e3, 1e6):
            other = self.converges(table, '{:g}'.format(thickness), stack(thickness=thickness))
            self.assertEqual(count(reference), count(other))
            for name, unit in (('max_displacement', 1), ('max_von_mises', 1), ('strain_energy', thickness)):
                self.near(other.summary['results'][name] / unit, reference.summary['results'][name], 1e-9, name)
            self.near(pair(other)['normal_force'] / thickness, pair(reference)['normal_force'], 1e-9)

    def test_thicknesses_apart(self):
        table = Table('thickness of the lower body over that of the upper one')
        for ratio in (1e-6, 1e-3, 1e3, 1e6):
            result = self.converges(table, '{:g}'.format(ratio), stack(), {'Body base/Thickness': ratio})
            self.in_balance(result)


if __name__ == '__main__':
    unittest.main()
