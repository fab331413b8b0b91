"""The fault campaign: `rotor sweep` against independent peers, with faults at random moments, judged from outside.

    python benchmarks/soak.py --singles --pairs --page     (all; docs/faults.md; `make soak`)
    python benchmarks/soak.py --pairs --run 100            (so many more)
    python benchmarks/soak.py --only "kill -9" --singles   (runs with these words in their name)
    python benchmarks/soak.py --case "one supply"          (what was found once; --cases: all of those)
    python benchmarks/soak.py --json --summary             (of the runs that are kept)

A run is kept as a line in benchmarks/parts/soak/results/ as soon as it is judged, and not run again on the same code;
Ctrl-C loses only what is under way. With --json the last line is one JSON object. Status 1 if anything was otherwise
than it should be.
"""

import argparse
import json
import os
import signal
import sys
import traceback
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from types import FrameType

from benchmarks.parts.case_arguments import add_workers
from benchmarks.parts.jobs import WorkerDied, in_parallel
from benchmarks.parts.soak.cases import CASES
from benchmarks.parts.soak.controllers import CONTROLLERS, ROOT
from benchmarks.parts.soak.faults import Case, pairs, singles
from benchmarks.parts.soak.judge import Verdict, judge
from benchmarks.parts.soak.page import page, text
from benchmarks.parts.soak.results import FOLDER, campaign, code, keep, kept, prune, summary
from benchmarks.parts.soak.run import run

PAGE = ROOT / "docs/faults.md"


def main() -> None:
    """Run what is asked for and not done yet, and say what is kept."""
    options = arguments()
    wanted = cases(options)
    if not options.summary:
        run_all(wanted, options)
    results = kept(options.folder)
    names = {case.run for case in wanted}
    verdicts = [verdict for verdict in results.values() if not names or verdict.run in names]
    if options.page:
        PAGE.write_text(page(list(results.values())), encoding="utf-8")
    if not options.json:
        print(text(verdicts))
    print(json.dumps(summary(campaign(results.values()) if options.summary or not wanted else verdicts)))
    sys.exit(1 if any(verdict.wrong for verdict in verdicts) else 0)


def cases(options: argparse.Namespace) -> list[Case]:
    """Return the runs that the command line asks for."""
    chosen: list[Case] = [CASES[name] for name in options.case]
    chosen += list(CASES.values()) if options.cases else []
    chosen += singles(options.rounds) if options.singles else []
    chosen += pairs(options.rounds) if options.pairs else []
    chosen = [case for case in chosen if not options.on or case.controller in options.on]
    return [case for case in chosen if all(word in case.run for word in options.only)]


def run_all(wanted: Sequence[Case], options: argparse.Namespace) -> None:
    """Run the cases that are not kept for this code: first those that were never run, then those of other code."""
    version = code()
    done = {} if options.again else kept(options.folder)
    jobs = [case for case in wanted if case.run not in done or done[case.run].code != version]
    if options.run:
        jobs = sorted(jobs, key=lambda case: (case.run in done, case.seed))[: options.run]
    signal.signal(signal.SIGTERM, _terminated)
    count = 0

    def told(verdict: Verdict) -> None:
        nonlocal count
        count += 1
        said = ", ".join(verdict.wrong) or "ok"
        print(f"{count}/{len(jobs)} {verdict.run}: {said}; {verdict.status}, {verdict.last_line[:90]}", file=sys.stderr)

    try:
        work = partial(complete, version=version, folder=options.folder)
        in_parallel(work, jobs, workers=options.workers, scheduler=options.scheduler, done=told)
    except KeyboardInterrupt:
        _leave("stopped", 130)
    except WorkerDied as error:
        _leave(str(error), 1)
    prune(options.folder)


def complete(case: Case, *, version: str, folder: Path) -> Verdict:
    """Run one case and keep its verdict; one that crashes is not kept."""
    try:
        verdict = run(case, judge)
    except Exception:
        verdict = Verdict(run=case.run, set=case.set, seed=case.seed, controller=case.controller, faults={})
        verdict.last_line = f"the run itself failed: {traceback.format_exc()}"
        print(verdict.last_line, file=sys.stderr)
        return verdict
    keep(verdict, version=version, folder=folder)
    return verdict


def _terminated(number: int, frame: FrameType | None) -> None:
    """Leave as on Ctrl-C, with the status of SIGTERM."""
    _leave("terminated", 143)


def _leave(why: str, status: int) -> None:
    print(f"{why}; what is done is kept, the same command goes on with the rest", file=sys.stderr)
    sys.exit(status)


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", action="store_true", help="all pairs of faults on three controllers")
    parser.add_argument("--singles", action="store_true", help=f"single faults on {len(CONTROLLERS)} controllers")
    parser.add_argument("--case", nargs="+", choices=sorted(CASES), default=[], metavar="NAME", help="named cases")
    parser.add_argument("--cases", action="store_true", help="all named cases")
    parser.add_argument("--only", nargs="+", default=[], metavar="WORDS", help="runs with all of these in their name")
    parser.add_argument(
        "--on", nargs="+", choices=CONTROLLERS, default=[], metavar="NAME", help="these controllers alone"
    )
    parser.add_argument("--run", type=int, default=0, metavar="N", help="so many of them, at random")
    parser.add_argument("--rounds", type=int, default=1, help="runs of each, at other moments (default 1)")
    parser.add_argument("--again", action="store_true", help="run also what is kept for this code")
    workers = 2 * (os.cpu_count() or 2)
    add_workers(parser, default=workers, of="runs at a time")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="where results are kept")
    parser.add_argument("--summary", action="store_true", help="run nothing: figures of what is kept")
    parser.add_argument("--json", action="store_true", help="print the figures alone")
    parser.add_argument("--page", action="store_true", help="write docs/faults.md from what is kept")
    options = parser.parse_args()
    for name, least in (("rounds", 1), ("workers", 1), ("run", 0)):
        if getattr(options, name) < least:
            parser.error(f"--{name} is {getattr(options, name)}, want at least {least}")
    return options


if __name__ == "__main__":
    main()
