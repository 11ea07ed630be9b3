"""Receding contact of a layer: observed rates in energy, displacement and pressure; degree 1 and 2; on a rigid plane and
through mortar (scripts/verification: through meshes that match, too). Energy norm at least 0.95 and 1.4. Where the
contact ends between two nodes changes from mesh to mesh, and with it the error: rates are those of the whole ladder. The
displacement of the end that lifts off hangs on that alone, and so does the pressure, whose error sits in the last
element in contact."""

import unittest

import measured
from energy import rate, slope

CELLS = 4, 8, 16
REFERENCE = 32  # of energy and displacement; of the pressure, whose error falls more slowly:
PRESSURE_CELLS = 4, 16
PRESSURE_REFERENCE = 64
measured.RANKS = 1  # those of friction and bulk have two


class Receding(unittest.TestCase):

    def ladder(self, kind):
        reference = measured.layer(kind, REFERENCE, 2)
        finest = measured.layer(kind, PRESSURE_REFERENCE, 2, fields=False)
        for degree, energy_rate in ((1, 0.95), (2, 1.4)):
            with self.subTest(degree=degree):
                layers = {cells: measured.layer(kind, cells, degree) for cells in CELLS}
                errors = [measured.layer_errors(layer, reference) for layer in layers.values()]
                sizes = [1 / cells for cells in CELLS]
                self.assertGreaterEqual(slope(sizes, [error['energy'] for error in errors]), energy_rate, errors)
                displacement = [errors[i]['displacement'] for i in (0, -1)]
                self.assertGreaterEqual(rate(*displacement, CELLS[-1] / CELLS[0]), 0.95, displacement)
                pressure = [measured.layer_pressure_error(layers[cells], finest) for cells in PRESSURE_CELLS]
                self.assertGreaterEqual(rate(*pressure, PRESSURE_CELLS[-1] / PRESSURE_CELLS[0]), 0.75, pressure)

    def test_on_a_rigid_plane(self):
        self.ladder('obstacle')

    def test_mortar(self):
        self.ladder('mortar')


if __name__ == '__main__':
    unittest.main()
