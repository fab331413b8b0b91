"""A bearing that sits loosely in its seat: within the gap nothing holds the shaft, beyond it the bearing does.

The outer ring lies at the bottom of its seat under the weight and rattles when the whirl lifts it (Childs, J. Eng.
Power 104 (1982) 533, fractional-frequency motion due to clearance). The law takes from the linear bearing what the
gap does not let it carry: its stiffness times the part of the displacement inside the gap. The damping stays.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings, true_bearing
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {"gap": 1e-5}  # m, radial
SIZE = ("gap",)
RANGE = {"gap": LogUniform(1e-6, 2.5e-5)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the force that the gap takes from each bearing sought."""
    laws = [(b.position, true_bearing(truth, b)) for b in sought_bearings(rig)]
    return tuple(Force(on=at(position), law=slack, constants=(values["gap"], b.kxx, b.kyy)) for position, b in laws)


@law
def slack(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = gap, stiffness in x and y."""
    r = math.hypot(motion.x, motion.y)
    inside = 1.0 if r <= p[0] else p[0] / r
    return p[1] * inside * motion.x, p[2] * inside * motion.y
