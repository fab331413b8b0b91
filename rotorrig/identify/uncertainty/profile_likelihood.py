"""The interval within which the profiled chi2 rises by no more than a given amount: profile likelihood.

Profiled means: as small as all other parameters can make it while one quantity is held (Venzon and Moolgavkar, Appl.
Statist. 37 (1988) 87). The root of its rise is nearly a straight line on either side of the optimum, exactly so where
chi2 is a parabola; so a secant finds where it is 1.96, and each trial starts from the last with one step for the move
and a few to settle. An end takes two to eight Jacobians.

An end that the bounds of the fit forestall is the bound: the data are content with everything up to there.
"""

from dataclasses import dataclass

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Solution, inverse_information
from rotorrig.identify.uncertainty.quantities import Amount, Phase, Quantity
from rotorrig.identify.uncertainty.settings import UNCERTAINTY

_SETTINGS = UNCERTAINTY.profile


@dataclass(frozen=True, slots=True, kw_only=True)
class End:
    """One end of an interval."""

    coordinate: float
    bound: bool  # a bound came first
    converged: bool


def profile_interval(
    problem: ExtendedProblem, best: Solution, quantity: Quantity, *, rise: float
) -> tuple[float, float] | None:
    """Return the least and the largest value [SI] of `quantity` at which the profiled chi2 is `rise` above the optimum.

    Where the fit is worse than the noise the rise is enlarged as the covariance is. Returns None where an end is not
    found, and for the phase of an unbalance that may be none at all.
    """
    limit = best.chi2 + rise * max(1.0, best.chi2 / best.dof)
    if isinstance(quantity, (Amount, Phase)) and _may_be_none(problem, best, quantity.at, limit):
        if isinstance(quantity, Phase):
            return None
        low = End(coordinate=0.0, bound=True, converged=True)
    else:
        low = find_end(problem, best, quantity, side=-1, limit=limit)
    high = find_end(problem, best, quantity, side=+1, limit=limit)
    if not (low.converged and high.converged):
        return None
    return quantity.si(low.coordinate), quantity.si(high.coordinate)


def find_end(problem: ExtendedProblem, best: Solution, quantity: Quantity, *, side: int, limit: float) -> End:
    """Return the largest (`side` +1) or the least (-1) coordinate at which the profiled chi2 is `limit`."""
    rise = limit - best.chi2
    bound = quantity.high if side > 0 else quantity.low
    here = _Point(problem, quantity, best.p, J=best.jacobian)
    bracket = _Bracket(here, side=side, rise=rise)
    for _ in range(_SETTINGS.trials):
        bracket.take(here)
        at_bound = abs(here.coordinate - bound) <= _SETTINGS.at_bound * here.scale and here.chi2 <= limit
        if at_bound or abs(here.chi2 - limit) <= _SETTINGS.close * rise or bracket.narrow:
            end = bound if at_bound else here.coordinate
            return End(coordinate=end, bound=at_bound, converged=True)
        target = min(side * bracket.next(), side * bound) * side
        here = _minimize_at(bracket.inside, target, tolerance=_SETTINGS.settled * rise, limit=limit)
    return End(coordinate=bracket.inside.coordinate, bound=False, converged=False)


class _Point:
    """A parameter vector, its residual, and its Jacobian once it is asked for."""

    def __init__(self, problem: ExtendedProblem, quantity: Quantity, p: Reals, *, J: Reals | None = None) -> None:
        self.p = p
        self.coordinate = quantity.read(p)
        self.r = problem.residual(p)
        with np.errstate(over="ignore"):  # of a step that goes too far, and is shortened
            self.chi2 = float(self.r @ self.r)
        self.gradient = quantity.gradient(p)
        self._problem = problem
        self._quantity = quantity
        self._J = J

    @property
    def J(self) -> Reals:  # noqa: N802
        if self._J is None:
            self._J = self._problem.jacobian(self.p)
        return self._J

    @property
    def room(self) -> tuple[Reals, Reals]:
        low, high = self._problem.parameters.bounds
        return low - self.p, high - self.p

    @property
    def scale(self) -> float:
        return self._quantity.scale(self.p)

    def moved(self, step: Reals) -> "_Point":
        return _Point(self._problem, self._quantity, self.p + step)


class _Bracket:
    """The farthest point with chi2 below the limit, and the nearest beyond with chi2 above."""

    def __init__(self, optimum: _Point, *, side: int, rise: float) -> None:
        self.inside = optimum
        self._outside: _Point | None = None
        self._optimum = optimum
        self._side = side
        self._goal = np.sqrt(rise)
        self._taken: list[bool] = []  # whether the points were inside

    def take(self, point: _Point) -> None:
        self._taken.append(self._root(point) <= self._goal)
        if self._taken[-1]:
            self.inside = point
        else:
            self._outside = point

    @property
    def narrow(self) -> bool:
        if self._outside is None:
            return False
        width = abs(self._outside.coordinate - self.inside.coordinate)
        return width <= _SETTINGS.narrow * abs(self.inside.coordinate - self._optimum.coordinate)

    def next(self) -> float:
        """Return where the root of the rise would be the goal if it were straight; halfway if that failed twice."""
        inside, outside = self.inside, self._outside
        if outside is not None:
            low, high = self._root(inside), self._root(outside)
            part = np.clip((self._goal - low) / (high - low), _SETTINGS.inside, 1 - _SETTINGS.inside)
            if len(self._taken) > 2 and self._taken[-1] == self._taken[-2]:  # the other end is a bad guide
                part = 0.5
            return inside.coordinate + part * (outside.coordinate - inside.coordinate)
        variance = inside.gradient @ inverse_information(inside.J) @ inside.gradient
        ahead = (self._goal - self._root(inside)) * np.sqrt(variance)
        return inside.coordinate + self._side * min(ahead, _SETTINGS.longest * inside.scale)

    def _root(self, point: _Point) -> float:
        return float(np.sqrt(max(point.chi2 - self._optimum.chi2, 0.0)))


def _minimize_at(start: _Point, target: float, *, tolerance: float, limit: float) -> _Point:
    """Return the point with the least chi2 at the coordinate `target`, or any there if none is below the limit."""
    here = start.moved(_step(start, ahead=target - start.coordinate)[0])
    for _ in range(_SETTINGS.steps):
        step, promise = _step(here, ahead=target - here.coordinate)
        if promise <= tolerance or here.chi2 - promise > limit:
            break
        shorter = (here.moved(step / 2**halvings) for halvings in range(_SETTINGS.halvings))
        better = next((point for point in shorter if point.chi2 < here.chi2), None)
        if better is None:
            break
        here = better
    return here


def _step(here: _Point, *, ahead: float) -> tuple[Reals, float]:
    """Return the step to the least |r + J step|^2 that moves the coordinate by `ahead`, and by how much that falls.

    Parameters that would leave their bounds go as far as these and are held there; cut short alone, they would part
    from those they are correlated with.
    """
    Q, R = np.linalg.qr(here.J)
    along = Q.T @ here.r
    step = np.zeros(len(here.p))
    free = np.ones(len(here.p), dtype=bool)
    while True:
        covariance = inverse_information(R[:, free])
        step[free] = -covariance @ (R[:, free].T @ (along + R[:, ~free] @ step[~free]))
        toward = covariance @ here.gradient[free]
        if toward.any():
            missing = ahead - here.gradient @ step
            step[free] += missing / (here.gradient[free] @ toward) * toward
        held = np.clip(step, *here.room)
        out = free & (np.abs(held - step) > _SETTINGS.at_bound)
        if not out.any():
            return held, float(along @ along - np.sum((along + R @ held) ** 2))
        step[out] = held[out]
        free &= ~out


def _may_be_none(problem: ExtendedProblem, best: Solution, at: slice, limit: float) -> bool:
    """Say whether chi2 is within the limit without the unbalance whose re and im are at `at`."""
    widest = np.sqrt(np.linalg.eigvalsh(best.covariance[at, at])[-1])
    if np.linalg.norm(best.p[at]) > _SETTINGS.none * widest:
        return False
    nothing = dict(zip(range(at.start, at.stop), _SETTINGS.nothing * best.p[at], strict=True))
    return problem.solve(best.p, fixed=nothing).chi2 <= limit
