"""Pictures of the fields of a run, the same scale and colours in all its steps."""

import math

import matplotlib
matplotlib.use("Agg")
import matplotlib.collections
import matplotlib.pyplot as plt
import numpy as np

from . import bands, fields, symbols

DRAWN_DISPLACEMENT = 0.04  # of the size of the scene
DRAWN_GAP = 0.002  # of that size: less does not show
CLIPPED_SHARE = 0.001  # of the points may lie above the colour bar: corner singularities would swallow it
WIDTH = 7  # inches of the longer side of the drawing
DPI = 150
ROUNDING = 1e-6  # fields that vary by less than this part are constant: files have single precision ...
MARGIN = 0.01  # ... and have this part of them above and below in the colour bar


class Options:
    """How to draw. @p scale of displacements, None: chosen. @p box: xmin, xmax, ymin, ymax before loading."""

    def __init__(self, scale=None, box=None, centre=(0., 0.), with_symbols=True, limits=None):
        self.scale, self.box, self.centre, self.with_symbols, self.limits = scale, box, centre, with_symbols, limits


def magnification(run, grids, wanted):
    """What displacements are multiplied by: what is wanted, or 1 where contact is open, bodies overlap before loading, or gaps
    are not those of the geometry (beside magnified displacements they look like penetration, or like open contact), or 1, 2,
    5, 10, ... so that they show."""
    if wanted is not None:
        return wanted
    if run.is_open_anywhere() or run.scene.has_given_gaps():
        return 1
    largest = max(np.linalg.norm(grid.displacement, axis=1).max() for grid in grids)
    if not largest > 0 or not math.isfinite(largest):
        return 1
    size = max(np.ptp(grids[0].points, axis=0))
    share = DRAWN_DISPLACEMENT * size / largest
    decade = 10.0 ** math.floor(math.log10(share)) if share > 0 else 1
    factor = max(1, int(max(step for step in (1, 2, 5) if step * decade <= share * (1 + 1e-12)) * decade))
    return 1 if factor * run.largest_closed_gap() > DRAWN_GAP * size else factor


def inside(points, box):
    return np.full(len(points), True) if box is None else ((points[:, 0] >= box[0]) & (points[:, 0] <= box[1]) &
                                                           (points[:, 1] >= box[2]) & (points[:, 1] <= box[3]))


class Painter:
    """Draws one field in any step: limits of colours, magnification and the part that is shown are those of all steps."""

    def __init__(self, run, name, options, grids=None):
        self.run, self.name, self.options = run, name, options
        self.title, self.unit, _ = fields.FIELDS[name]
        self.grids = grids or [run.grid(step) for step in range(len(run.grid_files))]
        self.factor = magnification(run, self.grids, options.scale)
        self.values = [fields.values(name, grid, options.centre) for grid in self.grids]
        # of bodies of revolution the other half of the section too
        self.mirrored = not options.box and run.summary.get("problem", {}).get("plane_state") == "axisymmetric"
        self.shown = inside(self.grids[0].points, options.box)
        if not self.shown.any():
            raise ValueError(f"--box: nothing of the scene is in it; the scene is in {self.extent(self.grids[0].points)}")
        self.find_limits()
        self.find_view()

    @staticmethod
    def extent(points):
        low, high = points.min(axis=0), points.max(axis=0)
        return f"{low[0]:g},{high[0]:g},{low[1]:g},{high[1]:g}"

    def find_limits(self):
        finite = np.concatenate([values[self.shown & np.isfinite(values)] for values in self.values])
        if finite.size == 0:
            raise ValueError(f"{self.title} has no finite value")
        low, high = finite.min(), finite.max()
        bottom, top = np.quantile(finite, [CLIPPED_SHARE, 1 - CLIPPED_SHARE])
        span = max(top - bottom, 1e-300)
        self.clipped_above, self.clipped_below = high > top + 0.1 * span, low < bottom - 0.1 * span
        self.limits = [bottom if self.clipped_below else low, top if self.clipped_above else high]
        if self.options.limits:
            self.limits = list(self.options.limits)
            self.clipped_below, self.clipped_above = low < self.limits[0], high > self.limits[1]
        if self.limits[1] - self.limits[0] <= ROUNDING * max(abs(self.limits[0]), abs(self.limits[1]), 1e-300):  # one colour
            margin = max(MARGIN * abs(self.limits[0]), 1e-12)
            self.limits = [self.limits[0] - margin, self.limits[1] + margin]

    def find_view(self):
        """The part of the plane that is drawn: where the shown points are in any step, with room for symbols."""
        places = [(grid.points + self.factor * grid.displacement)[self.shown] for grid in self.grids]
        places.append(self.grids[0].points[self.shown])
        if self.options.box:
            x0, x1, y0, y1 = self.options.box
            places = [np.array([[x0, y0], [x1, y1]])] + places
        if self.mirrored:
            places += [place * [-1, 1] for place in places]
        low = np.min([place.min(axis=0) for place in places], axis=0)
        high = np.max([place.max(axis=0) for place in places], axis=0)
        self.size = max(high - low) or 1.
        margin = (0.11 if self.options.with_symbols and self.run.conditions and not self.options.box else 0.02) * self.size
        self.low, self.high = low - margin, high + margin

    def figure_size(self):
        width, height = self.high - self.low
        scale = WIDTH / max(width, height)
        return max(2.8, width * scale) + 2.6, max(1.8, height * scale) + 1.9

    def largest(self, step):
        """Value and place before loading of the largest magnitude that is shown."""
        values = np.where(self.shown & np.isfinite(self.values[step]), np.abs(self.values[step]), -1)
        k = int(np.argmax(values))
        return (self.values[step][k], self.grids[step].points[k], k) if values[k] >= 0 else None

    def lines_of_title(self, step):
        t = self.run.factor(step)
        several = len(self.grids) > 1
        found = self.largest(step)
        name = self.run.summary.get("case", "")
        lines = [": ".join(part for part in (name, self.title) if part)]
        if several:
            lines[0] += f", step {step} (0 to {len(self.grids) - 1}), t = {t:g}"
        if found:
            signed = self.limits[0] < 0
            is_whole = self.title == "displacement" and step == len(self.grids) - 1 and self.shown.all()
            error = self.run.error_bar("max_displacement") if is_whole else None
            value = f"{found[0]:.5g}" + ("" if error is None else f" \u00b1 {error:.2g}")
            lines.append(f"{'largest magnitude' if signed else 'largest'} {value} {self.unit} at {fields.place(found[1])}")
        lines.append("displacements in true scale" if self.factor == 1 else f"displacements drawn {self.factor:g} times")
        return lines

    def draw(self, step):
        """A figure of the step, which the caller closes."""
        grid, values = self.grids[step], self.values[step]
        points = grid.points + self.factor * grid.displacement
        figure, axes = plt.subplots(figsize=self.figure_size(), layout="constrained")
        axes.set_xlim(self.low[0], self.high[0])
        axes.set_ylim(self.low[1], self.high[1])
        axes.set_aspect("equal")
        image = axes.tripcolor(grid.triangulation(points), np.nan_to_num(values, nan=self.limits[0]), shading="gouraud",
                               cmap=self.colours(), vmin=self.limits[0], vmax=self.limits[1], rasterized=True, zorder=1)
        if self.mirrored:
            axes.tripcolor(grid.triangulation(points * [-1, 1]), np.nan_to_num(values, nan=self.limits[0]), shading="gouraud",
                           cmap=self.colours(), vmin=self.limits[0], vmax=self.limits[1], rasterized=True, zorder=1)
        for field, colour, line_width in (("subdomain", "white", 0.5), ("body", "black", 1.2)):
            lines = points[grid.outlines(field)]
            if self.mirrored:  # the axis is no outline
                lines = lines[np.abs(lines[:, :, 0]).max(axis=1) > 1e-9 * self.size]
                lines = np.concatenate([lines, lines * [-1, 1]])
            axes.add_collection(matplotlib.collections.LineCollection(lines, colors=colour, linewidths=line_width,
                                                                      capstyle="round", zorder=2))
        found = self.largest(step)
        if found:
            axes.plot(*points[found[2]], marker="o", markersize=9, markerfacecolor="none", markeredgecolor="magenta",
                      markeredgewidth=1.6, zorder=7)
        handles = [matplotlib.lines.Line2D([], [], linestyle="none", marker="o", markerfacecolor="none", markersize=8,
                                           markeredgecolor="magenta", markeredgewidth=1.6, label="largest")] if found else []
        if self.options.with_symbols:
            handles += self.draw_symbols(axes, grid, self.run.factor(step))
        axes.set_xlabel("x [mm]")
        axes.set_ylabel("y [mm]")
        extend = {(True, True): "both", (True, False): "min", (False, True): "max"}.get(
            (bool(self.clipped_below), bool(self.clipped_above)), "neither")
        figure.colorbar(image, ax=axes, label=f"{self.title} [{self.unit}]" if self.unit else self.title, extend=extend,
                        shrink=0.9)
        bands.add(figure, self.lines_of_title(step), handles)
        return figure

    def colours(self):
        """Of values with a sign: blue below zero, red above, grey is zero, equally deep at equal magnitudes."""
        if self.limits[0] >= 0:
            return "turbo"
        low, high = (limit / max(map(abs, self.limits)) for limit in self.limits)
        return matplotlib.colors.ListedColormap(matplotlib.colormaps["coolwarm"](np.linspace((1 + low) / 2, (1 + high) / 2, 512)))

    def draw_symbols(self, axes, grid, t):
        def moved(point):
            return point + self.factor * grid.displacement_near([point])[0]
        symbols.draw_all(axes, self.run, grid, t, self.size, moved)
        return symbols.key(self.run)

    def save(self, step, file):
        figure = self.draw(step)
        figure.savefig(file, dpi=DPI)
        plt.close(figure)
