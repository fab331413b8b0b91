"""Solve the least-squares problem of a fit, some of its parameters held, and say how well the rest are determined."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from rotorrig.identify.chea.residuals import (
    FIT,
    Minimum,
    Point,
    Stop,
    minimize_squares,
    triangular_factor,
)
from rotorrig.rig import DataError

Reals = NDArray[np.float64]
Index = NDArray[np.intp]

NONE_FIXED: Mapping[int, float] = MappingProxyType({})

Worth = Callable[[float, float], bool]  # of the sum of squares and of what a full step promises to take from it


@dataclass(frozen=True, slots=True, kw_only=True)
class LeastSquaresSettings:
    """End of a fit, and what its data leave open."""

    tolerance: float = 1e-4  # of chi2: a step of a hundredth of a standard deviation
    steps: int = 50  # a fit that takes as many does not converge
    unbounded: float = 1e100  # sigma per unit: so does an unstable rotor move, and no square of more is finite
    rounding: float = 1e-9  # singular value of the scaled Jacobian, relative: less is rounding


LEAST_SQUARES = LeastSquaresSettings()


def always(cost: float, promise: float) -> bool:
    """Go on."""
    return True


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """A refined candidate: parameters, their covariance and how well it fits."""

    p: Reals  # (parameter,) in the order of the problem's names
    covariance: Reals  # (parameter, parameter), scaled up where the fit is worse than the noise; 0 for what was fixed
    jacobian: Reals  # (whitened figure + prior, parameter) at p; 0 for what was fixed
    chi2: float  # measured figures and priors together
    dof: int
    stop: Stop = Stop.CONVERGED  # given up: its chi2 is no less than the best

    @property
    def sigma(self) -> Reals:
        """Standard deviations, (parameter,)."""
        return np.sqrt(np.diag(self.covariance))


class LeastSquares(Protocol):
    """What is solved."""

    @property
    def bounds(self) -> tuple[Reals, Reals]:
        """Lower and upper bounds of the parameters."""
        ...

    @property
    def size(self) -> int:
        """Number of real figures measured, and of priors."""
        ...

    def residual(self, p: Reals) -> Reals:
        """Return whitened residuals, (figure + prior,)."""
        ...

    def jacobian(self, p: Reals, free: Index | None = None) -> Reals:
        """Return the columns `free` of its derivatives."""
        ...

    def solve_linear(self, p: Reals, free: Index) -> Reals:
        """Return `p` with the linear parameters among `free` at their best."""
        ...


def solve(
    problem: LeastSquares,
    start: Reals,
    *,
    fixed: Mapping[int, float] = NONE_FIXED,
    tolerance: float = LEAST_SQUARES.tolerance,
    share: float = 0.0,
    of_excess: bool = False,
    max_steps: int = LEAST_SQUARES.steps,
    worth: Worth = always,
    damped: bool = False,
    jacobian: Reals | None = None,
) -> Solution:
    """Refine `start` within the bounds, the parameters in `fixed` held at those values.

    It has converged when a full step promises less than `tolerance`, or than a `share` of chi2; with `of_excess` that
    is a share of what chi2 is beyond the degrees of freedom. It is given up where `worth`, asked before every step but
    the first, says no. With `damped` no full steps are tried first and the linear parameters are solved for after every
    step: where a residual takes as long as a Jacobian, full steps cost more than they gain. `jacobian` is that at
    `start`, where it is known; not with `damped`, which begins elsewhere.
    """
    p = start.copy()
    p[list(fixed)] = list(fixed.values())
    free = np.setdiff1d(np.arange(len(p)), list(fixed))
    low, high = problem.bounds
    part = _Free(problem, p, free)
    with np.errstate(over="ignore", invalid="ignore"):  # steps too far, taken back; columns without bound
        minimum = minimize_squares(
            part,
            part.first(part.solve_linear(p[free])) if damped else part.first(p[free], jacobian),
            bounds=(low[free], high[free]),
            settings=replace(FIT, full_steps=not damped),
            solve_linear=part.solve_linear,
            tolerance=tolerance,
            share=share,
            floor=float(problem.size - len(free)) if of_excess else 0.0,
            max_steps=max_steps,
            watch=lambda at: None if worth(at.point.cost, at.model.full_promise) else Stop.GIVEN_UP,
        )
        return _solution(minimum, part.full(minimum.point.p), free, size=problem.size)


class _Free:
    """The problem in its free parameters alone."""

    def __init__(self, problem: LeastSquares, p: Reals, free: Index) -> None:
        self._problem = problem
        self._p = p
        self._free = free
        self._figures = 1

    def full(self, part: Reals) -> Reals:
        """Return the whole vector."""
        whole = self._p.copy()
        whole[self._free] = part
        return whole

    def first(self, part: Reals, jacobian: Reals | None = None) -> Point:
        """Return the point a fit begins from, its Jacobian if it is known. Raises DataError if nothing moves there."""
        r = self._problem.residual(self.full(part))
        self._figures = len(r)
        return Point(part, r, partial(self._jacobian, part) if jacobian is None else lambda: jacobian[:, self._free])

    def __call__(self, part: Reals) -> Point:
        """Return a point; a step too far, to where the model has no motion or to no number, costs infinitely."""
        try:
            if not np.isfinite(part).all():
                raise DataError(f"parameters are {part}, want finite ones")
            r = self._problem.residual(self.full(part))
        except DataError:
            r = np.full(self._figures, np.inf)
        return Point(part, r, partial(self._jacobian, part))

    def solve_linear(self, part: Reals) -> Reals:
        """Return the free parameters with the linear ones at their best."""
        try:
            return self._problem.solve_linear(self.full(part), self._free)[self._free]
        except (DataError, np.linalg.LinAlgError):
            return part

    def _jacobian(self, part: Reals) -> Reals:
        """Return the Jacobian, 0 along what moves the model without bound, where there is no telling a good step."""
        J = self._problem.jacobian(self.full(part), self._free)
        bounded = np.all(np.abs(J) < LEAST_SQUARES.unbounded, axis=0)  # NaN is not
        return J if bounded.all() else np.where(bounded, J, 0.0)


def _solution(minimum: Minimum, p: Reals, free: Index, *, size: int) -> Solution:
    """Return a minimum over the parameters `free` as one over all of `p`."""
    dof, cost, part = size - len(free), minimum.point.cost, minimum.point.J
    jacobian = np.zeros((len(part), len(p)))
    jacobian[:, free] = part
    covariance = np.zeros((len(p), len(p)))
    covariance[np.ix_(free, free)] = inverse_information(part) * max(1.0, cost / max(dof, 1))
    return Solution(p=p, covariance=covariance, jacobian=jacobian, chi2=cost, dof=dof, stop=minimum.stop)


def inverse_information(jacobian: Reals) -> Reals:
    """Return (J^T J)^-1, (parameter, parameter); what the rows leave open gets a large variance, never a small one."""
    root = inverse_information_root(jacobian)
    return root @ root.T


def inverse_information_root(jacobian: Reals) -> Reals:
    """Return R with R R^T = (J^T J)^-1, (parameter, direction): it holds variances that are too unlike for a sum."""
    length = np.linalg.norm(jacobian, axis=0)
    scale = np.divide(1.0, length, out=np.ones_like(length), where=length > 0)
    root, _ = triangular_factor(jacobian * scale)
    square = np.pad(root, ((0, len(length) - len(root)), (0, 0)))  # fewer rows than parameters leave some open
    _, size, directions = np.linalg.svd(square)
    return scale[:, None] * directions.T / np.maximum(size, LEAST_SQUARES.rounding * size[0])


def squared_distance(off: Reals, root: Reals) -> float:
    """Return off^T (R R^T)^-1 off, the square of the Mahalanobis distance; R (parameter, direction) of full rank.

    By the triangular factor of R, each row of it scaled: R R^T would lose the directions of small variance beside those
    that are left open.
    """
    scale = 1.0 / np.linalg.norm(root, axis=1)
    triangle = np.linalg.qr((scale[:, None] * root).T, mode="r")
    whitened = linalg.solve_triangular(triangle, scale * off, trans="T")
    return float(whitened @ whitened)
