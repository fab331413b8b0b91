"""The fault campaign: every fault on every drive at random moments of a sweep, judged from outside.

    python benchmarks/soak.py --rounds 1 --drives powerflex400 --where DAQ      (a look)
    python benchmarks/soak.py --write                                  (all; docs/faults.md; `make soak`)
    python benchmarks/soak.py --summary                                (of the runs that are done)

Every run is a simulated bench with one scripted fault and the `rotor sweep` program on its wires, each in a process of
its own, in real time unless told otherwise; it leaves in the folder what was seen. What is there is not run again, and
Ctrl-C loses only what is under way. Judging is done afterwards, from the files alone. Ends with one JSON object on the
last line, and with status 1 if anything was otherwise than it should be.
"""

import argparse
import json
import os
import signal
import sys
import traceback
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from types import FrameType
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from benchmarks.parts.parallel import WorkerDied, in_parallel
from benchmarks.parts.soak.faults import FAULTS
from benchmarks.parts.soak.judge import judge
from benchmarks.parts.soak.page import page, text, totals
from benchmarks.parts.soak.rigs import DRIVES
from benchmarks.parts.soak.run import Case, run

ROOT = Path(__file__).parents[1]
WHERE = tuple(dict.fromkeys(fault.where for fault in FAULTS))
TRIES = 3  # of a run, on a machine that is too busy
Job = tuple[Case, Path, float, float]


def main() -> None:
    """Run what is not done yet, judge what is done, print, and write the page if asked."""
    options = arguments()
    folder = options.folder / "soak"
    wanted = cases(options)
    if not options.summary:
        run_all(wanted, folder, options)
    done = [seen for case in wanted if (seen := kept(case, folder)) and "void" not in seen]
    judged = [judge(seen) for seen in done]
    if options.write:
        versions = sorted({seen.get("code_version", "unknown") for seen in done})
        (ROOT / "docs/faults.md").write_text(page(judged, versions=versions), encoding="utf-8")
    print(text(judged))
    if missing := len(wanted) - len(done):
        print(f"{missing} of {len(wanted)} runs are missing or void; the same command goes on with them")
    print(json.dumps(totals(judged)))
    sys.exit(1 if any(judgement.wrong for judgement in judged) else 0)


def cases(options: argparse.Namespace) -> list[Case]:
    """Return the runs that the command line asks for, every fault on every drive in turn."""
    return [
        Case(drive=drive, where=fault.where, fault=fault.name, number=number)
        for number in range(options.rounds)
        for fault in FAULTS
        for drive in options.drives
        if fault.where in options.where and (not options.faults or fault.name in options.faults)
    ]


def run_all(wanted: Sequence[Case], folder: Path, options: argparse.Namespace) -> None:
    """Run the cases that are not done; say so if that is stopped, and leave."""
    jobs = [
        (case, folder, options.rate, options.crowded)
        for case in wanted
        if (seen := kept(case, folder)) is None or {"crashed", "void"} & set(seen)
    ]
    if not jobs:
        return
    folder.mkdir(parents=True, exist_ok=True)
    signal.signal(signal.SIGTERM, _terminated)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    try:
        with Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True)) as bars:
            task = bars.add_task("faults", total=len(jobs))
            in_parallel(
                complete,
                jobs,
                workers=options.workers,
                done=lambda name: bars.update(task, advance=1, description=name),
            )
    except KeyboardInterrupt:
        _leave("stopped", 130)
    except WorkerDied as error:
        _leave(str(error), 1)


def complete(job: Job) -> str:
    """Run one case and keep what was seen, or what went wrong with the run itself."""
    case, folder, rate, crowded = job
    seen: dict[str, Any] = {}
    for _ in range(TRIES):
        try:
            seen = run(case, rate=rate)
        except Exception:  # a run that crashes counts as one that failed and must not end the campaign
            seen = {"case": asdict(case), "crashed": traceback.format_exc()}
            break
        if seen["crowded"] <= crowded:
            break
        seen = {"case": asdict(case), "void": f"some process waited for {seen['crowded']:.0%} of the time"}
    part = place(case, folder).with_suffix(".part")
    part.write_text(json.dumps(seen), encoding="utf-8")
    part.replace(place(case, folder))
    return case.name


def kept(case: Case, folder: Path) -> dict[str, Any] | None:
    """Return what was seen of a case; None if it was not run yet."""
    path = place(case, folder)
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


def place(case: Case, folder: Path) -> Path:
    """Return the file of a case."""
    return folder / f"{case.name}.json"


def _terminated(number: int, frame: FrameType | None) -> None:
    """Leave as on Ctrl-C, with the status of SIGTERM; what stands in a `finally` ends the workers."""
    _leave("terminated", 143)


def _leave(why: str, status: int) -> None:
    print(f"{why}; what is done is kept, the same command goes on with the rest", file=sys.stderr)
    sys.exit(status)


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3, help="runs of every fault on every drive (default 3)")
    parser.add_argument(
        "--drives", nargs="+", choices=DRIVES, default=list(DRIVES), metavar="DRIVE", help="these alone"
    )
    parser.add_argument("--where", nargs="+", choices=WHERE, default=list(WHERE), help="faults there alone")
    parser.add_argument("--faults", nargs="+", choices=sorted({f.name for f in FAULTS}), default=[], metavar="FAULT")
    parser.add_argument("--rate", type=float, default=1.0, help="rig's time over wall time, at the most (default 1)")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 2, help="runs at a time (default: one a core)")
    parser.add_argument(
        "--crowded",
        type=float,
        default=0.5,
        help="share of the time that a process may wait for a processor, beyond which a run is void (default 0.5)",
    )
    parser.add_argument("--folder", type=Path, default=ROOT / ".cache", help="where runs are kept (default .cache)")
    parser.add_argument("--summary", action="store_true", help="judge the runs that are done; run none")
    parser.add_argument("--write", action="store_true", help="write docs/faults.md")
    options = parser.parse_args()
    for name, least in (("rounds", 1), ("workers", 1)):
        if getattr(options, name) < least:
            parser.error(f"--{name} is {getattr(options, name)}, want at least {least}")
    if not 0 < options.rate < float("inf"):
        parser.error(f"--rate is {options.rate}, want a number above 0")
    return options


if __name__ == "__main__":
    main()
