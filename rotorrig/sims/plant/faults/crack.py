"""A transverse crack that breathes: the more its side of the shaft is stretched, the more of it is open.

It opens gradually with the angle between its mouth and the bending, by (1 + cos) / 2 (Mayes and Davies, Analysis of the
response of a multi-rotor-bearing system containing a transverse crack in a rotor, J. Vib. Acoust. 106 (1984) 139), and
gives way across its mouth too, by a fifth (`ACROSS`: of a crack to 0.4 of the diameter, by the compliances of
Papadopoulos and Dimarogonas, Coupled longitudinal and bending vibrations of a rotating shaft with an open crack, J.
Sound Vib. 117 (1987) 81). Both stand in the energy that the crack stores, from which the moments follow, so that it
makes none. It softens an element of shaft as long as the diameter; the bending is that of weight and vibration
together.
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
ACROSS = 0.2  # of the softening along the mouth


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
    With c = cos of the angle from mouth to bulge and b the bend, the energy lacking is lost / 2 b^2 h,
    h = (1 + c) / 2 (c^2 + across (1 - c^2)): b^2 h = (b + u) / (2 b) (u^2 + across v^2), u along the mouth, v across.
    """
    c, s = math.cos(turn.angle + p[1]), math.sin(turn.angle + p[1])
    b = math.hypot(motion.x, motion.y)
    if b == 0.0:
        return 0.0, 0.0
    u, v = -(c * motion.x + s * motion.y), -(c * motion.y - s * motion.x)
    opens, gives = (1.0 + u / b) / 2.0, u * u + ACROSS * v * v
    # half the derivatives of opens * gives by u and v
    along = opens * u + gives * v * v / (4.0 * b**3)
    aside = opens * ACROSS * v - gives * u * v / (4.0 * b**3)
    return -p[0] * (c * along - s * aside), -p[0] * (s * along + c * aside)
