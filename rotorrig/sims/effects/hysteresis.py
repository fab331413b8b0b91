"""Damping of a bearing that does not depend on frequency: rubber, a dry stack of springs.

K (1 + j eta): as viscous damping of eta k / Omega, strong at low speed. What loses energy must grow stiffer with
frequency, or it would answer before it is pushed: a loss factor that is the same at all frequencies asks for
k (1 + 2 eta / pi ln(Omega / Omega_r)), by the relations of Kramers and Kronig. Source: Nashif, Jones, Henderson,
Vibration Damping (1985), ch. 2; Crandall, J. Sound Vib. 11 (1970) 3-18 on the stiffness.
"""

from dataclasses import dataclass

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.bearing_terms import own_stiffness
from rotorrig.sims.effects.places import bearing_groups, bearing_words, reference_speed
from rotorrig.sims.rotor.model import Added, RotorModel, with_added

#: ln x to second order about 1, powers of x from 0 up: within 0.11 from half the reference to 1.8 times it; 0.21 too
#: much at a third of it, where the rotor hardly moves
LOGARITHM = (-1.5, 2.0, -0.5)


@dataclass(frozen=True, kw_only=True)
class Hysteresis(Effect):
    """The loss factor "eta" of the bearings of one group, whose stiffness is the rotor's at `reference` [rad/s]."""

    name = "hysteresis"
    title = "hysteretic bearing damping"
    orders = EVERY
    bearings: tuple[str, ...]
    reference: float

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with it; above 1X as stiff as at 1X."""
        lossy = theta["eta"] * own_stiffness(model, self.bearings)
        constant, once, squared = (2 / np.pi * part / self.reference**n for n, part in enumerate(LOGARITHM))
        return with_added(model, Added(K=np.complex128(constant + 1j) * lossy, H=once * lossy, S=squared * lossy))

    def words(self, theta: Theta) -> str:
        """Say how large it is."""
        return f"there is hysteretic damping in {bearing_words(self.bearings)}: loss factor {theta['eta']:.3f}"


def effects(rig: RigConfig) -> tuple[Hysteresis, ...]:
    """Return one for every group of bearings sought."""
    unknown = (Parameter(name="eta", unit="", low=0.0, high=0.1, size=0.02),)
    return tuple(
        Hysteresis(where=where, bearings=names, reference=reference_speed(rig), parameters=unknown)
        for where, names in bearing_groups(rig).items()
    )
