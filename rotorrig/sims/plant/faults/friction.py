"""Dry friction at a bearing: its housing sticks in its seat until it is pushed hard enough, then slides.

A spring as stiff as the roughness of the surfaces in series with a slider, in the plane: the force follows the motion
elastically, and where it would exceed the limit it keeps its direction and stays at it (Iwan, J. Appl. Mech. 33 (1966)
893; return mapping as in Simo and Hughes, Computational Inelasticity (1998), ch. 3). It needs no smoothed sign of the
velocity, and it sticks.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "limit": 0.05,  # N, where it begins to slide
    "stuck_stiffness": 1e5,  # N/m: slides after half a micrometre
}
SIZE = ("limit",)
RANGE = {"limit": LogUniform(3e-3, 0.15)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the friction at each bearing sought, at ease where the shaft rests."""
    constants = (values["limit"], values["stuck_stiffness"])
    return tuple(
        Force(on=at(b.position), law=slider, constants=constants, memory=4, from_rest=True)
        for b in sought_bearings(rig)
    )


@law
def slider(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = limit, stuck stiffness; remembers x, y and the force there."""
    fx = before[2] - p[1] * (motion.x - before[0])
    fy = before[3] - p[1] * (motion.y - before[1])
    size = math.hypot(fx, fy)
    if size > p[0]:
        fx, fy = fx * p[0] / size, fy * p[0] / size
    after[0], after[1], after[2], after[3] = motion.x, motion.y, fx, fy
    return fx, fy
