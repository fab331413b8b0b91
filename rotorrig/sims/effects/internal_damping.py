"""Damping that turns with the shaft: of its material, or of a disk that rubs on its seat.

In the rotor's axes it resists the change of shape; in ours that is C = beta K_s and a circulatory beta Omega K_s J. A
forward circular orbit is at rest in the rotor and does not feel it. Source: Genta, Dynamics of Rotating Systems (2005),
section 2.4; Kimball, Internal friction theory of shaft whirling, Gen. Electr. Rev. 27 (1924) 244.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.shaft_motion import pairwise_map
from rotorrig.sims.rotor.model import Added, Direction, RotorModel, with_added

Matrix = NDArray[np.float64]

J = ((0.0, 1.0), (-1.0, 0.0))


@dataclass(frozen=True, kw_only=True)
class InternalDamping(Effect):
    """The time "beta" [s]: rotating damping beta K_s of the whole shaft."""

    name = "internal_damping"
    title = "internal damping of the shaft"
    orders = EVERY

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with it."""
        if not theta["beta"]:
            return model
        C, H = self._of(model.shaft.K, model, theta)
        return with_added(model, Added(C=C, H=H))

    def change_along_shaft(self, along: Direction, model: RotorModel, theta: Theta) -> Direction:
        """Return the derivative with that of the rotating damping: it is in proportion to the stiffness."""
        C, H = self._of(along.K.real, model, theta)
        return along._replace(C=along.C + C, H=along.H + H)

    def _of(self, stiffness: Matrix, model: RotorModel, theta: Theta) -> tuple[Matrix, Matrix]:
        """Return its matrices C and H for a shaft of that stiffness."""
        C = theta["beta"] * stiffness
        circulatory = C @ pairwise_map(model, J)
        skew = (circulatory - circulatory.T) / 2  # exactly so, but for rounding and what a reduction leaves out
        return C, model.rotation * skew

    def words(self, theta: Theta) -> str:
        """Say how large it is."""
        return f"the shaft has rotating damping of {1e6 * theta['beta']:.0f} us times its stiffness"


def effects(rig: RigConfig) -> tuple[InternalDamping, ...]:
    """Return the one of the shaft."""
    return (InternalDamping(parameters=(Parameter(name="beta", unit="s", low=0.0, high=5e-4, size=5e-5),)),)
