"""Investigations of simulated rigs: how often the rig finds out by itself what is wrong with it, and in how many runs.

    python benchmarks/investigate.py --development --seeds 1 --hidden bow delay
    python benchmarks/investigate.py                                   (the published cases; resumable, some hours)
    python benchmarks/investigate.py --summary --json                  (of the cases that are kept)

Every case hides one fault, of a size drawn from its range, in a rig with one plane of probes, one of three a rig of its
own (parts/blind/rigs/drawn.py); `rotor investigate` is run on it over the real wire, unwatched by anybody but its
simulated operator, who mounts masses, and may make six runs. Then the truth is opened, and it is asked what two runs
of the plan, one of them with a trial mass, could name at all. A first run that trips is drawn again. Order is random
and fixed, so that a run that was stopped is a fair sample. Development has seeds 0 to 99; those of the published cases
begin at 5000.
"""

import argparse
import json
import statistics
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.parts.alone import Ending
from benchmarks.parts.blind.cases import Case, modelled
from benchmarks.parts.blind.records import append_record, open_records, read_newest, read_records, source_version
from benchmarks.parts.case_arguments import case_parser, parse_cases
from benchmarks.parts.investigate.case_run import run_case
from benchmarks.parts.jobs import run_limited
from benchmarks.parts.shares import share
from rotorrig.identify.verdict import VERDICT

ROOT = Path(__file__).parents[1]
KEPT = ROOT / "benchmarks/parts/investigate/cases.jsonl"
DEVELOPED = ROOT / ".cache/investigate.jsonl"
PUBLISHED = 5000  # first seed of what is published
RIGS = 3  # per fault
LIMIT = 1800.0  # s a case


def main() -> None:
    """Run the cases that are not kept yet, and print what came of all."""
    options = arguments()
    first = 0 if options.development else PUBLISHED
    path = DEVELOPED if options.development else KEPT
    wanted = in_order(
        [Case(design="P1", faults=(f,), seed=first + i) for f in options.hidden for i in range(options.seeds)]
    )
    version = source_version(later=frozenset({"balancing"}))
    if not options.summary:
        run(wanted, path, version, options)
    kept = [r for r in read_newest(path) if any(r["name"] == c.name for c in wanted)]
    result = summarise(kept, wanted=len(wanted))
    for key, value in result.items():
        print(f"{key:16} {value}")
    if options.json:
        print(json.dumps(result))


def in_order(cases: Sequence[Case]) -> list[Case]:
    """Return the cases in a random order that is always the same."""
    order = np.random.default_rng(zlib.crc32(b"investigate")).permutation(len(cases))
    return [cases[i] for i in order]


def run(wanted: Sequence[Case], path: Path, version: str, options: argparse.Namespace) -> None:
    """Run the cases of which `path` has no line of this version."""
    with open_records(path) as file:
        kept = read_records(path, version=version)
        jobs = [case for case in wanted if f"{case.design} {case.name}" not in kept]

        def keep(case: Case, parts: dict[str, Any], ending: Ending) -> None:
            about = {"design": case.design, "name": case.name, "fault": case.faults[0], "seed": case.seed}
            append_record(file, {"version": version, "ending": ending, **about, **parts})
            print(f"{case.name}: {parts.get('verdict', ending)}", flush=True)

        run_limited(run_case, jobs, workers=options.workers, scheduler=options.scheduler, limit=LIMIT, done=keep)


def summarise(kept: Sequence[dict[str, Any]], *, wanted: int) -> dict[str, Any]:
    """Return the figures: named right and wrong, ties that were resolved, runs used, trips of a chosen run."""
    whole = [r for r in kept if "runs" in r]
    right = [r for r in whole if r["verdict"] == "named" and set(r["named"]) & set(r["right"])]
    wrong = [r for r in whole if r["verdict"] == "named" and not set(r["named"]) & set(r["right"])]
    tied = [r for r in whole if r["first_verdict"] == "tied" and set(r["first_beliefs"]) & set(r["right"])]
    resolved = [r for r in tied if r in right]
    nameable = [r for r in whole if r.get("lam", {}).get("rival_lam", 0.0) >= VERDICT.nameable]
    return {
        "named_right": share(len(right), len(kept)),
        "named_right_of_nameable": share(sum(r in right for r in nameable), len(nameable)),
        "named_right_first": share(sum(r["first_verdict"] == "named" for r in right), len(kept)),
        "ties_resolved": share(len(resolved), len(tied)),
        "wrong_unique": len(wrong),
        "still_tied": sum(r["verdict"] == "tied" for r in whole),
        "runs_median": statistics.median(len(r["runs"]) for r in whole) if whole else None,
        "limit_trips": sum(r.get("verdict") == "tripped" for r in kept),
        "unfinished": len(kept) - len(whole) - sum(r.get("verdict") == "tripped" for r in kept),
        "cases": len(kept),
        "wanted": wanted,
        "version": sorted({r["version"] for r in kept}),
    }


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = case_parser(__doc__, seeds=RIGS, of="rigs per fault")
    parser.add_argument("--hidden", nargs="+", choices=modelled(), default=list(modelled()), metavar="FAULT")
    return parse_cases(parser)


if __name__ == "__main__":
    main()
