"""Displacement and stress along the lines of probes, and at single points over the load steps."""

import itertools

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from . import bands

KINDS = (("displacement [mm]", "u_"), ("stress [MPa]", ("stress_", "von_mises")))
NOTHING = 1e-9  # of the largest of its kind: a component that is rounding is not drawn
LOWEST, MARGIN = -30, 0.06  # decades; part of the range above and below the curves


class ProbePainter:
    """All steps have the same axes. Single points are drawn where there are several steps."""

    def __init__(self, run):
        self.run = run
        probes = {}
        for row in run.table("probes.csv"):
            probes.setdefault(row["probe"], {}).setdefault(int(row["step"]), []).append(row)
        self.steps = sorted({step for of_probe in probes.values() for step in of_probe})
        self.probes = {name: of_probe for name, of_probe in probes.items()
                       if len(of_probe[min(of_probe)]) > 1 or len(self.steps) > 1}

    @staticmethod
    def columns(rows, prefixes):
        """Name -> values of the columns of one kind that are not zero throughout."""
        found = {name: np.array([float(row[name]) for row in rows]) for name in rows[0] if name.startswith(prefixes)}
        largest = max((np.abs(values).max() for values in found.values()), default=0.)
        return {name: values for name, values in found.items() if np.abs(values).max() > max(NOTHING * largest, 10.**LOWEST)}

    def draw(self, step):
        """A figure, which the caller closes; None where there is nothing to draw."""
        if not self.probes:
            return None
        figure, all_axes = plt.subplots(len(self.probes), 2, squeeze=False, layout="constrained",
                                        figsize=(12, 3.6 * len(self.probes) + 0.6))
        for row_of_axes, (name, of_probe) in zip(all_axes, self.probes.items()):
            for axes, (label, prefixes) in zip(row_of_axes, KINDS):
                self.draw_probe(axes, name, of_probe, step, prefixes)
                axes.set_ylabel(label)
        title = self.run.summary.get("case", "") + ": probes"
        if len(self.steps) > 1:
            title += f", step {step} (0 to {self.steps[-1]}), t = {self.run.factor(step):g}"
        bands.add(figure, [title], [])
        return figure

    def draw_probe(self, axes, name, of_probe, step, prefixes):
        every = list(itertools.chain.from_iterable(of_probe[k] for k in sorted(of_probe)))
        is_line = len(of_probe[min(of_probe)]) > 1
        drawn, values = self.columns(every, prefixes), of_probe.get(step, [])
        for column, of_all in drawn.items():
            if is_line:
                axes.plot([float(row["s"]) for row in values], [float(row[column]) for row in values], label=column)
            else:
                axes.plot([float(row["t"]) for row in every], of_all, marker=".", label=column)
        if not is_line:
            axes.axvline(self.run.factor(step), color="0.6", linewidth=0.8)
        low = min([0.] + [of_all.min() for of_all in drawn.values()])
        high = max([0.] + [of_all.max() for of_all in drawn.values()])
        margin = MARGIN * (high - low) or 1.
        axes.set_ylim(low - margin, high + margin)
        axes.axhline(0, color="0.8", linewidth=0.8, zorder=0)
        place = [", ".join(f"{float(row[axis]):.5g}" for axis in "xyz" if axis in row) for row in (every[0], of_probe[min(of_probe)][-1])]
        axes.set_title(f"{name}, from ({place[0]}) to ({place[1]})" if is_line else f"{name}, at ({place[0]})", fontsize=11)
        axes.set_xlabel("s, distance from the beginning [mm]" if is_line else "t, load factor")
        if drawn:
            axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)

    def save(self, step, file):
        figure = self.draw(step)
        if figure is None:
            return False
        figure.savefig(file, dpi=130 if figure.get_figheight() < 30 else 90)
        plt.close(figure)
        return True
