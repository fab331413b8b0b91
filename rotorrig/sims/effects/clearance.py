"""A loose seat: the journal of a bearing moves freely over a radial gap before its stiffness takes hold.

On the linear bearing it acts as K rho min(1, gap / |rho|) outwards: what the bearing lacks inside the gap, and as much
as at the gap's edge outside. The rotor's weight lays it against one side, so at small motion it is stiff along gravity
and soft across. Source: Ehrich, Handbook of Rotordynamics (1992), ch. 1; Kim, Noah, J. Appl. Mech. 57 (1990) 1067.
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

GAPS = tuple(map(float, np.geomspace(0.5e-6, 80e-6, 16)))  # m: 40 % apart


@dataclass(frozen=True, kw_only=True)
class Clearance(Effect):
    """The radial "gap" [m] at the bearings of one group."""

    name = "clearance"
    title = "clearance in a bearing's seat"
    law_error = 0.1
    orders = EVERY
    bearings: tuple[str, ...]
    gravity: str  # as in RigConfig

    def force_laws(self, model: RotorModel, theta: Theta) -> tuple[ForceLaw, ...]:
        """Return what the bearings lack, about where they would lie without a gap."""
        rest = at_rest(model, self.gravity)
        return tuple(
            ForceLaw(
                rows=bearing.rows,
                force=loose,
                constants=np.append(theta["gap"], bearing.at(0.0)[0].ravel()),
                static=bearing.rows @ rest,
            )
            for bearing in map(model.bearing, self.bearings)
        )

    def words(self, theta: Theta) -> str:
        """Say how wide it is."""
        return f"there is a radial clearance of {1e6 * theta['gap']:.1f} um in {bearing_words(self.bearings)}"


@njit(cache=True)
def loose(x: float, y: float, vx: float, vy: float, constants: NDArray[np.float64]) -> tuple[float, float]:
    """Return K (x, y) min(1, gap / |r|) of constants gap, kxx, kxy, kyx, kyy."""
    gap, r = constants[0], np.hypot(x, y)
    share = gap / r if r > gap else 1.0
    if gap <= 0.0:
        share = 0.0
    return share * (constants[1] * x + constants[2] * y), share * (constants[3] * x + constants[4] * y)


def effects(rig: RigConfig) -> tuple[Clearance, ...]:
    """Return one for every group of bearings sought."""
    unknown = (Parameter(name="gap", unit="m", low=0.0, high=100e-6, size=10e-6, starts=GAPS, of_rig=True),)
    return tuple(
        Clearance(where=where, bearings=names, gravity=rig.gravity, parameters=unknown)
        for where, names in bearing_groups(rig).items()
    )
