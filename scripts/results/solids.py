"""Pictures of solids: fields on their surface, seen from the front, right and above; tractions on contact surfaces."""

import math
import xml.etree.ElementTree

import matplotlib
matplotlib.use("Agg")
import matplotlib.collections
import matplotlib.pyplot as plt
import matplotlib.tri
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

from . import bands, fields, pictures

VIEW = (0.55, 0.45, 1.0)  # from where it is seen: x to the right, y upwards, z to the front
DPI = 150
DEPTH_TOLERANCE = 0.01  # of the size of the picture: what lies less in front of an edge does not hide it
EDGE_ANGLE = 30  # degrees between faces: their common edge is drawn
# Outwards, of VTK's hexahedron and tetrahedron: a triangle has its last corner twice.
FACES = {8: np.array([[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]]),
         4: np.array([[0, 2, 1, 1], [0, 1, 3, 3], [1, 2, 3, 3], [2, 0, 3, 3]])}
STATUS_COLOURS = {"open": "0.8", "stick": "tab:blue", "slip": "tab:red"}
MOST_ARROWS = 24  # along a side


def axes_of_view():
    """Unit vectors to the right, upwards and towards the eye."""
    towards = np.array(VIEW) / np.linalg.norm(VIEW)
    right = np.cross([0, 1, 0], towards)
    right /= np.linalg.norm(right)
    return right, np.cross(towards, right), towards


def hidden(places, depths, corners, depths_of_corners):
    """Which places on the picture have a triangle in front of them?"""
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = DEPTH_TOLERANCE * max(np.ptp(corners.reshape(-1, 2), axis=0))
    result = np.zeros(len(places), dtype=bool)
    for k, (x, depth) in enumerate(zip(places, depths)):
        around = np.flatnonzero(((low <= x) & (x <= high)).all(axis=1))
        a, u, v = corners[around, 0], corners[around, 1] - corners[around, 0], corners[around, 2] - corners[around, 0]
        area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        proper = np.abs(area) > 0
        around, a, u, v, area = around[proper], a[proper], u[proper], v[proper], area[proper]
        s = ((x - a)[:, 0] * v[:, 1] - (x - a)[:, 1] * v[:, 0]) / area
        t = (u[:, 0] * (x - a)[:, 1] - u[:, 1] * (x - a)[:, 0]) / area
        z = depths_of_corners[around]
        front = z[:, 0] + s * (z[:, 1] - z[:, 0]) + t * (z[:, 2] - z[:, 0])
        result[k] = ((s >= 0) & (t >= 0) & (s + t <= 1) & (front > depth + near)).any()
    return result


def pieces(files):
    """The subdomains of .pvtu files: their cells are of one kind."""
    found = []
    for file in files:
        if file.suffix == ".pvtu":
            found += [file.parent / piece.get("Source") for piece in xml.etree.ElementTree.parse(file).getroot().iter("Piece")]
        else:
            found.append(file)
    return found


class SolidGrid:
    """Hexahedra, tetrahedra and fields of one step. Points are repeated from subdomain to subdomain."""

    def __init__(self, files):
        grids = [self.read(file) for file in files]
        offsets = np.cumsum([0] + [len(grid[0]) for grid in grids])
        self.points = np.concatenate([grid[0] for grid in grids])
        self.cells = np.concatenate([grid[1][:, :4] + offset for grid, offset in zip(grids, offsets)])
        self.faces = np.concatenate([grid[1][:, FACES[grid[1].shape[1]]].reshape(-1, 4) + offset
                                     for grid, offset in zip(grids, offsets)])
        self.point_fields = {name: np.concatenate([grid[2][name] for grid in grids]) for name in grids[0][2]}
        self.cell_fields = {name: np.concatenate([grid[3][name] for grid in grids]) for name in grids[0][3]}

    @staticmethod
    def read(file):
        """Of one subdomain."""
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(file))
        reader.Update()
        grid = reader.GetOutput()
        if reader.GetErrorCode() or grid.GetNumberOfCells() == 0:
            raise ValueError(f"{file} cannot be read or is empty")

        def named(data):
            return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}

        corners = len(vtk_to_numpy(grid.GetCells().GetConnectivityArray())) // grid.GetNumberOfCells()
        cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, corners)  # one kind a subdomain
        return (vtk_to_numpy(grid.GetPoints().GetData()).astype(float), cells, named(grid.GetPointData()),
                named(grid.GetCellData()))

    @property
    def displacement(self):
        return self.point_fields["displacement"]

    def surface(self):
        """Faces of one cell only, as points in order around them, seen from outside; numbers of points, the same at the same place."""
        low, size = self.points.min(axis=0), max(np.ptp(self.points, axis=0))
        rounded = np.floor((self.points - low) / size * 2**20 + 0.3).astype(np.int64)
        names = np.unique(rounded, axis=0, return_inverse=True)[1].reshape(-1)
        keys = names[self.faces]
        keys[self.faces[:, 3] == self.faces[:, 2], 3] = -1  # of a triangle, whichever corner comes twice
        keys = np.sort(keys, axis=1)
        _, first, n = np.unique(keys, axis=0, return_index=True, return_counts=True)
        return self.faces[first[n == 1]], names


class SolidPainter:
    """Draws one field in any step; colours, magnification and view are those of all steps."""

    def __init__(self, run, name, options, grids):
        if name in fields.POLAR:
            raise ValueError(f"--field {name}: not for solids")
        self.run, self.grids, self.options = run, grids, options
        self.title, self.unit, _ = fields.FIELDS[name]
        self.values = [fields.values(name, grid) for grid in grids]
        self.faces, self.names = grids[0].surface()  # those of all steps
        self.factor = pictures.magnification(run, grids, options.scale)
        shown = np.concatenate([values[np.unique(self.faces)] for values in self.values])
        self.limits = list(options.limits) if options.limits else [shown.min(), shown.max()]
        if self.limits[1] - self.limits[0] <= pictures.ROUNDING * max(map(abs, self.limits + [1e-300])):  # one colour
            margin = max(pictures.MARGIN * abs(self.limits[0]), 1e-12)
            self.limits = [self.limits[0] - margin, self.limits[1] + margin]

    def draw(self, step):
        """A figure of the step, which the caller closes."""
        grid, values = self.grids[step], self.values[step]
        right, up, towards = axes_of_view()
        points = grid.points + self.factor * grid.displacement
        flat, depth = points @ np.stack([right, up], axis=1), points @ towards
        corner = points[self.faces]
        normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        visible = np.flatnonzero(normal @ towards > 0)
        visible = visible[np.argsort(depth[self.faces[visible]].mean(axis=1))]  # the nearest last
        faces = self.faces[visible]
        triangles = np.stack([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]], axis=1).reshape(-1, 3)
        span = np.ptp(flat[faces].reshape(-1, 2), axis=0)
        figure, axes = plt.subplots(figsize=(2.2 + 6.5 * span[0] / max(span), 1.5 + 6.5 * span[1] / max(span)), layout="constrained")
        axes.set_aspect("equal")
        axes.axis("off")
        image = axes.tripcolor(matplotlib.tri.Triangulation(flat[:, 0], flat[:, 1], triangles), values, shading="gouraud",
                               cmap="turbo" if self.limits[0] >= 0 else "coolwarm", vmin=self.limits[0], vmax=self.limits[1],
                               rasterized=True)
        edges = self.sharp_edges(visible, normal)
        is_hidden = [hidden(flat[of].mean(axis=1), depth[of].mean(axis=1), flat[triangles], depth[triangles])
                     for of in (faces, edges)]
        axes.add_collection(matplotlib.collections.PolyCollection(flat[faces[~is_hidden[0]]], facecolors="none", edgecolors=(0, 0, 0, 0.18),
                                                                  linewidths=0.3))
        axes.add_collection(matplotlib.collections.LineCollection(flat[edges[~is_hidden[1]]], colors="black", linewidths=1.0,
                                                                  capstyle="round"))
        axes.autoscale_view()
        self.draw_directions(axes, flat, right, up, max(span))
        figure.colorbar(image, ax=axes, label=f"{self.title} [{self.unit}]" if self.unit else self.title, shrink=0.8)
        bands.add(figure, self.lines_of_title(step), [])
        return figure

    def sharp_edges(self, visible, normal):
        """Edges between visible faces that meet at an angle, or of one visible face alone."""
        faces = self.faces[visible]
        edges = np.concatenate([faces[:, [i, (i + 1) % 4]] for i in range(4)])
        owner = np.tile(visible, 4)
        real = edges[:, 0] != edges[:, 1]  # of triangles three
        edges, owner = edges[real], owner[real]
        keys = np.sort(self.names[edges], axis=1)
        order = np.lexsort((keys[:, 1], keys[:, 0]))
        same = (keys[order][1:] == keys[order][:-1]).all(axis=1)
        alone = ~np.append(same, False) & ~np.append(False, same)
        angle = (normal[owner[order[1:]]] * normal[owner[order[:-1]]]).sum(axis=1) < math.cos(math.radians(EDGE_ANGLE))
        return edges[np.concatenate([order[alone], order[1:][same & angle]])]

    @staticmethod
    def draw_directions(axes, flat, right, up, size):
        origin = flat.min(axis=0) - 0.06 * size
        for k, name in enumerate("xyz"):
            tip = 0.1 * size * np.array([right[k], up[k]])
            axes.annotate("", xy=origin + tip, xytext=origin, arrowprops={"arrowstyle": "->", "color": "0.3"})
            axes.text(*(origin + 1.25 * tip), name, color="0.3", ha="center", va="center", fontsize=10)
        axes.update_datalim([origin - 0.05 * size])
        axes.autoscale_view()

    def lines_of_title(self, step):
        line = ": ".join(part for part in (self.run.summary.get("case", ""), self.title) if part)
        if len(self.grids) > 1:
            line += f", step {step} (0 to {len(self.grids) - 1}), t = {self.run.factor(step):g}"
        k = int(np.argmax(np.abs(self.values[step])))
        return [line, f"largest magnitude {self.values[step][k]:.5g} {self.unit} at {fields.place(self.grids[step].points[k])}",
                "displacements in true scale" if self.factor == 1 else f"displacements drawn {self.factor:g} times"]

    def save(self, step, file):
        figure = self.draw(step)
        figure.savefig(file, dpi=DPI)
        plt.close(figure)


class ContactSurfacePainter:
    """Pressure with arrows of the tangential traction, and the status of the nodes, seen against the mean normal."""

    def __init__(self, run, wanted=None):
        self.run, self.wanted = run, wanted
        self.steps = sorted({int(row["step"]) for row in run.contact})

    def triangles(self, step, n):
        """The polygons of contact_NNN.vtp, whose nodes are in the order of contact.csv, as fans."""
        file = self.run.folder / f"contact_{step:03d}.vtp"
        if not file.is_file():
            return np.zeros((0, 3), int)
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(file))
        reader.Update()
        surface = reader.GetOutput()
        if surface.GetNumberOfPoints() != n or surface.GetNumberOfPolys() == 0:
            return np.zeros((0, 3), int)
        connectivity = vtk_to_numpy(surface.GetPolys().GetConnectivityArray())
        first = vtk_to_numpy(surface.GetPolys().GetOffsetsArray())
        return np.array([[connectivity[begin], connectivity[k], connectivity[k + 1]]
                         for begin, end in zip(first[:-1], first[1:]) for k in range(begin + 1, end - 1)])

    def draw(self, step):
        rows = [row for row in self.run.contact if int(row["step"]) == step]
        names = list(dict.fromkeys(row["pair"] for row in rows))
        for name in self.wanted or []:
            if name not in names:
                raise ValueError(f"--pairs: contact.csv has no pair '{name}', it has {', '.join(names)}")
        names = self.wanted or names
        if not names:
            return None
        triangles = self.triangles(step, len(rows))
        pair = np.array([row["pair"] for row in rows])
        figure, all_axes = plt.subplots(len(names), 2, squeeze=False, figsize=(13, 5.6 * len(names) + 0.6), layout="constrained")
        handles = []
        for axes, name in zip(all_axes, names):
            chosen = np.flatnonzero(pair == name)
            number = np.full(len(rows), -1)
            number[chosen] = np.arange(len(chosen))
            own = number[triangles]
            handles = self.draw_pair(figure, axes, name, [rows[k] for k in chosen], own[(own >= 0).all(axis=1)])
        title = self.run.summary.get("case", "")
        if len(self.steps) > 1:
            title += f", step {step} (0 to {self.steps[-1]}), t = {self.run.factor(step):g}"
        bands.add(figure, [title + ": contact surface, seen from the other side"], handles, legend_above=True)
        return figure

    def draw_pair(self, figure, axes, name, rows, triangles):
        def columns(*wanted):
            return np.array([[float(row[column]) for column in wanted] for row in rows])
        x, n = columns("x", "y", "z"), columns("normal_x", "normal_y", "normal_z").mean(axis=0)
        towards = n / np.linalg.norm(n)
        axis = 0 if abs(towards[0]) < 0.8 else 1
        right = np.eye(3)[axis] - towards[axis] * towards
        right /= np.linalg.norm(right)
        up = np.cross(towards, right)
        frame = np.stack([right, up], axis=1)
        flat, traction = x @ frame, columns("traction_x", "traction_y", "traction_z") @ frame
        pressure = columns("pressure")[:, 0]
        status = np.array([row["status"] for row in rows])
        labels = ["".join(f"{'+' if v > 0 else '-'}{'xyz'[k]}" for k, v in enumerate(way) if abs(v) > 0.5) for way in (right, up)]
        if len(triangles):
            image = axes[0].tripcolor(matplotlib.tri.Triangulation(flat[:, 0], flat[:, 1], triangles), pressure, shading="gouraud",
                                      cmap="turbo", rasterized=True)
        else:
            image = axes[0].scatter(*flat.T, c=pressure, cmap="turbo")
        figure.colorbar(image, ax=axes[0], label="pressure [MPa]", shrink=0.85)
        length = np.linalg.norm(traction, axis=1)
        if length.max() > 0:
            every = max(1, int(math.sqrt(len(rows)) / MOST_ARROWS))
            some = np.flatnonzero(length > 0.02 * length.max())[::every]
            axes[0].quiver(*flat[some].T, *traction[some].T, color="white", edgecolor="black", linewidth=0.4, width=0.004)
            axes[0].set_title(f"{name}: pressure, and tangential traction on the body, up to {length.max():.4g} MPa", fontsize=10)
        else:
            axes[0].set_title(f"{name}: pressure", fontsize=10)
        handles = []
        for key, colour in STATUS_COLOURS.items():
            here = flat[status == key]
            handles += axes[1].plot(*here.T, linestyle="none", marker="o", markersize=max(2, 90 / math.sqrt(len(rows) + 300)),
                                    color=colour, label=key)
        axes[1].set_title(f"{name}: " + ", ".join(f"{(status == key).sum()} {key}" for key in STATUS_COLOURS), fontsize=10)
        for one in axes:
            one.set_aspect("equal")
            one.set_xlabel(f"along {labels[0]} [mm]")
            one.set_ylabel(f"along {labels[1]} [mm]")
        return handles

    def save(self, step, file):
        figure = self.draw(step)
        if figure is None:
            return False
        figure.savefig(file, dpi=DPI)
        plt.close(figure)
        return True
