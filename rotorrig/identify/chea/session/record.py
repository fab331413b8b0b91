"""`Record`: every point a search has evaluated and every minimum it has met, in the unit cube."""

from collections.abc import Generator
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from rotorrig.identify.chea.session.minima import Minima

Array = NDArray[np.float64]
UNSORTED = 4096  # points at the most that are gone through one by one for the nearest
T = TypeVar("T")

#: A part of a search: it yields points (n, dim) of the unit cube, is sent their values (n,), and returns its finding.
#: A value that could not be had is +inf.
Evaluations = Generator[Array, Array, T]


class Stage(NamedTuple):
    """All steps of one kind."""

    name: str
    steps: int
    calls: int


class Record:
    """Points and values of one search, and its minima.

    The ask/tell object adds the points; the parts of the search all else.
    """

    def __init__(self, dim: int, *, same_point: float = 0.0, minima: Minima | None = None) -> None:
        """Begin empty; ends of local searches within `same_point` of one another in every parameter are one minimum.

        `minima` are an empty list that has another rule.
        """
        self.dim = dim
        self.minima = Minima(dim, tolerance=same_point) if minima is None else minima
        self.nfev = 0
        self.njev = 0  # gradients taken by finite differences; their points are in nfev
        self.nit = 0  # steps of the search: generations, local searches, far searches
        self.stage = ""  # of the latest step
        self._stages: dict[str, Stage] = {}
        self.heads: list[Array] = []  # (dim,) of the clusters that were searched
        self.reduced = 0  # clusters that were not convex, in whose bounds points were gathered again
        self.failures = 0
        self.history: list[tuple[int, float]] = []  # (nfev, best so far) at every improvement
        self._points = np.empty((1024, dim))
        self._values = np.empty(1024)
        self._best = -1  # row of the lowest value
        self._tree: cKDTree | None = None  # of the first `_sorted` points
        self._sorted = 0

    @property
    def points(self) -> Array:
        """All points evaluated, (nfev, dim), read-only."""
        return _read_only(self._points[: self.nfev])

    @property
    def values(self) -> Array:
        """Their values, (nfev,), read-only; +inf where there was none."""
        return _read_only(self._values[: self.nfev])

    @property
    def best(self) -> tuple[Array, float]:
        """The lowest point met (dim,), read-only, and its value; NaN and +inf before the first finite value."""
        if self._best < 0:
            return np.full(self.dim, np.nan), np.inf
        return _read_only(self._points[self._best]), float(self._values[self._best])

    def nearest(self, u: Array, number: int) -> NDArray[np.intp]:
        """Return the rows of so many points nearest to u (dim,), in no order; all if there are no more."""
        if self.nfev - self._sorted > UNSORTED:
            self._tree, self._sorted = cKDTree(self._points[: self.nfev]), self.nfev
        squared = ((self._points[self._sorted : self.nfev] - u) ** 2).sum(axis=1)
        rows = np.arange(self._sorted, self.nfev)
        if self._tree is not None:
            away, sorted_rows = self._tree.query(u, k=min(number, self._sorted))
            squared, rows = np.append(squared, away**2), np.append(rows, sorted_rows)
        return rows[np.argpartition(squared, number)[:number]] if len(rows) > number else rows

    def add(self, points: Array, values: Array) -> None:
        """Take in points (n, dim) and values (n,); a value that is not finite counts as a failure and as +inf."""
        end = self.nfev + len(points)
        while end > len(self._values):
            self._points = np.concatenate([self._points, np.empty_like(self._points)])
            self._values = np.concatenate([self._values, np.empty_like(self._values)])
        finite = np.isfinite(values)
        self.failures += len(values) - int(np.count_nonzero(finite))
        self._points[self.nfev : end] = points
        self._values[self.nfev : end] = np.where(finite, values, np.inf)
        lowest = self.best[1]
        for i, value in enumerate(self._values[self.nfev : end].tolist(), start=self.nfev):
            if value < lowest:
                lowest, self._best = value, i
                self.history.append((i + 1, value))
        self.nfev = end  # the last to change: whatever interrupts this, `points` and `values` belong together

    def step(self, stage: str) -> None:
        """Count a step of the search, for whoever watches."""
        self.nit += 1
        self.stage = stage
        self.tally(stage, steps=1)

    def tally(self, stage: str, *, steps: int = 0) -> None:
        """Put the calls since the last tally down to a kind of step."""
        before = self._stages.get(stage, Stage(stage, 0, 0))
        counted = sum(done.calls for done in self.stages)
        self._stages[stage] = Stage(stage, before.steps + steps, before.calls + self.nfev - counted)

    @property
    def stages(self) -> tuple[Stage, ...]:
        """What each kind of step did, in the order they began."""
        return tuple(self._stages.values())


def _read_only(view: Array) -> Array:
    view.flags.writeable = False
    return view
