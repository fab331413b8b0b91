"""The vibration channels pass a filter that the keyphasor's does not: the anti-alias filters were left in.

A Butterworth filter of second order and corner f comes late by sqrt(2) / (2 pi f) at low frequency; of what is near the
corner it takes something off, and delays it more (Oppenheim and Willsky, Signals and Systems, 2nd ed. 1997, sec. 6.5).
All probes alike.
"""

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.sensors import Chain

PARAMETERS: dict[str, float] = {"time": 1.5e-4}  # s, at low frequency: a corner of 1.5 kHz
SIZE = ("time",)
RANGE = {"time": LogUniform(6e-5, 4e-4)}


def sensors(rig: RigConfig, chain: Chain, values: Values) -> Chain:
    """Return `chain` with a filter in all probes' channels."""
    return chain._replace(delay=chain.delay + values["time"])
