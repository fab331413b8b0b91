"""A probe set at the end of its linear range, or before a shaft too thin for it: its scale factor bends.

The field of an eddy-current coil falls off with distance, so that the volts per metre change along the gap, the more so
before a round target hardly wider than the tip: the chapter's shaft has 10 mm, a usual tip 8 mm.
"""

from dataclasses import replace

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import AnyProbe, LogUniform, Values
from rotorrig.sims.plant.places import probe_of_number
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "quadratic": 0.03,  # of the scale factor, 300 um nearer than the gap voltage
    "cubic": 0.03,  # of the scale factor, 300 um to either side
    "probe": 1.0,  # its number in the config, from 0
}
SIZE = ("quadratic", "cubic")
RANGE = {
    "quadratic": LogUniform(0.005, 0.08, either_sign=True),
    "cubic": LogUniform(0.005, 0.08, either_sign=True),
    "probe": AnyProbe(),
}


def deviations(rig: RigConfig, truth: Truth, values: Values) -> Truth:
    """Return `truth` with one probe's scale factor bent."""
    curvatures = list(truth.probe_curvatures)
    probe = probe_of_number(rig, values["probe"])
    quadratic, cubic = curvatures[probe]
    curvatures[probe] = (quadratic + values["quadratic"], cubic + values["cubic"])
    return replace(truth, probe_curvatures=tuple(curvatures))
