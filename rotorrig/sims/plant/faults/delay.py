"""The vibration channels are late against the keyphasor: a converter that takes its channels in turn, or a filter.

A converter of s conversions per second takes the n-th channel of a scan (n - 1) / s after the first; a Butterworth
anti-alias filter of second order and corner f delays low frequencies by sqrt(2) / (2 pi f), the slope of its phase.
All probes are delayed alike, the keyphasor is not.
"""

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.chain import Chain
from rotorrig.sims.plant.faults.base import LogUniform, Values

PARAMETERS: dict[str, float] = {"time": 1.5e-4}  # s
SIZE = ("time",)
RANGE = {"time": LogUniform(2e-5, 4e-4)}


def sensors(rig: RigConfig, chain: Chain, values: Values) -> Chain:
    """Return `chain` with all probes late."""
    return chain._replace(delay=chain.delay + values["time"])
