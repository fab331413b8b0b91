"""Modal solution over one sweep, cached and shared by all load cases."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rotorrig.sims.rotor.model import RotorModel
from rotorrig.sims.rotor.swept.envelope import Envelope
from rotorrig.sims.rotor.swept.passed_modes import Spectra, fit_passed_modes, solve_spectra
from rotorrig.sims.rotor.swept.tracking_windows import TrackedRows

KEPT = 2  # models whose solution is kept: a fit asks for a response, then for its derivatives, or for those before


@dataclass(frozen=True, slots=True, kw_only=True)
class SweptSolution:
    """Poles over the speed, and the propagators from turn to turn."""

    spectra: Spectra
    envelope: Envelope
    motions: list[tuple[Any, Any]] = field(default_factory=list, repr=False, compare=False)  # of swept_motion.py


def solve_sweep(model: RotorModel, rows: TrackedRows) -> SweptSolution:
    """Solve `model` over the rows at their order; the last few solutions are kept with the rows.

    Raises ConfigError on a bearing that depends on speed.
    """
    for known, solution in rows.solutions:
        if known is model:
            kept: SweptSolution = solution
            return kept
    solution = _solve(model, rows)
    rows.solutions.append((model, solution))
    del rows.solutions[:-KEPT]
    return solution


def _solve(model: RotorModel, rows: TrackedRows) -> SweptSolution:
    spectra = solve_spectra(model, rows.speeds, order=rows.order)
    modes = fit_passed_modes(spectra, np.zeros((model.dof, 0), dtype=complex))
    return SweptSolution(spectra=spectra, envelope=Envelope(modes.L, modes.T, rows))
