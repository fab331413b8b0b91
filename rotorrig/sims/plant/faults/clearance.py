"""A loose ball bearing: within the gap it holds nothing, beyond it the shaft lies on one ball or on two neighbours.

The balls are few and stand where the cage has carried them, so that the gap is no circle but the polygon of the balls'
tangents, which turns with the cage: the play is larger between two balls than under one, and changes as they pass
(varying compliance: Fukata, Gad, Kondou, Ayabe and Tamura, On the radial vibration of ball bearings, Bull. JSME 28
(1985) 899; Tiwari, Gupta and Prakash, Effect of radial internal clearance of a ball bearing on the dynamics of a
balanced horizontal rotor, J. Sound Vib. 238 (2000) 723). Balls and races are rigid beside the springs that carry the
bearing: the force is that of the springs, pushed by what part of the shaft's displacement leaves the polygon. The law
takes from the linear bearing the rest. The damping stays.
"""

import math

from numba import njit
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings, true_bearing
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {"gap": 1e-5}  # m, radial
SIZE = ("gap",)
RANGE = {"gap": LogUniform(1e-6, 2.5e-5)}
BALLS = 8  # of a 6200 bearing, for a shaft of 10 mm
CAGE = 0.381  # turns per turn of the shaft: (1 - ball / pitch diameter) / 2 with balls of 4.76 mm on 20 mm


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the force that the gap takes from each bearing sought."""
    laws = [(b.position, true_bearing(truth, b)) for b in sought_bearings(rig)]
    return tuple(Force(on=at(position), law=slack, constants=(values["gap"], b.kxx, b.kyy)) for position, b in laws)


@njit(cache=True)
def within_balls(x: float, y: float, gap: float, kx: float, ky: float, cage: float) -> tuple[float, float]:
    """Return the point of the balls' polygon that springs kx, ky draw (x, y) to; itself if it is inside.

    Of all points of a convex polygon the springs leave the one from which they pull square to a side, or at a corner
    between the directions of the two sides that meet there.
    """
    step = math.tau / BALLS
    inside = True
    for i in range(BALLS):
        inside &= x * math.cos(cage + i * step) + y * math.sin(cage + i * step) <= gap
    if inside:
        return x, y
    half = math.tan(step / 2) * gap  # from the middle of a side to its corners
    best_x, best_y, least = x, y, math.inf
    for i in range(BALLS):
        c, s = math.cos(cage + i * step), math.sin(cage + i * step)
        if x * c + y * s <= gap:
            continue  # the nearest point of the polygon is on a side that faces outwards to it
        # on the side (gap c, gap s) + u (-s, c), the springs' energy is least at this u
        u = (kx * -s * (x - gap * c) + ky * c * (y - gap * s)) / (kx * s * s + ky * c * c)
        u = min(max(u, -half), half)
        px, py = gap * c - u * s, gap * s + u * c
        energy = kx * (x - px) ** 2 + ky * (y - py) ** 2
        if energy < least:
            best_x, best_y, least = px, py, energy
    return best_x, best_y


@law
def slack(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = gap, stiffness in x and y."""
    x, y = within_balls(motion.x, motion.y, p[0], p[1], p[2], CAGE * turn.angle)
    return p[1] * x, p[2] * y
