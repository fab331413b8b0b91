"""A magnet beside the disk that draws it to one side, the harder the nearer it comes: a spring of negative stiffness.

At a given magnetomotive force the pull of a pole on iron goes as one over the square of the gap, F (g / (g - u))^2 with
u the disk's motion towards the pole (Maxwell's tension; Schweitzer and Maslen (eds.), Magnetic Bearings (2009), ch. 4).
For small motion that is the constant F and the stiffness -2 F / g along the magnet's axis, none across it. The iron
saturates before the pole is touched: nearer than a fifth of the gap the pull grows no further (an estimate). The magnet
is put up beside the disk at rest; what it then draws it aside by is its own doing.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Uniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import disk_of_number
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "pull": 0.8,  # N on the disk at rest
    "gap": 1.2e-3,  # m, there
    "angle": 0.5,  # rad from x towards y, where the magnet stands
    "disk": 0.0,  # its number in the config, from 0
}
SIZE = ("pull",)
RANGE = {
    "pull": LogUniform(0.05, 1.5),  # with the narrowest gap at most 3 kN/m off a shaft that has 45 at the disk
    "gap": Uniform(1e-3, 2e-3),
    "angle": ANY_PHASE,
}
SATURATED = 0.2  # of the gap


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the pull of the magnet on the disk."""
    disk = disk_of_number(rig, values["disk"])
    constants = (values["pull"], values["gap"], math.cos(values["angle"]), math.sin(values["angle"]))
    return (Force(on=at(disk.position), law=pole, constants=constants, from_rest=True),)


@law
def pole(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = pull at rest, gap there, cosine and sine of the direction."""
    left = max(1.0 - (motion.x * p[2] + motion.y * p[3]) / p[1], SATURATED)
    pull = p[0] / (left * left)
    return pull * p[2], pull * p[3]
