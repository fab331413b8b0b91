"""A probe whose scale is not its nameplate's: another target material, a curved shaft, a wrong driver.

The reading is 1 + e times the motion at every order. Source: API 670: within 5 % of the scale factor.
"""

from dataclasses import dataclass

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Complex, Effect, Parameter, ReadingContext, Theta


@dataclass(frozen=True, kw_only=True)
class ProbeGain(Effect):
    """The ratio "error" by which the probe shows more than there is."""

    name = "probe_gain"
    title = "probe gain"
    law_error = 0.0
    orders = EVERY
    as_nuisance = True
    linear = True
    probe: str

    def change_readings(self, z: Complex, context: ReadingContext, theta: Theta) -> Complex:
        """Return the vectors with this probe's multiplied."""
        return z * np.where(np.array(context.probes) == self.probe, 1 + theta["error"], 1.0)

    def words(self, theta: Theta) -> str:
        """Say what it shows in percent."""
        return f"probe {self.probe} shows {100 * (1 + theta['error']):.1f} % of the motion"


def effects(rig: RigConfig) -> tuple[ProbeGain, ...]:
    """Return one for every probe."""
    unknown = (Parameter(name="error", unit="", low=-0.2, high=0.25, size=0.05),)
    return tuple(ProbeGain(where=f"probe {p.name}", probe=p.name, parameters=unknown) for p in rig.probes)
