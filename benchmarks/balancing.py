"""Balancing simulated rigs: how far the vibration comes down, and whether what was predicted for it came true.

    python benchmarks/balancing.py --development --seeds 6
    python benchmarks/balancing.py                                     (the published cases; resumable, about an hour)
    python benchmarks/balancing.py --summary --json                    (of the cases that are kept)

Every rig departs from its nameplate and does what no nameplate speaks of (sims/plant/deviations.py); it is swept as it
is, with one trial mass on every plane, and with every correction mounted (parts/balancing/case_run.py): by trial runs,
and with one plane also by the fit of the first run alone, and with holes and masses at hand. Mounting is exact: what
mounting masses changes besides is simulated in tests/balancing/test_coverage.py. Seeds 0 to 99 are for development.
"""

import argparse
import json
import statistics
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.parts.alone import Ending
from benchmarks.parts.balancing.case_run import Case, Kind, run_case
from benchmarks.parts.blind.records import append_record, open_records, read_newest, read_records, source_version
from benchmarks.parts.case_arguments import case_parser, parse_cases
from benchmarks.parts.jobs import run_limited
from benchmarks.parts.shares import share, to_text

ROOT = Path(__file__).parents[1]
KEPT = ROOT / "benchmarks/parts/balancing/cases.jsonl"
DEVELOPED = ROOT / ".cache/balancing.jsonl"
KINDS: tuple[Kind, ...] = ("one plane", "two planes")
PUBLISHED = 6000  # first seed of what is published
CASES = 100  # of each kind
LIMIT = 900.0  # s a case
TENFOLD, FIVEFOLD = 10.0, 5.0

Record = dict[str, Any]


def main() -> None:
    """Run the cases that are not kept yet, and print what came of all."""
    options = arguments()
    first = 0 if options.development else PUBLISHED
    path = DEVELOPED if options.development else KEPT
    wanted = [Case(kind=kind, seed=first + i) for i in range(options.seeds) for kind in options.kind]
    version = source_version(later=frozenset({"app", "investigation"}))
    if not options.summary:
        run(wanted, path, version, options)
    names = {case.name for case in wanted}
    kept = [record for record in read_newest(path) if record["name"] in names]
    result = summarise(kept, wanted=len(wanted))
    for key, value in result.items():
        print(f"{key:24} {to_text(value)}")
    if options.json:
        print(json.dumps(result))


def run(wanted: Sequence[Case], path: Path, version: str, options: argparse.Namespace) -> None:
    """Run the cases of which `path` has no line of this version."""
    with open_records(path) as file:
        kept = read_records(path, version=version)
        jobs = [case for case in wanted if f"{case.kind} {case.name}" not in kept]

        def keep(case: Case, parts: Record, ending: Ending) -> None:
            record = {"version": version, "ending": ending, "design": case.kind, "name": case.name, **asdict(case)}
            append_record(file, record | parts)
            print(f"{case.name}: {parts.get('error') or 'done'}", flush=True)

        run_limited(run_case, jobs, workers=options.workers, scheduler=options.scheduler, limit=LIMIT, done=keep)


def summarise(kept: Sequence[Record], *, wanted: int) -> dict[str, Any]:
    """Return the figures: how often the bars are met, and what is in the median."""
    one, two = ([record for record in kept if record["kind"] == kind] for kind in KINDS)

    def reaches(factor: float) -> Callable[[Record], bool]:
        return lambda found: found["factor"] >= factor or found["at_noise"]

    parts = [found for record in kept for found in (record.get(m) for m in ("by_trial", "by_fit", "in_holes")) if found]
    return {
        "trial_tenfold": reached(one, "by_trial", reaches(TENFOLD)),
        "trial_factor_median": median(one, "by_trial", "factor"),
        "two_planes_fivefold": reached(two, "by_trial", reaches(FIVEFOLD)),
        "two_planes_factor_median": median(two, "by_trial", "factor"),
        "fit_held": reached(one, "by_fit", lambda found: found["held"]),
        "fit_no_worse": reached(one, "by_fit", lambda found: found["no_worse"]),
        "fit_factor_median": median(one, "by_fit", "factor"),
        "fit_fivefold": reached(one, "by_fit", reaches(FIVEFOLD)),
        "holes_held": reached(one, "in_holes", lambda found: found["held"]),
        "holes_factor_median": median(one, "in_holes", "factor"),
        "holes_expected_median": median(one, "in_holes", "expected"),
        "inside_mean": round(statistics.fmean(found["inside"] for found in parts), 3) if parts else None,
        "errors": sum("error" in record or record["ending"] != "ended" for record in kept),
        "cases": len(kept),
        "wanted": wanted,
        "version": sorted({record["version"] for record in kept}),
    }


def reached(kept: Sequence[Record], method: str, met: Callable[[Record], bool]) -> dict[str, Any]:
    """Return the share of cases that meet a bar by a method; one that ended in an error does not."""
    return share(sum(method in record and met(record[method]) for record in kept), len(kept))


def median(kept: Sequence[Record], method: str, key: str) -> float | None:
    """Return the median of what the cases have."""
    values = [record[method][key] for record in kept if method in record]
    return round(statistics.median(values), 2) if values else None


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = case_parser(__doc__, seeds=CASES, of="rigs of each kind")
    parser.add_argument("--kind", nargs="+", choices=KINDS, default=list(KINDS))
    return parse_cases(parser)


if __name__ == "__main__":
    main()
