"""Force laws on the rotor (rub, clearance, cubic springs ...).

Harmonic balance, time stepping, swept motion, tangents.
"""

from rotorrig.sims.rotor.nonlinear.changes import LawChange, LawDerivatives
from rotorrig.sims.rotor.nonlinear.force_law import ForceLaw
from rotorrig.sims.rotor.nonlinear.steady_response import steady_law_derivatives, steady_with_law
from rotorrig.sims.rotor.nonlinear.swept_derivatives import swept_law_derivatives
from rotorrig.sims.rotor.nonlinear.swept_response import swept_with_law

__all__ = [
    "ForceLaw",
    "LawChange",
    "LawDerivatives",
    "steady_law_derivatives",
    "steady_with_law",
    "swept_law_derivatives",
    "swept_with_law",
]
