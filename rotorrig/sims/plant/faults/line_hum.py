"""Mains in the probe cables: a ground loop adds the same voltage to all probes, whatever the shaft does.

A tone at the mains' frequency and its third harmonic, which a saturated transformer makes (Ott, Electromagnetic
Compatibility Engineering (2009), ch. 3); it meets 1X at 3000 rpm, 2X at 1500 rpm.
"""

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.chain import MAINS, Chain
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Values

PARAMETERS: dict[str, float] = {
    "amount": 1e-6,  # m, what a probe makes of it
    "phase": 0.5,  # rad when the plant's clock starts
    "frequency": MAINS,  # Hz
    "third": 0.3,  # of the amount, at three times the frequency
}
SIZE = ("amount",)
RANGE = {"amount": LogUniform(1e-7, 3e-6), "phase": ANY_PHASE}


def sensors(rig: RigConfig, chain: Chain, values: Values) -> Chain:
    """Return `chain` with two more tones."""
    amount, frequency, phase = (values[name] for name in ("amount", "frequency", "phase"))
    tones = [[amount, frequency, phase], [values["third"] * amount, 3.0 * frequency, 3.0 * phase]]
    return chain._replace(tones=np.concatenate([chain.tones, tones]))
