"""A coupling that is out of line: bored off centre, or motor and shaft misaligned.

An eccentric bore bends the coupling by the same amount wherever it stands: a constant force on the shaft's end, once
per turn. A coupling of two jaws or a few bolts is stiffer along one of its diameters than across it, by +-v; where the
motor's axis stands beside the shaft's end, by d, that is a force v d twice per turn. The same stiffness, turning, meets
the shaft's own motion, which at 1X answers by where its heavy spot is to the stiff diameter: -1/2 v e^{2 j s} r* of a
motion r, strongest near the critical speed. v and d themselves are told apart by it. The mean stiffness of the coupling
and the mean force on its offset are none of it: the one is the nameplate's, the other shifts the mean only.

Source: Sinha, Lees, Friswell, J. Sound Vib. 272 (2004) 967-989 (forces that do not change with speed); Tondl, Some
Problems of Rotor Dynamics (1965), ch. 2 (unequal stiffness that turns).
"""

from dataclasses import dataclass

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import Effect, Theta, pair, phasor, polar
from rotorrig.sims.effects.shaft_motion import forward, position_rows
from rotorrig.sims.rotor.model import Added, Load, RotorModel, with_added

SURE = 0.1  # of the most that is plausible: less is not worth a word


@dataclass(frozen=True, kw_only=True)
class Coupling(Effect):
    """The phasors "force 1X" and "force 2X" [N] at z = 0, and "stiffness" [N/m], v e^{2 j s}, stiffest at the angle s.

    All turn with the shaft. Where v / 2 times the end's flexibility at the critical speed comes to 1, the rotor is
    unstable there: on configs/rk4.toml at about 15 kN/m. Below that the response is exact in v.
    """

    name = "coupling"
    title = "coupling out of line"
    orders = (1, 2)
    linear = True

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with the stiffness that turns."""
        f = forward(position_rows(model, 0.0), model.rotation)
        return with_added(model, Added(T=phasor(theta, "stiffness") * np.outer(f, f)))

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return a force of either order."""
        push = forward(position_rows(model, 0.0), model.rotation)
        return tuple(Load(pattern=phasor(theta, f"force {n}X") * push, law="constant", order=n) for n in self.orders)

    def words(self, theta: Theta) -> str:
        """Say how hard it pushes, and what that says of the alignment."""
        (once, angle), (twice, _) = (polar(theta, f"force {n}X") for n in self.orders)
        text = (
            f"the coupling pushes the shaft's end with {once:.2g} N once per turn, {angle:.0f} deg from the keyphasor "
            f"mark, and with {twice:.2g} N twice per turn"
        )
        v, stiffest = polar(theta, "stiffness")
        if v > SURE * next(p.high for p in self.parameters if p.name == "stiffness re"):
            text += f"; it is stiffer by {2 * v / 1e3:.2g} kN/m at {stiffest / 2:.0f} deg than across"
        return text


def effects(rig: RigConfig) -> tuple[Coupling, ...]:
    """Return the one at the shaft's first end."""
    once, twice = (pair(f"force {n}X", "N", most=5.0, size=0.3, order=n, of_rig=True) for n in Coupling.orders)
    uneven = pair("stiffness", "N/m", most=5e3, size=1e3, order=1, of_rig=True)
    return (Coupling(parameters=once + twice + uneven),)
