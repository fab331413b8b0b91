"""A residual bow of the shaft: bent, crept or badly stored, it turns as it is and takes part in every resonance.

The force is K_s q_b, constant over speed: at rest the shaft shows the bow, the response amplifies it and above the
critical speed it straightens out. Source: Nicholas, Gunter, Allaire, Effect of residual shaft bow on unbalance response
and balancing of a single mass flexible rotor, J. Eng. Power 98 (1976) 171-189.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from rotorrig.rig.config import SHORTEST, RigConfig
from rotorrig.sims.effects.base import Effect, Theta, pair, phasor, polar
from rotorrig.sims.effects.places import bending_stiffness, place_label
from rotorrig.sims.effects.shaft_motion import forward
from rotorrig.sims.rotor.model import Load, RotorModel, bow_force


@dataclass(frozen=True, kw_only=True)
class Bow(Effect):
    """The shaft stands off by the phasor "bow" [m] at one disk, pinned in its bearings."""

    name = "bow"
    title = "residual shaft bow"
    linear = True
    place: str  # disk or plane

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return the force that bends a straight shaft so."""
        return (Load(pattern=phasor(theta, "bow") * bow_force(model, self.place), law="constant"),)

    def words(self, theta: Theta) -> str:
        """Say how far it is bent, and where to."""
        size, angle = polar(theta, "bow")
        return (
            f"the shaft is bowed by {1e6 * size:.1f} um 0-peak at {angle:.0f} deg from the keyphasor mark, "
            f"at {self.place}"
        )


@dataclass(frozen=True, kw_only=True)
class Arc(Bow):
    """The same, of a shaft that is curved evenly between its outermost bearings: the phasor is that of its middle."""

    start: float  # m from the coupling
    end: float
    stations: tuple[tuple[float, float, float], ...]  # m, m, N m^2: stretches between them and their E I

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return the moments at the ends of every stretch that curve it so when nothing else acts."""
        curvature = -8.0 * phasor(theta, "bow") / (self.end - self.start) ** 2
        slope = CubicSpline(model.z, model.centreline, axis=1)
        rows = np.sum([stiffness * (slope(b, 1) - slope(a, 1)) for a, b, stiffness in self.stations], axis=0)
        return (Load(pattern=curvature * forward(rows, model.rotation), law="constant"),)

    def words(self, theta: Theta) -> str:
        """Say how far it is bent, and where to."""
        size, angle = polar(theta, "bow")
        return (
            f"the shaft is bowed in an arc between its bearings by {1e6 * size:.1f} um 0-peak at {angle:.0f} deg from "
            "the keyphasor mark, in its middle"
        )


def effects(rig: RigConfig) -> tuple[Bow, ...]:
    """Return a bow at every disk that no bearing holds, as if bent by a push there, and an even one."""
    held = [bearing.position for bearing in rig.bearings]
    free = [disk for disk in rig.disks if min(abs(disk.position - z) for z in held) > SHORTEST]
    unknown = pair("bow", "m", most=100e-6, size=10e-6, of_rig=True)
    pushed = tuple(Bow(place=disk.name, where=place_label(disk.name, free), parameters=unknown) for disk in free)
    start, end = min(held), max(held)
    if end - start < SHORTEST:
        return pushed
    arc = Arc(place="", where="even", start=start, end=end, stations=_stations(rig, start, end), parameters=unknown)
    return (*pushed, arc)


def _stations(rig: RigConfig, start: float, end: float) -> tuple[tuple[float, float, float], ...]:
    """Return the stretches of one cross-section between `start` and `end`, each with its E I [N m^2]."""
    return tuple(
        (max(tube.start, start), min(tube.end, end), bending_stiffness(tube))
        for tube in rig.shaft.tubes
        if min(tube.end, end) - max(tube.start, start) > SHORTEST
    )
