"""A bearing that grows stiffer or softer with speed: an O-ring, preload, contact angle.

k (1 + a (Omega / Omega_r)^2). Below the first critical speed that is a changed mass and stiffness in disguise. Source:
Darlow, Zorzi, Mechanical design handbook for elastomers, NASA CR-3423 (1981).
"""

from dataclasses import dataclass

from rotorrig.rig.config import RPM, RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.bearing_terms import own_stiffness
from rotorrig.sims.effects.places import bearing_groups, bearing_words, reference_speed
from rotorrig.sims.rotor.model import Added, RotorModel, with_added


@dataclass(frozen=True, kw_only=True)
class StiffnessOverSpeed(Effect):
    """The ratio "growth": by how much of itself the stiffness has grown at `reference` [rad/s]."""

    name = "stiffness_over_speed"
    title = "bearing stiffness over speed"
    orders = EVERY
    bearings: tuple[str, ...]
    reference: float

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with it, in proportion to the stiffness that its bearings have at that speed."""
        there = own_stiffness(model, self.bearings, self.reference)
        return with_added(model, Added(S=theta["growth"] / self.reference**2 * there))

    def words(self, theta: Theta) -> str:
        """Say by how much."""
        return (
            f"the stiffness of {bearing_words(self.bearings)} changes with the square of the speed: "
            f"{100 * theta['growth']:+.1f} % at {self.reference * RPM:.0f} rpm"
        )


def effects(rig: RigConfig) -> tuple[StiffnessOverSpeed, ...]:
    """Return one for every group of bearings sought; the reference is a speed in the middle of what the rig does."""
    unknown = (Parameter(name="growth", unit="", low=-0.5, high=0.5, size=0.1),)
    return tuple(
        StiffnessOverSpeed(where=where, bearings=names, reference=reference_speed(rig), parameters=unknown)
        for where, names in bearing_groups(rig).items()
    )
