"""Damping that turns with the shaft: of its material, or of a disk that rubs on its seat.

In the rotor's axes it resists the change of shape. A forward circular orbit is at rest in the rotor and does not feel
it; a backward one is felt at the frequency 2 Omega. Source: Genta, Dynamics of Rotating Systems (2005), section 2.4;
Kimball, Internal friction theory of shaft whirling, Gen. Electr. Rev. 27 (1924) 244.

Viscous, that is C = beta K_s and a circulatory beta Omega K_s J in our axes. But what materials and dry seats lose
grows less than in proportion to frequency, and what loses energy also stiffens: stress goes with a derivative of the
strain whose order is a fraction, (j w)^a, a = 1 for a viscous one. Source: Bagley, Torvik, A theoretical basis for the
application of fractional calculus to viscoelasticity, J. Rheology 27 (1983) 201.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.places import reference_speed
from rotorrig.sims.effects.shaft_motion import pairwise_map
from rotorrig.sims.rotor.model import Added, Direction, RotorModel, with_added

Matrix = NDArray[np.float64]

J = ((0.0, 1.0), (-1.0, 0.0))
#: of the reference, where a power of the frequency has to be right: it is within 1 % from 0.36 on, within 3 % at 0.3
SPEEDS = np.linspace(0.3, 1.8, 31)
TO_POWERS = np.linalg.pinv(np.vander(SPEEDS, 3, increasing=True))  # of a function there: constant, linear, squared


@dataclass(frozen=True, kw_only=True)
class InternalDamping(Effect):
    """The time "beta" [s], rotating damping beta K_s of the whole shaft, and the "exponent" of frequency.

    The time is that of a backward whirl at the speed `reference` [rad/s]. Without the exponent it is viscous.
    """

    name = "internal_damping"
    title = "internal damping of the shaft"
    orders = EVERY
    reference: float

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with it; what is not viscous, above 1X as at 1X."""
        return with_added(model, self._build_matrices(model.shaft.K, model, theta)) if theta["beta"] else model

    def change_along_shaft(self, along: Direction, model: RotorModel, theta: Theta) -> Direction:
        """Return the derivative with that of the rotating damping: it is in proportion to the stiffness."""
        more = self._build_matrices(along.K.real, model, theta)._asdict()
        return along._replace(**{name: getattr(along, name) + A for name, A in more.items() if A is not None})

    def _build_matrices(self, stiffness: Matrix, model: RotorModel, theta: Theta) -> Added:
        """Return its matrices for a shaft of that stiffness."""
        circulatory = stiffness @ pairwise_map(model, J)
        skew = model.rotation * (circulatory - circulatory.T) / 2  # exactly so, but for rounding and the reduction
        beta, exponent = theta["beta"], theta.get("exponent", 1.0)
        if exponent == 1.0:
            return Added(C=beta * stiffness, H=beta * skew)
        backward = (stiffness - 1j * skew) / 2  # of a motion its backward part alone
        seen = 2 * self.reference * beta * 1j**exponent * SPEEDS**exponent
        constant, once, squared = (c * backward / self.reference**n for n, c in enumerate(TO_POWERS @ seen))
        return Added(K=constant, H=once.real, C=once.imag, S=squared.real, G=squared.imag)

    def words(self, theta: Theta) -> str:
        """Say how large it is."""
        exponent = theta.get("exponent", 1.0)
        growing = f", growing with the power {exponent:.1f} of frequency" if exponent != 1.0 else ""
        return f"the shaft has rotating damping of {1e6 * theta['beta']:.0f} us times its stiffness{growing}"


def effects(rig: RigConfig) -> tuple[InternalDamping, ...]:
    """Return the one of the shaft."""
    beta = Parameter(name="beta", unit="s", low=0.0, high=5e-4, size=5e-5)
    exponent = Parameter(name="exponent", unit="", low=0.1, high=1.2, size=0.3, at_zero=1.0)
    guesses = ({"exponent": 0.5}, {"exponent": 1.0})  # of plastics and seats; viscous
    return (InternalDamping(reference=reference_speed(rig), parameters=(beta, exponent), initial_guesses=guesses),)
