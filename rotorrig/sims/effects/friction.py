"""Dry friction at a bearing's support: strong damping of small motion, next to none of large.

f = -F v / sqrt(v^2 + v0^2), Coulomb's law with its edge rounded at creeping speed. Source: Olsson, Astrom, et al.,
Friction models and friction compensation, Eur. J. Control 4 (1998) 176-195.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.rig.description import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.places import bearing_groups, bearing_words
from rotorrig.sims.rotor.assembly import RotorModel
from rotorrig.sims.rotor.force_law import ForceLaw

CREEP = 1e-3  # m/s: about 10 um at 1000 rpm, the least that the probes see as motion


@dataclass(frozen=True, kw_only=True)
class Friction(Effect):
    """The "force" [N] that resists the motion of the bearings of one group."""

    name = "friction"
    title = "dry friction at a bearing"
    orders = EVERY
    bearings: tuple[str, ...]

    def laws(self, model: RotorModel, theta: Theta) -> tuple[ForceLaw, ...]:
        """Return it at every bearing."""
        constants = np.array([theta["force"]])
        return tuple(ForceLaw(rows=model.bearing(name).rows, force=dry, constants=constants) for name in self.bearings)

    def words(self, theta: Theta) -> str:
        """Say how strong it is."""
        return f"dry friction of {1e3 * theta['force']:.0f} mN acts at {bearing_words(self.bearings)}"


@njit(cache=True)
def dry(x: float, y: float, vx: float, vy: float, constants: NDArray[np.float64]) -> tuple[float, float]:
    """Return -F v / |v|, rounded."""
    factor = -constants[0] / np.sqrt(vx * vx + vy * vy + CREEP * CREEP)
    return factor * vx, factor * vy


def effects(rig: RigConfig) -> tuple[Friction, ...]:
    """Return one for every group of bearings sought."""
    unknown = (Parameter(name="force", unit="N", low=0.0, high=1.0, size=0.05, starts=(0.02, 0.1, 0.4)),)
    return tuple(
        Friction(where=where, bearings=names, parameters=unknown) for where, names in bearing_groups(rig).items()
    )
