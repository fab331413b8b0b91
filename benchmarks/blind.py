"""The blind benchmark: faults hidden in simulated rigs, and how often the diagnosis finds and names them.

    python benchmarks/blind.py --seeds 1 --hidden bow runout           (development: seeds 0 to 99, kept in .cache)
    python benchmarks/blind.py --examine                               (the examination; `make blind`, some ten hours)
    python benchmarks/blind.py --summary --json                        (of the examination's cases that are kept)
    python benchmarks/blind.py --supersede "why" --examine             (the code has changed: another, on new seeds)

Every case is sealed, swept, tracked and diagnosed in a process of its own, killed after `--limit`; then lam of what it
hides is computed (parts/blind/lam.py). Its line is kept as soon as it is done and it is not run again: Ctrl-C or a kill
loses what is under way, and the same command goes on. The order is random and fixed, so that a run that was stopped is
a fair sample. An examination is of one version of the code, on seeds that nobody has run (parts/blind/records.py).
"""

import argparse
import json
import signal
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from types import FrameType
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from benchmarks.parts.alone import Ending
from benchmarks.parts.blind.case_run import run_case
from benchmarks.parts.blind.cases import (
    DESIGNS,
    DEVELOPMENT,
    EXTENTS,
    HEALTHY,
    OUTSIDERS,
    Case,
    Design,
    Extent,
    cases,
    modelled,
    shuffle,
)
from benchmarks.parts.blind.lam import template
from benchmarks.parts.blind.page import page, text
from benchmarks.parts.blind.records import (
    FOLDER,
    Attempt,
    Record,
    append_record,
    attempts,
    begin_attempt,
    choose_attempt,
    open_records,
    read_records,
    results_file,
    source_version,
    supersede_attempt,
)
from benchmarks.parts.blind.rigs.deviants import DEVIANTS
from benchmarks.parts.blind.score import KILLED, Score, score, summarise
from benchmarks.parts.case_arguments import add_workers
from benchmarks.parts.jobs import run_limited
from rotorrig.rig import ConfigError

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/blind.md"
LIMIT = 1800.0  # s a case: two sweeps, a diagnosis and lam take a minute or two
INTERRUPTED, TERMINATED = 130, 143  # exit statuses, as shells have them


def main() -> None:
    """Run what is asked for and not done yet, judge what is kept, print, and write the page if asked."""
    options = arguments()
    try:
        if options.supersede:
            supersede_attempt(options.supersede, options.results)
        if options.examine or options.summary:
            examine(options)
        elif not options.supersede:
            develop(options)
    except ConfigError as error:
        sys.exit(str(error))


def examine(options: argparse.Namespace) -> None:
    """Go on with the examination, unless only its summary is asked for, and say what it has found."""
    attempt = choose_attempt(options.results) if options.summary else begin_attempt(options.results)
    wanted = examination(attempt)
    if attempt and not options.summary:
        run_all(wanted, results_file(attempt, options.results), number=attempt.number, options=options)
    kept = read_records(results_file(attempt, options.results), version=attempt.version) if attempt else {}
    judged = judge(wanted, kept)
    summaries = {d: summarise(scores, wanted=sum(c.design == d for c in wanted)) for d, scores in judged.items()}
    if attempt and attempt.superseded:
        print(f"Attempt {attempt.number}, superseded: {attempt.superseded}\n")
    print(text(judged, summaries))
    if options.write:
        whole = page(judged, summaries, attempts=attempts(options.results), told=attempt)
        PAGE.write_text(whole, encoding="utf-8")
    if options.json:
        print(json.dumps(_report(attempt, summaries)))


def develop(options: argparse.Namespace) -> None:
    """Run development cases and say what became of them."""
    extent = Extent(**{name: getattr(options, name) for name in EXTENT})
    wanted = [c for design in options.design for c in cases(design, extent, hidden=options.hidden)]
    path = options.folder / "blind" / "development.jsonl"
    run_all(wanted, path, number=0, options=options)
    judged = judge(wanted, read_records(path, version=source_version()))
    summaries = {design: summarise(scores) for design, scores in judged.items()}
    print(text(judged, summaries))
    if options.json:
        print(json.dumps({"version": source_version(), **summaries}))


def examination(attempt: Attempt | None) -> list[Case]:
    """Return the cases of an attempt, in its order."""
    if attempt is None:
        return []
    wanted = [c for design, extent in EXTENTS.items() for c in cases(design, extent, first=attempt.first_seed)]
    return shuffle(wanted, attempt=attempt.number)


def run_all(wanted: Sequence[Case], path: Path, *, number: int, options: argparse.Namespace) -> None:
    """Run the cases that `path` has no line of, and keep a line of each; leave with a status if that is stopped."""
    version, folder = source_version(), options.folder / "blind"
    signal.signal(signal.SIGTERM, _terminated)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    try:
        with (
            open_records(path) as file,
            Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True)) as bars,
        ):
            kept = read_records(path, version=version)
            jobs = [(c, folder) for c in wanted if f"{c.design} {c.name}" not in kept]
            task = bars.add_task("blind cases", total=len(jobs))
            for design in dict.fromkeys(c.design for c, _ in jobs):
                template(design, folder)  # once, not by every worker

            def keep(job: tuple[Case, Path], parts: Record, ending: Ending) -> None:
                append_record(file, line(job[0], parts, ending, version=version, number=number))
                bars.update(task, advance=1, description=f"{job[0].design} {job[0].name}")

            run_limited(
                run_case, jobs, workers=options.workers, scheduler=options.scheduler, limit=options.limit, done=keep
            )
    except KeyboardInterrupt:
        _leave("stopped", INTERRUPTED)


def line(case: Case, parts: Record, ending: Ending, *, version: str, number: int) -> Record:
    """Return the line that is kept of a case; one that was ended before there was a verdict has that for a verdict."""
    missing = {} if "verdict" in parts else {"verdict": KILLED, "error": f"its process {ending}"}
    own = {"name": case.name, **{k: v for k, v in asdict(case).items() if k != "again"}}
    return {"attempt": number, "version": version, "ending": ending, **own, **parts, **missing}


def judge(wanted: Sequence[Case], kept: dict[str, Record]) -> dict[Design, list[Score]]:
    """Judge the cases that are kept, by design."""
    scores = [score(kept[key]) for c in wanted if (key := f"{c.design} {c.name}") in kept]
    return {design: [s for s in scores if s.case.design == design] for design in DESIGNS}


def _report(attempt: Attempt | None, summaries: dict[Design, dict[str, Any]]) -> dict[str, Any]:
    """Return the summary of the standing attempt for a program to read."""
    about = {"version": attempt.version if attempt else None, "attempt": attempt.number if attempt else None}
    each = {design: {**about, **summary} for design, summary in summaries.items()}
    return {**about, "cases": sum(summary["cases"] for summary in summaries.values()), **each}


def _terminated(number: int, frame: FrameType | None) -> None:
    """Leave as on Ctrl-C, with the status of SIGTERM; what stands in a `finally` ends the workers."""
    _leave("terminated", TERMINATED)


def _leave(why: str, status: int) -> None:
    print(f"{why}; what is done is kept, the same command goes on with the rest", file=sys.stderr)
    sys.exit(status)


EXTENT = {"seeds": 1, "healthy": 3, "outsiders": 4, "pairs": 2, "deviants": 5}


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--examine", action="store_true", help="go on with the examination, or begin it")
    parser.add_argument("--supersede", metavar="WHY", default="", help="end the attempt that stands; the next is new")
    parser.add_argument("--summary", action="store_true", help="judge the examination's cases that are kept; run none")
    parser.add_argument("--write", action="store_true", help="write docs/blind.md from them")
    parser.add_argument("--json", action="store_true", help="end with one JSON object on the last line")
    add_workers(parser)
    parser.add_argument("--limit", type=float, default=LIMIT, help="seconds after which a case is killed")
    for name, default in EXTENT.items():
        words = "cases per fault" if name == "seeds" else f"{name} per design"
        parser.add_argument(f"--{name}", type=int, default=default, help=f"development: {words} (default {default})")
    parser.add_argument("--design", nargs="+", choices=DESIGNS, default=list(DESIGNS), help="development: these")
    known = [*modelled(), *OUTSIDERS, *DEVIANTS, HEALTHY]
    parser.add_argument("--hidden", nargs="+", choices=known, default=[], metavar="WHAT", help="development: these")
    parser.add_argument("--folder", type=Path, default=ROOT / ".cache", help="development, and sweeps that are kept")
    parser.add_argument("--results", type=Path, default=FOLDER, help="where the examination's cases are kept")
    options = parser.parse_args()
    if options.workers < 1:
        parser.error(f"--workers is {options.workers}, want at least 1")
    for name in EXTENT:
        if not 0 <= getattr(options, name) <= DEVELOPMENT:
            parser.error(
                f"--{name} is {getattr(options, name)}, want 0 to {DEVELOPMENT}: other seeds are not to be seen"
            )
    if options.write and not (options.examine or options.summary):
        parser.error("--write is for --examine or --summary: development stands on no page")
    return options


if __name__ == "__main__":
    main()
