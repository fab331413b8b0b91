"""Steady-state response to rotating loads: condensed receptances for fits, harmonic response, derivatives."""

from rotorrig.sims.rotor.steady.conjugate_solve import solve_with_conjugate
from rotorrig.sims.rotor.steady.derivatives import Derivatives, steady_derivatives
from rotorrig.sims.rotor.steady.harmonic_response import columns, load_columns, probe_response, steady_response
from rotorrig.sims.rotor.steady.receptance import Receptance, ReceptanceDerivatives, condense_groups

__all__ = [
    "Derivatives",
    "Receptance",
    "ReceptanceDerivatives",
    "columns",
    "condense_groups",
    "load_columns",
    "probe_response",
    "solve_with_conjugate",
    "steady_derivatives",
    "steady_response",
]
