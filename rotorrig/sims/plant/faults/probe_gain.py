"""A probe whose scale factor is not what its calibration says: another steel, a cut cable, a wrong driver.

The volts per metre depend on the target's conductivity and permeability and on the length of the cable; API 670 allows
5 % from one part to the next.
"""

from dataclasses import replace

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import AnyProbe, LogUniform, Values
from rotorrig.sims.plant.places import probe_of_number
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "gain": 0.05,  # relative, on top of the calibration's own error
    "probe": 1.0,  # its number in the config, from 0
}
SIZE = ("gain",)
RANGE = {"gain": LogUniform(0.07, 0.2, either_sign=True), "probe": AnyProbe()}


def deviations(rig: RigConfig, truth: Truth, values: Values) -> Truth:
    """Return `truth` with one probe's gain off."""
    gains = list(truth.probe_gain_factors)
    gains[probe_of_number(rig, values["probe"])] *= 1.0 + values["gain"]
    return replace(truth, probe_gain_factors=tuple(gains))
