"""Traction, slip bound and status along contact lines."""

import itertools
import math
import textwrap

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from . import bands

STATUS_COLOURS = {"open": "0.75", "stick": "tab:blue", "slip": "tab:red"}
MOST_PAIRS_TWICE = 6  # more pairs than these are drawn once each, not with a close-up


class ContactPainter:
    """All steps have the same axes."""

    def __init__(self, run, wanted=None):
        self.run, self.wanted = run, wanted
        self.steps = sorted({int(row["step"]) for row in run.contact})
        self.ranges = {}
        for step in self.steps:
            for name, nodes in run.contact_pairs(step, wanted).items():
                stresses = np.concatenate([nodes["pressure"], nodes["tangential_traction"], [0]])
                low, high = self.ranges.get(name, (0, 0))
                self.ranges[name] = min(low, np.nanmin(stresses)), max(high, np.nanmax(stresses))

    def draw(self, step):
        """A figure, which the caller closes; None where the step has no node."""
        pairs = self.run.contact_pairs(step, self.wanted)
        if not pairs:
            return None
        panels = []
        for name, nodes in pairs.items():
            panels.append((name, nodes, "whole contact boundary", np.full(len(nodes["s"]), True)))
            if len(pairs) <= MOST_PAIRS_TWICE:
                panels.append((name, nodes, "where it touches", touching_part(nodes)))
        columns = 2 if len(pairs) <= MOST_PAIRS_TWICE else 4
        rows = math.ceil(len(panels) / columns)
        figure, all_axes = plt.subplots(rows, columns, squeeze=False, figsize=(6 * columns, 4.2 * rows + 0.8),
                                        layout="constrained")
        handles = {}
        for axes, panel in itertools.zip_longest(all_axes.flat, panels):
            if panel is None or panel[3] is None:
                axes.remove()
                continue
            self.draw_pair(axes, step == self.steps[-1], *panel)
            handles.update(zip(*reversed(axes.get_legend_handles_labels())))
        title = self.run.summary.get("case", "")
        if len(self.steps) > 1:
            title += f", step {step} (0 to {self.steps[-1]}), t = {self.run.factor(step):g}"
        bands.add(figure, [title] if title else [], list(handles.values()), legend_above=True)
        return figure

    def draw_error_bar(self, axes, name, s, pressure, is_last):
        """Of the largest pressure, where the run estimated it."""
        error = self.run.error_bar(f"{name}.max_pressure") if is_last else None
        if error is not None and np.isfinite(pressure).any():
            k = np.nanargmax(pressure)
            axes.errorbar(s[k], pressure[k], yerr=error, color="tab:green", capsize=4, linewidth=1.5, zorder=5,
                          label="largest pressure, estimated error of the mesh")

    def draw_pair(self, axes, is_last, name, nodes, part, shown):
        s = nodes["s"][shown]
        marker = "." if shown.sum() < 120 else None
        axes.plot(s, nodes["pressure"][shown], color="black", marker=marker, label="pressure")
        self.draw_error_bar(axes, name, s, nodes["pressure"][shown], is_last)
        axes.plot(s, nodes["tangential_traction"][shown], color="tab:orange", marker=marker, label="tangential traction")
        low, high = self.ranges[name]
        margin = 0.12 * (high - low) or 1.
        bound = nodes.get("slip_bound", np.full(len(nodes["s"]), np.nan))[shown]
        if np.isfinite(bound).any() and np.nanmax(bound[np.isfinite(bound)]) > 0:
            bound = np.where(np.isfinite(bound), bound, np.nan)
            axes.plot(s, bound, "--", color="0.45", linewidth=1, label="slip bound, both signs")
            axes.plot(s, -bound, "--", color="0.45", linewidth=1)
        # Status: a strip of coloured marks at the lower edge.
        transform = axes.get_xaxis_transform()
        for status, colour in STATUS_COLOURS.items():
            here = s[nodes["status"][shown] == status]
            axes.plot(here, np.full(here.size, 0.02), linestyle="none", marker="s", markersize=4, color=colour,
                      transform=transform, label=status)
        axes.margins(x=0.02)
        axes.set_ylim(low - margin, high + margin)
        axes.axhline(0, color="0.8", linewidth=0.8, zorder=0)
        axes.set_title("\n".join(textwrap.wrap(f"{name}: {part}", 60)), fontsize=11)
        axes.set_xlabel("s, arc length along the slave boundary [mm]")
        axes.set_ylabel("[MPa]")

    def save(self, step, file):
        figure = self.draw(step)
        if figure is None:
            return False
        figure.savefig(file, dpi=150 if figure.get_figheight() < 30 else 100)
        plt.close(figure)
        return True


def touching_part(nodes):
    """The nodes that touch with a margin; None when that is nothing or everything."""
    touching = np.flatnonzero(nodes["status"] != "open")
    if not touching.size:
        return None
    close = np.full(len(nodes["s"]), False)
    margin = max(2, (touching[-1] - touching[0]) // 5)
    close[max(0, touching[0] - margin):touching[-1] + margin + 1] = True
    return None if close.all() else close
