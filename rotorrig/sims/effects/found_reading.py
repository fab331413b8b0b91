"""A probe that reads otherwise than the effects in this folder have it, by laws over motion and speed.

Like found_force.py it is not in the catalogue: a diagnosis makes one where nothing known explains the measurement. In a
config it is `where = "probe 1x: share over speed"`. A law adds to the vector of the probe, at every order, a complex
share of what it is of; its argument is a lag or lead. Source: none of its own: a gain (probe_gain.py, API 670), a lag
(delay.py) and cross-talk (cross_talk.py) are real or imaginary shares; these are any, alike at all speeds or growing.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Complex, Effect, ReadingContext, Theta, pair, phasor, polar
from rotorrig.sims.effects.found_laws import PLUS, check_laws
from rotorrig.sims.effects.places import probe_planes, reference_speed

NAME = "found_reading"
SIZE = 0.03  # a typical share
MOTION = 100e-6  # m, of a vector whose share over size is the share
SHARES: Mapping[str, tuple[str, Callable[[Complex, Complex, NDArray[np.float64]], Complex]]] = MappingProxyType(
    {  # what it is of, in words; and that, of its own vectors z, its neighbour's and the speed over a reference
        "share": ("of the motion it reads", lambda z, other, speed: z),
        "share over speed": ("of the motion it reads, times the speed", lambda z, other, speed: speed * z),
        "share over size": (
            "of the motion it reads, times its size squared",
            lambda z, other, speed: (np.abs(z) / MOTION) ** 2 * z,
        ),
        "other probe": ("of what the other probe of its plane reads", lambda z, other, speed: other),
        "other probe over speed": (
            "of what the other probe of its plane reads, times the speed",
            lambda z, other, speed: speed * other,
        ),
    }
)


@dataclass(frozen=True, kw_only=True)
class FoundReading(Effect):
    """The complex "<law>" of every one of its `laws` at one probe."""

    name = NAME
    title = "a reading of a probe"
    orders = EVERY
    laws: tuple[str, ...]
    probe: str
    other: str  # of its plane; "": there is none
    reference: float  # rad/s

    def change_readings(self, z: Complex, context: ReadingContext, theta: Theta) -> Complex:
        """Return the vectors with the shares added to those of this probe."""
        names = list(context.probes)
        own = z[:, names.index(self.probe)]
        other = z[:, names.index(self.other)] if self.other else np.zeros_like(own)
        speed = np.abs(context.omega) / self.reference
        changed = z.copy()
        for law in self.laws:
            changed[:, names.index(self.probe)] += phasor(theta, law) * SHARES[law][1](own, other, speed)
        return changed

    def words(self, theta: Theta) -> str:
        """Say how much it adds and of what."""
        told = []
        for law in self.laws:
            share, angle = polar(theta, law)
            told.append(f"{100 * share:.2g} % at {angle:.0f} deg {SHARES[law][0]}")
        return f"probe {self.probe} reads besides " + " and ".join(told)


def found_reading(rig: RigConfig, probe: str, laws: Iterable[str]) -> FoundReading:
    """Return the one at that probe with these laws. Raises ValueError on an unknown law or probe."""
    names = tuple(laws)
    check_laws(NAME, names, SHARES)
    planes = [[p.name for p in plane] for plane in probe_planes(rig).values()]
    beside = next((plane for plane in planes if probe in plane), None)
    if beside is None:
        raise ValueError(f"{NAME}: there is no probe '{probe}', want one of {', '.join(p.name for p in rig.probes)}")
    parameters = tuple(q for name in names for q in pair(name, "", most=1.0, size=SIZE))
    return FoundReading(
        where=f"probe {probe}: {PLUS.join(names)}",
        laws=names,
        probe=probe,
        other=next((name for name in beside if name != probe), ""),
        reference=reference_speed(rig),
        parameters=parameters,
    )


def from_config(rig: RigConfig, name: str, where: str) -> FoundReading | None:
    """Return the one that `where` tells of if `name` is that of this file. Raises ValueError as `found_reading`."""
    if name != NAME:
        return None
    probe, _, laws = where.removeprefix("probe ").partition(": ")
    return found_reading(rig, probe, laws.split(PLUS))
