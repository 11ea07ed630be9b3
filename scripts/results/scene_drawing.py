"""The scene before loading: bodies by colour, contact boundaries, supports, loads, obstacles."""

import itertools

import matplotlib
matplotlib.use("Agg")
import matplotlib.collections
import matplotlib.pyplot as plt
import numpy as np

from . import bands, pictures, symbols

BODIES = ["#c9d8ea", "#f3dcc0", "#cfe8cf", "#e6d3ea", "#f0d0d0", "#d8e6e6"]
PAIRS = ["tab:red", "tab:purple", "tab:brown", "tab:cyan", "tab:olive", "tab:pink"]
MOST_NAMES = 8  # more bodies or pairs than these have colours without names


def outside(edges, names):
    """Of the edges of all contact pairs: by pair, the ends."""
    return [np.array([[[float(row["x1"]), float(row["y1"])], [float(row["x2"]), float(row["y2"])]]
                      for row in edges if row["name"] == name]) for name in names]


def draw(run, step=0):
    """A figure, which the caller closes. Loads are those of the last load step, which is the one that is asked for."""
    grid = run.grid(step)
    painter = pictures.Painter(run, "displacement", pictures.Options(scale=0), [grid])
    figure, axes = plt.subplots(figsize=painter.figure_size(), layout="constrained")
    axes.set_xlim(painter.low[0], painter.high[0])
    axes.set_ylim(painter.low[1], painter.high[1])
    axes.set_aspect("equal")
    handles = []
    bodies = grid.cell_fields.get("body", np.zeros(len(grid.cells))).astype(int)
    names = run.scene.names("Bodies")
    for number in np.unique(bodies):
        colour = BODIES[number % len(BODIES)]
        cells = grid.cells[bodies == number]
        axes.add_collection(matplotlib.collections.PolyCollection(grid.points[cells], facecolors=colour, edgecolors=colour,
                                                                  linewidths=0.3, zorder=1))
        if len(names) <= MOST_NAMES and number < len(names):
            handles.append(matplotlib.patches.Patch(facecolor=colour, edgecolor="black", label="body " + names[number]))
    axes.add_collection(matplotlib.collections.LineCollection(grid.points[grid.outlines("body")], colors="black",
                                                              linewidths=0.9, zorder=2))
    contact = [row for row in run.conditions if row["kind"] == "contact"]
    pairs = list(dict.fromkeys(row["name"] for row in contact))
    for name, edges, colour in zip(pairs, outside(contact, pairs), itertools.cycle(PAIRS)):
        axes.add_collection(matplotlib.collections.LineCollection(edges, colors=colour, linewidths=2.4, zorder=3))
        if len(pairs) <= MOST_NAMES:
            handles.append(matplotlib.lines.Line2D([], [], color=colour, linewidth=2.4, label="contact " + name))
    t = run.factor(len(run.factors) - 1)
    symbols.draw_all(axes, run, grid, t, painter.size, lambda point: point)
    symbols.draw_probes(axes, run, lambda point: point)
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    loads = f", loads at t = {t:g}" if len(run.factors) > 1 else ""
    bands.add(figure, [f"{run.summary.get('case', 'the scene')} before loading{loads}"], handles + symbols.key(run) + symbols.key_of_probes(run))
    return figure
