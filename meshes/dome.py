#!/usr/bin/python3
"""Dome of loose stones: RINGS rings of STONES stones each around an open eye.

    meshes/dome.py        > prm/dome.prm
    meshes/dome.py --mesh > meshes/dome.msh     (hexahedra, Gmsh 2.2)

A stone lies between two cones about the axis (y) with their tips in the centre, two planes through the axis, and two spheres. Its
boundaries: lower, upper, start, end (the planes), inner, outer.
"""

import itertools
import math
import sys

from prm_text import section, wrapped

RINGS, STONES = 1, 8
INNER, OUTER = 2500., 3000.      # radii [mm]
EYE, SEAT = 20., 75.             # angles of the highest and the lowest joint from the axis [degrees]
CELLS = (4, 3, 2)                # of a stone: along the meridian, around, through its thickness
DENSITY, GRAVITY = 2.4e-9, 9810. # [t/mm^3, mm/s^2]
FRICTION = .6
SIDES = ('lower', 'upper', 'start', 'end', 'inner', 'outer')

HEADER = '''# Dome of {n} loose stones around an open eye, dry joints with Coulomb friction, standing on a rigid conical seat. Written by
# meshes/dome.py.
#
# What it shows. {n} floating bodies in space, {pairs} contact pairs, no support at all: contact and friction hold the dome. Contact
# search finds the joints between the stones; those on the seat are declared.
#
# What to expect
#   weight {weight:.1f} kN, of which polyhedra lack 2 %; each of the {stones} stones on the seat bears as much of it
#   the {stones} stones are alike: so are the forces of their joints, all of them compressed
#   a warning: at the lower corners a stone sticks to the seat and to its neighbour, which hold each other in more than one
#   way; there only the sums of the forces are determined
'''


def angle(ring):
    """Of the upper joint of a ring, counted from above; that of the seat is angle(RINGS)."""
    return math.radians(EYE + (SEAT - EYE) * ring / RINGS)


def weight():
    volume = 2 * math.pi / 3 * (OUTER ** 3 - INNER ** 3) * (math.cos(math.radians(EYE)) - math.cos(math.radians(SEAT)))
    return volume * DENSITY * GRAVITY


def names():
    return ['r{}s{}'.format(ring + 1, stone + 1) for ring in range(RINGS) for stone in range(STONES)]


def mesh():
    groups, nodes, elements = {}, [], []
    group = lambda dimension, name: groups.setdefault((dimension, name), len(groups) + 1)
    for name, (ring, stone) in zip(names(), itertools.product(range(RINGS), range(STONES))):
        number = {}
        for at in itertools.product(*(range(n + 1) for n in CELLS)):
            down, around, out = (a / n for a, n in zip(at, CELLS))
            theta = angle(ring) + (angle(ring + 1) - angle(ring)) * (1 - down)  # the first is the lower joint
            phi = 2 * math.pi * (stone * CELLS[1] + at[1]) / (STONES * CELLS[1])
            r = INNER + (OUTER - INNER) * out
            nodes.append((r * math.sin(theta) * math.cos(phi), r * math.cos(theta), -r * math.sin(theta) * math.sin(phi)))
            number[at] = len(nodes)
        square = ((0, 0), (1, 0), (1, 1), (0, 1))
        for at in itertools.product(*(range(n) for n in CELLS)):
            corner = lambda a, b, c: number[(at[0] + a, at[1] + b, at[2] + c)]
            elements.append((5, group(3, name), [corner(a, b, c) for a in (1, 0) for b, c in square]))
        for axis, end in itertools.product(range(3), (0, 1)):
            others = [d for d in range(3) if d != axis]
            for place in itertools.product(*(range(CELLS[d]) for d in others)):
                face = []
                for step in square:
                    at = [end * CELLS[axis]] * 3
                    for d, p, s in zip(others, place, step):
                        at[d] = p + s
                    face.append(number[tuple(at)])
                elements.append((3, group(2, name + ' ' + SIDES[2 * axis + end]), face))
    print('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}'.format(len(groups)))
    for (dimension, name), k in groups.items():
        print('{} {} "{}"'.format(dimension, k, name))
    print('$EndPhysicalNames\n$Nodes\n{}'.format(len(nodes)))
    for k, x in enumerate(nodes):
        print(k + 1, *('{:.12g}'.format(round(c, 8) + 0.) for c in x))
    print('$EndNodes\n$Elements\n{}'.format(len(elements)))
    for k, (kind, of, vertices) in enumerate(elements):
        print(k + 1, kind, 2, of, of, *vertices)
    print('$EndElements')


def scene():
    lowest = names()[-STONES:]
    n = RINGS * STONES
    print(HEADER.format(n=n, stones=STONES, pairs=n + n, weight=weight() / 1000))
    print('set Dimension   = 3')
    print('set Title       = Dome of loose stones, dry joints, own weight')
    print('set Materials   = stone')
    print(wrapped('Bodies     ', names()))
    print('set Obstacles   = seat')
    print('set Body forces = weight')
    print(wrapped('Contacts   ', ['seat of ' + stone for stone in lowest]))
    print(section('Material stone', Young_modulus='2e4', Poisson_ratio='0.2', Density=DENSITY))
    for stone in names():
        print(section('Body ' + stone, Shape='mesh', File='../meshes/dome.msh', Part=stone, Material='stone'))
    print(section('Obstacle seat', Shape='function', Height='sqrt(x^2+z^2)*{!r}'.format(1 / math.tan(math.radians(SEAT)))))
    print(section('Body force weight', Bodies='all', Acceleration_y='{:g}'.format(-GRAVITY)))
    print(section('Solver', Tolerance='1e-6'))
    print(section('Contact search', Mode='automatic', Law='Coulomb', Friction_coefficient=FRICTION))
    for stone in lowest:
        print(section('Contact seat of ' + stone, Slave='{0}/{0} lower'.format(stone), Master='seat', Law='Coulomb',
                      Friction_coefficient=FRICTION))


if __name__ == '__main__':
    mesh() if '--mesh' in sys.argv else scene()
