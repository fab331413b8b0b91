"""Table 7 by the chapter's own algorithm: `chea(..., profile="seed")` on f1, f2 and f3, and the step that loses it.

The data and the box are those of table7.py, the settings those of Table 6: the profile's own, and 500 iterations of the
random search. All five parameters are on a logarithmic scale: the box spans five to seven decades of each. A search may
take twice the chapter's calls. Then the same for random truths, log-uniform over the box, and the steps of a few runs
one by one.
"""

from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest

from benchmarks.parts.identification.searches import box
from benchmarks.parts.identification.seed_stages import LOSSES, PATIENCE, SETTINGS, STEPS, mean, stages
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
from rotorrig.identify.chea import chea

Real = NDArray[np.float64]
TRUTHS = 20
STAGED = 10  # runs whose steps are looked at


@dataclass(frozen=True)
class Run:
    """One search."""

    calls: int  # until it ended, by itself or for the budget
    error: float  # largest relative error of a parameter, of those the data determine
    exact_after: float  # calls until a point was exact; inf: never


def measure(
    pool: ProcessPoolExecutor, *, seeds: int, truths: int = TRUTHS, staged: int = STAGED
) -> dict[str, dict[str, list[Any]]]:
    """Return what `summarise` and `text` need; `staged` runs have their steps looked at."""
    return {
        name: {
            "runs": list(pool.map(search, [name] * seeds, range(seeds))),
            "truths": list(pool.map(search_random, [name] * truths, range(truths))),
            "stages": list(pool.map(stages, [name] * staged, range(staged))),
        }
        for name in OBJECTIVES
    }


def summarise(measured: dict[str, Any]) -> dict[str, Any]:
    """Return seed.table7 of the JSON object."""
    return {
        name: {
            **_row(found["runs"]),
            "truths": _row(found["truths"]),
            "stages": {step: _known(mean([asdict(run)[step] for run in found["stages"]])) for step in STEPS},
            "lost_by": {loss: sum(run.lost_by == loss for run in found["stages"]) for loss in LOSSES},
        }
        for name, found in measured.items()
    }


def text(measured: dict[str, Any]) -> str:
    """Return the tables in Markdown."""
    found = measured["f1"]
    runs, truths, staged = (len(found[kind]) for kind in ("runs", "truths", "stages"))
    return (
        f'### Table 7 by the chapter\'s algorithm\n\n`profile="seed"` with Table 6, on values alone, within twice the '
        f"chapter's calls; {runs} runs on Table 7's data, {truths} on random truths, of which those parameters count "
        f"that the data determine. Exact is {EXACT:.1%} in all of them.\n\n"
        f"{rates(measured)}\n\n"
        f"What becomes of the true minimum, step by step, means of {staged} runs. A point is in its basin if least "
        f"squares on the objective's residuals, {PATIENCE} evaluations, lead from there to it.\n\n{steps(measured)}\n\n"
        f"Where it was lost, runs of these {staged}:\n\n{losses(measured)}"
    )


def rates(measured: dict[str, Any]) -> str:
    """Return the table of how often a search is exact."""
    head = ["objective", "chapter's calls", "calls, median", "exact", "bounds", "after, median", "random truths exact"]
    rows = [
        [
            name,
            f"{CHAPTER[name]:,d}",
            f"{row['calls_median']:,.0f}",
            f"{row['success']:.0%}",
            _bounds(row["success"], len(measured[name]["runs"])),
            _printed(row["exact_after_median"], ",.0f"),
            f"{row['truths']['success']:.0%}",
        ]
        for name, row in summarise(measured).items()
    ]
    return markdown(head, rows)


def steps(measured: dict[str, Any]) -> str:
    """Return the table of what becomes of the true minimum, step by step."""
    summary = summarise(measured)
    rows = [
        [title, *(_printed(summary[name]["stages"][step], ".0%") for name in OBJECTIVES)]
        for step, title in STEPS.items()
    ]
    return markdown(["step", *OBJECTIVES], rows)


def losses(measured: dict[str, Any]) -> str:
    """Return the table of the steps that lost the true minimum, in runs."""
    summary = summarise(measured)
    rows = [[loss, *(str(summary[name]["lost_by"][loss]) for name in OBJECTIVES)] for loss in LOSSES]
    found = ["found", *(str(sum(run.lost_by is None for run in measured[name]["stages"])) for name in OBJECTIVES)]
    return markdown(["lost by", *OBJECTIVES], [*rows, found])


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


def _errors(x: Real, truth: Real, known: NDArray[np.bool_]) -> Real:
    return np.abs(x / truth - 1)[:, known].max(axis=1, initial=0.0)


def _row(runs: list[Run]) -> dict[str, float | None]:
    exact = [run for run in runs if run.error <= EXACT]
    return {
        "success": len(exact) / len(runs),
        "calls_median": float(np.median([run.calls for run in runs])),
        "exact_after_median": float(np.median([run.exact_after for run in exact])) if exact else None,
    }


def _known(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _printed(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)


def _bounds(share: float, runs: int) -> str:
    """Return the 95 % confidence bounds of a share of runs, Clopper and Pearson's.

    >>> _bounds(0.5, 20)
    '27 to 73%'
    """
    bounds = binomtest(round(share * runs), runs).proportion_ci(0.95, method="exact")
    return f"{100 * bounds.low:.0f} to {bounds.high:.0%}"
