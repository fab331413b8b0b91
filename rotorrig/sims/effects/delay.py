"""A delay in the measuring chain: of all probes against the keyphasor, of a plane's, or of one probe.

An anti-aliasing filter, a multiplexed converter or a slow keyphasor: order n lags by n Omega tau, its size unchanged.
Source: any text on linear phase; a two-pole filter at 1 kHz has 225 us.
"""

from dataclasses import dataclass

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Complex, Effect, Parameter, ReadingContext, Theta
from rotorrig.sims.effects.places import probe_planes


@dataclass(frozen=True, kw_only=True)
class Delay(Effect):
    """The time "delay" [s] by which the probes' signals come late; below zero: the keyphasor's does."""

    name = "delay"
    title = "time delay"
    orders = EVERY
    after_hum = True
    probes: tuple[str, ...]

    def change_readings(self, z: Complex, context: ReadingContext, theta: Theta) -> Complex:
        """Return the vectors with the lag of their order and speed."""
        late = np.isin(context.probes, self.probes) * theta["delay"]
        return z * np.exp(-1j * context.order * np.multiply.outer(context.omega, late))

    def words(self, theta: Theta) -> str:
        """Say how late."""
        who = self.where or "all probes"
        return f"the signal of {who} comes {1e6 * theta['delay']:.0f} us late against the keyphasor"


def effects(rig: RigConfig) -> tuple[Delay, ...]:
    """Return one for all probes, and for every plane and probe if there are others."""
    unknown = (Parameter(name="delay", unit="s", low=-2e-3, high=2e-3, size=1.5e-4),)
    planes = {name: tuple(p.name for p in probes) for name, probes in probe_planes(rig).items()}
    everyone = tuple(p.name for p in rig.probes)
    places = {"": everyone}
    places |= {name: probes for name, probes in planes.items() if 1 < len(probes) < len(everyone)}
    places |= {f"probe {p}": (p,) for p in everyone if len(everyone) > 1}
    return tuple(Delay(where=where, probes=probes, parameters=unknown) for where, probes in places.items())
