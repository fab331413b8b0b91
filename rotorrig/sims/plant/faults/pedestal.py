"""A bearing on a pedestal that gives: it slides on its base, and rocks about it.

Bearing and pedestal are in series, so that what the shaft feels dips and peaks about the pedestal's own frequencies
(Gasch, Nordmann and Pfuetzner, Rotordynamik, 2nd ed. 2002). Along x the pedestal is a rigid body on a base that yields
sideways and lets it rock (Richart, Hall and Woods, Vibrations of Soils and Foundations (1970), sec. 8.6): two motions
that go together, with a resonance each, of which the lower is the one stated. Along y it has one. The probes stand on
the ground. The pedestal's weight was there before the shaft was aligned and moves nothing.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

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
ROCKING = 0.6  # of the compliance in x, at the bearing; the rest is sliding: a slender pedestal, an estimate
CENTRE = 0.5  # height of its centre of mass over that of the bearing: of an even block
GYRATION = 0.32  # its radius of gyration over that height: of a block two thirds as long as it is high
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
    """Return `rotor` with the bearing `K`, `C` at `station` on a pedestal instead of on the ground."""
    wide = rotor.with_coordinate().with_coordinate()
    n = wide.n
    slides, rocks, lifts, spare = n - 2, n - 1, 2 * n - 2, 2 * n - 1
    # rocking is counted by what it moves the bearing: there the pedestal moves by the sum of both
    moves = np.zeros((2, 2 * n))
    moves[0, [station, slides, rocks]] = 1.0, -1.0, -1.0
    moves[1, [station + n, lifts]] = 1.0, -1.0
    here = np.ix_([station, station + n], [station, station + n])
    for whole, bearing in ((wide.K, K), (wide.C, C)):
        whole[here] -= bearing
        whole += moves.T @ bearing @ moves
    omega = math.tau * values["frequency"]
    sideways = np.ix_([slides, rocks], [slides, rocks])
    shape = np.array([[1.0, CENTRE], [CENTRE, CENTRE**2 + GYRATION**2]])  # mass matrix of 1 kg
    k = np.diag([1.0 / (1.0 - ROCKING), 1.0 / ROCKING]) / values["compliance"]
    kilograms = float(linalg.eigh(k, shape, eigvals_only=True)[0]) / omega**2
    wide.M[sideways] += kilograms * shape
    wide.K[sideways] += k
    wide.C[sideways] += 2.0 * values["damping_ratio"] / omega * k
    upright = 1.0 / (values["compliance"] * values["aspect"])
    wide.M[lifts, lifts] += kilograms
    wide.K[lifts, lifts] += upright
    wide.C[lifts, lifts] += 2.0 * values["damping_ratio"] * math.sqrt(upright * kilograms)
    # along y nothing rocks: a coordinate that nothing moves, and that no speed of the rig could
    wide.M[spare, spare], wide.K[spare, spare] = kilograms, 1e6 * kilograms * omega**2
    return wide
