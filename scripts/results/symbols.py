"""Obstacles, supports and loads as symbols."""

import math

import matplotlib.collections
import matplotlib.patches
import numpy as np

LOAD, SUPPORT, MOVED, HEAT, BOLT, PROBE = "crimson", "darkgreen", "royalblue", "darkorange", "purple", "black"
MOST_SYMBOLS = 12  # a boundary
SMALL = 1e-9  # part of the largest traction that is drawn as none


class Edges:
    """The edges, or the points, of one support or load."""

    def __init__(self, rows):
        ends = np.array([[float(row[name]) for name in ("x1", "y1", "x2", "y2")] for row in rows])
        self.middle = (ends[:, :2] + ends[:, 2:]) / 2
        along = ends[:, 2:] - ends[:, :2]
        self.length = np.linalg.norm(along, axis=1)
        self.is_point = not (self.length > 0).any()
        with np.errstate(invalid="ignore", divide="ignore"):
            self.normal = np.where(self.length[:, None] > 0, np.column_stack([along[:, 1], -along[:, 0]]) / self.length[:, None], 0)

    def some(self):
        """Indices of edges spread evenly over the boundary."""
        n = len(self.length)
        if n <= MOST_SYMBOLS:
            return np.arange(n)
        order = np.lexsort((self.middle[:, 1].round(9), self.middle[:, 0].round(9)))
        position = np.cumsum(self.length[order]) - self.length[order] / 2
        wanted = (np.arange(MOST_SYMBOLS) + 0.5) / MOST_SYMBOLS * self.length.sum()
        return np.unique(order[np.searchsorted(position, wanted).clip(0, n - 1)])


def grouped(run, kind):
    names = {}
    for row in run.conditions:
        if row["kind"] == kind:
            names.setdefault(row["name"], []).append(row)
    return {name: Edges(rows) for name, rows in names.items()}


def draw_obstacles(axes, run, t, size):
    """@p size of the scene. Rigid bodies are grey; those without an end are drawn beyond the picture."""
    scene, far = run.scene, 3 * size
    style = {"facecolor": "0.86", "edgecolor": "0.35", "linewidth": 1, "hatch": "///", "zorder": 0.5}
    for name in scene.names("Obstacles"):
        section = "Obstacle " + name
        shape = scene.get(section + "/Shape")
        center, radius = scene.numbers(section + "/Center"), scene.numbers(section + "/Radius")
        if shape == "circle" and len(center) == 2 and radius:
            axes.add_patch(matplotlib.patches.Circle(center, radius[0], **style))
        elif shape == "hole" and len(center) == 2 and radius:
            axes.add_patch(matplotlib.patches.Annulus(center, radius[0] * 1.05, radius[0] * 0.05, **style))
        elif shape == "half plane":
            point, normal = (np.array(scene.numbers(f"{section}/{key}")) for key in ("Point", "Normal"))
            if len(point) == 2 and len(normal) == 2 and np.linalg.norm(normal) > 0:
                normal = normal / np.linalg.norm(normal)
                along = np.array([-normal[1], normal[0]])
                axes.add_patch(matplotlib.patches.Polygon([point - far * along, point + far * along,
                                                           point + far * (along - normal), point - far * (along + normal)],
                                                          **style))
        elif shape == "polyline":
            points = [[float(x) for x in part.split()] for part in scene.get(section + "/Points").split(";") if part.strip()]
            axes.plot(*zip(*points), color="0.35", linewidth=2, zorder=0.5)
        elif shape == "function":
            low, high = axes.get_xlim()
            x = np.linspace(low, high, 400)
            heights = [scene.field(section + "/Height", one, 0., t) for one in x]
            if all(height is not None for height in heights):
                axes.fill_between(x, heights, min(heights) - far, **style)


def held(scene, name, x, y, t, normal):
    """Which axes the support holds, and the displacement that it prescribes there."""
    section, held_axes, moved = "Support " + name, [], np.zeros(2)
    for axis, key in enumerate(("Displacement x", "Displacement y")):
        prescribed = scene.field(f"{section}/{key}", x, y, t)
        if prescribed is not None or scene.get(f"{section}/{key}", "free") not in ("", "free"):
            held_axes.append(np.eye(2)[axis])
            moved[axis] = prescribed or 0
    prescribed = scene.field(section + "/Displacement normal", x, y, t)
    if scene.get(section + "/Displacement normal", "free") not in ("", "free"):
        held_axes.append(np.array(normal))
        moved = (prescribed or 0) * np.array(normal)
    return held_axes, moved


def triangle(axes, tip, direction, height, filled):
    """With its tip at the place that is held, from against @p direction."""
    side = np.array([-direction[1], direction[0]]) * 0.6 * height
    base = tip - height * direction
    axes.add_patch(matplotlib.patches.Polygon([tip, base + side, base - side], closed=True, edgecolor=SUPPORT, zorder=5,
                                              facecolor=SUPPORT if filled else "white", linewidth=1))


def draw_supports(axes, run, t, height, moved_point):
    for name, edges in grouped(run, "support").items():
        for k in edges.some():
            x, y = edges.middle[k]
            held_axes, moved = held(run.scene, name, x, y, t, edges.normal[k])
            tip = moved_point(edges.middle[k])
            if edges.is_point:  # from below or from the left
                for axis in held_axes:
                    triangle(axes, tip, axis, height, len(held_axes) > 1)
            elif len(held_axes) > 1:
                triangle(axes, tip, -edges.normal[k], height, True)
            elif held_axes:  # a roller: from outside, along the direction that is held
                axis = held_axes[0] if held_axes[0] @ edges.normal[k] < 0 else -held_axes[0]
                triangle(axes, tip, axis, height, False)
            if np.linalg.norm(moved) > 0:
                direction = moved / np.linalg.norm(moved)
                arrow(axes, tip - 3.2 * height * direction, tip - 1.2 * height * direction, MOVED)


def arrow(axes, start, end, colour):
    axes.add_patch(matplotlib.patches.FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=9, color=colour,
                                                      linewidth=1.2, zorder=6, shrinkA=0, shrinkB=0))


def traction(scene, name, x, y, t, normal):
    section = "Traction " + name
    vector = np.array([scene.field(f"{section}/Traction {axis}", x, y, t) or 0. for axis in "xy"])
    return vector - (scene.field(section + "/Pressure", x, y, t) or 0.) * np.array(normal)


def draw_loads(axes, run, t, length, moved_point):
    """Arrows of tractions and of point loads; the longest of each kind has @p length."""
    arrows = []
    for name, edges in grouped(run, "traction").items():
        arrows += [("traction", edges.middle[k], traction(run.scene, name, *edges.middle[k], t, edges.normal[k]), edges.normal[k])
                   for k in edges.some()]
    for name, edges in grouped(run, "point load").items():
        force = [run.scene.field(f"Point load {name}/Force {axis}", *edges.middle[0], t) or 0. for axis in "xy"]
        arrows.append(("point load", edges.middle[0], np.array(force), np.zeros(2)))
    for kind in ("traction", "point load"):
        ours = [entry for entry in arrows if entry[0] == kind]
        largest = max((np.linalg.norm(entry[2]) for entry in ours), default=0)
        if not largest > 0 or not math.isfinite(largest):
            continue
        for _, at, vector, normal in ours:
            if np.linalg.norm(vector) <= SMALL * largest:
                continue
            drawn, place = vector / largest * length, moved_point(at)
            if vector @ normal > 0:  # pulls: from the boundary outwards
                arrow(axes, place, place + drawn, LOAD)
            else:
                arrow(axes, place - drawn, place, LOAD)


def bodies_of(scene, path):
    names = scene.names(path)
    return scene.names("Bodies") if names in (["all"], ["*"]) else names


def middles(run, grid, names):
    """Of bodies: the centre of their cells where that is in the body, else the middle of the cell next to it."""
    numbers, all_names = grid.cell_fields.get("body"), run.scene.names("Bodies")
    found = []
    for name in names:
        if numbers is None or name not in all_names:
            continue
        cells = grid.cells[numbers == all_names.index(name)]
        if len(cells) == 0:
            continue
        centres = grid.points[cells].mean(axis=1)
        centre = centres.mean(axis=0)
        if not is_in_any(centre, grid.points[cells]):
            centre = centres[np.argmin(((centres - centre) ** 2).sum(axis=1))]
        found.append((name, centre))
    return found


def is_in_any(point, cells):
    """@p cells: corners in turn, convex; a triangle has one of them twice."""
    along = np.roll(cells, -1, axis=1) - cells
    to_point = point - cells
    side = along[:, :, 0] * to_point[:, :, 1] - along[:, :, 1] * to_point[:, :, 0]
    return bool(((side >= 0).all(axis=1) | (side <= 0).all(axis=1)).any())


def body_force(scene, load, body, x, y, t):
    """Force per volume."""
    section, density = "Body force " + load, scene.field(f"Material {scene.get(f'Body {body}/Material')}/Density", x, y, t) or 0.
    vector = lambda name: np.array([scene.field(f"{section}/{name} {axis}", x, y, t) or 0. for axis in "xy"])
    return vector("Force") + density * vector("Acceleration")


def draw_body_forces(axes, run, grid, t, length, moved_point):
    """An arrow with a dot at its tail in the middle of every body, the longest with @p length; a turning arrow about the axis
    of a rotation."""
    arrows = []
    for name in run.scene.names("Body forces"):
        for body, place in middles(run, grid, bodies_of(run.scene, f"Body force {name}/Bodies")):
            arrows.append((place, body_force(run.scene, name, body, *place, t)))
        if (run.scene.field(f"Body force {name}/Angular velocity", 0, 0, t) or 0.) != 0:
            centre = run.scene.numbers(f"Body force {name}/Axis", (0., 0.))
            if run.summary.get("problem", {}).get("plane_state") != "axisymmetric" and len(centre) == 2:
                draw_turning(axes, np.array(centre), 0.6 * length)
    largest = max((np.linalg.norm(vector) for _, vector in arrows), default=0)
    for place, vector in arrows:
        if largest > 0 and math.isfinite(largest) and np.linalg.norm(vector) > SMALL * largest:
            tail = moved_point(place)
            axes.plot(*tail, marker="o", markersize=5, color=LOAD, zorder=6)
            arrow(axes, tail, tail + vector / largest * length, LOAD)


def draw_turning(axes, centre, radius):
    angles = np.radians(np.linspace(20, 290, 40))
    axes.plot(centre[0] + radius * np.cos(angles), centre[1] + radius * np.sin(angles), color=LOAD, linewidth=1.2, zorder=6)
    at = lambda angle: centre + radius * np.array([math.cos(angle), math.sin(angle)])
    arrow(axes, at(angles[-2]), at(angles[-1] + 0.3), LOAD)
    axes.plot(*centre, marker="+", color=LOAD, markersize=6, zorder=6)


def draw_temperatures(axes, run, grid, t, moved_point):
    """The sum of the changes in the middle of every body that has any."""
    changes = {}
    for name in run.scene.names("Temperatures"):
        for body, place in middles(run, grid, bodies_of(run.scene, f"Temperature {name}/Bodies")):
            change = run.scene.field(f"Temperature {name}/Change", *place, t)
            if change is not None:
                changes[body] = (place, changes.get(body, (place, 0.))[1] + change)
    for place, change in changes.values():
        if change != 0:
            axes.text(*moved_point(place), f"{change:+.4g} K", color=HEAT, fontsize=9, fontweight="bold", ha="center", va="bottom",
                      zorder=6, clip_on=True, bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": HEAT, "alpha": 0.85})


def draw_bolts(axes, run, length, moved_point):
    """Two arrows that meet at the section."""
    for name in run.scene.names("Pretensions"):
        section = "Pretension " + name
        point, direction = (np.array(run.scene.numbers(f"{section}/{key}")) for key in ("Point", "Direction"))
        if len(point) != 2 or len(direction) != 2 or not np.linalg.norm(direction) > 0:
            continue
        along, place = direction / np.linalg.norm(direction), moved_point(point)
        for side in (1, -1):
            arrow(axes, place + side * length * along, place, BOLT)


def probes_of(run):
    """Name -> the ends of its line, or its point, before loading."""
    ends = {}
    for row in run.table("probes.csv"):
        if int(row["step"]) == 0:
            ends.setdefault(row["probe"], []).append(np.array([float(row["x"]), float(row["y"])]))
    return {name: points[:1] + points[1:][-1:] for name, points in ends.items()}


def draw_probes(axes, run, moved_point):
    """Crosses with names, joined by dotted lines."""
    for name, ends in probes_of(run).items():
        places = np.array([moved_point(end) for end in ends])
        axes.plot(places[:, 0], places[:, 1], marker="x", linestyle=":", linewidth=1.2, markersize=6, color=PROBE, zorder=6)
        axes.annotate(name, places[0], xytext=(4, 4), textcoords="offset points", fontsize=8, color=PROBE, zorder=6,
                      annotation_clip=True)


def draw_all(axes, run, grid, t, size, moved_point):
    """@p size of the scene; @p moved_point: where a point is drawn."""
    draw_obstacles(axes, run, t, size)
    draw_supports(axes, run, t, 0.02 * size, moved_point)
    draw_loads(axes, run, t, 0.08 * size, moved_point)
    draw_body_forces(axes, run, grid, t, 0.06 * size, moved_point)
    draw_temperatures(axes, run, grid, t, moved_point)
    draw_bolts(axes, run, 0.06 * size, moved_point)


def key(run):
    """Entries of a legend: what the symbols mean."""
    handles = []
    kinds = {row["kind"] for row in run.conditions}
    line = lambda **style: matplotlib.lines.Line2D([], [], linestyle="none", markersize=7, **style)
    if "support" in kinds:
        handles.append(line(marker="^", color=SUPPORT, label="held (open: one direction)"))
    if kinds & {"traction", "point load"}:
        handles.append(line(marker=r"$\downarrow$", color=LOAD, label="load"))
    if run.scene.names("Body forces"):
        handles.append(matplotlib.lines.Line2D([], [], color=LOAD, marker="o", markersize=5, linewidth=1.2, label="body force"))
    if run.scene.names("Temperatures"):
        handles.append(matplotlib.patches.Patch(facecolor="white", edgecolor=HEAT, label="change of temperature"))
    if run.scene.names("Pretensions"):
        handles.append(line(marker=r"$\updownarrow$", color=BOLT, label="pretension"))
    if run.scene.names("Obstacles"):
        handles.append(matplotlib.patches.Patch(facecolor="0.86", edgecolor="0.35", hatch="///", label="rigid obstacle"))
    return handles


def key_of_probes(run):
    return [matplotlib.lines.Line2D([], [], color=PROBE, marker="x", linestyle=":", label="probe")] if probes_of(run) else []
