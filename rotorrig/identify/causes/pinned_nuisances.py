"""Base fit with nuisances pinned at their priors: the starting point when an unmodelled cause has biased them.

A cause that the model lacks may bias gains and masses by many of their standard deviations, and from there a fit with
that cause does not converge to the truth. Pinned, they leave the rotor as it is.
"""

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Solution


def nuisances_biased(problem: ExtendedProblem, p: Reals) -> bool:
    """Say whether a nuisance of `p` is further off than its prior allows, as under an unmodelled cause."""
    return bool(np.abs(problem.parameters.prior_residual(p)).max(initial=0.0) > SELECTION.biased)


def fit_with_pinned_nuisances(problem: ExtendedProblem, p: Reals) -> Solution:
    """Fit `problem` from `p` with its nuisances pinned at their priors."""
    pinned = problem.parameters.pinned
    start = p.copy()
    start[list(pinned)] = list(pinned.values())
    return problem.solve(start, fixed=pinned, tolerance=SELECTION.pinned_settled, max_steps=SELECTION.steps)
