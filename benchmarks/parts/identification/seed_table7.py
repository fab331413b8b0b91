"""Table 7 by the chapter's own algorithm: `chea(..., profile="seed")` on f1, f2 and f3, and the step that loses it.

The data and the box are those of table7.py, the settings those of Table 6: the profile's own, and 500 iterations of the
random search. All five parameters are on a logarithmic scale: the box spans five to seven decades of each. A search may
take twice the chapter's calls. Then the same for random truths, log-uniform over the box, and the steps of a few runs
one by one.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from benchmarks.parts.identification.searches import box
from benchmarks.parts.identification.table7 import (
    CHAPTER,
    EXACT,
    OBJECTIVES,
    SAME_RESPONSE,
    TRUTH,
    oracle_response,
    random_truth,
    standard_deviations,
    steady,
)
from benchmarks.parts.tables import markdown
from rotorrig.identify.base_model import ObjectiveName
from rotorrig.identify.base_model.objectives import Amplitudes
from rotorrig.identify.chea import SEED, chea
from rotorrig.identify.chea.chapter import chapter
from rotorrig.identify.chea.engine import Clusters, End, Engine
from rotorrig.identify.chea.session import Evaluations, Record, from_bounds

Real = NDArray[np.float64]
Misfit = Callable[[Real], Real]  # points (n, 5) in SI -> values (n,)

SETTINGS = replace(SEED, far_iterations=500)  # Table 6
TRUTHS = 20
STAGED = 10  # runs whose steps are looked at
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


@dataclass(frozen=True)
class Run:
    """One search."""

    calls: int  # until it ended, by itself or for the budget
    error: float  # largest relative error of a parameter, of those the data determine
    exact_after: float  # calls until a point was exact; inf: never


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


def measure(pool: ProcessPoolExecutor, *, seeds: int) -> dict[str, Any]:
    """Return what `summarise` and `text` need."""
    found: dict[str, Any] = {}
    for name in OBJECTIVES:
        found[name] = {
            "runs": list(pool.map(search, [name] * seeds, range(seeds))),
            "truths": list(pool.map(search_random, [name] * TRUTHS, range(TRUTHS))),
            "stages": list(pool.map(stages, [name] * STAGED, range(STAGED))),
        }
    return found


def summarise(measured: dict[str, Any]) -> dict[str, Any]:
    """Return seed.table7 of the JSON object."""
    return {
        name: {
            **_row(found["runs"]),
            "truths": _row(found["truths"]),
            "stages": {step: _known(_mean([asdict(run)[step] for run in found["stages"]])) for step in STEPS},
        }
        for name, found in measured.items()
    }


def text(measured: dict[str, Any]) -> str:
    """Return the tables in Markdown."""
    summary = summarise(measured)
    head = ["objective", "chapter's calls", "calls, median", "exact", "after, median", "random truths exact"]
    rows = [
        [
            name,
            f"{CHAPTER[name]:,d}",
            f"{row['calls_median']:,.0f}",
            f"{row['success']:.0%}",
            _printed(row["exact_after_median"], ",.0f"),
            f"{row['truths']['success']:.0%}",
        ]
        for name, row in summary.items()
    ]
    steps = [
        [title, *(_printed(summary[name]["stages"][step], ".0%") for name in OBJECTIVES)]
        for step, title in STEPS.items()
    ]
    return (
        f'### Table 7 by the chapter\'s algorithm\n\n`profile="seed"` with Table 6, on values alone, within twice the '
        f"chapter's calls; {len(measured['f1']['runs'])} runs on Table 7's data, {TRUTHS} on random truths, of which "
        f"those parameters count that the data determine. Exact is {EXACT:.1%} in all of them.\n\n"
        f"{markdown(head, rows)}\n\n"
        f"What becomes of the true minimum, step by step, means of {STAGED} runs. A point is in its basin if Levenberg-"
        "Marquardt on the objective's residuals leads from there to it.\n\n"
        f"{markdown(['step', *OBJECTIVES], steps)}"
    )


def search(objective: ObjectiveName, seed: int) -> Run:
    """Search f1, f2 or f3 of Table 7."""
    amplitudes = Amplitudes(steady(), np.abs(oracle_response()))
    return _searched(amplitudes, TRUTH, np.ones(5, dtype=np.bool_), objective, np.random.default_rng(seed))


def search_random(objective: ObjectiveName, seed: int) -> Run:
    """Search f1, f2 or f3 of a random truth."""
    rng = np.random.default_rng([8, seed])
    truth, v = random_truth(rng)
    amplitudes = Amplitudes(steady(), np.abs(steady().receptance.response(*truth)))
    known = standard_deviations(amplitudes, v, noise=SAME_RESPONSE) < EXACT / 3
    return _searched(amplitudes, truth, known, objective, rng)


def _searched(
    amplitudes: Amplitudes,
    truth: Real,
    known: NDArray[np.bool_],
    objective: ObjectiveName,
    rng: np.random.Generator,
) -> Run:
    calls, exact_after = 0, np.inf

    def misfit(x: Real) -> Real:
        nonlocal calls, exact_after
        exact = np.flatnonzero(_errors(x, truth, known) <= EXACT)
        if len(exact) and np.isinf(exact_after):
            exact_after = float(calls + exact[0] + 1)
        calls += len(x)
        return amplitudes.cost(x, objective=objective)

    result = chea(
        misfit,
        box(amplitudes),
        rng=rng,
        profile="seed",
        settings=SETTINGS,
        x_scale="log",
        vectorized=True,
        max_nfev=2 * CHAPTER[objective],
    )
    return Run(result.nfev, float(_errors(result.x[None], truth, known)[0]), exact_after)


def stages(objective: ObjectiveName, seed: int) -> Stages:
    """Search Table 7 once more, and look at every step."""
    amplitudes = Amplitudes(steady(), np.abs(oracle_response()))
    watch = _Watch(amplitudes, objective)
    record = Record(5, same_point=SETTINGS.same_point)
    method = replace(chapter.method(5, SETTINGS), gather=watch.gather, local=watch.local)
    plan = Engine(record, np.random.default_rng(seed), method).run()
    scaling = from_bounds(box(amplitudes), "log")
    points = next(plan)
    try:
        while record.nfev < 2 * CHAPTER[objective]:
            values = amplitudes.cost(scaling.to_parameters(points), objective=objective)
            record.add(points, values)
            points = plan.send(values)
    except StopIteration:
        pass
    return watch.stages(np.random.default_rng(seed))


class _Watch:
    """The chapter's parts, with note taken of what they did."""

    def __init__(self, amplitudes: Amplitudes, objective: ObjectiveName) -> None:
        self._method = chapter.method(5, SETTINGS)
        self._vector = amplitudes.vector(objective)
        low, high = np.log(box(amplitudes)).T
        self._truth = (np.log(TRUTH) - low) / (high - low)
        self._widths = high - low
        self._boxes: list[Real] = []
        self._founders = self._mature = self._heads = np.empty((0, 5))
        self._descents: list[tuple[Real, Real]] = []  # start and end

    def gather(self, engine: Engine, box: Real) -> Evaluations[Clusters]:
        self._boxes.append(box)
        clusters = list((yield from self._method.gather(engine, box)))
        if len(self._boxes) == 1:
            self._founders = engine.record.points[: SETTINGS.population].copy()
            self._mature = np.unique(engine.points, axis=0)
            self._heads = np.array([engine.points[members[0]] for members in clusters])
        return iter(clusters)

    def local(self, record: Record, start: Real, value: float, *, radius: float | None, wary: bool) -> Evaluations[End]:
        end = yield from self._method.local(record, start, value, radius=radius, wary=False)
        self._descents.append((start, end.u))
        return end

    def stages(self, rng: np.random.Generator) -> Stages:
        begun = np.array([self._leads_there(start) for start, _ in self._descents], dtype=np.bool_)
        ended = np.array([self._is_there(end) for _, end in self._descents], dtype=np.bool_)
        held = [bool(((self._truth >= low) & (self._truth <= high)).all()) for low, high in self._boxes[1:]]
        return Stages(
            founders=_mean([self._leads_there(u) for u in rng.permutation(self._founders)[:SAMPLE]]),
            mature=_mean([self._leads_there(u) for u in rng.permutation(self._mature)[:SAMPLE]]),
            heads=_mean([self._leads_there(u) for u in self._heads]),
            from_basin=_mean(begun),
            arrived=_mean(ended[begun]),
            elsewhere=_mean(ended[~begun]),
            held=_mean(held),
        )

    def _leads_there(self, u: Real) -> bool:
        inside = np.clip(u, 1e-9, 1 - 1e-9)  # as scipy's method wants its starts
        end = least_squares(
            lambda v: self._vector(v)[0], inside, jac=lambda v: self._vector(v)[1], bounds=(0, 1), x_scale="jac"
        )
        return self._is_there(end.x)

    def _is_there(self, u: Real) -> bool:
        return bool(np.abs(np.expm1((u - self._truth) * self._widths)).max() <= EXACT)


def _errors(x: Real, truth: Real, known: NDArray[np.bool_]) -> Real:
    return np.abs(x / truth - 1)[:, known].max(axis=1, initial=0.0)


def _row(runs: list[Run]) -> dict[str, float | None]:
    exact = [run for run in runs if run.error <= EXACT]
    return {
        "success": len(exact) / len(runs),
        "calls_median": float(np.median([run.calls for run in runs])),
        "exact_after_median": float(np.median([run.exact_after for run in exact])) if exact else None,
    }


def _mean(values: Sequence[float] | NDArray[Any]) -> float:
    """Return the mean of those that are numbers, NaN if there is none."""
    numbers = np.asarray(values, dtype=np.float64)
    numbers = numbers[np.isfinite(numbers)]
    return float(numbers.mean()) if len(numbers) else float("nan")


def _known(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _printed(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)
