"""The chapter's Tables 2 to 4, and beyond: CHEA's two profiles, today's peers and the chapter's rows side by side.

    python benchmarks/chea_tables.py --seeds 20
    python benchmarks/chea_tables.py --seeds 100 --json --no-peers         (one JSON object on the last line)
    python benchmarks/chea_tables.py --seeds 100 --peer-seeds 100 --dimensions --write         (docs/chea-tables.md)

Every call counts, finite differences included, by one wrapper around the function. Each seed has its own box, the same
for every method. A minimum counts as found by a point within 1e-3 of it in every parameter; beyond the chapter's
functions within 1e-3 of the half width of the box.
"""

import argparse
import json
import os
import sys
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from benchmarks.parts.chea import niching_runs
from benchmarks.parts.chea.chapter import CHAPTER
from benchmarks.parts.chea.functions import Case, cases_beyond, chapter_cases
from benchmarks.parts.chea.page import Scores, dimension_tables, page, tables
from benchmarks.parts.chea.peers import CHEA, METHODS, PEERS, Method
from benchmarks.parts.chea.score import Run, run, summarise

ROOT = Path(__file__).parents[1]
CALLS_PER_DIMENSION = 2000  # the budget of every method beyond the chapter's functions
CASES = {case.name: case for case in (*chapter_cases(), *cases_beyond())}

Job = tuple[str, str, int, int | None]  # case, method, seed, budget


def main() -> None:
    """Measure, print, and write the page if asked."""
    options = arguments()
    methods = [*CHEA, *(() if options.no_peers else PEERS)]
    with ProcessPoolExecutor(options.workers, initializer=threadpool_limits, initargs=(1,)) as pool:
        chapter = measure(
            pool,
            chapter_cases(),
            methods,
            seeds=lambda method: options.seeds if method in CHEA else options.peer_seeds,
            budget=lambda method, case: method.budget,
        )
        beyond = measure(
            pool,
            cases_beyond() if options.dimensions else [],
            methods,
            seeds=lambda method: options.dimensions,
            budget=lambda method, case: CALLS_PER_DIMENSION * case.dim,
        )
    text = tables(chapter) + (dimension_tables(beyond) if options.dimensions else [])
    print("\n\n".join(text))
    if options.write:
        counts = {"seeds": options.seeds, "peer_seeds": options.peer_seeds, "dimensions": options.dimensions}
        written = page(chapter, beyond, methods, **counts, calls_per_dimension=CALLS_PER_DIMENSION)
        (ROOT / "docs/chea-tables.md").write_text(written, encoding="utf-8")
    if options.json:
        print(json.dumps(summary(chapter, beyond)))


def measure(
    pool: ProcessPoolExecutor,
    cases: Sequence[Case],
    methods: Sequence[Method],
    *,
    seeds: Callable[[Method], int],
    budget: Callable[[Method, Case], int | None],
) -> Scores:
    """Return scores[method][case] of seeds 0, 1, ...; None where the package is missing or the dimension too high."""
    jobs: list[Job] = [
        (case.name, method.name, seed, budget(method, case))
        for case in cases
        for method in methods
        if method.can(case.dim)
        for seed in range(seeds(method))
    ]
    runs: dict[tuple[str, str], list[Run]] = {}
    for (case, method, *_), found in zip(jobs, _watched(pool.map(_do, jobs), len(jobs)), strict=True):
        runs.setdefault((method, case), []).append(found)
    return {
        method.name: {
            case.name: summarise(runs[method.name, case.name], case) if (method.name, case.name) in runs else None
            for case in cases
        }
        for method in methods
    }


def _do(job: Job) -> Run:
    case, method, seed, budget = job
    return run(CASES[case], METHODS[method], seed, budget=budget)


def _watched(runs: Iterable[Run], total: int) -> Iterable[Run]:
    """Pass the runs on, with a line on stderr that counts them."""
    for done, found in enumerate(runs, start=1):
        if done * 100 // total != (done - 1) * 100 // total:
            print(f"\r{done} of {total} runs", end="\n" if done == total else "", file=sys.stderr, flush=True)
        yield found


def summary(chapter: Scores, beyond: Scores) -> dict[str, Any]:
    """Return all figures: "seed" and "modern", each by function, "peers" by method, "chapter", "dimensions".

    "niching" is of the runs that chea_niching.py has kept.
    """
    plain, ours = _plain(chapter), {method.name for method in CHEA}
    found: dict[str, Any] = {name: plain[name] for name in plain if name in ours}
    found["peers"] = {name: plain[name] for name in plain if name not in ours}
    found["chapter"] = {name: {f: asdict(row) for f, row in rows.items()} for name, rows in CHAPTER.items()}
    if any(beyond.values()):
        found["dimensions"] = _plain(beyond)
    found["niching"] = niching_runs.summarise(niching_runs.read_runs(niching_runs.source_version(), any_version=True))
    return found


def _plain(scores: Scores) -> dict[str, Any]:
    return {name: {case: score and asdict(score) for case, score in row.items()} for name, row in scores.items()}


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20, help="runs of CHEA per function (default 20)")
    parser.add_argument("--peer-seeds", type=int, help="runs of each peer per function (default: as CHEA, up to 10)")
    parser.add_argument("--no-peers", action="store_true", help="run CHEA alone")
    parser.add_argument(
        "--dimensions",
        type=int,
        nargs="?",
        const=20,
        default=0,
        help="also the functions of 2 to 10 dimensions (20 runs)",
    )
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="processes (default: one per core)")
    parser.add_argument("--json", action="store_true", help="end with one JSON object on the last line")
    parser.add_argument("--write", action="store_true", help="write docs/chea-tables.md")
    options = parser.parse_args()
    if options.peer_seeds is None:
        options.peer_seeds = min(options.seeds, 10)
    for name, least in (("seeds", 1), ("peer_seeds", 1), ("workers", 1), ("dimensions", 0)):
        if getattr(options, name) < least:
            parser.error(f"--{name.replace('_', '-')} is {getattr(options, name)}, expected at least {least}")
    return options


if __name__ == "__main__":
    main()
