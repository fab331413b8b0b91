"""The missing force, with every known cause left out: whether it is found, where, and what its law predicts.

    python benchmarks/discovery.py --development --seeds 2 --hidden pedestal bow
    python benchmarks/discovery.py                                     (seeds from 2000 on; resumable)
    python benchmarks/discovery.py --summary --json                    (of the cases that are kept)

Cases are those of the blind test (benchmarks/blind.py), with two planes and a trial mass, and beside them faults that
no effect models, in a random order: as far as a run has come, it is a fair sample. Of a fault the base model must fail;
then one force or reading is looked for (rotorrig/identify/discovery), none of the effects in sims/effects is tried, and
the answer is held against parts/discovery/expected.py. Seeds 0 to 99 are for development.
"""

import argparse
import json
import statistics
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.parts.alone import Ending
from benchmarks.parts.blind.cases import Case
from benchmarks.parts.blind.records import append_record, open_records, read_newest, read_records, source_version
from benchmarks.parts.case_arguments import case_parser, parse_cases
from benchmarks.parts.discovery.case_run import run_case
from benchmarks.parts.discovery.wanted import wanted_cases
from benchmarks.parts.jobs import run_limited
from benchmarks.parts.shares import share, to_text

ROOT = Path(__file__).parents[1]
KEPT = ROOT / "benchmarks/parts/discovery/cases.jsonl"
DEVELOPED = ROOT / ".cache/discovery.jsonl"
RECORDINGS = ROOT / ".cache/blind"
PUBLISHED = 2000  # first seed of what is published
SEEDS = 10  # of every fault
LIMIT = 1800.0  # s a case
NEAR = 0.025  # m
MISSED = 1.96  # standard deviations

Record = dict[str, Any]


def main() -> None:
    """Run the cases that are not kept yet, and print what came of all."""
    options = arguments()
    first, path = (0, DEVELOPED) if options.development else (PUBLISHED, KEPT)
    wanted = wanted_cases(seeds=options.seeds, first=first, hidden=options.hidden)
    version = source_version()
    if not options.summary:
        run(wanted, path, version, options)
    names = {case.name for case in wanted}
    result = summarise([record for record in read_newest(path) if record["name"] in names], wanted=len(wanted))
    for key, value in result.items():
        print(f"{key:22} {to_text(value)}")
    if options.json:
        print(json.dumps(result))


def run(wanted: Sequence[Case], path: Path, version: str, options: argparse.Namespace) -> None:
    """Run the cases of which `path` has no line of this version."""
    with open_records(path) as file:
        kept = read_records(path, version=version)
        jobs = [(case, RECORDINGS) for case in wanted if f"{case.design} {case.name}" not in kept]

        def keep(job: tuple[Case, Path], parts: Record, ending: Ending) -> None:
            case = job[0]
            own = {"version": version, "ending": ending, "design": case.design, "name": case.name, "kind_of": case.kind}
            append_record(file, own | asdict(case) | parts)
            told = parts.get("words") if path == DEVELOPED else "done"  # nobody looks at what is published
            print(f"{case.name}: {parts.get('error') or told or 'adequate'}", flush=True)

        run_limited(run_case, jobs, workers=options.workers, scheduler=options.scheduler, limit=LIMIT, done=keep)


def summarise(kept: Sequence[Record], *, wanted: int) -> dict[str, Any]:
    """Return the figures of the cases whose base model fails; `described` are those that count as found."""
    failed = [r for r in kept if r.get("adequate") is False and "kind" in r]
    known = [r for r in failed if r["kind_of"] == "single" and r["right"][0]]
    strange = [r for r in failed if r["kind_of"] == "outsider" and r["right"][0]]
    healthy = [r for r in kept if r["kind_of"] == "healthy"]
    told = [r for r in known if not r["shortfall"]]
    placed = [r for r in told if r["right"][0]["places"]]
    sure = [r for r in known if r["right"][0]["places"] and r["sigma"] is not None and r["sigma"] <= NEAR]
    return {
        "kind_right": share(sum(map(is_kind_right, known)), len(known)),
        "described": share(len(told), len(known)),
        "described_kind_right": share(sum(map(is_kind_right, told)), len(told)),
        "place_right": share(sum(off(r) <= NEAR for r in placed), len(placed)),
        "place_right_of_sure": share(sum(off(r) <= NEAR for r in sure), len(sure)),
        "region_missed": share(sum(off(r) > MISSED * r["sigma"] for r in sure), len(sure)),
        "direction_right": share(sum(is_law_right(r) for r in told if r["right"][0]["laws"]), has_law(told)),
        "heldout_ok": share(sum(r["over_floor"] <= 1.5 for r in known), len(known)),
        "heldout_ok_expected": share(sum(r["over_expected"] <= 1.5 for r in known), len(known)),
        "healthy_found": share(sum(not r.get("shortfall", "none") for r in healthy), len(healthy)),
        "outsiders_kind_right": share(sum(map(is_kind_right, strange)), len(strange)),
        "outsiders_place_right": share(
            sum(off(r) <= NEAR for r in strange if r["right"][0]["places"]),
            sum(bool(r["right"][0]["places"]) for r in strange),
        ),
        "seconds_per_case": round(statistics.fmean(r["seconds_cpu"] for r in kept if "seconds_cpu" in r), 1)
        if any("seconds_cpu" in r for r in kept)
        else None,
        "errors": sum("error" in r or r["ending"] != "ended" for r in kept),
        "cases": len(kept),
        "wanted": wanted,
        "version": sorted({r["version"] for r in kept}),
    }


def is_kind_right(record: Record) -> bool:
    """Say whether a force was told from a reading; a moment is a force."""
    return bool((record["kind"] == "reading") == (record["right"][0]["kind"] == "reading"))


def is_law_right(record: Record) -> bool:
    """Say whether the first of its laws, which explains most, is one of the right ones."""
    return bool(record["laws"]) and record["laws"][0] in record["right"][0]["laws"]


def has_law(told: Sequence[Record]) -> int:
    """Return how many have a right law."""
    return sum(bool(record["right"][0]["laws"]) for record in told)


def off(record: Record) -> float:
    """Return how far its place is from the nearest right one [m]; infinite for a reading."""
    if record["place"] is None:
        return float("inf")
    return min(abs(record["place"] - place) for place in record["right"][0]["places"])


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = case_parser(__doc__, seeds=SEEDS, of="of every fault; ten times as many healthy")
    parser.add_argument("--hidden", nargs="+", default=[], help="of these faults alone, or 'healthy'")
    return parse_cases(parser)


if __name__ == "__main__":
    main()
