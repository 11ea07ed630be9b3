"""The folder of a run: fields of a step, contact lines, conditions, summary."""

import csv
import json
import math
import xml.etree.ElementTree

import matplotlib.tri
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPUnstructuredGridReader, vtkXMLUnstructuredGridReader

from .scene_file import Scene


class Grid:
    """Cells and fields of one step. Points are repeated from subdomain to subdomain, perhaps from cell to cell."""

    def __init__(self, files):
        grids = [self.read(file) for file in files]
        offsets = np.cumsum([0] + [grid[0].shape[0] for grid in grids])
        self.points = np.concatenate([grid[0] for grid in grids])
        self.cells = np.concatenate([grid[1] + offset for grid, offset in zip(grids, offsets)])  # 4 corners each
        self.point_fields = self.joined([grid[2] for grid in grids])
        # cell values may also stand at points that no two cells share, as deal.II writes them
        self.cell_fields = {name: values[self.cells[:, 0]] for name, values in self.point_fields.items()}
        self.cell_fields.update(self.joined([grid[3] for grid in grids]))
        if "displacement" not in self.point_fields:
            raise ValueError(f"{files[0]} has no field 'displacement'")

    @staticmethod
    def joined(parts):
        return {name: np.concatenate([part[name] for part in parts])
                for name in parts[0] if all(name in part for part in parts)}

    @staticmethod
    def read(file):
        reader = vtkXMLPUnstructuredGridReader() if file.suffix == ".pvtu" else vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(file))
        reader.Update()
        grid = reader.GetOutput()
        if reader.GetErrorCode() or grid.GetNumberOfCells() == 0:
            raise ValueError(f"{file} cannot be read or is empty")
        points = vtk_to_numpy(grid.GetPoints().GetData())[:, :2].astype(float)
        connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
        offsets = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
        sizes = np.diff(offsets)
        # The corners come first in the cells of every degree; 3, 6 and 10 nodes are those of triangles.
        corners = np.where(np.isin(sizes, (3, 6, 10)), 3, 4)
        cells = np.full((len(sizes), 4), -1)
        for corner in range(4):
            has = corners > corner
            cells[has, corner] = connectivity[offsets[:-1][has] + corner]
        cells[corners == 3, 3] = cells[corners == 3, 2]  # a triangle is a quadrilateral with an edge of length 0

        def fields(data):
            return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}

        return points, cells, fields(grid.GetPointData()), fields(grid.GetCellData())

    @property
    def displacement(self):
        return self.point_fields["displacement"][:, :2]

    def triangulation(self, points):
        proper = self.cells[:, 2] != self.cells[:, 3]
        triangles = np.concatenate([self.cells[:, [0, 1, 2]], self.cells[proper][:, [0, 2, 3]]])
        return matplotlib.tri.Triangulation(points[:, 0], points[:, 1], triangles)

    def displacement_near(self, points):
        """Of the mesh points nearest to each of some points before loading."""
        nearest = [np.argmin(((self.points - point) ** 2).sum(axis=1)) for point in points]
        return self.displacement[nearest] if nearest else np.zeros((0, 2))

    def outlines(self, field):
        """Pairs of points of the edges that belong to one cell only, among the cells of one value of the field."""
        low = self.points.min(axis=0)
        grain = max(np.ptp(self.points, axis=0)) / 2**28
        rounded = np.floor((self.points - low) / grain + 0.3).astype(np.int64)  # meshes like multiples of 1/2, not of 0.3
        keys = rounded[:, 0] << 32 | rounded[:, 1]
        values = self.cell_fields.get(field, np.zeros(len(self.cells)))
        edges = np.concatenate([self.cells[:, [i, (i + 1) % 4]] for i in range(4)])
        groups = np.tile(values, 4)
        proper = edges[:, 0] != edges[:, 1]
        edges, groups = edges[proper], groups[proper]
        names = np.unique(keys, return_inverse=True)[1][edges]
        names.sort(axis=1)
        order = np.lexsort((names[:, 1], names[:, 0], groups))
        sorted_names = np.column_stack([groups, names])[order]
        equal_next = np.append((sorted_names[1:] == sorted_names[:-1]).all(axis=1), False)
        single = ~equal_next & ~np.append(False, equal_next[:-1])
        return edges[order[single]]


class Run:
    """What a run left; missing files are empty."""

    def __init__(self, folder):
        self.folder = folder
        self.scene = Scene.of(folder)
        self.grid_files = self.files_of_steps(folder / "solution.pvd")
        self.conditions = self.table("conditions.csv")
        file = folder / "summary.json"
        self.summary = json.loads(file.read_text(encoding="utf-8", errors="replace")) if file.is_file() else {}
        self.factors = [step["load_factor"] for step in self.summary.get("steps", [])] or self.scene.load_factors()
        self._contact = None

    @staticmethod
    def files_of_steps(pvd):
        if not pvd.is_file():
            return []
        steps = {}
        for data_set in xml.etree.ElementTree.parse(pvd).getroot().findall(".//DataSet"):
            steps.setdefault(float(data_set.get("timestep", 0)), []).append(pvd.parent / data_set.get("file"))
        return [steps[time] for time in sorted(steps)]

    def table(self, name):
        file = self.folder / name
        if not file.is_file():
            return []
        with open(file, newline="", encoding="utf-8", errors="replace") as text:
            return list(csv.DictReader(text))

    def has_contact_table(self):
        return (self.folder / "contact.csv").is_file()

    @property
    def contact(self):
        """Rows of contact.csv."""
        if self._contact is None:
            self._contact = self.table("contact.csv")
        return self._contact

    def n_steps(self):
        return max([len(self.grid_files), 1 + max((int(row["step"]) for row in self.contact), default=-1)])

    def factor(self, step):
        return self.factors[step] if step < len(self.factors) else math.nan

    def grid(self, step):
        return Grid(self.grid_files[step])

    def error_bar(self, quantity):
        """Estimate of the error that the mesh causes in a figure of the last load step ("touch.max_pressure"); None if there is none."""
        return next((bar["error"] for bar in self.summary.get("error_bars", []) if bar["quantity"] == quantity), None)

    def is_open_anywhere(self):
        return any(row["status"] == "open" for row in self.contact)

    def largest_closed_gap(self):
        """Largest magnitude of the initial gaps or overlaps that loading has closed."""
        return max((abs(float(row.get("initial_gap") or 0)) for row in self.contact if row["status"] != "open"), default=0.)

    def contact_pairs(self, step, wanted=None):
        """Pair name -> columns of its nodes in the step, in order of arc length."""
        pairs = {}
        for row in self.contact:
            if int(row["step"]) == step:
                pairs.setdefault(row["pair"], []).append(row)
        if wanted:
            unknown = [name for name in wanted if name not in pairs]
            if unknown:
                raise ValueError(f"--pairs: {self.folder / 'contact.csv'} has no pair '{unknown[0]}', it has {', '.join(pairs)}")
            pairs = {name: pairs[name] for name in wanted}
        for nodes in pairs.values():
            nodes.sort(key=lambda row: float(row["s"]))
        return {name: {column: np.array([row[column] if column == "status" else float(row[column] or "nan") for row in nodes])
                       for column in ("s", "x", "y", "gap", "pressure", "tangential_traction", "slip_bound", "slip", "status")
                       if column in nodes[0]}
                for name, nodes in pairs.items()}
