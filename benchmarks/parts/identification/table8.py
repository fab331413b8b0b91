"""Table 8: the three-disk rotor with 10 % noise on its amplitudes: what f1, f2 and f3 make of it.

Every draw multiplies each amplitude of Table 7's data by 1 + 0.1 N(0, 1). Its minimum of each objective is sought with
the residual vector, and by CHEA as a black box; least_of_many says whether it is the global one. Beside the errors
stand the chapter's, and the Cramer-Rao bound. A point of the chapter that is worse than the true values on the
chapter's own objective, draw after draw, is no minimum of it: there the search had failed, not the objective.
"""

from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.parts.identification.chapter import NAMES, OBJECTIVES, TABLE8, TABLE8_REFERENCE, errors
from benchmarks.parts.identification.cramer_rao import bounds, relative_root
from benchmarks.parts.identification.searches import black_box, box, least_of_many
from benchmarks.parts.identification.table7 import oracle_response, steady
from benchmarks.parts.tables import markdown
from rotorrig.identify.base_model import ObjectiveName
from rotorrig.identify.base_model.global_search import search_amplitudes
from rotorrig.identify.base_model.objectives import Amplitudes

Real = NDArray[np.float64]

TRUTH = np.array(TABLE8_REFERENCE)
NOISE = 0.1
HALF = 0.674  # standard deviations: half of all normal errors are smaller
SAME = 1e-6  # of the objective: what counts as the global minimum


@dataclass(frozen=True, slots=True, kw_only=True)
class Search:
    """One search: where it ended, what the objective is there, and the calls of the model."""

    error: Real  # (5,) %
    cost: float
    calls: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """One objective on one draw of the noise."""

    vector: Search
    scalar: Search | None  # of the first draws alone
    least: float  # of the objective, met by any search
    at_truth: float  # the objective at the true values
    at_chapter: float  # and at those the chapter prints


def measure(pool: ProcessPoolExecutor, *, draws: int, starts: int, black_boxes: int) -> dict[ObjectiveName, list[Run]]:
    """Return the runs by objective. `starts` are those of the brute force; the first draws are black boxes too."""
    jobs = [(objective, draw, starts, draw < black_boxes) for objective in OBJECTIVES for draw in range(draws)]
    runs: dict[ObjectiveName, list[Run]] = {}
    for (objective, *_), run in zip(jobs, pool.map(_run, jobs), strict=True):
        runs.setdefault(objective, []).append(run)
    return runs


def summarise(runs: dict[ObjectiveName, list[Run]]) -> dict[str, Any]:
    """Return table8 of the JSON object: of every objective the median |error| in %, and what else `text` shows."""
    found: dict[str, Any] = {name: _row(of, name) for name, of in runs.items()}
    found["crb"] = _by_name(100 * bound())
    return found


def bound() -> Real:
    """Return the Cramer-Rao bounds, (5,), relative."""
    low, high = np.log(box(model := noisy(None))).T
    _, by = model.log_ratios((np.log(TRUTH) - low) / (high - low))
    return bounds(relative_root(by * np.log(10.0) / (high - low), share=NOISE))


def noisy(draw: int | None) -> Amplitudes:
    """Return the amplitudes with the noise of a draw; None: without."""
    amplitude = np.abs(oracle_response())
    if draw is not None:
        amplitude = amplitude * factors(draw)
    return Amplitudes(steady(), amplitude)


def factors(draw: int) -> Real:
    """Return the factors (speed, probe) that make a draw of the noise."""
    return 1 + NOISE * np.random.default_rng([8, draw]).standard_normal(oracle_response().shape)


def _run(job: tuple[ObjectiveName, int, int, bool]) -> Run:
    objective, draw, starts, as_black_box = job
    amplitudes, rng = noisy(draw), np.random.default_rng([88, draw])
    optima, calls, *_ = search_amplitudes(amplitudes, objective=objective, rng=rng)
    vector = _search(optima[0].theta, optima[0].cost, calls)
    scalar = _search(*black_box(amplitudes, objective=objective, seed=draw)) if as_black_box else None
    brute = least_of_many(amplitudes, objective=objective, starts=starts, near=TRUTH, rng=rng)
    at_truth, at_chapter = amplitudes.cost(np.array([TRUTH, TABLE8[objective]]), objective=objective)
    return Run(
        vector=vector,
        scalar=scalar,
        least=min(brute, vector.cost, scalar.cost if scalar else np.inf),
        at_truth=float(at_truth),
        at_chapter=float(at_chapter),
    )


def _search(theta: tuple[float, ...] | Real, cost: float, calls: int) -> Search:
    return Search(error=100 * (np.array(theta) / TRUTH - 1), cost=cost, calls=calls)


def _row(runs: list[Run], objective: ObjectiveName) -> dict[str, Any]:
    """Return the figures of one objective; those of the parameters are of the residual vector's search."""
    error = np.abs([run.vector.error for run in runs])
    black_boxes = [(run.scalar, run.least) for run in runs if run.scalar]
    printed = np.abs(list(errors(TABLE8, TABLE8_REFERENCE)[objective].values()))
    return {
        **_ends([(run.vector, run.least) for run in runs]),
        "quartiles": _by_name(np.quantile(error, [0.25, 0.75], axis=0).T),
        "chapter": _by_name(printed),
        "as_wrong": _by_name((error >= printed).mean(axis=0)),
        "scalar": _ends(black_boxes) if black_boxes else None,
        "truth_over_least": float(np.median([run.at_truth / run.least for run in runs])),
        "chapter_over_least": float(np.median([run.at_chapter / run.least for run in runs])),
        "chapter_worse_than_truth": float(np.mean([run.at_chapter > run.at_truth for run in runs])),
    }


def _ends(ends: list[tuple[Search, float]]) -> dict[str, Any]:
    """Return the figures of searches, each beside the least value of its objective."""
    return {
        **_by_name(np.median(np.abs([search.error for search, _ in ends]), axis=0)),
        "calls_median": float(np.median([search.calls for search, _ in ends])),
        "reached": float(np.mean([search.cost <= least * (1 + SAME) for search, least in ends])),
        "excess": float(np.median([search.cost / least for search, least in ends])),
        "draws": len(ends),
    }


def _by_name(values: Real) -> dict[str, Any]:
    return dict(zip(NAMES, np.asarray(values).tolist(), strict=True))


def text(runs: dict[ObjectiveName, list[Run]]) -> str:
    """Return the tables in Markdown, and what can be read from them."""
    summary = summarise(runs)
    readings = "\n".join(f"- {_reading(name, summary[name], summary['crb'])}" for name in OBJECTIVES)
    return f"### Table 8: 10 % noise\n\n{_errors(summary)}\n\n{_searches(summary)}\n\n{readings}"


def _errors(summary: dict[str, Any]) -> str:
    head = [
        "error, %",
        *(title for name in OBJECTIVES for title in (f"{name}, chapter", f"{name}, median (quartiles)")),
    ]
    rows = []
    for name in NAMES:
        cells = []
        for row in (summary[objective] for objective in OBJECTIVES):
            low, high = row["quartiles"][name]
            cells += [f"{row['chapter'][name]:.3g}", f"{row[name]:.3g} ({low:.3g} to {high:.3g})"]
        rows.append([name, *cells, f"{summary['crb'][name]:.3g}"])
    return markdown([*head, "Cramer-Rao, sigma"], rows)


def _searches(summary: dict[str, Any]) -> str:
    head = ["where", "draws", "calls, median", "global minimum", "objective / least, median"]
    rows = []
    for name in OBJECTIVES:
        row = summary[name]
        draws = str(row["draws"])
        searches = {"residual vector": row, "black box": row["scalar"]}
        for label, of in ((f"{name}, {kind}", of) for kind, of in searches.items() if of):
            calls, reached = f"{of['calls_median']:,.0f}", f"{of['reached']:.0%}"
            rows.append([label, str(of["draws"]), calls, reached, f"{of['excess']:.3g}"])
        rows.append([f"{name}, true values", draws, "", "", f"{row['truth_over_least']:.3g}"])
        rows.append([f"{name}, chapter's values", draws, "", "", f"{row['chapter_over_least']:.3g}"])
    return markdown(head, rows)


def _reading(objective: ObjectiveName, row: dict[str, Any], crb: dict[str, float]) -> str:
    """Say which of the chapter's errors the minimum of its objective shares, and how near it comes to the bound."""
    times_bound = [row[name] / (HALF * crb[name]) for name in NAMES]
    printed = {name: f"{name} ({row['chapter'][name]:.3g} %)" for name in NAMES}
    never = [printed[name] for name in NAMES if row["as_wrong"][name] == 0]
    shared = [f"{printed[name]} in {row['as_wrong'][name]:.0%}" for name in NAMES if row["as_wrong"][name] > 0]
    said = []
    if never:
        said.append(f"The minimum is in no draw as wrong as the chapter's {', '.join(never)}: its optimiser's errors.")
    if shared:
        said.append(
            f"It is as wrong as the chapter's {', '.join(shared)} of the draws: errors of the objective and the noise."
        )
    times = row["chapter_over_least"] / row["truth_over_least"]
    said.append(
        f"The chapter's values have a higher objective than the true ones in {row['chapter_worse_than_truth']:.0%} of "
        f"the draws, {times:.3g} times in the median."
    )
    said.append(
        f"Median errors of the minimum are {min(times_bound):.1f} to {max(times_bound):.1f} times those of an estimate "
        "that attains the Cramer-Rao bound."
    )
    return f"{objective}. {' '.join(said)}"
