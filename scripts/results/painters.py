"""Selects the drawing functions of a run: for the plane or for solids."""

from . import contact_plot, pictures, solids


def is_in_space(run):
    return run.summary.get("problem", {}).get("dimension") == 3


def grids(run):
    """Of all steps."""
    if is_in_space(run):
        return [solids.SolidGrid(solids.pieces(files)) for files in run.grid_files]
    return [run.grid(step) for step in range(len(run.grid_files))]


def field_painter(run, name, options, of_steps):
    if is_in_space(run) and options.box:
        raise ValueError("--box: not for solids")
    return (solids.SolidPainter if is_in_space(run) else pictures.Painter)(run, name, options, of_steps)


def contact_painter(run, pairs=None):
    return (solids.ContactSurfacePainter if is_in_space(run) else contact_plot.ContactPainter)(run, pairs)
