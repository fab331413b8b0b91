"""A disk loose on its shaft: it hangs on it like a ring on a rod and falls behind a little with every turn.

Rolling without slip, a bore of radius R + c turns once while the shaft in it, of radius R, turns (R + c) / R times: it
loses c / (R + c) of every turn, and the heavy spot wanders round the shaft. So it goes while the weight of the disk
exceeds the pull of its unbalance, here up to 700 rad/s.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import disk_of_number, sense
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "clearance": 2e-6,  # m, radial: 0.14 degrees per turn on a shaft of 10 mm
    "disk": 0.0,  # its number in the config, from 0
}
SIZE = ("clearance",)
RANGE = {"clearance": LogUniform(1e-7, 1e-5)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the pull of every unbalance on the disk where it has wandered, less its pull where it was."""
    disk = disk_of_number(rig, values["disk"])
    loss = values["clearance"] / (rig.shaft.diameter / 2 + values["clearance"])
    carried = [u for u in (*truth.unbalances, *truth.trial) if u.disk == disk.name]
    return tuple(
        Force(on=at(disk.position), law=wandering_unbalance, constants=(u.amount, sense(rig) * u.angle, loss), memory=1)
        for u in carried
    )


@law
def wandering_unbalance(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = unbalance, signed angle, share of a turn lost; remembers the angle lost."""
    after[0] = before[0] + p[2] * turn.omega * turn.step
    was = turn.angle + p[1]
    now = was - after[0]
    c, s = math.cos(now) - math.cos(was), math.sin(now) - math.sin(was)
    square = turn.omega * turn.omega
    return p[0] * (square * c + turn.alpha * s), p[0] * (square * s - turn.alpha * c)
