"""Run-out of the surface under one probe plane: an eccentric, oval, scratched track, not a motion of the shaft.

The track is a profile over the shaft's own angle: eccentricity, oval, and a dent where a jaw of the chuck has held it;
a probe is nearer to the surface by what stands under it. Besides, the steel conducts unevenly around, which each probe
takes for a little distance of its own, as its frequency and its gap are its own: electrical run-out (API 670, 5th ed.;
Littrell, Understanding and mitigating shaft runout, Orbit 25 (3) (2005) 5; the shares are estimates after the latter).
"""

import math

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, AnyProbe, LogUniform, Values
from rotorrig.sims.plant.places import probe_of_number, same_plane
from rotorrig.sims.plant.sensors import Chain, phasors_at

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
DENT = 0.5  # of the eccentricity, deep
DENT_WIDTH = math.radians(8.0)  # falls off by exp(-1/2) within it
DENT_AFTER = 2.0  # rad from the high spot
ELECTRICAL = 0.1  # of the eccentricity, once per turn; of the oval twice
POINTS = 512  # of the profile, around the shaft


def sensors(rig: RigConfig, chain: Chain, values: Values) -> Chain:
    """Return `chain` with a rougher track under the probes of one plane."""
    surface = _harmonics(_profile(values), chain.track.shape[1])
    track = chain.track.copy()
    for number, probe in enumerate(same_plane(rig, probe_of_number(rig, values["probe"]))):
        x, y = chain.direction[probe]
        electrical = np.zeros_like(surface)
        spots = values["angle"] + 1.3 + 1.1 * number  # rad: where the steel conducts worst, as this probe takes it
        electrical[:2] = values["eccentricity"] * np.exp(1j * spots), values["oval"] * np.exp(2j * spots)
        track[probe] += phasors_at(surface + ELECTRICAL * electrical, math.atan2(y, x), rig)
    return chain._replace(track=track)


def _profile(values: Values) -> NDArray[np.float64]:
    """Return how high the surface stands over the mean [m] that a probe at angle zero sees at shaft angles 2 pi k / N.

    The high spot passes it before shaft angle zero: what it sees at theta is the track at -theta.
    """
    theta = math.tau * np.arange(POINTS) / POINTS
    once = values["eccentricity"] * np.cos(theta + values["angle"])
    twice = values["oval"] * np.cos(2.0 * (theta + values["oval_angle"]))
    beside = np.angle(np.exp(1j * (theta + values["angle"] + DENT_AFTER)))
    dent = values["eccentricity"] * DENT * np.exp(-0.5 * (beside / DENT_WIDTH) ** 2)
    return once + twice - dent


def _harmonics(profile: NDArray[np.float64], count: int) -> NDArray[np.complex128]:
    """Return z (count,) of the profile's sum of Re(z_n e^{j n theta}), n from 1; the mean is part of the gap."""
    return 2.0 * np.fft.rfft(profile)[1 : count + 1] / len(profile)
