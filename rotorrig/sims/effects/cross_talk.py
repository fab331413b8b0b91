"""Cross-talk: the tips of a plane's probes stand so close that each feels the other's field.

Each reads eps times the other besides its own. Source: API 670, minimum tip to tip distance.
"""

from dataclasses import dataclass

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Complex, Effect, Parameter, ReadingContext, Theta
from rotorrig.sims.effects.places import probe_planes


@dataclass(frozen=True, kw_only=True)
class CrossTalk(Effect):
    """The share "leak" that the probes of a plane take of each other."""

    name = "cross_talk"
    title = "cross-talk between probes"
    orders = EVERY
    linear = True
    law_error = 0.1  # the field that a tip leaves to the other goes with both gaps
    probes: tuple[str, ...]

    def change_readings(self, z: Complex, context: ReadingContext, theta: Theta) -> Complex:
        """Return the vectors with the others' share added at every probe of the plane."""
        here = np.isin(context.probes, self.probes)
        others = z[:, here].sum(axis=1, keepdims=True) - z
        return z + theta["leak"] * here * others

    def words(self, theta: Theta) -> str:
        """Say how much, in percent."""
        return f"{' and '.join(self.probes)} read {100 * theta['leak']:+.1f} % of each other"


def effects(rig: RigConfig) -> tuple[CrossTalk, ...]:
    """Return one for every plane of more than one probe."""
    unknown = (Parameter(name="leak", unit="", low=-0.2, high=0.2, size=0.02),)
    return tuple(
        CrossTalk(where=plane, probes=tuple(p.name for p in probes), parameters=unknown)
        for plane, probes in probe_planes(rig).items()
        if len(probes) > 1
    )
