"""A bearing whose principal axes of stiffness are not x and y: four springs that are not set alike.

K gains kxy = kyx: symmetric, so it neither drives nor damps. Two critical speeds with inclined orbits between. Source:
Friswell, Penny, Garvey, Lees, Dynamics of Rotating Machines (2010), section 6.4.
"""

from dataclasses import dataclass

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.bearing_terms import on_bearings
from rotorrig.sims.effects.places import bearing_groups, bearing_words, group_stiffness
from rotorrig.sims.rotor.model import Added, RotorModel, with_added


@dataclass(frozen=True, kw_only=True)
class CrossStiffness(Effect):
    """The stiffness kxy = kyx = "k" [N/m] of the bearings of one group."""

    name = "cross_stiffness"
    title = "bearing stiffness with turned axes"
    orders = EVERY
    bearings: tuple[str, ...]

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with it."""
        k = theta["k"]
        return with_added(model, Added(K=on_bearings(model, self.bearings, [[0, k], [k, 0]])))

    def words(self, theta: Theta) -> str:
        """Say how large it is."""
        return (
            f"the stiffness axes of {bearing_words(self.bearings)} are turned: kxy = kyx = {theta['k'] / 1e3:+.2f} kN/m"
        )


def effects(rig: RigConfig) -> tuple[CrossStiffness, ...]:
    """Return one for every group of bearings sought, up to 30 % of its stiffness."""
    return tuple(
        CrossStiffness(where=where, bearings=names, parameters=(_unknown(group_stiffness(rig, names)),))
        for where, names in bearing_groups(rig).items()
    )


def _unknown(k: float) -> Parameter:
    return Parameter(name="k", unit="N/m", low=-0.3 * k, high=0.3 * k, size=0.06 * k)
