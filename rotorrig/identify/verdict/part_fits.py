"""Fits of a model to parts of the data, begun at its fit to all of it.

A part moves that by little, so the derivatives there serve every part; it is only where the model is wrong that a
second step is needed. Under a force law, whose derivatives take longest, one has to do.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model import ExtendedProblem, Recording
from rotorrig.identify.least_squares import LinearModel, Point, inverse_information_root, take_step
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.rig import DataError


@dataclass(frozen=True, slots=True, kw_only=True)
class PartFit:
    """The fit to a part of the data."""

    problem: ExtendedProblem  # of that part
    p: Reals
    chi2: float  # of its rows, priors included
    jacobian: Reals  # (whitened figure + prior, parameter) of the last step


class PartFits:
    """Fits to parts of the data by the derivatives at the fit `p` to all of it."""

    def __init__(self, problem: ExtendedProblem, p: Reals) -> None:
        """Take the derivatives of `problem` at `p`."""
        exact = problem.taken_for_exact()
        self._problem = problem
        self._p = p
        self._J, self._r = exact.jacobian(p), exact.residual(p)
        self._steps = 1 if problem.model.moving(p).laws else VERDICT.refit_steps

    def are_of(self, problem: ExtendedProblem, p: Reals) -> bool:
        """Say whether these fits are of that problem, begun there."""
        return problem is self._problem and np.array_equal(p, self._p)

    def fit(self, recordings: Sequence[Recording]) -> PartFit:
        """Return the fit to recordings of which some vectors are not usable."""
        part = self._problem.on(recordings)
        start = PartFit(problem=part, p=self._p, chi2=float("nan"), jacobian=self._columns(part))
        return _refit(start, part.less_error(_usable_mask(part) * self._r), steps=self._steps)

    def spread(self, hidden: ExtendedProblem, fit: PartFit) -> Reals:
        """Return what a fit leaves open of what is hidden from it, (figure + prior, direction), one sigma each."""
        free = fit.problem.parameters.free
        return self._columns(hidden)[:, free] @ inverse_information_root(fit.jacobian[:, free])

    def _columns(self, part: ExtendedProblem) -> Reals:
        """Return the derivatives of what is usable in a part, whitened as there."""
        return part.less_error(_usable_mask(part)[:, None] * self._J)


def _refit(start: PartFit, r: Reals, *, steps: int) -> PartFit:
    """Return the fit from `start`, its residual `r` there, in `steps` or fewer."""
    problem, p, J = start.problem, start.p, start.jacobian
    free = problem.parameters.free
    low, high = problem.bounds

    def full(part: Reals) -> Reals:
        whole = p.copy()
        whole[free] = part
        return whole

    def evaluate(part: Reals) -> Point:
        try:
            with np.errstate(over="ignore", invalid="ignore"):  # of a step that goes too far, and is taken back
                reached = problem.residual(full(part))
        except DataError:  # a step too far, to where there is no motion
            reached = np.full(len(r), np.inf)
        return Point(part, reached, lambda: problem.jacobian(full(part))[:, free])

    enough = max(VERDICT.accurate, VERDICT.nearly * float(r @ r))
    for step in range(1, steps + 1):
        model = LinearModel(J[:, free], r, p[free], (low[free], high[free]))
        promise = model.promise(model.best(0.0))
        taken = take_step(evaluate, model) if promise > enough else None
        if taken is None:
            break
        p, r = full(taken.point.p), taken.point.r
        if step == steps or (promise < VERDICT.close * enough and promise - (model.cost - float(r @ r)) < enough):
            break
        J = problem.jacobian(p)
    return PartFit(problem=problem, p=p, chi2=float(r @ r), jacobian=J)


def _usable_mask(problem: ExtendedProblem) -> Reals:
    """Return 1 for every element of the residual that is usable, and every prior, 0 for the others."""
    usable = [np.repeat(m.usable, 2, axis=1).ravel() for r in problem.recordings for m in r.measured.values()]
    return np.concatenate([*usable, np.ones(len(problem.parameters.priors))]).astype(float)
