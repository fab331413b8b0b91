"""A ball bearing that grows stiffer with speed: the balls are thrown against the outer race.

Hertz's contact is as stiff as the cube root of its load, and to the preload on the outer race comes the balls'
centrifugal force, which goes as W^2: its stiffness grows as (1 + (W / W_r)^2)^(1/3), fast at first and slower when the
centrifugal force outweighs the preload, here at the reference speed (Jones, A general theory for elastically
constrained ball and radial roller bearings, J. Basic Eng. 82 (1960) 309; Harris, Rolling Bearing Analysis (1966)). A
negative gain is an angular contact bearing whose contact angle opens by as much. The preload holds the shaft where it
rests, so the spring added pulls it there.
"""

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings, true_bearing
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "gain": 0.08,  # of the stiffness at standstill, more at the reference speed
    "reference": 230.0,  # rad/s, where the balls press outwards by as much as the preload
}
SIZE = ("gain",)
RANGE = {"gain": LogUniform(0.015, 0.15, either_sign=True)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the spring that speed adds to each bearing sought."""
    share = values["gain"] / (2.0 ** (1.0 / 3.0) - 1.0)
    laws = [(at(b.position), true_bearing(truth, b)) for b in sought_bearings(rig)]
    return tuple(
        Force(on=place, law=spring, constants=(share * b.kxx, share * b.kyy, values["reference"]), from_rest=True)
        for place, b in laws
    )


@law
def spring(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = stiffness in x and y that the gain adds per unit of the law, reference speed."""
    ratio = turn.omega / p[2]
    grown = (1.0 + ratio * ratio) ** (1.0 / 3.0) - 1.0
    return -p[0] * grown * motion.x, -p[1] * grown * motion.y
