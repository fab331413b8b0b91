"""Drag on a disk in oil that it carries round: neither quite of the second power, nor against oil at rest.

The drag coefficient of a cylinder falls with the Reynolds number, about as 1 + 10 Re^(-2/3) (White, Viscous Fluid Flow
(1974), sec. 3-9), so that the force grows with a power between 4/3 and 2 of the speed; and the oil in the narrow bath
turns with the disk at a part of its speed (Muszynska, J. Sound Vib. 110 (1986) 443), so that a forward whirl meets less
of it. In oil 1 N s^2/m^2 is a disk of 75 mm by 25 mm, more in a narrow bath; a thousandth of that in air.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import disk_of_number
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "coefficient": 10.0,  # N s^2/m^2, at `TYPICAL` past the oil
    "disk": 0.0,  # its number in the config, from 0
}
SIZE = ("coefficient",)
RANGE = {"coefficient": LogUniform(1.0, 30.0)}
TYPICAL = 0.03  # m/s: 130 um at the critical speed of the chapter's rig
REYNOLDS = 0.075 / 1e-4  # s/m, times a speed: the disk's diameter in oil of 100 mm^2/s
SWIRL = 0.1  # of the disk's speed, in a bath on one side: an estimate


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the drag on the disk."""
    disk = disk_of_number(rig, values["disk"])
    typical = 1.0 + 10.0 * (REYNOLDS * TYPICAL) ** (-2.0 / 3.0)
    constants = (values["coefficient"] / typical,)
    return (Force(on=at(disk.position), law=drag, constants=constants, from_rest=True),)


@law
def drag(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = coefficient at a high Reynolds number."""
    vx = motion.vx + SWIRL * turn.omega * motion.y
    vy = motion.vy - SWIRL * turn.omega * motion.x
    speed = math.hypot(vx, vy)
    if speed == 0.0:
        return 0.0, 0.0
    c = p[0] * speed * (1.0 + 10.0 * (REYNOLDS * speed) ** (-2.0 / 3.0))
    return -c * vx, -c * vy
