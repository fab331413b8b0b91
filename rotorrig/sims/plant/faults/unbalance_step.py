"""A balance screw that is lost, once and for all: from some moment on the disk's unbalance is another.

What holds the screw gives way when the centrifugal force passes it on the way up, or, where the force itself had wedged
it, when the force falls again on the way down. It does not come back: that happens in one recording of the rig, or
while it stands still between two, and every later recording begins without the screw, whatever speeds it runs through.
It creeps out of its thread and is gone by e within `LEAVING`: a ramp of the unbalance, no step (an estimate; after
Muszynska, Rotordynamics (2005), on loose rotating parts, whose 1X vector changes over some seconds).
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, OneOf, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, heavy_spot, law
from rotorrig.sims.plant.places import disk_of_number, sense
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "amount": 4e-6,  # kg m, by which the unbalance changes
    "angle": -1.2,  # rad from shaft angle zero, in the sense of rotation
    "speed": 300.0,  # rad/s, the first time it is passed; negative: the first time the shaft falls to it from above
    "time": 0.0,  # s of the plant's clock, before which nothing happens
    "run": 0.0,  # the recording it happens in, from 0; 0.5: between the first two
    "disk": 0.0,  # its number in the config, from 0
}
SIZE = ("amount",)
RANGE = {
    "amount": LogUniform(2e-7, 8e-6),
    "angle": ANY_PHASE,
    "speed": LogUniform(100.0, 360.0, either_sign=True),
    "run": OneOf((0.0, 0.5, 1.0)),
}
LEAVING = 0.5  # s
WEDGED = 1.02  # times the speed it falls out at, which the shaft has to have passed: a drive's hunting is no falling


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the pull of what has moved; none in a recording before the one it moves in."""
    if truth.run < values["run"]:
        return ()
    disk = disk_of_number(rig, values["disk"])
    angle = sense(rig) * values["angle"]
    if truth.run > values["run"]:
        return (Force(on=at(disk.position), law=heavy_spot, constants=(values["amount"], angle)),)
    constants = (values["amount"], angle, values["speed"], values["time"])
    return (Force(on=at(disk.position), law=lost_unbalance, constants=constants, memory=2),)


@law
def lost_unbalance(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = change of unbalance, signed angle, speed and time of it.

    Remembers how much of it has happened, and the highest speed so far.
    """
    speed = abs(turn.omega)
    after[1] = max(before[1], speed)
    due = speed >= p[2] if p[2] >= 0.0 else speed <= -p[2] and after[1] >= -WEDGED * p[2]
    leaves = before[0] > 0.0 or (due and turn.t >= p[3])
    after[0] = (before[0] + turn.step / LEAVING) / (1.0 + turn.step / LEAVING) if leaves else 0.0
    psi = turn.angle + p[1]
    c, s = math.cos(psi), math.sin(psi)
    U, square = after[0] * p[0], turn.omega * turn.omega
    return U * (square * c + turn.alpha * s), U * (square * s - turn.alpha * c)
