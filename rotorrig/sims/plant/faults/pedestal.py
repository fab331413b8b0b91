"""A bearing on a pedestal that gives: a mass on springs of its own between bearing and ground.

Bearing and pedestal are in series, so that what the shaft feels dips and peaks about the pedestal's own frequencies
(Gasch, Nordmann and Pfuetzner, Rotordynamik, 2nd ed. 2002). The probes stand on the ground. The pedestal's weight was
there before the shaft was aligned and moves nothing.
"""

import math

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Uniform, Values
from rotorrig.sims.plant.places import sought_bearings, true_bearing
from rotorrig.sims.plant.shaft import Rotor
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "compliance": 4e-6,  # m/N in x, of the pedestal alone: 8 kg at 28 Hz
    "frequency": 28.0,  # Hz in x, of the pedestal alone
    "aspect": 0.1,  # compliance in y over that in x
    "damping_ratio": 0.04,  # in x and y
}
SIZE = ("compliance",)
RANGE = {
    "compliance": LogUniform(1e-7, 6e-6),
    "frequency": Uniform(20.0, 35.0),
    "damping_ratio": Uniform(0.02, 0.06),
}


def structure(rig: RigConfig, truth: Truth, rotor: Rotor, values: Values) -> Rotor:
    """Return `rotor` with a pedestal under each bearing sought."""
    for bearing in sought_bearings(rig):
        b = true_bearing(truth, bearing)
        K, C = np.array([[b.kxx, b.kxy], [b.kyx, b.kyy]]), np.array([[b.cxx, b.cxy], [b.cyx, b.cyy]])
        rotor = _on_a_pedestal(rotor, rotor.station(bearing.position), K, C, values)
    return rotor


def _on_a_pedestal(rotor: Rotor, station: int, K: NDArray, C: NDArray, values: Values) -> Rotor:
    """Return `rotor` with the bearing `K`, `C` at `station` on a mass with springs instead of on the ground."""
    wide = rotor.with_coordinate()
    journal, mass = [station, station + wide.n], [wide.n - 1, 2 * wide.n - 1]
    for whole, bearing in ((wide.K, K), (wide.C, C)):
        whole[np.ix_(mass, mass)] += bearing
        whole[np.ix_(journal, mass)] -= bearing
        whole[np.ix_(mass, journal)] -= bearing
    kilograms = 1.0 / (values["compliance"] * (math.tau * values["frequency"]) ** 2)
    for i, share in zip(mass, (1.0, values["aspect"]), strict=True):
        k = 1.0 / (values["compliance"] * share)
        wide.M[i, i] += kilograms
        wide.K[i, i] += k
        wide.C[i, i] += 2.0 * values["damping_ratio"] * math.sqrt(k * kilograms)
    return wide
