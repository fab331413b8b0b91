"""The bearings that are not sought, taken as stiff as the nameplate says, give way: a bush, an O-ring, a thin wall.

Their flexibilities grow by one factor. Below the critical speed one plane of probes takes it for other values of what
is sought. Source: Friswell, Penny, Garvey, Lees, Dynamics of Rotating Machines (2010), section 5.6.
"""

from dataclasses import dataclass

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.bearing_terms import own_stiffness
from rotorrig.sims.effects.places import bearing_words, other_bearings, stiffness
from rotorrig.sims.rotor.model import Added, RotorModel, with_added

SOFTEST = 5e4  # N/m: below, no such bearing would be taken for a stiff one


@dataclass(frozen=True, kw_only=True)
class SoftLeftBearing(Effect):
    """The ratio "softness": by how much of itself their flexibility 1 / k is larger than it is taken for."""

    name = "soft_left_bearing"
    title = "soft bearing beside the ones sought"
    orders = EVERY
    bearings: tuple[str, ...]

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with it."""
        return with_added(model, Added(K=(1 / (1 + theta["softness"]) - 1) * own_stiffness(model, self.bearings)))

    def words(self, theta: Theta) -> str:
        """Say how stiff they are."""
        share = 1 / (1 + theta["softness"])
        return f"the stiffness of {bearing_words(self.bearings)} is {100 * share:.0f} % of what it is taken for"


def effects(rig: RigConfig) -> tuple[SoftLeftBearing, ...]:
    """Return one for all elastic bearings that are not sought, if any; a rigid one has no stiffness to change."""
    others = other_bearings(rig)
    if not others:
        return ()
    most = max(min(stiffness(bearing) for bearing in others) / SOFTEST - 1, 1.0)
    unknown = Parameter(name="softness", unit="", low=-0.3, high=most, size=0.5)
    return (SoftLeftBearing(bearings=tuple(b.name for b in others), parameters=(unknown,)),)
