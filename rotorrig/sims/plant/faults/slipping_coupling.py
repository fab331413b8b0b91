"""A misaligned coupling that slips: while the shaft is sped up or slowed down, its hub creeps round the shaft.

The eccentric bore's force turns with the hub, not with the shaft. A clamped hub carries so much torque, the rotor's
inertia times its angular acceleration, by friction; beyond, the bending of every turn works it round the shaft a little
further, as it does a press fit. At constant speed it holds.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sense
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "bore_force": 0.3,  # N, eccentricity of the bore times stiffness of the coupling
    "bore_angle": 0.6,  # rad from shaft angle zero, in the sense of rotation, at the start
    "creep": 0.005,  # turns of the hub back round the shaft, per turn of the shaft
    "holds": 2.0,  # rad/s^2, acceleration it still carries: above the hunting of the drive, below any ramp
}
SIZE = ("bore_force",)
RANGE = {"bore_force": LogUniform(0.03, 0.7), "bore_angle": ANY_PHASE, "creep": LogUniform(1e-3, 0.02)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the hub's force on the driven end of the shaft."""
    constants = (values["bore_force"], sense(rig) * values["bore_angle"], values["creep"], values["holds"])
    return (Force(on=at(0.0), law=hub, constants=constants, memory=1),)


@law
def hub(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = force, signed angle, creep, acceleration carried; remembers the angle crept."""
    slips = abs(turn.alpha) > p[3]
    after[0] = before[0] + (p[2] * turn.omega * turn.step if slips else 0.0)
    psi = turn.angle + p[1] - after[0]
    return p[0] * math.cos(psi), p[0] * math.sin(psi)
