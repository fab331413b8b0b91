"""Dry friction at a bearing's support: strong damping of small motion, next to none of large.

The contact gives a little before it slides, as a spring in series with a slider. The balls shake the bearing at random
besides; so shaken, the slider creeps under less than its limit instead of sticking. With s the velocity at which it
slides where the place moves at v,

    f = -F s / q,  q = sqrt(s^2 + creep^2),  v = s + d(give s / q) / dt.

On a circle that has a closed form; on other paths it is taken at the angular speed about the centre at each instant. On
a line, where that is zero, the contact does not give: an error of some give / amplitude of the friction. Source:
Sanliturk, Ewins, J. Sound Vib. 193 (1996) 511 (sliding contact in the plane); Caughey, J. Acoust. Soc. Am. 35 (1963)
1706 (what noise does to a force law).
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.places import bearing_groups, bearing_words
from rotorrig.sims.rotor.model import RotorModel
from rotorrig.sims.rotor.nonlinear import ForceLaw

FORCES = tuple(map(float, np.geomspace(2e-3, 0.8, 10)))  # N: a factor of 2 apart
STILL = 1e-12  # m: nearer to the centre than this no angle is known


@dataclass(frozen=True, kw_only=True)
class Friction(Effect):
    """The "force" [N] that resists the motion of the bearings of one group, how far it gives and how fast it creeps.

    It gives way elastically by "give" [m]; the random shaking of the bearing lets it creep at "creep" [m/s].
    """

    name = "friction"
    title = "dry friction at a bearing"
    law_error = 0.1
    orders = EVERY
    bearings: tuple[str, ...]

    def force_laws(self, model: RotorModel, theta: Theta) -> tuple[ForceLaw, ...]:
        """Return it at every bearing."""
        constants = np.array([theta["force"], theta["give"], theta["creep"]])
        return tuple(
            ForceLaw(rows=model.bearing(name).rows, force=dry, constants=constants, overtones=False)  # they are small
            for name in self.bearings
        )

    def words(self, theta: Theta) -> str:
        """Say how strong it is."""
        return f"dry friction of {1e3 * theta['force']:.0f} mN acts at {bearing_words(self.bearings)}"


@njit(cache=True)
def dry(x: float, y: float, vx: float, vy: float, constants: NDArray[np.float64]) -> tuple[float, float]:
    """Return the force at (x, y) on a circle run through at (vx, vy), of constants force, give and creep.

    There v = j w r, so s (1 + j g / q) = v with g = give w, and q^2 is the positive root of
    (q^2 - creep^2) (q^2 + g^2) = |v|^2 q^2.
    """
    force, give, creep = constants[0], constants[1], constants[2]
    squared = vx * vx + vy * vy
    w = (x * vy - y * vx) / max(x * x + y * y, STILL * STILL)
    g = give * abs(w)
    middle, product = (squared + creep * creep - g * g) / 2, creep * g
    root = np.hypot(middle, product)
    q2 = middle + root if middle > 0 else product * product / (root - middle)
    q = np.sqrt(max(q2, creep * creep))
    damping = -force * q / (q * q + g * g)
    spring = damping * w * w * give / q
    return spring * x + damping * vx, spring * y + damping * vy


def effects(rig: RigConfig) -> tuple[Friction, ...]:
    """Return one for every group of bearings sought."""
    unknown = (
        Parameter(name="force", unit="N", low=0.0, high=1.0, size=0.05, starts=FORCES, of_rig=True),
        Parameter(name="give", unit="m", low=0.0, high=5e-6, size=0.5e-6, at_zero=0.5e-6),  # a few asperities high
        Parameter(name="creep", unit="m/s", low=1e-5, high=2e-3, size=1e-4, at_zero=1e-4),  # 0.5 um at 2000 rpm
    )
    return tuple(
        Friction(where=where, bearings=names, parameters=unknown) for where, names in bearing_groups(rig).items()
    )
