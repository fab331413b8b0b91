"""What the sensors stand on: a base plate that gives way under the bearings, a keyphasor beside a shaft that moves.

A bearing's spring pushes the base plate, which moves there by a share of what the bearing does, in x and y, as a mass
on a spring (bracket.py); the probes nearest to that bearing stand on it, and tell the shaft's motion less its own. That
the rotor stands on it too is part of the bearing's stiffness.

The keyphasor looks at a wheel, which follows the driven end's motion by a share. As it moves past the keyphasor, along
with the surface that this sees, the mark comes early, by that motion over the wheel's radius: a once-per-turn motion
shifts the zero of shaft angle by an angle that goes with speed.
"""

import math

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import Bearing, Probe, RigConfig
from rotorrig.sims.plant.places import sense, sought_bearings
from rotorrig.sims.plant.sensors.bracket import Brackets
from rotorrig.sims.plant.truth import Truth

BASE_DAMPING = 0.03  # ratio, of a bolted plate


class Mounting:
    """From the shaft's motion to what probes and keyphasor see of it; block after block as if in one."""

    def __init__(self, rig: RigConfig, truth: Truth, *, sample_rate: float) -> None:
        """Take the base plate and the wheel of `truth`."""
        under = [_nearest_bearing(rig, probe) for probe in rig.probes]
        self._probes = len(rig.probes)
        self.watched = (*(p.position for p in rig.probes), *(b.position for b in under), 0.0)  # m, that it wants to see
        healthy = truth.unmodelled
        plate = np.tile((healthy.base_share, healthy.base_frequency, BASE_DAMPING), (2 * len(under), 1))
        self._base = Brackets(plate, sample_rate=sample_rate) if healthy.base_share else None
        c, s = math.cos(healthy.keyphasor_direction), math.sin(healthy.keyphasor_direction)
        self._lead = healthy.mark_lead * sense(rig) * np.array([-s, c])  # rad/m, per motion in x and y

    def at_probes(self, deflections: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far the shaft has moved from where each probe stands (sample, probe, 2) [m].

        `deflections` (sample, place, 2) [m] are those at the places `watched`.
        """
        own, under = np.split(deflections[:, :-1], [self._probes], axis=1)
        if self._base is None:
            return np.ascontiguousarray(own)
        moved = self._base.move(np.ascontiguousarray(under.reshape(len(own), 2 * self._probes)))
        return own - moved.reshape(own.shape)

    def at_keyphasor(self, deflections: NDArray[np.float64], angle: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the shaft angle (sample,) [rad] the keyphasor takes for `angle`."""
        return angle + deflections[:, -1] @ self._lead


def _nearest_bearing(rig: RigConfig, probe: Probe) -> Bearing:
    return min(sought_bearings(rig), key=lambda b: abs(b.position - probe.position))
