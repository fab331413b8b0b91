"""A shaft that is stiffer in one of its planes than across it: drawn oval, or with a flat or keyway along it.

Second moments I (1 + a) and I (1 - a) about two axes that turn with the shaft: in fixed axes the bending stiffness
gains a E I [[cos 2b, sin 2b], [sin 2b, -cos 2b]], b the stiff plane's angle (Tondl, Some Problems of Rotor Dynamics
(1965)). Under its weight the shaft is lifted twice per turn.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, bend, law, sway
from rotorrig.sims.plant.places import bending_spans, sense
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "asymmetry": 0.01,  # (stiff - soft) / (stiff + soft)
    "stiff_plane": 0.4,  # rad from shaft angle zero, in the sense of rotation
}
SIZE = ("asymmetry",)
RANGE = {"asymmetry": LogUniform(5e-4, 0.015), "stiff_plane": ANY_PHASE}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return what the stiff plane adds and the soft one lacks, beam element by beam element.

    An element between two places where forces act bends as one cubic but for the weight of the shaft itself.
    """
    cuts = (0.0, rig.shaft.length, *(d.position for d in rig.disks), *(b.position for b in rig.bearings))
    angle = sense(rig) * values["stiff_plane"]
    acting = []
    for start, end, stiffness in bending_spans(rig, truth, *cuts):
        k = values["asymmetry"] * stiffness / (end - start)
        acting.append(Force(on=bend(start, end), law=turning_spring, constants=(k, angle)))
        acting.append(Force(on=sway(start, end), law=turning_spring, constants=(3.0 * k, angle)))
    return tuple(acting)


@law
def turning_spring(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return the moments in x and y; p = what the stiff plane has more than the mean, its signed angle."""
    c, s = math.cos(2.0 * (turn.angle + p[1])), math.sin(2.0 * (turn.angle + p[1]))
    return -p[0] * (c * motion.x + s * motion.y), -p[0] * (s * motion.x - c * motion.y)
