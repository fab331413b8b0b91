"""Solve the least-squares problem of a fit, some of its parameters held, and say how well the rest are determined."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.least_squares.levenberg_marquardt import (
    TOLERANCE,
    Minimum,
    Stop,
    Worth,
    always,
    minimise,
    triangular_factor,
)
from rotorrig.rig import DataError

Reals = NDArray[np.float64]
Index = NDArray[np.intp]

OPEN = 1e-9  # singular value of the scaled Jacobian, relative, below which it is rounding
NONE_FIXED: Mapping[int, float] = MappingProxyType({})


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
    tolerance: float = TOLERANCE,
    max_steps: int = 50,
    worth: Worth = always,
    damped: bool = False,
) -> Solution:
    """Refine `start` within the bounds, the parameters in `fixed` held at those values; as least_squares.minimise."""
    p = start.copy()
    p[list(fixed)] = list(fixed.values())
    free = np.setdiff1d(np.arange(len(p)), list(fixed))
    low, high = problem.bounds

    def full(part: Reals) -> Reals:
        whole = p.copy()
        whole[free] = part
        return whole

    known: list[int] = []

    def residual(part: Reals) -> Reals:
        try:
            r = problem.residual(full(part))
        except DataError:  # a step too far, to where the model has no motion: not if it began there
            if not known:
                raise
            return np.full(known[0], np.inf)
        known.append(len(r))
        return r

    def settle(part: Reals) -> Reals:
        try:
            return problem.solve_linear(full(part), free)[free]
        except DataError:
            return part

    with np.errstate(over="ignore", invalid="ignore"):  # steps that go too far, and are taken back
        found = minimise(
            residual,
            lambda part: problem.jacobian(full(part), free),
            p[free],
            bounds=(low[free], high[free]),
            settle=settle,
            tolerance=tolerance,
            max_steps=max_steps,
            worth=worth,
            damped=damped,
        )
    return _polished(found, full(found.p), free, size=problem.size)


def _polished(found: Minimum, p: Reals, free: Index, *, size: int) -> Solution:
    """Return a solution of the parameters `free` as one of all of `p`."""
    dof = size - len(free)
    jacobian = np.zeros((len(found.jacobian), len(p)))
    jacobian[:, free] = found.jacobian
    covariance = np.zeros((len(p), len(p)))
    covariance[np.ix_(free, free)] = inverse_information(found.jacobian) * max(1.0, found.cost / max(dof, 1))
    return Solution(p=p, covariance=covariance, jacobian=jacobian, chi2=found.cost, dof=dof, stop=found.stop)


def inverse_information(jacobian: Reals) -> Reals:
    """Return (J^T J)^-1, (parameter, parameter); what the rows leave open gets a large variance, never a small one."""
    length = np.linalg.norm(jacobian, axis=0)
    scale = np.divide(1.0, length, out=np.ones_like(length), where=length > 0)
    root, _ = triangular_factor(jacobian * scale)
    square = np.pad(root, ((0, len(length) - len(root)), (0, 0)))  # fewer rows than parameters leave some open
    _, size, directions = np.linalg.svd(square)
    root = scale[:, None] * directions.T / np.maximum(size, OPEN * size[0])
    return root @ root.T
