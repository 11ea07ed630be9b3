"""Scenes of benchmarks/graded: contact on tensor grids graded towards it."""

import meshes
from family_scenes import plane_strain_modulus
from scenes import Scene

SIZE, RADIUS = 10., 20.  # of the body and of the circle [mm]
SMALLEST = 1e-3  # of the cells, over the size of the body
DRIVEN = 0.01  # how far the top is moved down [mm]
# Hertz, half width 0.34 mm under that motion: what follows scales the Tresca bound only
TRESCA = 150.  # about a tenth of the largest pressure [MPa]


def law_of(name):
    if name == "tresca":
        return ("Tresca", TRESCA)
    return float(name[len("coulomb"):]) if name.startswith("coulomb") else name


def circle(variant, n=50, law="frictionless", sheared=0.):
    """A body on a rigid circle, cells smallest at the middle of its bottom."""
    scene = Scene("Graded body on a rigid circle", variant)
    xs = meshes.graded_both(-SIZE / 2, 0, SIZE / 2, n, SMALLEST * SIZE)
    scene.body("box", meshes.grid(xs, meshes.graded(0, SIZE, n, SMALLEST * SIZE)))
    scene.circle("circle", (0, -RADIUS), RADIUS)
    scene.clamp("box/top", sheared, -DRIVEN)
    scene.contact("touch", "box/bottom", "circle", law_of(law))
    return scene


def sheared_circle(variant, n=50, law="tresca"):
    return circle(variant, n, law, 0.002)


def hertz(variant, n=50, law="frictionless"):
    """A body with a round bottom of radius 10 on a block that is half as large again, n and 1.1 n cells a side."""
    scene = Scene("Hertz, graded bodies", variant)
    radius = RADIUS / 2  # the relative curvature is that of two equal cylinders of radius 20

    def bend(x, y):
        return x, y + x * x / (2 * radius) * (1 - y / SIZE)

    upper = meshes.grid(meshes.graded_both(-SIZE / 2, 0, SIZE / 2, n, SMALLEST * SIZE), meshes.graded(0, SIZE, n, SMALLEST * SIZE))
    scene.body("upper", upper.mapped(bend))
    m = 2 * round(0.55 * n)
    scene.body("lower", meshes.grid(meshes.graded_both(-0.75 * SIZE, 0, 0.75 * SIZE, m, SMALLEST * SIZE),
                                    meshes.graded(0, -SIZE, m, SMALLEST * SIZE)[::-1]))
    scene.clamp("upper/top", 0, -1.5 * DRIVEN)
    scene.clamp("lower/bottom")
    scene.contact("touch", "upper/bottom", "lower/top", law_of(law))
    return scene


def hertz_pressure_on_rigid(force, radius=RADIUS):
    """Largest pressure of an elastic half plane on a rigid cylinder, line force [N/mm]."""
    return (force * plane_strain_modulus() / (3.141592653589793 * radius)) ** 0.5


SCENES = {"circle": circle, "sheared": sheared_circle, "hertz": hertz}
