"""Damping that turns with the shaft: its material takes a while to follow, like a sleeve of plastic shrunk onto it.

In axes fixed to the shaft every fibre has, beside its own stiffness, a spring in series with a dashpot (Zener; rotating
in a chain of such: Genta and Amati, Hysteretic damping in rotordynamics: an equivalent formulation, J. Sound Vib. 329
(2010) 4772). What it loses depends on how fast the bending moves as seen from the shaft, |whirl speed - W|: a whirl
that turns slower than the shaft is driven (Kimball, Phil. Mag. 49 (1925) 724), and the damping fades where that is much
faster than the relaxation.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, bend, law, sway
from rotorrig.sims.plant.places import bending_spans
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {"time": 5e-5}  # s, stress per stiffness and strain rate at `RELAXATION`
SIZE = ("time",)
RANGE = {"time": LogUniform(2.5e-5, 1.2e-4)}
RELAXATION = 460.0  # rad/s, one over the relaxation time: twice the critical speed, as seen of a backward whirl there


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the lagging part of the shaft's stiffness, beam element by beam element."""
    cuts = (0.0, rig.shaft.length, *(d.position for d in rig.disks), *(b.position for b in rig.bearings))
    share = 2.0 * values["time"] * RELAXATION  # the dashpot is half as fast there as if there were no spring
    acting = []
    for start, end, stiffness in bending_spans(rig, truth, *cuts):
        k = share * stiffness / (end - start)
        acting.append(Force(on=bend(start, end), law=lagging_spring, constants=(k,), memory=4))
        acting.append(Force(on=sway(start, end), law=lagging_spring, constants=(3.0 * k,), memory=4))
    return tuple(acting)


@law
def lagging_spring(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return the moments in x and y; p = the spring that is in series with the dashpot.

    It remembers, in the shaft's axes, the bending and where the dashpot stands: trapezoidal rule.
    """
    c, s = math.cos(turn.angle), math.sin(turn.angle)
    after[0], after[1] = c * motion.x + s * motion.y, c * motion.y - s * motion.x
    a = turn.step * RELAXATION / 2.0
    after[2] = ((1.0 - a) * before[2] + a * (before[0] + after[0])) / (1.0 + a)
    after[3] = ((1.0 - a) * before[3] + a * (before[1] + after[1])) / (1.0 + a)
    u, v = p[0] * (after[0] - after[2]), p[0] * (after[1] - after[3])
    return -(c * u - s * v), -(s * u + c * v)
