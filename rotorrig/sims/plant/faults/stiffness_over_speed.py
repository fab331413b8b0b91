"""A bearing that grows stiffer with speed: the balls are thrown outwards and preload it.

The centrifugal force of a ball goes as W^2, and with it, while it is small, the preload and what that adds to the
stiffness (Harris and Kotzalas, Advanced Concepts of Bearing Technology, 5th ed. 2006). The preload holds the
shaft where it rests, so the spring added pulls it there.
"""

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings, true_bearing
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "gain": 0.08,  # of the stiffness at standstill, more at the reference speed
    "reference": 230.0,  # rad/s
}
SIZE = ("gain",)
RANGE = {"gain": LogUniform(0.005, 0.15, either_sign=True)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the spring that speed adds to each bearing sought."""
    share = values["gain"] / values["reference"] ** 2
    laws = [(b.position, true_bearing(truth, b)) for b in sought_bearings(rig)]
    return tuple(
        Force(on=at(position), law=spring, constants=(share * b.kxx, share * b.kyy), from_rest=True)
        for position, b in laws
    )


@law
def spring(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = stiffness in x and y per square of the speed."""
    square = turn.omega * turn.omega
    return -p[0] * square * motion.x, -p[1] * square * motion.y
