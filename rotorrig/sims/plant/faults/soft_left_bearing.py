"""A bearing taken for stiff that gives: an O-ring or a plastic bush between its outer ring and its housing.

The compliances of bearing and seat add up, in both directions alike; only the shape of the whirl tells.
"""

from dataclasses import replace

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.places import held_bearings
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {"compliance": 1.25e-6}  # m/N of the seat, one per bearing
SIZE = ("compliance",)
RANGE = {"compliance": LogUniform(5e-8, 3e-6)}


def deviations(rig: RigConfig, truth: Truth, values: Values) -> Truth:
    """Return `truth` with a soft seat under the bearings a fit takes from the nameplate."""
    held = {b.name for b in held_bearings(rig)}
    seat = values["compliance"]
    bearings = tuple(
        replace(b, kxx=b.kxx / (1.0 + b.kxx * seat), kyy=b.kyy / (1.0 + b.kyy * seat)) if b.name in held else b
        for b in truth.bearings
    )
    return replace(truth, bearings=bearings)
