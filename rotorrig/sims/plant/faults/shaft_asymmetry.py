"""A shaft that is softer in one of its planes: a flat is milled along it from its first bearing to its last.

What is milled away lacks in bending towards the flat alone: there the second moment is (1 - a) / (1 + a) of the round
shaft's, across it is whole, so that the shaft is also softer on the average (Dimentberg, Flexural Vibrations of
Rotating Shafts (1961), ch. 3). In axes that turn with the shaft it is a missing spring along one of them. Under its
weight the shaft is lifted twice per turn.
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
    """Return what the soft plane lacks, beam element by beam element.

    An element between two places where forces act bends as one cubic but for the weight of the shaft itself.
    """
    held = [b.position for b in rig.bearings]
    cuts = [z for z in (*(d.position for d in rig.disks), *held) if min(held) <= z <= max(held)]
    lost = 2.0 * values["asymmetry"] / (1.0 + values["asymmetry"])
    soft = sense(rig) * values["stiff_plane"] + math.pi / 2
    acting = []
    for start, end, stiffness in bending_spans(rig, truth, *cuts):
        k = lost * stiffness / (end - start)
        acting.append(Force(on=bend(start, end), law=missing_spring, constants=(k, soft)))
        acting.append(Force(on=sway(start, end), law=missing_spring, constants=(3.0 * k, soft)))
    return tuple(acting)


@law
def missing_spring(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return the moments in x and y; p = stiffness that the soft plane lacks, its signed angle."""
    c, s = math.cos(turn.angle + p[1]), math.sin(turn.angle + p[1])
    moment = p[0] * (c * motion.x + s * motion.y)
    return moment * c, moment * s
