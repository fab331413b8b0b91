"""A bow: the shaft was heated on one side at one place, by a rub or a torch, and the bend has stayed.

Heat runs off along a rod to either side of the spot and falls by e within `SPREAD` (Incropera and DeWitt, Fundamentals
of Heat and Mass Transfer (1985), sec. 3.6, the long fin); the curvature is in proportion to the difference of
temperature across the shaft (Boley and Weiner, Theory of Thermal Stresses (1960), ch. 10). So the shaft is bent
sharply near the spot and hardly elsewhere. A piece that is curved without load carries the bending moment
E I (curvature - that curvature): the bow is a pair of opposite moments at the ends of each piece that turn with the
shaft: no reaction, no growth with speed.
"""

import math

import numpy as np

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
RANGE = {"amount": LogUniform(1.2e-5, 4e-5), "angle": ANY_PHASE}
SPOT = 0.42  # of the way from the first bearing to the last, where it was heated
SPREAD = 0.075  # m: sqrt(k d / 4 h) of steel of 10 mm, k = 45 W/m K, h = 20 W/m^2 K in air
PIECES = 6  # of even curvature


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the pair of moments of each piece of the bow."""
    places = [b.position for b in rig.bearings]
    start, end = min(places), max(places)
    spans = bending_spans(rig, truth, *np.linspace(start, end, PIECES + 1).tolist())
    spot = start + SPOT * (end - start)
    curved = [_mean_heat(a - spot, b - spot) for a, b, _ in spans]
    scale = values["amount"] / _bulge(start, end, [(a, b, c) for (a, b, _), c in zip(spans, curved, strict=True)])
    angle = sense(rig) * values["angle"]
    return tuple(
        Force(on=bend(a, b), law=turning_force, constants=(-scale * c * stiffness, angle))
        for (a, b, stiffness), c in zip(spans, curved, strict=True)
    )


def _mean_heat(a: float, b: float) -> float:
    """Return the mean of exp(-|s| / SPREAD) from s = a to b.

    >>> round(_mean_heat(-0.001, 0.001), 3), round(_mean_heat(0.075, 0.0751), 3)
    (0.993, 0.368)
    """

    def up_to(s: float) -> float:
        return math.copysign(SPREAD * (1.0 - math.exp(-abs(s) / SPREAD)), s)

    return (up_to(b) - up_to(a)) / (b - a)


def _bulge(start: float, end: float, pieces: list[tuple[float, float, float]]) -> float:
    """Return how far the middle stands off the line between the ends, of pieces of even curvature.

    A kink of one at s, between ends a length L apart, lifts the middle by min(s, L - s) / 2.

    >>> _bulge(0.0, 0.4, [(0.0, 0.2, 1.0), (0.2, 0.4, 1.0)])  # an arc: L^2 / 8
    0.02
    """
    middle = (start + end) / 2
    lift = 0.0
    for a, b, curvature in pieces:
        for p, q in ((a, min(b, middle)), (max(a, middle), b)):
            if q > p:
                near = (p + q) / 2 - start if q <= middle else end - (p + q) / 2
                lift += curvature * (q - p) * near / 2
    return round(lift, 15)
