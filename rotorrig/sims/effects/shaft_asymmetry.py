"""A shaft that is not equally stiff both ways: a keyway, a flat, rolled stock.

In the rotor's axes the stiffness differs by +-delta; as it turns under gravity its sag moves twice per turn, forward,
with a resonance at half the critical speed. At 1X it shifts the critical speed by which side the unbalance is on, which
a response linear in its phasors cannot tell and this leaves out. Source: Tondl, Some Problems of Rotor Dynamics (1965),
ch. 2; Yamamoto, Ishida, Linear and Nonlinear Rotordynamics (2012), ch. 5.
"""

from dataclasses import dataclass

from rotorrig.rig.description import RigConfig
from rotorrig.sims.effects.base import Effect, Theta, pair, phasor, polar
from rotorrig.sims.effects.shaft_motion import at_rest, pairwise_map
from rotorrig.sims.rotor.assembly import RotorModel
from rotorrig.sims.rotor.loads import Load


@dataclass(frozen=True, kw_only=True)
class ShaftAsymmetry(Effect):
    """The phasor "asymmetry", delta e^{j 2 gamma}: delta of the stiffness, stiffest at the angle gamma."""

    name = "shaft_asymmetry"
    title = "asymmetric shaft"
    orders = (2,)
    linear = True
    gravity: str  # as in RigConfig

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return the force -delta e^{j 2 (theta + gamma)} K_s r* of the sag r = x + j y, first order in delta."""
        s = model.rotation
        sag = pairwise_map(model, [[1, -1j * s], [-1j * s, -1]]) @ at_rest(model, self.gravity)
        pattern = -phasor(theta, "asymmetry") * model.shaft.K @ sag
        return (Load(pattern=pattern, law="constant", order=2),)

    def words(self, theta: Theta) -> str:
        """Say by how much, and which way it is stiffest."""
        size, angle = polar(theta, "asymmetry")
        return (
            f"the shaft's stiffness differs by +-{100 * size:.2f} % around it, largest at {angle / 2:.0f} deg from the "
            f"keyphasor mark"
        )


def effects(rig: RigConfig) -> tuple[ShaftAsymmetry, ...]:
    """Return the one of the shaft; none where gravity does not bend it."""
    if rig.gravity == "none":
        return ()
    return (ShaftAsymmetry(gravity=rig.gravity, parameters=pair("asymmetry", "", most=0.1, size=0.01)),)
