"""95 % intervals of the estimates: from the covariance where that is good enough, else from the profile likelihood.

The covariance is that of a quadratic chi2. Near a bound of the search, and where a parameter is known so badly that
the response is not linear in it over the width of the interval, it misleads: a damping at its lower bound has a huge
symmetric sigma, while the data do say how much there can be at most.
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.identification import Estimate
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.uncertainty.profile_likelihood import profile_interval
from rotorrig.identify.uncertainty.quantities import Coefficient, Phase, Quantity, quantities
from rotorrig.identify.uncertainty.settings import UNCERTAINTY


def with_intervals(
    estimates: Iterable[Estimate], best: Solution, problem: ExtendedProblem, *, unseen: str = "", profile: bool = False
) -> tuple[Estimate, ...]:
    """Return the estimates of a fit with their intervals; with `profile` all of these are of the profile likelihood.

    `unseen` names the axes no probe looks along: the coefficients of these have several valleys and get no interval.
    If the covariance is not to be trusted for one quantity, it is not for those correlated with it: all are profiled.
    """
    sought = quantities(problem.parameters.base, best.p)
    if problem.model.amplitudes_alone:
        sought = tuple(quantity for quantity in sought if not isinstance(quantity, Phase))
    hidden = [isinstance(q, Coefficient) and any(axis in unseen for axis in q.axes) for q in sought]
    profile = profile or any(_wants_profile(best, q) for q, out in zip(sought, hidden, strict=True) if not out)
    with_interval = []
    for estimate, quantity, out in zip(estimates, sought, hidden, strict=True):
        if out:
            with_interval.append(estimate)
        elif profile:
            within = profile_interval(problem, best, quantity, rise=UNCERTAINTY.rise)
            with_interval.append(replace(estimate, interval=within, interval_by="profile likelihood" if within else ""))
        else:
            with_interval.append(replace(estimate, interval=normal_interval(best, quantity), interval_by="covariance"))
    return tuple(with_interval)


def normal_interval(best: Solution, quantity: Quantity) -> tuple[float, float]:
    """Return the interval [SI] that is symmetric in the coordinate of `quantity`: in the logarithm of a stiffness."""
    middle, sigma = quantity.read(best.p), standard_deviation(best, quantity)
    return quantity.si(middle - UNCERTAINTY.half_width * sigma), quantity.si(middle + UNCERTAINTY.half_width * sigma)


def standard_deviation(best: Solution, quantity: Quantity) -> float:
    """Return that of its coordinate."""
    gradient = quantity.gradient(best.p)
    return float(np.sqrt(gradient @ best.covariance @ gradient))


def _wants_profile(best: Solution, quantity: Quantity) -> bool:
    sigma = standard_deviation(best, quantity)
    middle = quantity.read(best.p)
    room = min(middle - quantity.low, quantity.high - middle)
    return bool(sigma > UNCERTAINTY.curved * quantity.scale(best.p) or room < UNCERTAINTY.near * sigma)
