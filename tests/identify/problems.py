"""The least-squares problem of the base model, as an identification sets it up."""

from rotorrig.identify.base_fit import BaseProblem
from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import recordings_of
from rotorrig.identify.least_squares import Solution
from rotorrig.processing.response import OrderTrackedResponse


def problem_of(response: OrderTrackedResponse) -> ExtendedProblem:
    """Return that of one response at 1X."""
    return BaseProblem.of(recordings_of([response], orders=(1,))).problem


def refine(problem: ExtendedProblem, values: Reals) -> Solution:
    """Fit a problem from values of the base's unknowns, SI: the nameplate exact first, then with all free."""
    return problem.solve(problem.approach(values).p, damped=True)
