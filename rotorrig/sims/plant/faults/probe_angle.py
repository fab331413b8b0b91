"""A probe that does not point where the drawing says: its bracket is turned round the shaft.

It sees the component of the motion along its true direction; API 670 allows 5 degrees.
"""

import math
from dataclasses import replace

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import AnyProbe, LogUniform, Values
from rotorrig.sims.plant.places import probe_of_number
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "turn": math.radians(5.0),  # rad from +x towards +y, on top of the drawing's own error
    "probe": 1.0,  # its number in the config, from 0
}
SIZE = ("turn",)
RANGE = {"turn": LogUniform(math.radians(6.0), math.radians(20.0), either_sign=True), "probe": AnyProbe()}


def deviations(rig: RigConfig, truth: Truth, values: Values) -> Truth:
    """Return `truth` with one probe turned."""
    errors = list(truth.probe_angle_errors)
    errors[probe_of_number(rig, values["probe"])] += values["turn"]
    return replace(truth, probe_angle_errors=tuple(errors))
