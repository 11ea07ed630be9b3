"""GetFEM on the box and the cube with Coulomb friction and on Hertz contact; run by benchmarks/rivals with Debian's Python.

rival_getfem.py box CELLS | cube CELLS FRICTION | hertz MESH.json; prints one line of JSON: time by stage, peak memory, Newton steps, and the normal
force of every contact node by position. Nodal augmented Lagrangian, Newton, MUMPS. Settings: the symmetric augmentation
with r = 10 E takes the fewest Newton steps of three versions, four r, two line searches (box with 2500 cells and four times
as many).
"""

import json
import resource
import sys
import time

import getfem as gf
import numpy as np

YOUNG, POISSON, FRICTION, PRESSURE = 1e5, 0.35, 0.3, 250.0  # box: [MPa], [-], [-], [MPa]
SIZE, RADIUS = 10.0, 20.0  # [mm]
CUBE_PRESSURE, SPHERE = 500.0, 100.0  # on the top of the cube [MPa]; radius of the sphere below the middle of its bottom [mm]
AUGMENTATION, VERSION = 10.0, 2  # r over Young's modulus; symmetric (Hertz: the nonsymmetric version 1)
RESIDUAL = 1e-6  # relative


class Stages:
    def __init__(self):
        self.seconds, self.since = {}, time.monotonic()

    def end(self, name):
        now = time.monotonic()
        self.seconds[name] = now - self.since
        self.since = now


def lame(young, poisson, plane_stress):
    shear, first = young / 2 / (1 + poisson), young * poisson / (1 + poisson) / (1 - 2 * poisson)
    return (2 * first * shear / (first + 2 * shear) if plane_stress else first), shear


def solve(model):
    steps, converged = model.solve("lsolver", "mumps", "max_iter", 100, "max_res", RESIDUAL)
    return {"steps": int(steps), "converged": bool(converged)}


def by_position(positions, forces):
    return [[float(x), float(y), float(force)] for (x, y), force in zip(positions, forces)]


def grid(dimension, n):
    """Of a square or cube: its elements of degree 1, with the regions 1, 2, 3 at x = 0, y = 0 and the largest y."""
    mesh = gf.Mesh("cartesian", *[np.linspace(0, SIZE, n + 1)] * dimension)
    faces = mesh.outer_faces()
    normals = mesh.normal_of_faces(faces)
    left, bottom, top = 1, 2, 3
    for region, kept in ((left, normals[0] < -0.9), (bottom, normals[1] < -0.9), (top, normals[1] > 0.9)):
        mesh.set_region(region, faces[:, kept])
    fem = gf.MeshFem(mesh, dimension)
    fem.set_fem(gf.Fem(f"FEM_QK({dimension},1)"))
    return fem, gf.MeshIm(mesh, gf.Integ(f"IM_GAUSS_PARALLELEPIPED({dimension},3)")), (left, bottom, top)


def elastic(fem, integration, plane_stress, friction, traction, loaded):
    model = gf.Model("real")
    model.add_fem_variable("u", fem)
    first, shear = lame(YOUNG, POISSON, plane_stress)
    for name, value in (("lambda", first), ("mu", shear), ("r", AUGMENTATION * YOUNG), ("friction", friction)):
        model.add_initialized_data(name, [value])
    model.add_isotropic_linearized_elasticity_brick(integration, "u", "lambda", "mu")
    model.add_initialized_data("traction", traction)
    model.add_source_term_brick(integration, "u", "traction", loaded)
    return model


def box(n):
    """Left edge held along x, pressed from above on a rigid circle below the left corner."""
    stages = Stages()
    fem, integration, (left, bottom, top) = grid(2, n)
    stages.end("mesh")
    model = elastic(fem, integration, True, FRICTION, [0, -PRESSURE], top)
    model.add_normal_Dirichlet_condition_with_multipliers(integration, "u", 1, left)
    dofs = fem.basic_dof_on_region(bottom)
    for name in ("normal", "tangential"):
        model.add_variable(name, dofs.size // 2)
    model.add_nodal_contact_with_rigid_obstacle_brick(integration, "u", "normal", "tangential", "r", "friction", bottom,
                                                      f"sqrt(x*x+(y+{RADIUS})*(y+{RADIUS}))-{RADIUS}", VERSION)
    stages.end("model")
    result = solve(model)
    stages.end("solve")
    displacement = model.variable("u").reshape(-1, 2)
    result["max_displacement"] = float(np.hypot(*displacement.T).max())
    result["nodes"] = by_position(fem.basic_dof_nodes()[:, dofs[::2]].T, -model.variable("normal"))
    result["unknowns"] = fem.nbdof()
    return result, stages


def cube(n, friction):
    """prm/cube_on_sphere.prm: clamped at x = 0, pressed from above (y) on a rigid sphere; friction 0: frictionless."""
    stages = Stages()
    fem, integration, (left, bottom, top) = grid(3, n)
    stages.end("mesh")
    model = elastic(fem, integration, False, friction, [0, -CUBE_PRESSURE, 0], top)
    model.add_Dirichlet_condition_with_simplification("u", left)
    dofs = fem.basic_dof_on_region(bottom)
    variables = ["normal"]
    model.add_variable("normal", dofs.size // 3)
    if friction:
        model.add_variable("tangential", dofs.size // 3 * 2)
        variables.append("tangential")
    middle = SIZE / 2
    model.add_nodal_contact_with_rigid_obstacle_brick(
        integration, "u", *variables, "r", *(["friction"] if friction else []), bottom,
        f"sqrt((x-{middle})*(x-{middle})+(y+{SPHERE})*(y+{SPHERE})+(z-{middle})*(z-{middle}))-{SPHERE}", VERSION)
    stages.end("model")
    result = solve(model)
    stages.end("solve")
    result["max_displacement"] = float(np.linalg.norm(model.variable("u").reshape(-1, 3), axis=1).max())
    result["nodes"] = by_position(fem.basic_dof_nodes()[::2, dofs[::3]].T, -model.variable("normal"))
    result["unknowns"] = fem.nbdof()
    return result, stages


def hertz(file_name):
    """The cylinder on the block of a mesh file that benchmarks/rivals wrote."""
    stages = Stages()
    with open(file_name, encoding="utf-8") as file:
        given = json.load(file)
    meshes = []
    for body in given["bodies"]:
        mesh, points = gf.Mesh("empty", 2), np.array(body["points"]).T
        corners = points[:, np.array(body["cells"])[:, [0, 1, 3, 2]]]  # 2 x cells x 4, in GetFEM's order
        mesh.add_convex(gf.GeoTrans("GT_QK(2,1)"), np.ascontiguousarray(np.transpose(corners, (0, 2, 1))))
        meshes.append(mesh)
    cylinder, block = meshes
    radius, ground, flat, arc, top = given["radius"], 1, 2, 3, 4
    for mesh, y_of, region in ((block, given["bottom"], ground), (block, 0.0, top), (cylinder, radius, flat)):
        mesh.set_region(region, edges_at(mesh, lambda points, y=y_of: np.abs(points[1] - y) < 1e-3))
    cylinder.set_region(arc, edges_at(cylinder, lambda points: points[1] < radius / 2))
    stages.end("mesh")
    model = gf.Model("real")
    first, shear = lame(given["young"], given["poisson"], plane_stress=False)
    for name, value in (("lambda", first), ("mu", shear), ("r", AUGMENTATION * given["young"])):
        model.add_initialized_data(name, [value])
    unknowns, integrations, fems = 0, [], []
    for name, mesh in (("u1", cylinder), ("u2", block)):
        fem = gf.MeshFem(mesh, 2)
        fem.set_fem(gf.Fem("FEM_QK(2,1)"))
        integration = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(2,3)"))
        model.add_fem_variable(name, fem)
        model.add_isotropic_linearized_elasticity_brick(integration, name, "lambda", "mu")
        unknowns += fem.nbdof()
        fems.append(fem)
        integrations.append(integration)
    model.add_initialized_data("traction", [0, -given["pressure"]])
    model.add_source_term_brick(integrations[0], "u1", "traction", flat)
    model.add_Dirichlet_condition_with_simplification("u2", ground)
    hold_axis(model, fems[0], radius)
    dofs = fems[0].basic_dof_on_region(arc)
    model.add_nodal_contact_between_nonmatching_meshes_brick(integrations[0], integrations[1], "u1", "u2", "normal", "r", arc, top,
                                                             True, False, 1)  # version 2 fails: dimensions mismatch
    stages.end("model")
    result = solve(model)
    stages.end("solve")
    result["max_displacement"] = float(max(np.hypot(*model.variable(name).reshape(-1, 2).T).max() for name in ("u1", "u2")))
    result["nodes"] = by_position(fems[0].basic_dof_nodes()[:, dofs[::2]].T, -model.variable("normal"))
    result["unknowns"] = unknowns
    return result, stages


def edges_at(mesh, condition):
    """Outer faces both of whose ends meet the condition."""
    faces = mesh.outer_faces()
    kept = [i for i in range(faces.shape[1]) if condition(mesh.pts(mesh.pid_in_faces(faces[:, i:i + 1]))).all()]
    return faces[:, kept]


def hold_axis(model, fem, radius):
    """Two points of the axis keep the cylinder upright."""
    nodes = fem.basic_dof_nodes()
    held = [int(np.argmin(nodes[0]**2 + (nodes[1] - y)**2)) // 2 * 2 for y in (0.0, radius)]
    rows = gf.Spmat("empty", len(held), fem.nbdof())
    for row, dof in enumerate(held):
        rows.add(row, dof, 1.0)
    model.add_variable("axis", len(held))
    model.add_constraint_with_multipliers("u1", "axis", rows, np.zeros(len(held)))


def main():
    gf.util_trace_level(0)
    problem, *given = sys.argv[1:]
    if problem == "cube":
        result, stages = cube(int(given[0]), float(given[1]))
    else:
        result, stages = box(int(given[0])) if problem == "box" else hertz(given[0])
    result["time_s"] = dict(stages.seconds, total=sum(stages.seconds.values()))
    result["memory_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print("RESULT " + json.dumps(result))


if __name__ == "__main__":
    main()
