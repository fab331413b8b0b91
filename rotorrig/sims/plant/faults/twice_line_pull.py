"""A pull on the disk at twice the line frequency: a coil on the mains stands beside it.

A pull goes as the square of the field and has no sign: half of it stands still, the other half swings at twice the
line's frequency, whatever the shaft does (Finley, Hodowanec and Holter, An analytical approach to solving motor
vibration problems, IEEE Trans. Ind. Appl. 36 (2000) 1467). It is no order of the shaft: a line in the spectrum at 100
Hz, which 2X meets at 3000 rpm. The gap is wide against the motion.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import disk_of_number
from rotorrig.sims.plant.sensors import MAINS
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "pull": 1.0,  # N, on the average: as much swings, 0-peak
    "angle": 0.5,  # rad from x towards y, where to
    "phase": 0.3,  # rad of the swing when the plant's clock starts
    "frequency": MAINS,  # Hz of the line
    "disk": 0.0,  # its number in the config, from 0
}
SIZE = ("pull",)
RANGE = {"pull": LogUniform(0.02, 2.0), "angle": ANY_PHASE, "phase": ANY_PHASE}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the pull on the disk."""
    disk = disk_of_number(rig, values["disk"])
    towards = (math.cos(values["angle"]), math.sin(values["angle"]))
    constants = (values["pull"], *towards, 2.0 * math.tau * values["frequency"], values["phase"])
    return (Force(on=at(disk.position), law=coil, constants=constants),)


@law
def coil(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = mean pull, cosine and sine of its direction, rad/s and phase of its swing."""
    pull = p[0] * (1.0 + math.cos(p[3] * turn.t + p[4]))
    return pull * p[1], pull * p[2]
