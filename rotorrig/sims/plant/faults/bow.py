"""A residual bow: the shaft is bent for good between its outermost bearings, along a circular arc.

A piece of shaft that is curved without load carries the bending moment E I (curvature - that curvature), so the bow
is a pair of opposite moments at the ends of the arc that turn with the shaft: no reaction, no growth with speed
(Boley and Weiner, Theory of Thermal Stresses (1960), where a temperature gradient bends the beam).
"""

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, bend, turning_force
from rotorrig.sims.plant.places import bending_spans, sense
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "amount": 1e-5,  # m, midway between the outermost bearings, off the straight line through them
    "angle": 0.6,  # rad from shaft angle zero, in the sense of rotation: where it bulges
}
SIZE = ("amount",)
RANGE = {"amount": LogUniform(1e-6, 2.5e-5), "angle": ANY_PHASE}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the pair of moments of each span of the arc."""
    places = [b.position for b in rig.bearings]
    start, end = min(places), max(places)
    curvature = -8.0 * values["amount"] / (end - start) ** 2  # of the arc b (1 - (2 s / L)^2), which bulges outwards
    angle = sense(rig) * values["angle"]
    return tuple(
        Force(on=bend(a, b), law=turning_force, constants=(stiffness * curvature, angle))
        for a, b, stiffness in bending_spans(rig, truth, start, end)
    )
