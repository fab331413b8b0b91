"""Do the 95 % intervals hold the truth in 95 % of cases? Simulated rigs, from the search to the interval.

    python benchmarks/identification_coverage.py --cases 1000 --workers 3 --write

Each case is drawn by matched_run.py and goes through the whole of `fit`. An interval that is missing counts as a miss.
"""

import argparse
import json
import math
import sys
import time
from collections.abc import Iterable
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest
from threadpoolctl import threadpool_limits

from benchmarks.parts.identification.coverage_groups import GROUPS, NAMES
from benchmarks.parts.identification.matched_run import draw
from benchmarks.parts.identification.uncertainty_page import page, table
from rotorrig.identify import identify
from rotorrig.identify.uncertainty import Resampling
from rotorrig.rig.config import RigConfig, load

ROOT = Path(__file__).parents[1]


@dataclass(frozen=True, kw_only=True)
class Trial:
    """What came of one estimate of one case."""

    name: str
    covered: bool
    by: str  # how its interval was made; empty: there is none
    off: float  # estimate less truth in standard deviations
    relative: float  # standard deviation over the truth, rad for a phase


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """One case."""

    trials: tuple[Trial, ...]
    reduced_chi2: float
    seconds: float


def measure(pool: Executor, *, cases: int, seed: int = 0, groups: Iterable[str] = GROUPS) -> dict[str, list[Outcome]]:
    """Return the outcomes of every group, telling standard error how far it is."""
    found = {}
    for name in groups:
        count = max(1, round(cases * GROUPS[name].share))
        jobs = [(name, seed, i) for i in range(count)]
        found[name] = []
        for outcome in pool.map(case, jobs):
            found[name].append(outcome)
            print(f"\r{name}: {len(found[name])} of {count}", end="", file=sys.stderr, flush=True)
        print(file=sys.stderr)
    return found


def case(job: tuple[str, int, int]) -> Outcome:
    """Return the outcome of case number `i` of a group."""
    name, seed, i = job
    group = GROUPS[name]
    began = time.perf_counter()
    drawn = draw(_rig(), group.design, rng=np.random.default_rng([seed, i]))
    resampling = Resampling(draws=group.draws) if group.draws else None
    found = identify([drawn.response], seed=i, resampling=resampling).fits[0]
    trials = []
    for key, truth in drawn.truth.items():
        estimate = found.estimate(key)
        if key == "phase":  # the turn of the circle nearest to the estimate
            truth = estimate.value + math.remainder(truth - estimate.value, math.tau)
        low, high = estimate.interval or (math.nan, math.nan)
        trials.append(
            Trial(
                name=key,
                covered=low <= truth <= high,
                by=estimate.interval_by,
                off=(estimate.value - truth) / estimate.sigma,
                relative=estimate.sigma if key == "phase" else estimate.sigma / truth,
            )
        )
    return Outcome(trials=tuple(trials), reduced_chi2=found.chi2 / found.dof, seconds=time.perf_counter() - began)


@cache
def _rig() -> RigConfig:
    return load(ROOT / "configs/rk4.toml")


def summarise(measured: dict[str, list[Outcome]]) -> dict[str, Any]:
    """Return coverage95, pooled over the estimates of the first group, and the shares behind it."""
    groups = {name: _summary(outcomes) for name, outcomes in measured.items()}
    return {"coverage95": next(iter(groups.values()))["all"]["share"], "coverage": groups}


def _summary(outcomes: list[Outcome]) -> dict[str, Any]:
    trials = [trial for outcome in outcomes for trial in outcome.trials]
    rows = {name: _row([t for t in trials if t.name == name], cases=len(outcomes)) for name in NAMES}
    return {
        "cases": len(outcomes),
        **rows,
        "all": _row(trials, cases=len(outcomes)),
        "seconds_median": float(np.median([outcome.seconds for outcome in outcomes])),
        "chi2_median": float(np.median([outcome.reduced_chi2 for outcome in outcomes])),
    }


def _row(trials: list[Trial], *, cases: int) -> dict[str, Any]:
    """Return the share covered and its 95 % bounds; of pooled estimates as if they were fully correlated in a case."""
    share = sum(trial.covered for trial in trials) / len(trials)
    bounds = binomtest(round(share * cases), cases).proportion_ci(0.95, method="exact")
    known = [trial for trial in trials if math.isfinite(trial.off)]
    return {
        "share": share,
        "low": float(bounds.low),
        "high": float(bounds.high),
        "profiled": sum(trial.by == "profile likelihood" for trial in trials) / len(trials),
        "none": sum(not trial.by for trial in trials) / len(trials),
        "relative_sigma_median": float(np.median([trial.relative for trial in trials])),
        "rms_off": float(np.sqrt(np.mean([trial.off**2 for trial in known]))) if known else None,
    }


def text(measured: dict[str, list[Outcome]]) -> str:
    """Return the table in Markdown."""
    return table(summarise(measured)["coverage"])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--cases", type=int, default=100, help="of the first group; the others have fewer (default 100)"
    )
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2, help="processes (default 2)")
    parser.add_argument("--groups", nargs="+", choices=list(GROUPS), default=list(GROUPS))
    parser.add_argument("--json", action="store_true", help="end with one JSON object on the last line")
    parser.add_argument("--write", action="store_true", help="write docs/uncertainty.md")
    options = parser.parse_args()
    for name in ("cases", "workers"):
        if getattr(options, name) < 1:
            parser.error(f"--{name} is {getattr(options, name)}, want at least 1")
    with ProcessPoolExecutor(options.workers, initializer=threadpool_limits, initargs=(1,)) as pool:
        measured = measure(pool, cases=options.cases, seed=options.seed, groups=options.groups)
    summary = summarise(measured)
    if options.write:
        (ROOT / "docs/uncertainty.md").write_text(page(summary["coverage"]), encoding="utf-8")
    print(text(measured))
    if options.json:
        print(json.dumps(summary))


if __name__ == "__main__":
    main()
