"""A balance screw that moves once: from some speed on, or from some time on, the disk's unbalance is another.

What holds the screw gives way when the centrifugal force passes it, and it does not come back.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.description import RigConfig
from rotorrig.sims.plant.faults.base import Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import disk_of_number, sense
from rotorrig.sims.plant.sizes import ANY_PHASE, LogUniform, Uniform
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "amount": 4e-6,  # kg m, by which the unbalance changes
    "angle": -1.2,  # rad from shaft angle zero, in the sense of rotation
    "speed": 300.0,  # rad/s, the first time it is passed
    "time": 0.0,  # s of the plant's clock, before which nothing happens
    "disk": 0.0,  # its number in the config, from 0
}
SIZE = ("amount",)
RANGE = {"amount": LogUniform(2e-7, 8e-6), "angle": ANY_PHASE, "speed": Uniform(100.0, 370.0)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the pull of what has moved."""
    disk = disk_of_number(rig, values["disk"])
    constants = (values["amount"], sense(rig) * values["angle"], values["speed"], values["time"])
    return (Force(on=at(disk.position), law=moved, constants=constants, memory=1),)


@law
def moved(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = change of unbalance, signed angle, speed and time of it; remembers that it happened."""
    after[0] = max(before[0], 1.0 if turn.t >= p[3] and abs(turn.omega) >= p[2] else 0.0)
    psi = turn.angle + p[1]
    c, s = math.cos(psi), math.sin(psi)
    U, square = after[0] * p[0], turn.omega * turn.omega
    return U * (square * c + turn.alpha * s), U * (square * s - turn.alpha * c)
