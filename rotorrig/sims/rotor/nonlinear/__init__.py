"""Response with nonlinear force laws (rub, clearance, cubic springs ...), steady and swept, and its derivatives.

Harmonic balance gives the forces on a periodic motion; a sweep steps the passed modes with them from turn to turn.
"""

from rotorrig.sims.rotor.nonlinear.force_law import Force, ForceLaw
from rotorrig.sims.rotor.nonlinear.law_changes import LawChange, LawDerivatives
from rotorrig.sims.rotor.nonlinear.steady_response import steady_law_derivatives, steady_with_law
from rotorrig.sims.rotor.nonlinear.swept_derivatives import swept_law_derivatives
from rotorrig.sims.rotor.nonlinear.swept_response import swept_with_law

__all__ = [
    "Force",
    "ForceLaw",
    "LawChange",
    "LawDerivatives",
    "steady_law_derivatives",
    "steady_with_law",
    "swept_law_derivatives",
    "swept_with_law",
]
