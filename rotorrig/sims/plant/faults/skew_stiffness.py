"""A bearing's seal that pushes the shaft sideways, ahead in its whirl, the harder the more torque it takes.

Where the gap is narrow the fluid drags more, where it is wide less: what is left is a force a quarter turn ahead of the
displacement, in proportion to the torque, k = efficiency * torque / (diameter * height) (Alford, Protecting
turbomachinery from self-excited rotor whirl, J. Eng. Power 87 (1965) 333). The torque of a laminar film grows with the
speed. It feeds forward whirl and damps backward whirl. The seal stands about the shaft where it rests.
"""

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "stiffness": 1000.0,  # N/m at the reference speed; unstable above the bearing's damping times w: 3500 N/m
    "reference": 230.0,  # rad/s
}
SIZE = ("stiffness",)
RANGE = {"stiffness": LogUniform(150.0, 1800.0)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the sideways push at each bearing sought."""
    constants = (values["stiffness"] / values["reference"],)
    return tuple(Force(on=at(b.position), law=push, constants=constants, from_rest=True) for b in sought_bearings(rig))


@law
def push(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = stiffness per speed. Turning x to y, a shaft out along x is pushed along +y."""
    k = p[0] * turn.omega
    return -k * motion.y, k * motion.x
