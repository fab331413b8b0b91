"""Runs that list all global minima: one of a method on a function, those that are kept, and what they come to."""

import hashlib
import json
import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.parts.blind.records import read_records
from benchmarks.parts.chea.counting import Counted
from benchmarks.parts.chea.functions import Array
from benchmarks.parts.chea.nearest_better import nea2
from benchmarks.parts.chea.niching import niching_cases
from benchmarks.parts.chea.peers import Found
from benchmarks.parts.tables import markdown
from rotorrig.identify.chea import chea

ROOT = Path(__file__).parents[3]
KEPT = ROOT / "benchmarks/parts/chea/niching.jsonl"
CASES = {case.name: (case, budget) for case, budget in niching_cases()}
METHODS = ("chea all", "NEA2")

Record = dict[str, Any]
Job = tuple[str, str, int, str]  # method, function, seed, version


@dataclass
class Timed:
    """A function that adds up the time it takes."""

    fun: Any
    seconds: float = 0.0

    def __call__(self, x: Array) -> Array:
        """Return its values."""
        begin = time.perf_counter()
        values: Array = self.fun(x)
        self.seconds += time.perf_counter() - begin
        return values


def run_job(job: Job) -> Record:
    """Return the line of one run."""
    method, name, seed, version = job
    case, budget = CASES[name]
    problem = case.problem(seed)
    timed = Timed(problem.fun)
    fun = Counted(timed, budget=budget)
    begin = time.perf_counter()
    found = solve(method, fun, problem.bounds, np.random.default_rng(seed), budget)
    seconds = time.perf_counter() - begin
    near = problem.minima.nearest(found.listed)
    hit = (np.abs(near - found.listed) <= problem.tolerance).all(axis=1)
    listed = len(np.unique(near[hit].round(6), axis=0))
    about = {"version": version, "design": method, "name": f"{name} {seed}", "function": name, "seed": seed}
    own = 1e3 * (seconds - timed.seconds) / fun.calls
    return {**about, "listed": listed, "count": problem.minima.count, "calls": fun.calls, "own_ms": own}


def solve(method: str, fun: Counted, bounds: Array, rng: np.random.Generator, budget: int) -> Found:
    """Return what a method lists."""
    if method == "NEA2":
        return nea2(fun, bounds, rng)
    found = chea(fun.batch, bounds, rng=rng, stop="all", vectorized=True, max_nfev=budget)
    return Found(found.x, np.vstack([found.x, found.xl]))


def source_version() -> str:
    """Return the digest of what a run depends on: CHEA, the functions and the other method."""
    found = hashlib.sha256()
    parts = [ROOT / "benchmarks/parts/chea" / name for name in ("functions.py", "niching.py", "nearest_better.py")]
    for path in sorted([*(ROOT / "rotorrig/identify/chea").rglob("*.py"), *parts]):
        found.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return found.hexdigest()[:12]


def read_runs(version: str, *, any_version: bool) -> list[Record]:
    """Return the runs of a version; with `any_version`, of the newest there is where that has none."""
    if not KEPT.exists():
        return []
    versions = [json.loads(line)["version"] for line in KEPT.read_text(encoding="utf-8").splitlines()]
    if any_version and version not in versions and versions:
        version = versions[-1]
    return list(read_records(KEPT, version=version).values())


def summarise(kept: Sequence[Record]) -> dict[str, dict[str, Any]]:
    """Return figures by function and method: mean share of the minima, runs that list all, calls, own time."""
    found: dict[str, dict[str, Any]] = {}
    for name in CASES:
        for method in METHODS:
            rows = [r for r in kept if (r["function"], r["design"]) == (name, method)]
            if not rows:
                continue
            figures = {
                "runs": len(rows),
                "minima": rows[0]["count"],
                "peak_ratio": statistics.mean(r["listed"] / r["count"] for r in rows),
                "all_listed": statistics.mean(r["listed"] == r["count"] for r in rows),
                "calls_median": statistics.median(r["calls"] for r in rows),
                "own_ms": statistics.median(r["own_ms"] for r in rows),
            }
            found.setdefault(name, {})[method] = figures
        if name in found and "chea all" in found[name]:
            found[name]["peak_ratio"] = found[name]["chea all"]["peak_ratio"]
    return found


def table(found: dict[str, dict[str, Any]]) -> str:
    """Return the figures as a table, a row for every method on every function."""
    rows = []
    for name, methods in found.items():
        for method in METHODS:
            if figures := methods.get(method):
                rows.append(
                    [
                        f"{name} ({figures['minima']})",
                        method,
                        f"{figures['runs']}",
                        f"{100 * figures['peak_ratio']:.1f} %",
                        f"{100 * figures['all_listed']:.0f} %",
                        f"{figures['calls_median']:,.0f}",
                        f"{figures['own_ms']:.2f}",
                    ]
                )
    head = ("function (minima)", "method", "runs", "listed", "all of them", "calls", "own ms/call")
    return markdown(head, rows)
