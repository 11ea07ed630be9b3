"""Scenes of the families of benchmarks/families: each function makes one scene in one variant.

What is known about an answer stands in the text of its function.
"""

import math

import meshes
from scene_files import STEEL, Scene

CONTRAST = 1e9  # of the moduli of "stiff"


def plane_strain_modulus(elastic=STEEL):
    return elastic[0] / (1 - elastic[1] ** 2)


# ----- conforming pins

def pin(variant, around=(64, 96), gap="0", mu=0.1):
    """Solid pin of radius 10 in a ring of radii 10 and 25 that is held outside; its own weight presses it down."""
    scene = Scene("Pin pressed in its hole, conforming", variant)
    layers = around[0] // 8
    scene.body("pin", meshes.disc(10, around[0], layers))
    scene.body("plate", meshes.ring(meshes.graded(10, 25, around[1] // 6, 1.5 * 2 * math.pi * 10 / around[1]), around[1]))
    scene.clamp("plate/outer")
    scene.body_force("pin", 0, -2000 / (math.pi * 10 ** 2))  # 2000 N/mm in all
    scene.contact("fit", "pin/arc", "plate/inner", mu, Gap=gap)
    return scene


# ----- rollers

def block(width, height, nx, ny, fine, names=None):
    """Graded towards the middle of its top, at (0, 0)."""
    return meshes.grid(meshes.graded_both(-width / 2, 0, width / 2, nx, fine), meshes.graded(0, -height, ny, fine)[::-1], names)


def half_roller(variant, around=96, mu=0.1):
    """Half disc of radius 10, its flat driven down by 0.03 mm, on a block."""
    scene = Scene("Roller on a block, driven", variant)
    scene.body("roller", round_pad(10, 10, 10, around // 2, around // 3, 0.06))
    scene.body("block", block(40, 20, around // 4 * 3, around // 3, 0.08))
    scene.clamp("roller/top", 0, -0.03)
    scene.clamp("block/bottom")
    scene.contact("touch", "roller/bottom", "block/top", mu)
    return scene


def roller(variant, around=128, mu=0.1):
    """Whole disc of radius 10 on a block, pressed by its weight, 20 000 N/mm; nothing else holds it."""
    scene = Scene("Roller on a block, held by contact alone", variant)
    scene.body("roller", meshes.disc(10, around, around // 8, smallest=30 / around))
    scene.body("block", block(40, 20, around // 4 * 3, around // 3, 40 / around))
    scene.body_force("roller", 0, -20000 / (math.pi * 10 ** 2))
    scene.clamp("block/bottom")
    scene.sections["Body roller"]["Translation"] = ", ".join(scene.turned(0, 10.))
    scene.contact("touch", "roller/arc", "block/top", mu)
    return scene


# ----- fretting

def round_pad(radius, width, height, nx, ny, fine):
    """Block of the given width, its bottom an arc that touches (0, 0)."""
    flat = meshes.grid(meshes.graded_both(-width / 2, 0, width / 2, nx, fine), meshes.graded(0, height, ny, fine))

    def bend(x, y):
        rise = x * x / (2 * radius)
        return x, y + rise * (1 - y / height)

    return flat.mapped(bend)


def pad(variant, n=48, mu=0.6, shear=0.008, steps=(1, 2, 3), unload=False):
    """Rounded pad of radius 50, driven down by 0.02 mm, then sideways; sticks in the middle, slips at the edges."""
    scene = Scene("Fretting pad, pressed then sheared", variant)
    scene.body("pad", round_pad(50, 12, 6, n, n // 2, 0.08))
    scene.body("block", block(24, 12, n + n // 4, n // 2, 0.08))
    scene.clamp("block/bottom")
    if unload:
        last = steps[-1]
        scene.traction("pad/top", "0", f"-150*({last}-t)/{last - 1}")
    else:
        scene.clamp("pad/top", f"{shear / (steps[-1] - 1 or 1)}*max(t-1,0)", "-0.02*min(t,1)")
    scene.contact("touch", "pad/bottom", "block/top", mu)
    scene.steps(*steps)
    return scene


def pushed_pad(variant, n=48, mu=0.6, part=0.8):
    """As pad, pressed by a traction, then sheared by `part` of what friction holds; nothing but contact holds the pad."""
    scene = Scene("Fretting pad, forces prescribed", variant)
    scene.body("pad", round_pad(50, 12, 6, n, n // 2, 0.04))
    scene.body("block", block(24, 12, n + n // 4, n // 2, 0.05))
    scene.clamp("block/bottom")
    scene.traction("pad/top", f"{100 * mu * part}*max(t-1,0)/2", "-100*min(t,1)")
    scene.contact("touch", "pad/bottom", "block/top", mu)
    scene.steps(1, 2, 3)
    return scene


def flat_pad(variant, n=48, mu=0.6):
    """A flat pad with sharp corners, pressed, then sheared in three steps till its edges slip."""
    scene = Scene("Flat pad, pressed then sheared", variant)
    scene.body("pad", meshes.grid(meshes.uniform(-5, 5, n), meshes.uniform(0, 5, n // 2)))
    scene.body("block", meshes.grid(meshes.uniform(-12, 12, 2 * n + 6), meshes.graded(0, -12, n // 2, 12 / n)[::-1]))
    scene.clamp("block/bottom")
    scene.clamp("pad/top", "0.003*max(t-1,0)", "-0.01*min(t,1)")
    scene.contact("touch", "pad/bottom", "block/top", mu)
    scene.steps(1, 2, 3, 4)
    return scene


def bulk(variant, n=48, mu=0.3):
    """As pad; after partial slip the block is stretched under it by 100 MPa."""
    scene = Scene("Bulk load after partial slip", variant)
    scene.body("pad", round_pad(50, 12, 6, n, n // 2, 0.08))
    scene.body("block", block(24, 12, n + n // 4, n // 2, 0.08))
    scene.roller("block/bottom")
    scene.roller("block/left")
    scene.traction("block/right", "100*max(t-2,0)", "0")
    scene.clamp("pad/top", "0.003*min(max(t-1,0),1)", "-0.02*min(t,1)")
    scene.contact("touch", "pad/bottom", "block/top", mu)
    scene.steps(1, 2, 3)
    return scene


# ----- flat punches

def punch(variant, elements=40, mu=0.3):
    """Spence: half plane (block of 20 x 10 widths of half a punch) under a rigid flat punch of width 2, driven by 0.002."""
    scene = Scene("Rigid flat punch that adheres and slips", variant)
    xs = [-x for x in meshes.graded(1, 10, elements // 2, 2 / elements)[:0:-1]] + meshes.uniform(-1, 1, elements) \
        + meshes.graded(1, 10, elements // 2, 2 / elements)[1:]
    ys = meshes.graded(0, -10, elements, 2 / elements)[::-1]
    scene.body("block", meshes.grid(xs, ys, lambda side, x, y: "punched" if side == "top" and abs(x) < 1 else side))
    scene.half_plane("punch", (0, 0), (0, -1))
    scene.clamp("block/bottom")
    scene.contact("touch", "block/punched", "punch", mu, Offset="-0.002")
    return scene


def stiff_punch(variant, elements=40, mu=0.3, contrast=1e3):
    """The same with a punch that is an elastic body, stiffer by `contrast`, of non-matching mesh."""
    scene = Scene("Stiff flat punch that adheres and slips", variant)
    scene.body("punch", meshes.grid(meshes.uniform(-1, 1, elements * 3 // 4), meshes.uniform(0, 1, elements // 4)),
               (contrast * STEEL[0], 0.3))
    xs = [-x for x in meshes.graded(1, 10, elements // 2, 2 / elements)[:0:-1]] + meshes.uniform(-1, 1, elements) \
        + meshes.graded(1, 10, elements // 2, 2 / elements)[1:]
    scene.body("block", meshes.grid(xs, meshes.graded(0, -10, elements, 2 / elements)[::-1]))
    scene.clamp("punch/top", 0, -0.002)
    scene.clamp("block/bottom")
    scene.contact("touch", "block/top", "punch/bottom", mu)
    return scene


# ----- wedges

def wedge(variant, n=24, mu=0.3, angle=10., driven="force", symmetric=False):
    """Wedge of 10 degrees between an inclined block and a wall (or two blocks): driven in, released in five steps to zero.

    It slides out when mu is below tan(angle / 2) (both sides slip; symmetric: below tan(angle)), else it stays jammed.
    """
    scene = Scene("Wedge driven into a block and released", variant)
    slope, low, high, height = math.tan(math.radians(angle)), 0., 10., 10.

    def shape(x, y):  # x 0 to 1: from the wall to the incline
        right = 2 + slope * y
        return (right * (2 * x - 1) if symmetric else right * x), y

    scene.body("wedge", meshes.grid(meshes.uniform(0, 1, n // 3), meshes.uniform(low, high, n)).mapped(shape))

    def beside(x, y):  # x 0 to 1: from the incline outwards
        inner = 2 + slope * y
        return inner + x * (10 - inner), y

    right = meshes.grid(meshes.uniform(0, 1, n // 2), meshes.uniform(low, height, n + n // 4)).mapped(beside)
    scene.body("block", right)
    scene.clamp("block/right")
    if symmetric:
        left = meshes.grid(meshes.uniform(0, 1, n // 2), meshes.uniform(low, height, n + n // 4))
        scene.body("other", left.mapped(lambda x, y: (lambda p: (-p[0], p[1]))(beside(1 - x, y))))
        scene.clamp("other/left")
        scene.contact("left", "wedge/left", "other/right", mu)
    else:
        scene.half_plane("wall", (0, 0), (1, 0))
        scene.contact("left", "wedge/left", "wall", mu)
    scene.contact("right", "wedge/right", "block/left", mu)
    load = "min(t,(6-t)/5)"  # 1 at t = 1, then 0.8, 0.6, 0.4, 0.2, 0
    if driven == "force":
        scene.traction("wedge/top", "0", f"-50*{load}")
    else:
        scene.clamp("wedge/top", "0", f"-0.01*{load}")
    scene.steps(1, 2, 3, 4, 5, 6)
    return scene


# ----- friction above one

def raous(variant, n=32, mu=5):
    """prm/raous.prm with more friction."""
    scene = Scene("Block with high friction", variant)
    scene.body("block", meshes.grid(meshes.uniform(-40, 0, n), meshes.uniform(0, 40, n)), (1.3e5, 0.2))
    scene.half_plane("plane", (0, 0), (0, 1))
    scene.roller("block/right")
    scene.hold("block", (0., 0.), "y")
    scene.pressure("block/top", 50)
    scene.pressure("block/left", 150)
    scene.contact("ground", "block/bottom", "plane", mu)
    return scene


# ----- fits

def twisted_ring(variant, torque=0.5, around=(64, 80), mu=0.2, steps=(1, 2)):
    """Press fit with 0.01 mm of overlap, the shaft held at its bore, then the ring is twisted by `torque` of what holds."""
    scene = Scene(f"Ring twisted on its shaft by {torque:g} of what friction holds", variant)
    scene.body("shaft", meshes.ring(meshes.uniform(5, 10, around[0] // 10), around[0]))
    scene.body("ring", meshes.ring(meshes.uniform(10, 20, around[1] // 8), around[1]))
    scene.clamp("shaft/inner")
    holds = mu * rigid_bore_pressure(0.01) * 2 * math.pi * 10 ** 2  # N mm per mm
    shear = torque * holds / (2 * math.pi * 20 ** 2)
    factor = "max(t-1,0)" if len(steps) > 1 else "1"
    # the field of a torque is the same after every turn about the origin
    scene.add("Tractions", "Traction", "twist", Boundary="ring/outer", Traction_x=f"-{shear!r}*{factor}*y/20",
              Traction_y=f"{shear!r}*{factor}*x/20")
    scene.contact("fit", "ring/inner", "shaft/outer", mu, Gap="-0.01")
    scene.steps(*steps)
    return scene


def rigid_bore_pressure(overlap, inner=5., middle=10., outer=20., elastic=STEEL):
    """Pressure of the fit when the bore of the shaft is held, plane strain."""
    young, nu = elastic
    # shaft: u = A r + B / r, u(inner) = 0, radial stress -1 at middle; plane strain
    factor = young / ((1 + nu) * (1 - 2 * nu))
    a = -1 / (factor * (1 + (1 - 2 * nu) * inner ** 2 / middle ** 2))
    shaft = -(a * middle - a * inner ** 2 / middle)
    e, v = young / (1 - nu ** 2), nu / (1 - nu)
    ring = middle / e * ((outer ** 2 + middle ** 2) / (outer ** 2 - middle ** 2) + v)
    return overlap / (ring + shaft)


def press_fit(variant, around=(64, 80), mu=0.2, unload=True):
    """Whole ring on a hollow shaft, nothing held but by contact; the overlap is taken back to exactly zero."""
    scene = Scene("Press fit, unloaded to zero", variant)
    scene.body("shaft", meshes.ring(meshes.uniform(5, 10, around[0] // 10), around[0]))
    scene.body("ring", meshes.ring(meshes.uniform(10, 20, around[1] // 8), around[1]))
    scene.contact("fit", "ring/inner", "shaft/outer", mu, Gap="-0.01*(3-t)/2" if unload else "-0.01")
    scene.clamp("shaft/inner")
    scene.steps(*((1, 2, 3) if unload else (1,)))
    return scene


# ----- contrast of the moduli

def contrast(variant, n=32, law=0.3, ratio=CONTRAST):
    """Soft block on one stiffer by `ratio`, pressed with 10 MPa and sheared with 1.5 MPa."""
    scene = Scene("Two blocks, moduli 1 to 1e9", variant)
    soft = 210.
    scene.body("soft", meshes.grid(meshes.uniform(-10, 10, n), meshes.uniform(0, 10, n // 2)), (soft, 0.3))
    scene.body("stiff", meshes.grid(meshes.uniform(-15, 15, n + 7), meshes.uniform(-10, 0, n // 2 + 1)), (soft * ratio, 0.3))
    scene.clamp("stiff/bottom")
    scene.traction("soft/top", 1.5, -10)
    scene.contact("joint", "soft/bottom", "stiff/top", law)
    return scene
