"""A pedestal bolt that opens once per turn: lifted far enough, the bearing loses part of its vertical stiffness.

Pressed down, the pedestal stands on its base; pulled up beyond the bolt's preload it hangs on the bolt alone. The
stiffness has two values in one turn (Muszynska and Goldman, Chaos, Solitons & Fractals 5 (1995) 1683).
"""

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings, true_bearing
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "loss": 0.3,  # of the vertical stiffness, while open
    "lift": 5e-6,  # m above rest, where it opens
}
SIZE = ("loss",)
RANGE = {"loss": LogUniform(0.03, 0.5), "lift": LogUniform(1e-6, 4e-5)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the force that the open pedestal does not carry."""
    laws = [(b.position, true_bearing(truth, b)) for b in sought_bearings(rig)]
    return tuple(
        Force(on=at(position), law=opening, constants=(values["loss"] * b.kyy, values["lift"]), from_rest=True)
        for position, b in laws
    )


@law
def opening(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = stiffness lost while open, lift where it opens."""
    return 0.0, p[0] * max(motion.y - p[1], 0.0)
