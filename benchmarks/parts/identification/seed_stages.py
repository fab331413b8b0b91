"""Table 7 by the chapter's algorithm, watched: at which of its steps a search loses the true minimum.

A point is in the basin of the true minimum if least squares on the objective's residuals (scipy's trust region, 500
evaluations) lead from there to it. The search watched is that of seed_table7.py with the same seed, call for call.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from benchmarks.parts.identification.searches import box
from benchmarks.parts.identification.table7 import CHAPTER, EXACT, TRUTH, oracle_response, steady
from rotorrig.identify.base_model import ObjectiveName
from rotorrig.identify.base_model.objectives import Amplitudes
from rotorrig.identify.chea import SEED
from rotorrig.identify.chea.chapter import chapter
from rotorrig.identify.chea.engine import Clusters, End, Engine
from rotorrig.identify.chea.session import Evaluations, Record, from_bounds

Real = NDArray[np.float64]

SETTINGS = replace(SEED, far_iterations=500)  # Table 6
PATIENCE = 500  # residuals of a descent that shows a basin: from afar f1 takes hundreds
SAMPLE = 20  # of a population, whose basins are looked for
STEPS = {
    "founders": "founders in its basin",
    "mature": "mature population in its basin",
    "heads": "best of the clusters in its basin",
    "from_basin": "local searches begun in its basin",
    "arrived": "of these, ended there",
    "elsewhere": "of the others, ended there",
    "held": "reduced boxes that hold it",
}
#: where a search lost the minimum, in the order of the steps
LOSSES = ("genetic algorithm", "clusters", "reduced box", "local search")


@dataclass(frozen=True)
class Stages:
    """Shares of a run's points and steps that had to do with the true minimum; NaN where there was no such step."""

    founders: float  # of the founders in its basin
    mature: float  # of the distinct points of the first mature population
    heads: float  # of the best of its clusters
    from_basin: float  # of all local searches, begun in its basin
    arrived: float  # of these, ended there
    elsewhere: float  # of the others, ended there
    held: float  # of the reduced boxes, with the minimum inside
    error: float = float("nan")  # of the run's best point: largest relative error of a parameter

    @property
    def lost_by(self) -> str | None:
        """The step after which nothing led to the true minimum any more, one of LOSSES; None: it was found.

        A search that never began in the basin lost it before: in the genetic algorithm if no point of the mature
        population that was looked at is in the basin, by its choice of starts or of bounds otherwise.
        """
        if self.error <= EXACT:
            return None
        if self.from_basin > 0:
            return "local search"
        if self.mature == 0:
            return "genetic algorithm"
        return "reduced box" if self.held == 0 else "clusters"


@dataclass
class Seen:
    """What a search on Table 7 looked at, in the unit cube."""

    founders: Real = field(default_factory=lambda: np.empty((0, 5)))
    mature: Real = field(default_factory=lambda: np.empty((0, 5)))  # distinct points of the first mature population
    clusters: list[Real] = field(default_factory=list)  # their points, best first
    boxes: list[Real] = field(default_factory=list)  # (2, 5) corners, reduced ones only
    descents: list[tuple[Real, Real]] = field(default_factory=list)  # start and end of local searches
    best: Real = field(default_factory=lambda: np.full(5, np.nan))
    values: Real = field(default_factory=lambda: np.empty(0))  # of every call
    steps: list[tuple[str, int]] = field(default_factory=list)  # of every batch: what asked for it, calls at its end

    @property
    def heads(self) -> Real:
        """Best points of the clusters."""
        return np.array([points[0] for points in self.clusters]).reshape(-1, 5)


def stages(objective: ObjectiveName, seed: int) -> Stages:
    """Search Table 7 once more, and look at every step."""
    seen, basin, rng = watch(objective, seed), Basin(objective), np.random.default_rng(seed)
    begun = np.array([basin.leads_there(start) for start, _ in seen.descents], dtype=np.bool_)
    ended = np.array([basin.is_there(end) for _, end in seen.descents], dtype=np.bool_)
    truth = place(TRUTH)
    return Stages(
        founders=mean([basin.leads_there(u) for u in rng.permutation(seen.founders)[:SAMPLE]]),
        mature=mean([basin.leads_there(u) for u in rng.permutation(seen.mature)[:SAMPLE]]),
        heads=mean([basin.leads_there(u) for u in seen.heads]),
        from_basin=mean(begun),
        arrived=mean(ended[begun]),
        elsewhere=mean(ended[~begun]),
        held=mean([bool(((truth >= low) & (truth <= high)).all()) for low, high in seen.boxes]),
        error=basin.error(seen.best),
    )


def watch(objective: ObjectiveName, seed: int) -> Seen:
    """Search f1, f2 or f3 of Table 7, and return what the search looked at."""
    amplitudes = _amplitudes()
    parts = _Watched()
    record = Record(5, same_point=SETTINGS.same_point)
    method = replace(chapter.method(5, SETTINGS), gather=parts.gather, local=parts.local)
    plan = Engine(record, _generator(seed), method).run()
    scaling = from_bounds(box(amplitudes), "log")
    points = next(plan)
    try:
        while (left := 2 * CHAPTER[objective] - record.nfev) > 0:
            values = amplitudes.cost(scaling.to_parameters(points[:left]), objective=objective)
            record.add(points[:left], values)
            parts.seen.steps.append((parts.step, record.nfev))
            if len(points) <= left:
                points = plan.send(values)
    except StopIteration:
        pass
    parts.seen.best, parts.seen.values = record.best[0].copy(), record.values.copy()
    return parts.seen


def place(theta: Real) -> Real:
    """Return where parameters (..., 5) in SI lie in the unit cube."""
    low, high = np.log(box(_amplitudes())).T
    return (np.log(theta) - low) / (high - low)


def mean(values: Sequence[float] | NDArray[Any]) -> float:
    """Return the mean of those that are numbers, NaN if there is none."""
    numbers = np.asarray(values, dtype=np.float64)
    numbers = numbers[np.isfinite(numbers)]
    return float(numbers.mean()) if len(numbers) else float("nan")


class _Watched:
    """The chapter's parts, with note taken of what they did."""

    def __init__(self) -> None:
        self._method = chapter.method(5, SETTINGS)
        self.seen = Seen()
        self.step = "far"  # which part asks for points: "genetic", "local" or, where neither does, "far"
        self._gathered = 0

    def gather(self, engine: Engine, box: Real) -> Evaluations[Clusters]:
        if self._gathered:
            self.seen.boxes.append(box)
        self._gathered += 1
        self.step = "genetic"
        clusters = list((yield from self._method.gather(engine, box)))
        self.step = "far"
        if self._gathered == 1:
            self.seen.founders = engine.record.points[: SETTINGS.population].copy()
            self.seen.mature = np.unique(engine.points, axis=0)
            self.seen.clusters = [engine.points[members] for members in clusters]
        return iter(clusters)

    def local(self, record: Record, start: Real, value: float, *, radius: float | None, wary: bool) -> Evaluations[End]:
        self.step = "local"
        end = yield from self._method.local(record, start, value, radius=radius, wary=wary)
        self.step = "far"
        listed, values, _ = record.minima.sorted()
        met = listed[(np.abs(listed - end.u).max(axis=1) < SETTINGS.same_point) & (values <= end.fun)]
        self.seen.descents.append((start, met[0].copy() if len(met) else end.u))
        return end


class Basin:
    """The true minimum and where Levenberg-Marquardt leads."""

    def __init__(self, objective: ObjectiveName) -> None:
        amplitudes = _amplitudes()
        self._vector = amplitudes.vector(objective)
        low, high = np.log(box(amplitudes)).T
        self._truth, self._widths = place(TRUTH), high - low

    def leads_there(self, u: Real) -> bool:
        """Return whether a point (5,) of the unit cube is in the basin."""
        inside = np.clip(u, 1e-9, 1 - 1e-9)  # as scipy's method wants its starts
        end = least_squares(
            lambda v: self._vector(v)[0],
            inside,
            jac=lambda v: self._vector(v)[1],
            bounds=(0, 1),
            x_scale="jac",
            max_nfev=PATIENCE,
        )
        return self.is_there(end.x)

    def is_there(self, u: Real) -> bool:
        """Return whether a point (5,) of the unit cube is the minimum, to three digits."""
        return self.error(u) <= EXACT

    def error(self, u: Real) -> float:
        """Return the largest relative error of a parameter."""
        return float(np.abs(np.expm1((u - self._truth) * self._widths)).max())


def _amplitudes() -> Amplitudes:
    return Amplitudes(steady(), np.abs(oracle_response()))


def _generator(seed: int) -> np.random.Generator:
    """Return the generator that `chea` makes of default_rng(seed)."""
    return np.random.Generator(np.random.PCG64(np.random.default_rng(seed).integers(2**32, size=4).tolist()))
