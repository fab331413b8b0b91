"""Mains in the probe cables: a ground loop adds a voltage to all probes, whatever the shaft does, to each its own.

A tone at the mains' frequency and its third harmonic, which a saturated transformer makes, picked up by cables that run
unlike lengths beside the supply's, inductively and so with unlike phases too (Ott, Electromagnetic Compatibility
Engineering (2009), ch. 2 and 3; the spread is an estimate). The mains stray about their frequency, see
`sensors.chain`. It meets 1X at 3000 rpm, 2X at 1500 rpm.
"""

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Values
from rotorrig.sims.plant.sensors import MAINS, Chain

PARAMETERS: dict[str, float] = {
    "amount": 1e-6,  # m, what the probes make of it on the average
    "phase": 0.5,  # rad when the plant's clock starts
    "frequency": MAINS,  # Hz
    "third": 0.3,  # of the amount, at three times the frequency
}
SIZE = ("amount",)
RANGE = {"amount": LogUniform(7e-7, 5e-6), "phase": ANY_PHASE}
SPREAD = 0.25  # of the amount, and in rad: the most by which a probe's differs from the average


def sensors(rig: RigConfig, chain: Chain, values: Values) -> Chain:
    """Return `chain` with two more tones; from the first probe to the last the cables grow longer."""
    probes = len(rig.probes)
    longer = np.linspace(-1.0, 1.0, probes) if probes > 1 else np.zeros(1)
    tones = np.empty((2, probes, 3))
    for tone, order, share in zip(tones, (1.0, 3.0), (1.0, values["third"]), strict=True):
        tone[:, 0] = share * values["amount"] * (1.0 + SPREAD * longer)
        tone[:, 1] = order * values["frequency"]
        tone[:, 2] = order * (values["phase"] + SPREAD * longer)
    return chain._replace(tones=np.concatenate([chain.tones, tones]))
