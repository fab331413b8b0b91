"""An unbalance that drifts while the rig runs: a disk that is warmed unevenly, or takes on dirt, until it has its fill.

A disk clamped on one side only warms from there; heat comes at a steady rate and leaves in proportion to what the disk
is warmer by, so that its centre of gravity moves as 1 - exp(-t / T), the response of a lumped heat capacity (Incropera
and DeWitt, Fundamentals of Heat and Mass Transfer, 2nd ed. 1985, sec. 5.1; that rotors' vibration drifts so for minutes
after a change of heating: Zawoysky and Genovese, Generator rotor thermal sensitivity, GE Power Systems GER-3809
(2001)). Between two recordings it has cooled: each begins from zero. So slow a drift pulls as the unbalance it has come
to: what its own speed and acceleration add is less by 1 / (W T).
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import disk_of_number, sense
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "amount": 4e-6,  # kg m, that it tends to
    "angle": 1.0,  # rad from shaft angle zero, in the sense of rotation
    "time": 80.0,  # s, in which 63 % of it is there: a default sweep is at full speed after two minutes
    "disk": 0.0,  # its number in the config, from 0
}
SIZE = ("amount",)
RANGE = {"amount": LogUniform(1e-6, 1.2e-5), "angle": ANY_PHASE, "time": LogUniform(30.0, 300.0)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the pull of what has drifted."""
    disk = disk_of_number(rig, values["disk"])
    constants = (values["amount"], sense(rig) * values["angle"], values["time"])
    return (Force(on=at(disk.position), law=drifting_unbalance, constants=constants),)


@law
def drifting_unbalance(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = unbalance in the end, signed angle, time constant."""
    U = -p[0] * math.expm1(-turn.t / p[2])
    psi = turn.angle + p[1]
    c, s = math.cos(psi), math.sin(psi)
    square = turn.omega * turn.omega
    return U * (square * c + turn.alpha * s), U * (square * s - turn.alpha * c)
