"""Damping of a bearing that does not depend on frequency: rubber, a dry stack of springs.

K (1 + j eta): as viscous damping of eta k / Omega, strong at low speed. Source: Nashif, Jones, Henderson, Vibration
Damping (1985), ch. 2.
"""

from dataclasses import dataclass

import numpy as np

from rotorrig.rig.description import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.bearing_terms import own_stiffness
from rotorrig.sims.effects.places import bearing_groups, bearing_words
from rotorrig.sims.rotor.assembly import Added, RotorModel, with_added


@dataclass(frozen=True, kw_only=True)
class Hysteresis(Effect):
    """The loss factor "eta" of the bearings of one group."""

    name = "hysteresis"
    title = "hysteretic bearing damping"
    orders = EVERY
    bearings: tuple[str, ...]

    def changed(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with it."""
        return with_added(model, Added(K=np.complex128(1j * theta["eta"]) * own_stiffness(model, self.bearings)))

    def words(self, theta: Theta) -> str:
        """Say how large it is."""
        return f"there is hysteretic damping in {bearing_words(self.bearings)}: loss factor {theta['eta']:.3f}"


def effects(rig: RigConfig) -> tuple[Hysteresis, ...]:
    """Return one for every group of bearings sought."""
    unknown = (Parameter(name="eta", unit="", low=0.0, high=0.1, size=0.02),)
    return tuple(
        Hysteresis(where=where, bearings=names, parameters=unknown) for where, names in bearing_groups(rig).items()
    )
