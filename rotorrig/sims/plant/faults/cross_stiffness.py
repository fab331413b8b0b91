"""The principal axes of a bearing's stiffness are turned: a push along x moves the shaft a little along y.

Four springs of unequal rate, none of them quite along x or y, make a symmetric stiffness matrix with kxy = kyx:
conservative, whatever the sense of rotation: K = R diag(k1, k2) R^T has the off-diagonal (k1 - k2) / 2 sin 2a for
springs turned by a.
"""

from dataclasses import replace

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.places import sought_bearings
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {"stiffness": 2000.0}  # N/m, kxy and kyx
SIZE = ("stiffness",)
RANGE = {"stiffness": LogUniform(60.0, 3000.0, either_sign=True)}


def deviations(rig: RigConfig, truth: Truth, values: Values) -> Truth:
    """Return `truth` with turned axes in the bearings that are sought."""
    sought = {b.name for b in sought_bearings(rig)}
    k = values["stiffness"]
    bearings = tuple(replace(b, kxy=b.kxy + k, kyx=b.kyx + k) if b.name in sought else b for b in truth.bearings)
    return replace(truth, bearings=bearings)
