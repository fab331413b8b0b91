"""The base with its nuisances held at their priors: what a fit is begun from where they are drawn off.

A cause that the model lacks may draw gains and masses by many of their standard deviations, and from there a fit with
that cause does not find back. Held, they leave the rotor what it is.
"""

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Solution


def nuisances_biased(problem: ExtendedProblem, p: Reals) -> bool:
    """Say whether a nuisance of `p` is further off than its prior allows."""
    return bool(np.abs(problem.parameters.prior_residual(p)).max(initial=0.0) > SELECTION.biased)


def pinned_nuisances(problem: ExtendedProblem) -> dict[int, float]:
    """Return the nuisances that are not solved for anyway, at their priors: parameter -> value."""
    names = problem.parameters
    at_priors = names.start(np.zeros(0))
    return {int(i): float(at_priors[i]) for i in names.priors if i not in names.linear_nuisances}


def fit_with_pinned_nuisances(problem: ExtendedProblem, p: Reals) -> Solution:
    """Fit `problem` from `p` with its nuisances held at their priors."""
    held = pinned_nuisances(problem)
    return problem.solve(_at_priors(p, held), fixed=held, tolerance=SELECTION.pinned_settled, max_steps=SELECTION.steps)


def _at_priors(p: Reals, held: dict[int, float]) -> Reals:
    out = p.copy()
    out[list(held)] = list(held.values())
    return out
