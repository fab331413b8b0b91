"""Square-law drag on the disk: it moves through oil, and what it pushes aside goes turbulent.

F = -c |v| v with c = density * drag coefficient * area / 2 (Batchelor, An Introduction to Fluid Dynamics
(1967)): 1 N s^2/m^2 for a disk of 75 mm by 25 mm in oil, more in a narrow bath; a thousandth of that in air.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import disk_of_number
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "coefficient": 10.0,  # N s^2/m^2
    "disk": 0.0,  # its number in the config, from 0
}
SIZE = ("coefficient",)
RANGE = {"coefficient": LogUniform(0.5, 30.0)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the drag on the disk."""
    disk = disk_of_number(rig, values["disk"])
    return (Force(on=at(disk.position), law=drag, constants=(values["coefficient"],)),)


@law
def drag(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = coefficient."""
    c = p[0] * math.hypot(motion.vx, motion.vy)
    return -c * motion.vx, -c * motion.vy
