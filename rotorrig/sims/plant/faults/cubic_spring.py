"""A bearing that stiffens as it is pushed further: its ring hangs on short wires along the shaft, which stretch.

A straight wire of half length a and stiffness E A / a, moved sideways by r in its middle, is longer by
sqrt(a^2 + r^2) - a and pulls back with 2 E A / a (1 - a / sqrt(a^2 + r^2)) r (Nayfeh and Mook, Nonlinear Oscillations
(1979), sec. 1.1). That begins as E A / a^3 r^3 and falls short of it as the wire turns into the pull. The wires were
straight before the rotor was laid in: its weight has stretched them already, and they are stiffer along gravity, and
upwards softer than downwards.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "k3": 5e10,  # N/m^3 for small motion: at 250 um 3.1 kN/m more of secant stiffness
    "half_length": 1e-3,  # m of a wire; an estimate: longer ones hardly stretch
}
SIZE = ("k3",)
RANGE = {"k3": LogUniform(2e9, 1e11)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the pull of the wires at each bearing sought."""
    a = values["half_length"]
    constants = (2.0 * values["k3"] * a * a, a)
    return tuple(Force(on=at(b.position), law=wires, constants=constants) for b in sought_bearings(rig))


@law
def wires(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = 2 E A / a, half length a."""
    square = (motion.x * motion.x + motion.y * motion.y) / (p[1] * p[1])
    root = math.sqrt(1.0 + square)
    k = p[0] * square / (root * (root + 1.0))  # 1 - 1 / root, without loss of digits
    return -k * motion.x, -k * motion.y
