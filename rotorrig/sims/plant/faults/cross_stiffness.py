"""A spring of a bearing that is too stiff, and stands askew: a push along x moves the shaft a little along y.

Of the springs that carry the bearing one pair, at 45 degrees, is stiffer than it should be, by k along its axis and, as
a coil spring bends sideways too, by `SIDEWAYS` k across it (Wahl, Mechanical Springs, 2nd ed. 1963, ch. 4). In x and y
that is kxy = kyx = (1 - SIDEWAYS) k / 2 and as much more, over (1 - SIDEWAYS) / (1 + SIDEWAYS), on kxx and kyy.
"""

from dataclasses import replace

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.places import sought_bearings
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {"stiffness": 2000.0}  # N/m, kxy and kyx; negative: the pair along x = -y
SIZE = ("stiffness",)
RANGE = {"stiffness": LogUniform(60.0, 3000.0, either_sign=True)}
SIDEWAYS = 0.4  # of a short coil spring's own stiffness: Wahl's curves for a length of about one diameter


def deviations(rig: RigConfig, truth: Truth, values: Values) -> Truth:
    """Return `truth` with a stiffer, askew pair of springs in the bearings that are sought."""
    sought = {b.name for b in sought_bearings(rig)}
    k = values["stiffness"]
    more = abs(k) * (1.0 + SIDEWAYS) / (1.0 - SIDEWAYS)
    bearings = tuple(
        replace(b, kxx=b.kxx + more, kyy=b.kyy + more, kxy=b.kxy + k, kyx=b.kyx + k) if b.name in sought else b
        for b in truth.bearings
    )
    return replace(truth, bearings=bearings)
