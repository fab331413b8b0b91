"""A bearing's spring that stiffens as it is pushed further: leaf springs stretch as well as bend.

The restoring force gains k3 r^3 towards the centre (Duffing; Nayfeh and Mook, Nonlinear Oscillations (1979), sec. 4.1).
The springs are set with the weight on, so the centre is where the shaft rests.
"""

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {"k3": 5e10}  # N/m^3: at 250 um 3.1 kN/m more of secant stiffness
SIZE = ("k3",)
RANGE = {"k3": LogUniform(2e9, 1e11)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the cubic part of the springs of each bearing sought."""
    constants = (values["k3"],)
    return tuple(
        Force(on=at(b.position), law=spring, constants=constants, from_rest=True) for b in sought_bearings(rig)
    )


@law
def spring(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = k3."""
    k = p[0] * (motion.x * motion.x + motion.y * motion.y)
    return -k * motion.x, -k * motion.y
