"""The case of the day, on many days: how often the diagnosis names what is hidden, where it can hardly be missed.

    python benchmarks/daily.py --days 300                    (development: days of the past, kept in .cache)
    python benchmarks/daily.py --days 300 --summary --json

Every day draws a rig, a fault and its size from its date alone, of lam >= 100 to the base model and to the nearest
rival (parts/blind/daily.py), and a healthy rig. A test that asks for the name of today's fault would be red as often as
this misses one; `make test` asks no more than that the fault can be seen.
"""

import argparse
import json
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from datetime import date, timedelta
from pathlib import Path
from typing import Any

from benchmarks.parts.alone import Ending
from benchmarks.parts.blind.case_run import diagnosed, right_answers, verdict_part
from benchmarks.parts.blind.daily import draw_day, healthy_of_day, hide_fault
from benchmarks.parts.blind.measured import measure
from benchmarks.parts.blind.records import append_record, open_records, read_newest, read_records, source_version
from benchmarks.parts.blind.score import Score, score
from benchmarks.parts.case_arguments import add_workers
from benchmarks.parts.jobs import run_limited
from benchmarks.parts.shares import share
from rotorrig.sims.plant import unseal

ROOT = Path(__file__).parents[1]
KEPT = ROOT / ".cache/daily.jsonl"
LAST = date(2026, 10, 31)  # of the days of development, counted back from here
LIMIT = 1800.0  # s a case

Record = dict[str, Any]
Job = tuple[date, bool]  # with a fault, or healthy


def main() -> None:
    """Run the days that are not kept yet, and print how often they would be red."""
    options = arguments()
    days = [LAST - timedelta(days=i) for i in range(options.days)]
    wanted = [(day, faulty) for day in days for faulty in (True, False)]
    if not options.summary:
        run(wanted, options)
    names = {name_of(job) for job in wanted}
    result = summarise([r for r in read_newest(KEPT) if r["name"] in names], wanted=len(wanted))
    for key, value in result.items():
        print(f"{key:16} {value}")
    if options.json:
        print(json.dumps(result))


def run(wanted: Sequence[Job], options: argparse.Namespace) -> None:
    """Run the days of which there is no line of this version."""
    version = source_version()
    with open_records(KEPT) as file:
        kept = read_records(KEPT, version=version)
        jobs = [job for job in wanted if f"day {name_of(job)}" not in kept]

        def keep(job: Job, parts: Record, ending: Ending) -> None:
            append_record(file, {"version": version, "ending": ending, "design": "day", "name": name_of(job), **parts})
            print(f"{name_of(job)}: {parts.get('verdict', ending)} {list(parts.get('chosen', ()))}", flush=True)

        run_limited(run_day, jobs, workers=options.workers, scheduler=options.scheduler, limit=LIMIT, done=keep)


def name_of(job: Job) -> str:
    """Return what a day and its kind are called."""
    day, faulty = job
    return f"{day} {'fault' if faulty else 'healthy'}"


def run_day(job: Job) -> Iterator[Record]:
    """Yield the line of a day."""
    day, faulty = job
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        if faulty:
            hidden = draw_day(day, hide=lambda case: hide_fault(case, folder))
            case, responses, truth = hidden.case, hidden.responses, hidden.truth
            yield {**asdict(case), "lam": hidden.lam}
        else:
            case = healthy_of_day(day)
            yield asdict(case)
            responses = measure(case, sealed=folder / "sealed.json", folder=folder)
            truth = unseal(folder / "sealed.json")
        began = time.process_time()
        found = diagnosed(responses, folder / "diagnosis.json")
        spent = time.process_time() - began
    answers = [asdict(each) for each in right_answers(case, truth)]
    yield {**verdict_part(found), "seconds": spent, "seconds_cpu": spent, "hidden": answers}


def summarise(kept: Sequence[Record], *, wanted: int) -> dict[str, Any]:
    """Return how many days would be red, and how long they took."""
    scored = [score(record) for record in kept if "seed" in record]
    faults = [s for s in scored if s.kind == "single"]
    healthy = [s for s in scored if s.kind == "healthy"]
    seconds = sorted(s.cpu for s in scored)
    return {
        "in_set": share(sum(s.in_set for s in faults), len(faults)),
        "named_right": share(sum(s.named_right for s in faults), len(faults)),
        "wrong_name": share(sum(s.wrong_name for s in faults), len(faults)),
        "false_alarm": share(sum(s.false_alarm for s in healthy), len(healthy)),
        "missed": sorted(missed(s) for s in faults if not s.in_set),
        "seconds_median": round(seconds[len(seconds) // 2], 1) if seconds else None,
        "errors": sum(r["ending"] != "ended" for r in kept),
        "cases": len(kept),
        "wanted": wanted,
        "version": sorted({r["version"] for r in kept}),
    }


def missed(found: Score) -> str:
    """Return which case was missed, and how."""
    return f"{found.case.name}: {found.verdict} {sorted(found.named)}"


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--days", type=int, default=30, help="so many, each with a fault and a healthy rig")
    parser.add_argument("--summary", action="store_true", help="of the days that are kept; run none")
    parser.add_argument("--json", action="store_true", help="end with one JSON object on the last line")
    add_workers(parser)
    options = parser.parse_args()
    if options.days < 1:
        parser.error(f"--days is {options.days}, want at least 1")
    return options


if __name__ == "__main__":
    main()
