"""Scenes of benchmarks/graded: contact on tensor grids graded towards it."""

import functools

import meshes
from scene_files import Scene

SIZE, RADIUS = 10., 20.  # of the body and of the circle [mm]
SMALLEST, STEEP = 1e-3, 2.5e-4  # cells, over the size of the body; aspect ratios of 50 cells a side to 100 and 500
DRIVEN = 0.01  # how far the top is moved down [mm]; half width of the contact 0.3 mm
TRESCA = 150.  # about a tenth of the largest pressure [MPa]


def law_of(name):
    if name == "tresca":
        return ("Tresca", TRESCA)
    return float(name[len("coulomb"):]) if name.startswith("coulomb") else name


def graded_box(n, smallest, size=SIZE):
    """Above the x axis, cells smallest at (0, 0)."""
    return meshes.grid(meshes.graded_both(-size / 2, 0, size / 2, n, smallest * SIZE), meshes.graded(0, SIZE, n, smallest * SIZE))


def circle(variant, n=50, law="frictionless", smallest=SMALLEST, sheared=0.):
    """A body on a rigid circle, its top driven down."""
    scene = Scene("Graded body on a rigid circle", variant)
    scene.body("box", graded_box(n, smallest))
    scene.circle("circle", (0, -RADIUS), RADIUS)
    scene.clamp("box/top", sheared, -DRIVEN)
    scene.contact("touch", "box/bottom", "circle", law_of(law))
    return scene


def held(variant, n=50, law="frictionless", smallest=STEEP):
    """As prm/box_on_circle.prm: held at its left side, pressed by 250 MPa on top."""
    scene = Scene("Graded body on a rigid circle, held at its side", variant)
    scene.body("box", graded_box(n, smallest))
    scene.circle("circle", (0, -RADIUS), RADIUS)
    scene.clamp("box/left")
    scene.traction("box/top", 0, -250)
    scene.contact("touch", "box/bottom", "circle", law_of(law))
    return scene


def hertz(variant, n=50, law="frictionless", smallest=SMALLEST):
    """A body with a round bottom of radius 10 on a block that is half as large again, n and 1.1 n cells a side."""
    scene = Scene("Hertz, graded bodies", variant)
    radius = RADIUS / 2  # the relative curvature is that of two equal cylinders of radius 20
    scene.body("upper", graded_box(n, smallest).mapped(lambda x, y: (x, y + x * x / (2 * radius) * (1 - y / SIZE))))
    scene.body("lower", graded_box(2 * round(0.55 * n), smallest, 1.5 * SIZE).mapped(lambda x, y: (-x, -y)))
    scene.clamp("upper/top", 0, -1.5 * DRIVEN)
    scene.clamp("lower/top")
    scene.contact("touch", "upper/bottom", "lower/bottom", law_of(law))
    return scene


SCENES = {
    "circle": circle,
    "steep": functools.partial(circle, smallest=STEEP),
    "sheared": functools.partial(circle, sheared=0.002),
    "held": held,
    "hertz": hertz,
    "hertz-steep": functools.partial(hertz, smallest=STEEP),
}
