"""A coupling that is out of line: bored off centre, or motor and shaft misaligned.

What turns with it pushes the shaft's end round once per turn; a fixed offset of the two shafts makes a force twice per
turn, as a two-jaw or disc-pack coupling is stiffer one way. Both are constant over speed. Source: Sinha, Lees,
Friswell, J. Sound Vib. 272 (2004) 967-989.
"""

from dataclasses import dataclass

from rotorrig.rig.description import RigConfig
from rotorrig.sims.effects.base import Effect, Theta, pair, phasor, polar
from rotorrig.sims.effects.shaft_motion import forward, position_rows
from rotorrig.sims.rotor.assembly import RotorModel
from rotorrig.sims.rotor.loads import Load


@dataclass(frozen=True, kw_only=True)
class Coupling(Effect):
    """The phasors "force 1X" and "force 2X" [N] at the coupling, z = 0, both turning with the shaft."""

    name = "coupling"
    title = "coupling out of line"
    orders = (1, 2)
    linear = True

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return a force of either order."""
        push = forward(position_rows(model, 0.0), model.rotation)
        return tuple(Load(pattern=phasor(theta, f"force {n}X") * push, law="constant", order=n) for n in self.orders)

    def words(self, theta: Theta) -> str:
        """Say how hard it pushes."""
        (once, angle), (twice, _) = (polar(theta, f"force {n}X") for n in self.orders)
        return (
            f"the coupling pushes the shaft's end with {once:.2g} N once per turn, {angle:.0f} deg from the keyphasor "
            f"mark, and with {twice:.2g} N twice per turn"
        )


def effects(rig: RigConfig) -> tuple[Coupling, ...]:
    """Return the one at the shaft's first end."""
    once, twice = (pair(f"force {n}X", "N", most=5.0, size=0.3, order=n) for n in Coupling.orders)
    return (Coupling(parameters=once + twice),)
