"""`Ledger`: the only place that calls the objective. It counts, keeps the best and enforces the budget."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult

from rotorrig.identify.chea.scaling import Scaling
from rotorrig.identify.chea.stopping import Halt, StopReason

Array = NDArray[np.float64]
Callback = Callable[[OptimizeResult], object]


class Ledger:
    """Calls of one objective. The search works in the unit cube; `fun` is called with parameters.

    A call that raises, or returns NaN or an infinity, counts as a failure and as +inf. A vectorised `fun` that raises
    fails for its whole batch: it should return NaN for the points it cannot do.
    """

    def __init__(
        self,
        fun: Callable[[Array], Any],
        scaling: Scaling,
        *,
        max_nfev: int,
        f_target: float | None = None,
        vectorized: bool = False,
        callback: Callback | None = None,
    ) -> None:
        self.scaling = scaling
        self.max_nfev = max_nfev
        self.nfev = 0
        self.nit = 0  # reports made: generations, local searches, far searches
        self.failures = 0
        self.first_failure = ""
        self.best_x = np.full(scaling.dim, np.nan)
        self.best_fun = np.inf
        self.history: list[tuple[int, float]] = []  # (nfev, best so far) at every improvement
        self._fun = fun
        self._f_target = -np.inf if f_target is None else f_target
        self._vectorized = vectorized
        self._callback = callback
        self._points = np.empty((1024, scaling.dim))

    @property
    def points(self) -> Array:
        """All points evaluated so far, (nfev, dim) in the unit cube."""
        return self._points[: self.nfev]

    def evaluate(self, u: Array) -> Array:
        """Return fun (n,) at points (n, dim) of the unit cube; one call if vectorised, n calls otherwise.

        Raises `Halt` when the target is reached, or when the budget leaves no call for the next point.
        """
        size = len(u) if self._vectorized else 1
        values: list[Array] = []
        for start in range(0, len(u), size):
            batch = u[start : start + size]
            allowed = batch[: self.max_nfev - self.nfev]
            if len(allowed):
                values.append(self._call(allowed))
            if len(allowed) < len(batch):
                raise Halt(StopReason.BUDGET)
        return np.concatenate(values) if values else np.empty(0)

    def report(self, stage: str) -> None:
        """Count a step of the search and show the best so far to the callback, which may raise StopIteration."""
        self.nit += 1
        if self._callback is None:
            return
        best = OptimizeResult()
        best.update(x=self.best_x.copy(), fun=self.best_fun, nfev=self.nfev, nit=self.nit, stage=stage)
        try:
            self._callback(best)
        except StopIteration:
            raise Halt(StopReason.CALLBACK) from None

    def _call(self, u: Array) -> Array:
        x = self.scaling.to_parameters(u)
        self._remember(u)  # before the call, so that an interrupted one is counted too
        try:
            returned = self._fun(x.copy() if self._vectorized else x[0].copy())  # fun may write on it
        except Exception as error:  # whatever a user's model raises is a failed point, reported in the result
            f = self._failed(len(u), f"{type(error).__name__}: {error}")
        else:
            f = self._checked(returned, len(u))
        self._keep_best(x, f)
        if self.best_fun <= self._f_target:
            raise Halt(StopReason.TARGET)
        return f

    def _remember(self, u: Array) -> None:
        while self.nfev + len(u) > len(self._points):
            self._points = np.concatenate([self._points, np.empty_like(self._points)])
        self._points[self.nfev : self.nfev + len(u)] = u
        self.nfev += len(u)

    def _checked(self, returned: Any, n: int) -> Array:
        f = np.asarray(returned)
        if f.size != n or f.dtype.kind not in "fiub":
            raise TypeError(f"fun returned {f.dtype} of shape {f.shape}, expected {n} real number{'s'[: n > 1]}")
        f = f.astype(np.float64).reshape(n)
        if not np.isfinite(f).all():
            bad = ~np.isfinite(f)
            f[bad] = self._failed(int(bad.sum()), f"fun returned {f[bad][0]}")
        return f

    def _failed(self, n: int, why: str) -> Array:
        self.failures += n
        self.first_failure = self.first_failure or why
        return np.full(n, np.inf)

    def _keep_best(self, x: Array, f: Array) -> None:
        for i, value in enumerate(f.tolist()):
            if value < self.best_fun:
                self.best_x, self.best_fun = x[i].copy(), value
                self.history.append((self.nfev - len(f) + i + 1, value))
