"""A bearing whose stiffness grows with the deflection: a stop, a preloaded or bottoming spring.

f = -k3 (x^2 + y^2) (x, y) about the unloaded spring: the resonance leans to higher speeds, up and down alike, and jumps
where it leans over. The rotor's weight has pushed it already, so that it is stiffer along gravity than across and makes
twice-per-turn motion. Source: Yamamoto, Ishida, Linear and Nonlinear Rotordynamics (2012), ch. 6; Nayfeh, Mook,
Nonlinear Oscillations (1979), section 4.1.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.places import bearing_groups, bearing_words
from rotorrig.sims.effects.shaft_motion import at_rest
from rotorrig.sims.rotor.model import RotorModel
from rotorrig.sims.rotor.nonlinear import ForceLaw

STEEPNESS = tuple(map(float, np.geomspace(1e8, 3e11, 12)))  # N/m^3: a factor of 2 apart


@dataclass(frozen=True, kw_only=True)
class CubicSpring(Effect):
    """The stiffness "k3" [N/m^3] of the bearings of one group; below zero they soften."""

    name = "cubic_spring"
    title = "bearing stiffness that grows with deflection"
    law_error = 0.1
    orders = EVERY
    linear_in = "k3"
    bearings: tuple[str, ...]
    gravity: str  # as in RigConfig

    def force_laws(self, model: RotorModel, theta: Theta) -> tuple[ForceLaw, ...]:
        """Return its force at every bearing, about where its journal would be without weight."""
        rest, constants = at_rest(model, self.gravity), np.array([theta["k3"]])
        return tuple(
            ForceLaw(rows=rows, force=cubic, constants=constants, static=rows @ rest)
            for rows in (model.bearing(name).rows for name in self.bearings)
        )

    def words(self, theta: Theta) -> str:
        """Say how steep it is, at a deflection that one can picture."""
        more = theta["k3"] * 100e-6**2
        return (
            f"the stiffness of {bearing_words(self.bearings)} changes with deflection: {theta['k3']:.2g} N/m^3, "
            f"{more / 1e3:+.2f} kN/m at 100 um"
        )


@njit(cache=True)
def cubic(x: float, y: float, vx: float, vy: float, constants: NDArray[np.float64]) -> tuple[float, float]:
    """Return -k3 |r|^2 r."""
    k = -constants[0] * (x * x + y * y)
    return k * x, k * y


def effects(rig: RigConfig) -> tuple[CubicSpring, ...]:
    """Return one for every group of bearings sought."""
    unknown = (
        Parameter(
            name="k3",
            unit="N/m^3",
            low=-5e11,
            high=5e11,
            size=5e10,
            starts=(*(-k3 for k3 in reversed(STEEPNESS)), *STEEPNESS),
            of_rig=True,
        ),
    )
    return tuple(
        CubicSpring(where=where, bearings=names, gravity=rig.gravity, parameters=unknown)
        for where, names in bearing_groups(rig).items()
    )
