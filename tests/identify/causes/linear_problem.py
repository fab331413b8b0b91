"""A least-squares problem that can be solved by hand: every unknown of an effect moves the figures along one column."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.least_squares.solve import Solution, solve
from rotorrig.sims.effects.base import Effect, Parameter

Reals = NDArray[np.float64]

FIGURES = 64  # with neighbours off together, eight are independent: an unknown costs ln 8 = 2.08 of BIC
ROWS = 400  # fifty places of eight rows: a grid search costs 2 ln 50 = 7.8 of chi2


def effect(name: str, *, unknowns: int = 1, places: int = 0) -> Effect:
    """Return an effect of a kind of its own; with `places` its location is looked for at 0, 1 .. places - 1."""
    kind = type(name, (Effect,), {"name": name, "title": name})
    parameters = [Parameter(name=f"size {i}", unit="", low=-1e3, high=1e3, size=1.0) for i in range(unknowns)]
    if places:
        parameters.append(Parameter(name="place", unit="", low=0.0, high=places, size=1.0, grid_searched=True))
    return kind(parameters=tuple(parameters), grid=tuple((float(i),) for i in range(places)))


def axis(i: int) -> Reals:
    """Return the column (figure,) that moves figure number `i` alone."""
    return np.eye(FIGURES)[i]


@dataclass(frozen=True)
class Figures:
    """What was measured, in sigmas, and what the unknowns of every effect do to it."""

    measured: Reals  # (figure,)
    columns: Mapping[str, Sequence[Reals]]  # name of an effect -> a column for each unknown, or each place

    def of(self, effect: Effect) -> Reals:
        """Return the columns of an effect, (figure, unknown); a grid-searched one moves nothing."""
        own = self.columns[effect.name]
        if effect.grid:
            return np.stack([own[round(effect.at_zero["place"])], np.zeros(FIGURES)], axis=1)
        return np.stack(own, axis=1)


@dataclass
class LinearProblem:
    """The face of an ExtendedProblem: one unknown of a base model, which moves the last figure, and effects."""

    figures: Figures
    effects: tuple[Effect, ...] = ()
    curved: bool = False
    recordings: list[Any] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.recordings = [SimpleNamespace(rows=np.arange(ROWS), measured={1: SimpleNamespace(size=FIGURES)})]
        self.design = np.hstack([axis(-1)[:, None], *(self.figures.of(e) for e in self.effects)])
        self.size = FIGURES
        stops = np.cumsum([1, *(len(e.parameters) for e in self.effects)])
        frozen = [p.at_zero if p.grid_searched else np.nan for e in self.effects for p in e.parameters]
        self.frozen = {i: value for i, value in enumerate(frozen, start=1) if np.isfinite(value)}
        self.bounds = np.full(self.design.shape[1], -1e3), np.full(self.design.shape[1], 1e3)
        self.parameters = SimpleNamespace(
            effects=self.effects,
            own=slice(1, int(stops[-1])),
            theta=[slice(int(a), int(b)) for a, b in pairwise(stops)],
            of_effect=self._of_effect,
            prior_residual=lambda p: np.empty(0),
        )

    def extended(self, effects: Sequence[Effect]) -> "LinearProblem":
        return LinearProblem(self.figures, tuple(effects))

    def residual(self, p: Reals, *, orders: Sequence[int] = (1,)) -> Reals:
        return self.design @ p - self.figures.measured

    def jacobian(self, p: Reals, free: NDArray[np.intp] | None = None) -> Reals:
        return self.design if free is None else self.design[:, free]

    def solve_linear(self, p: Reals, free: NDArray[np.intp]) -> Reals:
        return p

    def solve(self, start: Reals, *, fixed: Mapping[int, float] | None = None, **how: Any) -> Solution:
        return solve(self, start, fixed={**self.frozen, **(fixed or {})}, **how)

    def error_of_effects(self, p: Reals) -> list[dict[int, Reals]]:
        return [{}]

    def _of_effect(self, p: Reals, i: int) -> dict[str, float]:
        names = (q.name for q in self.effects[i].parameters)
        return dict(zip(names, map(float, p[self.parameters.theta[i]]), strict=True))
