"""A bearing taken for stiff that gives: an O-ring or a plastic bush between its outer ring and its housing.

The compliances of bearing and seat add up. The seat is rubber, which lags: its stiffness is k (1 + j loss), so that the
two in series damp as well, as a dashpot does at `SPEED`; and the ring is pressed flat by the weight, which makes it
stiffer along gravity (Smalley, Darlow and Mehta, The dynamic characteristics of O-rings, J. Mech. Design 100 (1978)
132: a loss factor of 0.1 to 0.3, and stiffness up with the squeeze; the flattening is an estimate).
"""

from dataclasses import replace

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.places import held_bearings
from rotorrig.sims.plant.truth import BearingTruth, Truth

PARAMETERS: dict[str, float] = {"compliance": 1.25e-6}  # m/N of the seat, one per bearing
SIZE = ("compliance",)
RANGE = {"compliance": LogUniform(5e-7, 5e-6)}
LOSS = 0.15
SPEED = 230.0  # rad/s
FLATTENED = 0.8  # compliance along gravity over that across it


def deviations(rig: RigConfig, truth: Truth, values: Values) -> Truth:
    """Return `truth` with a soft seat under the bearings a fit takes from the nameplate."""
    held = {b.name for b in held_bearings(rig)}
    upright = 1.0 if rig.gravity == "none" else FLATTENED
    x, y = (upright, 1.0) if rig.gravity == "-x" else (1.0, upright)
    seat = values["compliance"]
    bearings = tuple(_on_a_seat(b, x * seat, y * seat) if b.name in held else b for b in truth.bearings)
    return replace(truth, bearings=bearings)


def _on_a_seat(bearing: BearingTruth, x: float, y: float) -> BearingTruth:
    """Return `bearing` in series with rubber of the compliances x and y [m/N]."""
    along = 1.0 / (1.0 / complex(bearing.kxx, SPEED * bearing.cxx) + x / complex(1.0, LOSS))
    across = 1.0 / (1.0 / complex(bearing.kyy, SPEED * bearing.cyy) + y / complex(1.0, LOSS))
    return replace(bearing, kxx=along.real, kyy=across.real, cxx=along.imag / SPEED, cyy=across.imag / SPEED)
