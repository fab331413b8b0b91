"""The chapter's Table 7 by the chapter's algorithm: how often it is exact, and which step loses the true minimum.

    python benchmarks/chea_table7.py --seeds 40 --staged 6
    python benchmarks/chea_table7.py --seeds 40 --staged 6 --write         (docs/chea-table7.json, then `make docs`)

Runs are kept in .cache/chea-table7 as they end, a file for each version of the code: Ctrl-C, and the same command goes
on. A search takes half a second, a staged run of f1 twenty, for each start is followed to see whose basin it is in.
"""

import argparse
import json
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from benchmarks.parts.identification import seed_table7
from benchmarks.parts.identification.seed_stages import Stages, stages
from benchmarks.parts.identification.seed_table7 import Run, search, search_random
from benchmarks.parts.identification.table7 import OBJECTIVES
from rotorrig.rig import code_version

ROOT = Path(__file__).parents[1]
KEPT = ROOT / "docs" / "chea-table7.json"
CACHE = ROOT / ".cache" / "chea-table7"
KINDS = {"runs": search, "truths": search_random, "stages": stages}

Job = tuple[str, str, int]  # kind, objective, seed


def main() -> None:
    """Measure what has not been measured yet, print, and keep it if asked."""
    options = arguments()
    counts = {"runs": options.seeds, "truths": options.truths, "stages": options.staged}
    wanted = list(jobs(counts))
    CACHE.mkdir(parents=True, exist_ok=True)
    cache = CACHE / f"{code_version()}.jsonl"
    done = read(cache)
    with (
        ProcessPoolExecutor(options.workers, initializer=threadpool_limits, initargs=(1,)) as pool,
        cache.open("a", encoding="utf-8") as file,
    ):
        missing = [job for job in wanted if job not in done]
        for job, row in zip(missing, pool.map(run, missing), strict=True):
            done[job] = row
            print(json.dumps([*job, row]), file=file, flush=True)
    measured = collect(wanted, done)
    print(seed_table7.text(measured))
    if options.write:
        kept = {"version": code_version(), **{name: plain(found) for name, found in measured.items()}}
        KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")


def jobs(counts: dict[str, int]) -> Iterator[Job]:
    """Return what to run, of every kind the same share before any goes on: one that is stopped has some of all."""
    seeds = [(kind, seed) for kind, count in counts.items() for seed in range(count)]
    for kind, seed in sorted(seeds, key=lambda one: one[1] / counts[one[0]]):
        yield from ((kind, name, seed) for name in OBJECTIVES)


def run(job: Job) -> dict[str, float]:
    """Return the fields of one run."""
    kind, name, seed = job
    return asdict(KINDS[kind](name, seed))  # type: ignore[arg-type]


def read(cache: Path) -> dict[Job, dict[str, float]]:
    """Return the runs of a file, none if it is not there."""
    lines = cache.read_text(encoding="utf-8").splitlines() if cache.exists() else []
    return {(kind, name, seed): row for kind, name, seed, row in map(json.loads, lines)}


def collect(wanted: list[Job], done: dict[Job, dict[str, float]]) -> dict[str, Any]:
    """Return the runs as `seed_table7.summarise` takes them."""
    measured: dict[str, Any] = {name: {kind: [] for kind in KINDS} for name in OBJECTIVES}
    for kind, name, seed in wanted:
        row = done[kind, name, seed]
        measured[name][kind].append(Stages(**row) if kind == "stages" else Run(**row))  # type: ignore[arg-type]
    return measured


def plain(found: dict[str, list[Any]]) -> dict[str, list[dict[str, float | None]]]:
    """Return runs as JSON has them: what there was not, and what never came, is null.

    >>> plain({"runs": [Run(calls=9, error=0.5, exact_after=float("inf"))]})
    {'runs': [{'calls': 9, 'error': 0.5, 'exact_after': None}]}
    """
    return {
        kind: [
            {key: value if abs(value) < float("inf") else None for key, value in asdict(run).items()} for run in rows
        ]
        for kind, rows in found.items()
    }


def restore(kept: dict[str, list[dict[str, Any]]]) -> dict[str, list[Any]]:
    """Return the runs of one objective that were kept: null is what there was not, or never came."""

    def known(row: dict[str, Any], other: float) -> dict[str, Any]:
        return {key: other if value is None else value for key, value in row.items()}

    return {
        "runs": [Run(**known(row, float("inf"))) for row in kept["runs"]],
        "truths": [Run(**known(row, float("inf"))) for row in kept["truths"]],
        "stages": [Stages(**known(row, float("nan"))) for row in kept["stages"]],
    }


def arguments(argv: list[str] | None = None) -> argparse.Namespace:
    """Return the checked command line, that of the process by default."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=40, help="runs on Table 7's data (default 40)")
    parser.add_argument("--truths", type=int, default=20, help="random truths (default 20)")
    parser.add_argument("--staged", type=int, default=6, help="runs whose steps are looked at (default 6)")
    parser.add_argument("--workers", type=int, default=1, help="processes (default 1)")
    parser.add_argument("--write", action="store_true", help=f"write {KEPT.relative_to(ROOT)}")
    options = parser.parse_args(argv)
    for name in ("seeds", "truths", "staged", "workers"):
        if getattr(options, name) < 1:
            parser.error(f"--{name} is {getattr(options, name)}, want at least 1")
    return options


if __name__ == "__main__":
    main()
