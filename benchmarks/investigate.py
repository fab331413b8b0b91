"""Investigations of simulated rigs: how often the rig finds out by itself what is wrong with it, and in how many runs.

    python benchmarks/investigate.py --development --seeds 1 --hidden bow delay
    python benchmarks/investigate.py                                   (the published cases; resumable, some hours)
    python benchmarks/investigate.py --summary --json                  (of the cases that are kept)

Every case hides one fault, of a size drawn from its range, in a rig with one plane of probes, one of three a rig of its
own (parts/blind/rigs/drawn.py); `rotor investigate` is run on it over the real wire, unwatched by anybody but its
simulated operator, who mounts masses, and may make six runs. Then the truth is opened. A first run that trips is drawn
again. Order is random and fixed, so that a run that was stopped is a fair sample. Development has seeds 0 to 99; those
of the published cases begin at 5000.
"""

import argparse
import json
import statistics
import tempfile
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.parts.alone import Ending
from benchmarks.parts.blind.cases import Case, draw_again, modelled, sizes
from benchmarks.parts.blind.names import answer
from benchmarks.parts.blind.records import append_record, open_records, read_newest, read_records, source_version
from benchmarks.parts.case_arguments import case_parser, parse_cases
from benchmarks.parts.jobs import run_limited
from benchmarks.parts.shares import share
from rotorrig.app.commands.investigate import investigate, prepare
from rotorrig.app.commands.simulate import SimulatedRig
from rotorrig.app.terminal import out
from rotorrig.investigation import Budget, Journal
from rotorrig.rig import RigError
from rotorrig.sims.plant import draw, seal, unseal

ROOT = Path(__file__).parents[1]
KEPT = ROOT / "benchmarks/parts/investigate/cases.jsonl"
DEVELOPED = ROOT / ".cache/investigate.jsonl"
PUBLISHED = 5000  # first seed of what is published
RIGS = 3  # per fault
RATE = 60.0  # simulated seconds per second, at most
LIMIT = 1800.0  # s a case
MOST_DRAWS = 6
RUNS = 6


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


def run_case(case: Case) -> Iterator[dict[str, Any]]:
    """Investigate one rig and yield the line of it; the truth is opened at the end."""
    out.quiet = True
    for _ in range(MOST_DRAWS):
        with tempfile.TemporaryDirectory() as scratch:
            sealed = Path(scratch) / "sealed.json"
            geometry, _ = case.geometry
            seal(replace(draw(case.rig, seed=case.plant_seed, faults=sizes(case)), geometry=geometry), sealed)
            setup = prepare(
                case.rig,
                config=Path("none.toml"),
                folder=Path(scratch) / "found",
                plan="default",
                budget=Budget(runs=RUNS),
                simulation=SimulatedRig(seed=case.seed, hidden=sealed, rate=RATE),
            )
            try:
                journal, diagnosis = investigate(setup)
            except RigError as error:
                if list((Path(scratch) / "found").glob("response-*")):
                    yield {"again": case.again, "verdict": "tripped", "error": str(error)}
                    return
                case = draw_again(case)
                continue
            truth = unseal(sealed)
            right = {label for fault in truth.faults for label in answer(case.rig, truth, fault).labels}
            named = [cause.label for cause in diagnosis.causes if cause.chosen]
            yield {"again": case.again, **line(journal, named, [list(t) for t in diagnosis.tied], right)}
            return
    yield {"again": case.again, "verdict": "tripped", "error": "every first run"}


def line(journal: Journal, named: Sequence[str], tied: Sequence[Sequence[str]], right: set[str]) -> dict[str, Any]:
    """Return what is kept of an investigation."""
    first = journal.judged[0]
    return {
        "verdict": str(journal.judged[-1].verdict),
        "named": list(named),
        "tied": list(tied),
        "right": sorted(right),
        "first_verdict": str(first.verdict),
        "first_beliefs": [each.label for each in first.beliefs],
        "runs": [{"plan": r.plan, "trial": list(r.trial), "seconds": r.seconds} for r in journal.judged],
        "ending": journal.ending,
    }


def summarise(kept: Sequence[dict[str, Any]], *, wanted: int) -> dict[str, Any]:
    """Return the figures: named right and wrong, ties that were resolved, runs used, trips of a chosen run."""
    whole = [r for r in kept if "runs" in r]
    right = [r for r in whole if r["verdict"] == "named" and set(r["named"]) & set(r["right"])]
    wrong = [r for r in whole if r["verdict"] == "named" and not set(r["named"]) & set(r["right"])]
    tied = [r for r in whole if r["first_verdict"] == "tied" and set(r["first_beliefs"]) & set(r["right"])]
    resolved = [r for r in tied if r in right]
    return {
        "named_right": share(len(right), len(kept)),
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
