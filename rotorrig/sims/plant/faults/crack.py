"""A transverse crack that breathes: it is open while its side of the shaft is stretched, closed while that is pressed.

An open crack acts as a hinge across its mouth (Gasch, J. Sound Vib. 160 (1993) 313, with one compliance); here it
softens an element of shaft as long as the diameter, and whether it is open follows from the bending there, of weight
and vibration together. It turns with the shaft, so the stiffness goes up and down once per turn.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Uniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, bend, law
from rotorrig.sims.plant.places import bending_spans, sense
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "compliance": 2e-5,  # rad/(N m) of the open hinge: near the disk 1 % of the rotor's stiffness
    "angle": 0.8,  # rad from shaft angle zero, in the sense of rotation: the crack's mouth
    "position": 0.33,  # m from the coupling
}
SIZE = ("compliance",)
RANGE = {"compliance": LogUniform(1e-6, 1e-4), "angle": ANY_PHASE, "position": Uniform(0.2, 0.42)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the moment that the open crack does not carry."""
    half = rig.shaft.diameter / 2
    angle = sense(rig) * values["angle"]
    acting = []
    for start, end, stiffness in bending_spans(rig, truth, values["position"] - half, values["position"] + half):
        whole = stiffness / (end - start)
        lost = whole - 1.0 / (1.0 / whole + values["compliance"])
        acting.append(Force(on=bend(start, end), law=mouth, constants=(lost, angle)))
    return tuple(acting)


@law
def mouth(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return the moments in x and y; p = stiffness lost when open, signed angle of the mouth.

    Slopes that fall along the shaft, towards the mouth, bulge it out on that side: the mouth is stretched and opens.
    """
    c, s = math.cos(turn.angle + p[1]), math.sin(turn.angle + p[1])
    towards = c * motion.x + s * motion.y
    if towards >= 0.0:
        return 0.0, 0.0
    return p[0] * towards * c, p[0] * towards * s
