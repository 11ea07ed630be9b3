"""Scenes that the benchmarks put together themselves, with the variants whose cost is compared."""

import dataclasses
import math

STEEL = (2.1e5, 0.3)  # Young modulus [MPa], Poisson ratio

MESHES_WRITTEN = set()  # files of this process: variants share them


@dataclasses.dataclass(frozen=True)
class Variant:
    """How a scene is discretised, cut, placed and run; all that must not change its price."""

    degree: int = 1
    subdomains: int = 8  # 0: Method = none
    seed: int = 0
    exchanged: bool = False  # master and slave
    turn: float = 0.  # degrees, the whole scene about the origin
    triangles: bool = False
    ranks: int = 1

    @property
    def name(self):
        return ("t" if self.triangles else "q") + str(self.degree) + (f"-metis{self.subdomains}" if self.subdomains else "-none") \
            + (f"-seed{self.seed}" if self.seed else "") + ("-exchanged" if self.exchanged else "") \
            + (f"-turned{self.turn:g}" if self.turn else "") + (f"-ranks{self.ranks}" if self.ranks > 1 else "")

    @property
    def problem(self):
        """Variants with the same one solve the same discrete problem."""
        return (self.degree, self.triangles, self.exchanged)

    @property
    def meshes(self):
        """Variants with the same one share mesh files."""
        return ("t" if self.triangles else "q") + (f"-turned{self.turn:g}" if self.turn else "")


def number(value):
    return value if isinstance(value, str) else f"{value!r}"


class Scene:
    """Collects parameters by the names of --set; vectors are given before the turn."""

    def __init__(self, title, variant, plane_strain=True):
        self.variant, self.meshes = variant, {}
        self.lists = {name: [] for name in ("Materials", "Bodies", "Obstacles", "Supports", "Tractions", "Body forces",
                                            "Point loads", "Contacts")}
        self.sections = {}
        self.top = {"Title": title, "Plane state": "plane strain" if plane_strain else "plane stress"}
        self.section("Decomposition", Method="METIS", Subdomains=variant.subdomains, Seed=variant.seed)
        if not variant.subdomains:
            self.sections["Decomposition"] = {"Method": "none"}
        self.section("Discretization", Degree=variant.degree)
        self.section("Output", VTU="false")

    def section(self, name, **values):
        self.sections.setdefault(name, {}).update({key.replace("_", " "): value for key, value in values.items()})

    def add(self, group, kind, name, **values):
        self.lists[group].append(name)
        self.section(f"{kind} {name}", **values)

    def turned(self, x, y):
        """A vector of numbers or formulas, turned with the scene; a list of two texts."""
        if not self.variant.turn:
            return number(x), number(y)
        angle = math.radians(self.variant.turn)
        c, s = math.cos(angle), math.sin(angle)
        if isinstance(x, str) or isinstance(y, str):
            return f"({c!r})*({x})-({s!r})*({y})", f"({s!r})*({x})+({c!r})*({y})"
        return number(c * x - s * y), number(s * x + c * y)

    def body(self, name, mesh, elastic=STEEL):
        if self.variant.triangles:
            mesh = mesh.split()
        self.meshes[name] = mesh.turned(self.variant.turn)
        self.add("Materials", "Material", name, Young_modulus=elastic[0], Poisson_ratio=elastic[1])
        self.add("Bodies", "Body", name, Shape="mesh", File=f"{name}-{self.variant.meshes}.msh", Material=name)

    def clamp(self, boundary, x=0, y=0):
        """Prescribed displacement, both components."""
        x, y = self.turned(x, y)
        self.add("Supports", "Support", boundary.replace("/", " "), Boundary=boundary, Displacement_x=x, Displacement_y=y)

    def roller(self, boundary):
        self.add("Supports", "Support", boundary.replace("/", " "), Boundary=boundary, Displacement_normal=0)

    def hold(self, body, point, directions):
        """Point support; the turn must be a multiple of 90 degrees, directions is "x" or "y"."""
        point = self.turned(*point)
        if round(self.variant.turn / 90) % 2:
            directions = "y" if directions == "x" else "x"
        self.add("Supports", "Support", f"{body} point", Body=body, Point=f"{point[0]}, {point[1]}",
                 **{f"Displacement_{directions}": 0})

    def traction(self, boundary, x, y):
        x, y = self.turned(x, y)
        self.add("Tractions", "Traction", boundary.replace("/", " "), Boundary=boundary, Traction_x=x, Traction_y=y)

    def pressure(self, boundary, value):
        self.add("Tractions", "Traction", boundary.replace("/", " "), Boundary=boundary, Pressure=number(value))

    def body_force(self, body, x, y):
        x, y = self.turned(x, y)
        self.add("Body forces", "Body force", body, Bodies=body, Force_x=x, Force_y=y)

    def half_plane(self, name, point, normal):
        (x, y), (u, v) = self.turned(*point), self.turned(*normal)
        self.add("Obstacles", "Obstacle", name, Shape="half plane", Point=f"{x}, {y}", Normal=f"{u}, {v}")

    def circle(self, name, center, radius):
        x, y = self.turned(*center)
        self.add("Obstacles", "Obstacle", name, Shape="circle", Center=f"{x}, {y}", Radius=number(radius))

    def contact(self, name, slave, master, law, **more):
        """law: frictionless, a number (Coulomb) or ("Tresca", bound)."""
        if self.variant.exchanged and master not in self.lists["Obstacles"]:
            slave, master = master, slave
        if law == "frictionless":
            values = {"Law": "frictionless"}
        elif isinstance(law, tuple):
            values = {"Law": "Tresca", "Slip_bound": law[1], "Slip_bound_acts_on": "contact"}
        else:
            values = {"Law": "Coulomb", "Friction_coefficient": law}
        self.add("Contacts", "Contact", name, Slave=slave, Master=master, **values, **more)

    def steps(self, *factors):
        self.section("Load steps", Factors=", ".join(f"{factor:g}" for factor in factors))

    def write(self, folder):
        """The .prm, its meshes beside it; returns its path."""
        folder.mkdir(parents=True, exist_ok=True)
        for name, mesh in self.meshes.items():
            file = folder / f"{name}-{self.variant.meshes}.msh"
            if file not in MESHES_WRITTEN:
                mesh.write(file, name)
                MESHES_WRITTEN.add(file)
        lines = [f"set {name} = {value}" for name, value in self.top.items()]
        lines += [f"set {name} = {', '.join(values)}" for name, values in self.lists.items() if values]
        for name, values in self.sections.items():
            lines += ["", f"subsection {name}", *(f"  set {key} = {value}" for key, value in values.items()), "end"]
        path = folder / f"{self.variant.name}.prm"
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return path
