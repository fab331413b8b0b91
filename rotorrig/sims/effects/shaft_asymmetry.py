"""A shaft that is not equally stiff both ways: a keyway, a flat, rolled stock.

In the rotor's axes the stiffness differs by +-delta. As it turns under gravity its sag moves twice per turn, forward,
with a resonance at half the critical speed. At 1X the shaft is stiffer or softer by which side the unbalance bends it
to: the force -delta K_s e^{2 j gamma} r* on a forward motion r, strongest near the critical speed. Source: Tondl, Some
Problems of Rotor Dynamics (1965), ch. 2; Yamamoto, Ishida, Linear and Nonlinear Rotordynamics (2012), ch. 5.
"""

from dataclasses import dataclass

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import Complex, Effect, Theta, pair, phasor, polar
from rotorrig.sims.effects.shaft_motion import at_rest, pairwise_map
from rotorrig.sims.rotor.model import Added, Load, RotorModel, with_added


@dataclass(frozen=True, kw_only=True)
class ShaftAsymmetry(Effect):
    """The phasor "asymmetry", delta e^{j 2 gamma}: delta of the stiffness, stiffest at the angle gamma."""

    name = "shaft_asymmetry"
    title = "asymmetric shaft"
    orders = (1, 2)
    linear = True
    gravity: str  # as in RigConfig

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with the stiffness that turns."""
        T = phasor(theta, "asymmetry") * _turning(model)
        return with_added(model, Added(T=(T + T.T) / 2))  # symmetric, but for rounding and what a reduction leaves out

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return its force on the sag, first order in delta."""
        pattern = -phasor(theta, "asymmetry") * (_turning(model) @ at_rest(model, self.gravity))
        return (Load(pattern=pattern, law="constant", order=2),)

    def words(self, theta: Theta) -> str:
        """Say by how much, and which way it is stiffest."""
        size, angle = polar(theta, "asymmetry")
        return (
            f"the shaft's stiffness differs by +-{100 * size:.2f} % around it, largest at {angle / 2:.0f} deg from the "
            f"keyphasor mark"
        )


def _turning(model: RotorModel) -> Complex:
    """Return T of a stiffness Re(T e^{2 j theta}) that makes K_s r* e^{2 j theta} of r = x + j y."""
    s = model.rotation
    turning: Complex = model.shaft.K @ pairwise_map(model, [[1, -1j * s], [-1j * s, -1]])
    return turning


def effects(rig: RigConfig) -> tuple[ShaftAsymmetry, ...]:
    """Return the one of the shaft; none where gravity does not bend it."""
    if rig.gravity == "none":
        return ()
    return (ShaftAsymmetry(gravity=rig.gravity, parameters=pair("asymmetry", "", most=0.1, size=0.01)),)
