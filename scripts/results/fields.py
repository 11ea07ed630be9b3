"""Fields that can be drawn, by name."""

import numpy as np

from .folder import Grid

STRESS = {"stress_xx": 0, "stress_xy": 1, "stress_yy": 4}


class Polar:
    """Stress components about a centre: r along the radius, t along the circle."""

    def __init__(self, grid, centre):
        away = grid.points - np.asarray(centre)
        length = np.linalg.norm(away, axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            c, s = np.where(length > 0, away.T / length, np.nan)  # no direction at the centre itself
        stress = grid.point_fields["stress"]
        xx, xy, yy = (stress[:, STRESS[name]] for name in ("stress_xx", "stress_xy", "stress_yy"))
        self.radial = c * c * xx + 2 * c * s * xy + s * s * yy
        self.hoop = s * s * xx - 2 * c * s * xy + c * c * yy
        self.shear = c * s * (yy - xx) + (c * c - s * s) * xy
        u = grid.displacement
        self.displacement = c * u[:, 0] + s * u[:, 1]


def _cells_to_points(grid, name):
    """Means of a cell field at the points."""
    total, n = np.zeros(len(grid.points)), np.zeros(len(grid.points))
    for corner in range(4):
        np.add.at(total, grid.cells[:, corner], grid.cell_fields[name])
        np.add.at(n, grid.cells[:, corner], 1)
    return total / np.maximum(n, 1)


# name: (title, unit, values of grid and centre)
FIELDS = {
    "von_mises": ("von Mises stress", "MPa", lambda grid, centre: grid.point_fields["von_mises"]),
    "displacement": ("displacement", "mm", lambda grid, centre: np.linalg.norm(grid.displacement, axis=1)),
    "displacement_x": ("displacement along x", "mm", lambda grid, centre: grid.displacement[:, 0]),
    "displacement_y": ("displacement along y", "mm", lambda grid, centre: grid.displacement[:, 1]),
    "displacement_radial": ("radial displacement", "mm", lambda grid, centre: Polar(grid, centre).displacement),
    "stress_xx": ("stress xx", "MPa", lambda grid, centre: grid.point_fields["stress"][:, 0]),
    "stress_yy": ("stress yy", "MPa", lambda grid, centre: grid.point_fields["stress"][:, 4]),
    "stress_xy": ("shear stress xy", "MPa", lambda grid, centre: grid.point_fields["stress"][:, 1]),
    "stress_zz": ("stress zz", "MPa", lambda grid, centre: grid.point_fields["stress_zz"]),
    "hoop_stress": ("hoop stress of a body of revolution", "MPa", lambda grid, centre: grid.point_fields["hoop_stress"]),
    "principal_stress_1": ("larger principal stress", "MPa", lambda grid, centre: grid.point_fields["principal_stress_1"]),
    "principal_stress_2": ("smaller principal stress", "MPa", lambda grid, centre: grid.point_fields["principal_stress_2"]),
    "hoop": ("hoop stress", "MPa", lambda grid, centre: Polar(grid, centre).hoop),
    "radial": ("radial stress", "MPa", lambda grid, centre: Polar(grid, centre).radial),
    "polar_shear": ("shear stress on circles", "MPa", lambda grid, centre: Polar(grid, centre).shear),
    "error_estimate": ("error estimate of the cells", "", lambda grid, centre: _cells_to_points(grid, "error_estimate")),
}
POLAR = ("hoop", "radial", "polar_shear", "displacement_radial")


def values(name, grid: Grid, centre=(0., 0.)):
    try:
        return np.asarray(FIELDS[name][2](grid, centre), dtype=float)
    except KeyError as missing:
        raise ValueError(f"the files of the run have no field {missing} to draw {name} from")


def place(point):
    """(1, 2); what is rounding beside the largest coordinate is 0."""
    rounded = np.where(np.abs(point) <= 1e-9 * np.abs(point).max(), 0., point)
    return "(" + ", ".join(f"{x:.5g}" for x in rounded) + ")"
