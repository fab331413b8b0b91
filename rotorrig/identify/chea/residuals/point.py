"""`Point`: residuals and their Jacobian in one place, and how a descent asks for the next."""

from collections.abc import Callable, Generator
from typing import Concatenate, ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Residual = Callable[[Array], tuple[Array, Array]]  # u (dim,) -> r (figure,) and dr/du (figure, dim)
P = ParamSpec("P")
T = TypeVar("T")


class Point:
    """A place, the residuals there, and their Jacobian once it is asked for."""

    __slots__ = ("_jacobian", "_normal", "cost", "p", "r")

    def __init__(self, p: Array, r: Array, jacobian: Array | Callable[[], Array]) -> None:
        """`p` (parameter,), `r` (figure,), `jacobian` (figure, parameter) or what returns it."""
        self.p = p
        self.r = r
        self.cost = sum_of_squares(r)
        self._jacobian = jacobian
        self._normal: Array | None = None

    @property
    def J(self) -> Array:  # noqa: N802
        """Jacobian, (figure, parameter)."""
        if callable(self._jacobian):
            self._jacobian = self._jacobian()
        return self._jacobian

    @property
    def normal(self) -> Array:
        """J^T J, (parameter, parameter)."""
        if self._normal is None:
            self._normal = self.J.T @ self.J
        return self._normal


def sum_of_squares(r: Array) -> float:
    """Return r r; infinite where a step went so far that there is no number."""
    with np.errstate(over="ignore", invalid="ignore"):
        cost = float(r @ r)
    return cost if np.isfinite(cost) else np.inf


class Counted:
    """A residual with its Jacobian, its calls counted. An answer that is not finite costs infinitely."""

    def __init__(self, fun: Residual) -> None:
        self._fun = fun
        self.calls = 0

    def __call__(self, u: Array) -> Point:
        """Return the residual and its Jacobian at `u`."""
        self.calls += 1
        r, J = self._fun(u)
        finite = np.isfinite(J).all()
        return Point(u, r if finite else np.full(len(r), np.inf), J)


Evaluate = Callable[[Array], Point]

#: A descent: it yields places (dim,), is sent the point there, and returns its finding.
Residuals = Generator[Array, Point, T]


def answering(descent: Callable[P, Residuals[T]]) -> Callable[Concatenate[Evaluate, P], T]:
    """Return a descent as a function whose first argument is called for the points."""

    def answered(evaluate: Evaluate, *args: P.args, **kwargs: P.kwargs) -> T:
        part = descent(*args, **kwargs)
        try:
            p = next(part)
            while True:
                p = part.send(evaluate(p))
        except StopIteration as end:
            return end.value

    return answered
