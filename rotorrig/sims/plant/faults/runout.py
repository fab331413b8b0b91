"""Run-out of the surface under one probe plane: an eccentric, slightly oval track, not a motion of the shaft.

A surface of radius R + e cos(phi - a) + o cos 2(phi - b) in the shaft's own angle phi comes nearer to a probe by what
stands under it; every probe of the plane sees the same track. API 670 allows a quarter of the vibration allowed.
"""

import math

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.chain import Chain, phasors_at
from rotorrig.sims.plant.faults.base import ANY_PHASE, AnyProbe, LogUniform, Values
from rotorrig.sims.plant.places import probe_of_number, same_plane

PARAMETERS: dict[str, float] = {
    "eccentricity": 6e-6,  # m, once per turn
    "angle": 0.9,  # rad from shaft angle zero, in the sense of rotation: where it is high
    "oval": 1e-6,  # m, twice per turn
    "oval_angle": 0.0,  # rad, as above
    "probe": 0.0,  # the number of a probe in the plane, from 0
}
SIZE = ("eccentricity", "oval")
RANGE = {
    "eccentricity": LogUniform(1e-6, 1.2e-5),
    "angle": ANY_PHASE,
    "oval": LogUniform(2e-7, 2e-6),
    "oval_angle": ANY_PHASE,
    "probe": AnyProbe(),
}


def sensors(rig: RigConfig, chain: Chain, values: Values) -> Chain:
    """Return `chain` with a rougher track under the probes of one plane."""
    # the probe at angle zero sees e cos(theta + a): the high spot passes it before shaft angle zero
    first = values["eccentricity"] * np.exp(1j * values["angle"])
    second = values["oval"] * np.exp(2j * values["oval_angle"])
    pattern = np.zeros(chain.track.shape[1], complex)
    pattern[:2] = first, second
    track = chain.track.copy()
    for probe in same_plane(rig, probe_of_number(rig, values["probe"])):
        x, y = chain.direction[probe]
        track[probe] += phasors_at(pattern, math.atan2(y, x), rig)
    return chain._replace(track=track)
