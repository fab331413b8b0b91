"""Cross-coupled stiffness of opposite signs at a bearing: oil, a seal, a blade ring.

It pushes along the whirl, which is as damping less k / Omega of a forward whirl, and drives it where it wins. Source:
Childs, Turbomachinery Rotordynamics (1993), ch. 1 and 3.
"""

from dataclasses import dataclass

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.bearing_terms import on_bearings
from rotorrig.sims.effects.places import bearing_groups, bearing_words
from rotorrig.sims.rotor.model import Added, RotorModel, with_added


@dataclass(frozen=True, kw_only=True)
class SkewStiffness(Effect):
    """The stiffness "k" [N/m]: kxy = -kyx = k for rotation x to y; above zero it drives forward whirl."""

    name = "skew_stiffness"
    title = "cross-coupled bearing stiffness"
    orders = EVERY
    bearings: tuple[str, ...]

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with it."""
        k = model.rotation * theta["k"]
        return with_added(model, Added(K=on_bearings(model, self.bearings, [[0, k], [-k, 0]])))

    def words(self, theta: Theta) -> str:
        """Say how large it is, and which way it pushes."""
        push = "drives" if theta["k"] > 0 else "holds back"
        return (
            f"a cross-coupled stiffness of {abs(theta['k']) / 1e3:.2f} kN/m at {bearing_words(self.bearings)} {push} "
            f"forward whirl"
        )


def effects(rig: RigConfig) -> tuple[SkewStiffness, ...]:
    """Return one for every group of bearings sought."""
    unknown = (Parameter(name="k", unit="N/m", low=-5e3, high=5e3, size=500.0, of_rig=True),)
    return tuple(
        SkewStiffness(where=where, bearings=names, parameters=unknown) for where, names in bearing_groups(rig).items()
    )
