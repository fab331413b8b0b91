"""Vectors from which a slow-roll vector was taken before they reached us, though the table does not say so.

What is left is y(Omega) - kappa y(slow roll): a bow turns into false unbalance. What was taken off is the vector as it
was measured, with its noise and whatever response was in it, at however high a speed. Source: API 670 on slow-roll
compensation; where the subtraction is known it belongs to the base model and not here.
"""

from dataclasses import dataclass

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Complex, Effect, Parameter, ReadingContext, Theta


@dataclass(frozen=True, kw_only=True)
class SlowRollSubtracted(Effect):
    """The share "share" of the slow-roll vector that was taken away."""

    name = "slow_roll_subtracted"
    title = "slow roll subtracted already"
    law_error = 0.0
    orders = EVERY
    linear = True
    after_hum = True

    def change_readings(self, z: Complex, context: ReadingContext, theta: Theta) -> Complex:
        """Return the rows less that share of the measured slow roll, or else the model's; that row itself stays."""
        taken = np.nan_to_num(context.slow_roll) if len(context.slow_roll) else z[-1]
        return np.concatenate([z[:-1] - theta["share"] * taken, z[-1:]])

    def words(self, theta: Theta) -> str:
        """Say how much of it, in percent."""
        return f"{100 * theta['share']:.0f} % of the slow-roll vector had been subtracted before"


def effects(rig: RigConfig) -> tuple[SlowRollSubtracted, ...]:
    """Return the one there is."""
    return (SlowRollSubtracted(parameters=(Parameter(name="share", unit="", low=0.0, high=1.2, size=1.0),)),)
