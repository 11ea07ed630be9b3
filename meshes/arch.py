#!/usr/bin/python3
"""Scene and limit analysis of the stone arch of arch.geo.

meshes/arch.py > prm/arch.prm writes the scene. meshes/arch.py --limit prints what rigid stones say (lower bound theorem
of limit analysis with friction; needs scipy): the critical friction coefficient and the largest point load, as in the
header of the scene. Other arches: change the numbers below and pass the same to gmsh by -setnumber.
"""

import math
import sys

from prm_text import section, wrapped

STONES, INNER, OUTER, EMBRACE, LOADED = 24, 2500., 3000., 160., 16  # as in arch.geo [mm, degrees]
DEPTH, DENSITY, GRAVITY, FORCE = 1000., 2.4e-9, 9810., 20000.  # [mm, t/mm^3, mm/s^2, N]
FRICTION = .6

HEADER = '''# Stone arch of {stones} voussoirs under its own weight and a point load, dry joints with Coulomb friction,
# plane stress. Written by meshes/arch.py; mesh by meshes/arch.geo.
#
# What it shows. {stones} floating bodies, {contacts} contact pairs, meshes that do not match, rigid abutments: contact
# and friction alone hold the arch. Joints open where the thrust leaves the middle third of the stones.
#
# What to expect
#   weight {weight:.1f} kN, point load {force:g} kN on stone v{loaded:02d}; the vertical forces of both springings
#   sum to {total:.1f} kN, the horizontal force in every joint is 30.1 kN
#   the centre of pressure of every joint lies inside the stones; the joints on both sides of the load open at the
#   intrados, the springing j00 opens at the intrados
#   rigid stones (limit analysis, meshes/arch.py --limit): equilibrium needs mu >= 0.342; at mu = 0.6 the arch bears
#   up to 56.3 kN there. Below the critical coefficient the run ends with status 4 and names the stones that slide.
#
# Variants:
#   --set Discretization/Refinements=2       finer
#   sed 's/coefficient = 0.6/coefficient = 0.3/' prm/arch.prm > prm/weak_arch.prm    too little friction: status 4
#   --set 'Point load load/Force y=-60000'   more than the stones bear: status 4
'''


def angle(joint):
    return math.radians(90 - EMBRACE / 2 + EMBRACE * joint / STONES)


def stone_weight():
    """Of one stone, and the distance of its centroid from the centre of the arch."""
    d = math.radians(EMBRACE / STONES)
    weight = (OUTER ** 2 - INNER ** 2) / 2 * d * DEPTH * DENSITY * GRAVITY
    return weight, 2 / 3 * (OUTER ** 3 - INNER ** 3) / (OUTER ** 2 - INNER ** 2) * math.sin(d / 2) / (d / 2)


def scene():
    weight = STONES * stone_weight()[0]
    stones = ['v{:02d}'.format(i + 1) for i in range(STONES)]
    joints = ['j{:02d}'.format(i) for i in range(STONES + 1)]
    print(HEADER.format(stones=STONES, contacts=STONES + 1, weight=weight / 1000, force=FORCE / 1000, loaded=LOADED,
                        total=(weight + FORCE) / 1000))
    print('set Title       = Stone arch, dry joints, own weight and point load')
    print('set Plane state = plane stress')
    print('set Materials   = stone')
    print(wrapped('Bodies     ', stones))
    print('set Obstacles   = right abutment, left abutment')
    print('set Body forces = weight')
    print('set Point loads = load')
    print(wrapped('Contacts   ', joints))
    print(section('Material stone', Young_modulus='2e4', Poisson_ratio='0.2', Density=DENSITY))
    for stone in stones:
        print(section('Body ' + stone, Shape='mesh', File='../meshes/arch.msh', Part=stone, Material='stone',
                      Thickness='{:g}'.format(DEPTH)))
    for name, joint, side in (('right', 0, 1), ('left', STONES, -1)):
        a = angle(joint)
        print(section('Obstacle {} abutment'.format(name), Shape='half plane',
                      Point='{!r}, {!r}'.format(INNER * math.cos(a), INNER * math.sin(a)),
                      Normal='{!r}, {!r}'.format(-side * math.sin(a), side * math.cos(a))))
    print(section('Body force weight', Bodies='all', Acceleration_y='{:g}'.format(-GRAVITY)))
    print(section('Point load load', Body=stones[LOADED - 1], Point='load', Force_y='{:g}'.format(-FORCE)))
    for i, joint in enumerate(joints):
        slave, master = ((stones[0] + '/start', 'right abutment') if i == 0 else
                         (stones[-1] + '/end', 'left abutment') if i == STONES else
                         (stones[i] + '/start', stones[i - 1] + '/end') if i % 2 else
                         (stones[i - 1] + '/end', stones[i] + '/start'))
        print(section('Contact ' + joint, Slave=slave, Master=master, Law='Coulomb', Friction_coefficient=FRICTION))
    print(section('Decomposition', Method='METIS', Subdomains='auto'))
    print(section('Solver', Tolerance='1e-6'))


def rigid_equilibrium(friction, force):
    """True when compression and friction at the ends of every joint balance the loads (linear programme)."""
    from scipy.optimize import linprog
    n = 4 * (STONES + 1)  # compression at intrados and extrados, friction there, of every joint
    balance, load = [[0.] * n for _ in range(3 * STONES)], [0.] * (3 * STONES)
    for joint in range(STONES + 1):
        er = (math.cos(angle(joint)), math.sin(angle(joint)))
        for end, radius in enumerate((INNER, OUTER)):
            for column, d in ((4 * joint + end, (-er[1], er[0])), (4 * joint + 2 + end, er)):
                for stone, sign in ((joint, 1), (joint - 1, -1)):
                    if 0 <= stone < STONES:
                        arm = radius * (er[0] * d[1] - er[1] * d[0])
                        for row, value in enumerate((d[0], d[1], arm)):
                            balance[3 * stone + row][column] = sign * value
    weight, radius = stone_weight()
    for stone in range(STONES):
        x = math.cos((angle(stone) + angle(stone + 1)) / 2)
        point = force if stone == LOADED - 1 else 0
        load[3 * stone + 1] = weight + point
        load[3 * stone + 2] = x * (radius * weight + OUTER * point)
    cone = [[-friction] * 2 + [sign] * 2 for sign in (1, -1)]
    bounds = [row for joint in range(STONES + 1) for row in
              ([0.] * (4 * joint) + c + [0.] * (n - 4 * joint - 4) for c in cone)]
    result = linprog([0.] * n, A_ub=bounds, b_ub=[0.] * len(bounds), A_eq=balance, b_eq=load,
                     bounds=[(0, None), (0, None), (None, None), (None, None)] * (STONES + 1))
    return result.status == 0


def bisect(holds, low, high):
    """Between low, where it does not hold, and high, where it does."""
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def limit():
    print('critical friction coefficient {:.4f}'.format(bisect(lambda mu: rigid_equilibrium(mu, FORCE), 0, 3)))
    largest = bisect(lambda force: rigid_equilibrium(FRICTION, force), 1e7, 0)
    print('largest point load at mu = {}: {:.1f} kN'.format(FRICTION, largest / 1000))


if __name__ == '__main__':
    limit() if '--limit' in sys.argv else scene()
