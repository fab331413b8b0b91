"""Runout: the track that a plane's probes look at is not round, not centred or not magnetically even.

A pattern fixed to the surface passes one probe after the other, so the n-th order of a probe at the angle a reads
rho e^{-j n a}: a vector that neither speed nor resonance changes. Source: API 670, section on runout compensation.
"""

from dataclasses import dataclass

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import Complex, Effect, ReadingContext, Theta, pair, phasor, polar
from rotorrig.sims.effects.places import probe_planes, sense


@dataclass(frozen=True, kw_only=True)
class Runout(Effect):
    """The phasor "runout" [m]: how far the surface stands out towards +x at theta = 0, once per turn."""

    name = "runout"
    title = "probe runout"
    linear = True
    probes: tuple[str, ...]
    rotation: int = 1

    def change_readings(self, z: Complex, context: ReadingContext, theta: Theta) -> Complex:
        """Return the vectors with the surface's own added at the probes of the plane."""
        (order,) = self.orders
        if context.order != order:
            return z
        here = np.isin(context.probes, self.probes)
        return z + here * phasor(theta, "runout") * np.exp(-1j * order * self.rotation * context.angle)

    def words(self, theta: Theta) -> str:
        """Say how large it is and where."""
        size, angle = polar(theta, "runout")
        times = "once" if self.orders == (1,) else "twice"
        return (
            f"the surface under {' and '.join(self.probes)} runs out by {1e6 * size:.1f} um 0-peak, {times} per turn, "
            f"at {angle:.0f} deg from the keyphasor mark"
        )


@dataclass(frozen=True, kw_only=True)
class Ovality(Runout):
    """The same twice per turn: an oval track. Another cause than an eccentric one, and not needed for that."""

    title = "oval probe track"
    orders = (2,)


def effects(rig: RigConfig) -> tuple[Runout, ...]:
    """Return both for every plane of probes."""
    unknown = pair("runout", "m", most=25e-6, size=5e-6)
    return tuple(
        kind(
            where=f"{plane}{suffix}",
            probes=tuple(p.name for p in probes),
            rotation=sense(rig),
            parameters=unknown,
        )
        for kind, suffix in ((Runout, ""), (Ovality, ", twice per turn"))
        for plane, probes in probe_planes(rig).items()
    )
