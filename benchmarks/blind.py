"""The blind benchmark: faults hidden in simulated rigs, and how often the diagnosis finds and names them.

    python benchmarks/blind.py --seeds 1 --effects bow runout                              (a look)
    python benchmarks/blind.py --write                                   (all; docs/blind.md; `make blind`)
    python benchmarks/blind.py --summary --json      (of the cases that are done; JSON on the last line)

Every case is sealed, swept, tracked and diagnosed on its own, and leaves in the folder what was measured (kept until
the plant changes), the sealed truth, written before the sweep, and the diagnosis; then lam of what it hides is computed
(parts/blind/lam.py). Faults and healthy rigs take turns, so that a run that was stopped has as large a part of each.
What is there is not run again, but for what ended in an error, and Ctrl-C or SIGTERM loses only what is under way.
Judging is done afterwards, from the files alone.
"""

import argparse
import json
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path
from types import FrameType
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from benchmarks.parts.blind.cases import DESIGNS, HEALTHY, Case, Design, cases, files, modelled, outsiders, write_whole
from benchmarks.parts.blind.lam import asked, compute, lam_of, template
from benchmarks.parts.blind.measured import measured
from benchmarks.parts.blind.page import page, text
from benchmarks.parts.blind.score import FAILED, Score, score, summarise
from benchmarks.parts.parallel import WorkerDied, in_parallel
from rotorrig.identify import diagnose, write_diagnosis
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import code_version
from rotorrig.sims.plant import unseal

ROOT = Path(__file__).parents[1]
ARRAYS = ("residual", "sigmas", "extended_residual")  # of diagnosis.json; not kept
Job = tuple[Case, Path]
INTERRUPTED, TERMINATED = 130, 143  # exit statuses, as shells have them


def main() -> None:
    """Run what is not done yet, judge what is done, print, and write the page if asked."""
    options = arguments()
    folder = options.folder / "blind"
    wanted = {design: chosen(design, options) for design in options.design}
    if not options.summary:
        run_all([case for listed in wanted.values() for case in listed], folder, workers=options.workers)
    judged = {design: [judge(c, folder) for c in listed if is_done(c, folder)] for design, listed in wanted.items()}
    summaries = {design: summarise(scores, wanted=len(wanted[design])) for design, scores in judged.items()}
    print(text(judged, summaries))
    if options.write:
        made_by = versions(judged, folder)
        (ROOT / "docs/blind.md").write_text(page(judged, summaries, versions=made_by), encoding="utf-8")
    if options.json:
        print(json.dumps(summaries))


def chosen(design: Design, options: argparse.Namespace) -> list[Case]:
    """Return the cases of a design that the command line asks for."""
    return list(
        cases(design, seeds=options.seeds, healthy=options.healthy, pairs=options.pairs, effects=options.effects)
    )


def run_all(wanted: Iterable[Case], folder: Path, *, workers: int) -> None:
    """Run the cases, and lam of each, that are not done well; say so if that is stopped, and leave with its status."""
    jobs = [(case, folder) for case in in_turns(wanted) if not (is_good(case, folder) and has_lam(case, folder))]
    if not jobs:
        return
    signal.signal(signal.SIGTERM, _terminated)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    try:
        for design in dict.fromkeys(case.design for case, _ in jobs):
            template(design, folder)  # once, not by every worker
        with Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True)) as bars:
            task = bars.add_task("blind cases", total=len(jobs))
            in_parallel(
                complete, jobs, workers=workers, done=lambda name: bars.update(task, advance=1, description=name)
            )
    except KeyboardInterrupt:
        _leave("stopped", INTERRUPTED)
    except WorkerDied as error:
        _leave(str(error), 1)


def in_turns(wanted: Iterable[Case]) -> list[Case]:
    """Return the cases of every fault and design spread evenly over the whole, those of the smallest seeds first."""
    groups: dict[tuple[str, ...], list[Case]] = {}
    for case in wanted:
        hidden = case.faults if case.kind != "pair" else ("two",)
        groups.setdefault((case.design, case.kind, *hidden), []).append(case)
    placed = [((i + 0.5) / len(group), case) for group in groups.values() for i, case in enumerate(group)]
    return [case for _, case in sorted(placed, key=lambda each: each[0])]


def complete(job: Job) -> str:
    """Run one case and compute its lam, as far as they are not there, and return its name."""
    if not is_good(*job):
        run(job)
    if not has_lam(*job):
        compute(job)
    case, _ = job
    return f"{case.design} {case.name}"


def run(job: Job) -> None:
    """Run one case; whatever goes wrong is written down as its result."""
    case, folder = job
    path, sealed = files(case, folder)
    began = swept = time.perf_counter()
    with tempfile.TemporaryDirectory() as scratch:
        try:
            responses = measured(case, folder, sealed=sealed)
            swept = time.perf_counter()
            found = diagnosed(responses, Path(scratch) / "diagnosis.json")
        except Exception:  # a case that crashes counts against the diagnosis and must not end a night's run
            found = {"verdict": FAILED, "error": traceback.format_exc()}
    seconds = {"measure": swept - began, "diagnose": time.perf_counter() - swept}
    write_whole(path, {"code_version": code_version(), "seconds": seconds, "diagnosis": found})


def diagnosed(responses: Sequence[OrderTrackedResponse], out: Path, *, without: Collection[str] = ()) -> dict[str, Any]:
    """Diagnose from the responses and their nameplate alone; write diagnosis.json and return it without its arrays.

    Effects in `without` are left out of the library.
    """
    write_diagnosis(out, diagnose(responses, without=without))
    table = json.loads(out.read_text(encoding="utf-8"))
    return {key: value for key, value in table.items() if key not in ARRAYS}


def judge(case: Case, folder: Path) -> Score:
    """Open the sealed truth of a case that is done and judge its diagnosis."""
    path, sealed = files(case, folder)
    done = json.loads(path.read_text(encoding="utf-8"))
    found = done["diagnosis"]
    if found["verdict"] == FAILED:
        return Score(case=case, verdict=FAILED, lam=lam_of(case, folder), error=found["error"])
    return score(case, found, unseal(sealed), seconds=done["seconds"]["diagnose"], lam=lam_of(case, folder))


def is_done(case: Case, folder: Path) -> bool:
    """Return whether a case has been diagnosed."""
    return files(case, folder)[0].exists()


def is_good(case: Case, folder: Path) -> bool:
    """Return whether that did not end in an error."""
    path = files(case, folder)[0]
    return path.exists() and json.loads(path.read_text(encoding="utf-8"))["diagnosis"]["verdict"] != FAILED


def has_lam(case: Case, folder: Path) -> bool:
    """Return whether lam of a case has been computed, or is not asked for."""
    return not asked(case) or lam_of(case, folder) is not None


def versions(judged: dict[Design, list[Score]], folder: Path) -> list[str]:
    """Return the versions of the code that the cases were run with: more than one if the run was taken up again."""
    paths = [files(s.case, folder)[0] for scores in judged.values() for s in scores]
    return sorted({json.loads(path.read_text(encoding="utf-8"))["code_version"] for path in paths})


def _terminated(number: int, frame: FrameType | None) -> None:
    """Leave as on Ctrl-C, with the status of SIGTERM; what stands in a `finally` ends the workers."""
    _leave("terminated", TERMINATED)


def _leave(why: str, status: int) -> None:
    print(f"{why}; what is done is kept, the same command goes on with the rest", file=sys.stderr)
    sys.exit(status)


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=10, help="cases per fault (default 10)")
    parser.add_argument("--healthy", type=int, default=200, help="healthy rigs per design (default 200)")
    parser.add_argument("--pairs", type=int, default=40, help="rigs with two faults, per design (default 40)")
    parser.add_argument("--design", nargs="+", choices=DESIGNS, default=list(DESIGNS))
    known = [*modelled(), *outsiders(), HEALTHY]
    parser.add_argument("--effects", nargs="+", choices=known, default=[], metavar="FAULT", help="these alone")
    parser.add_argument("--workers", type=int, default=2, help="processes (default 2)")
    parser.add_argument("--folder", type=Path, default=ROOT / ".cache", help="where cases are kept (default .cache)")
    parser.add_argument("--summary", action="store_true", help="judge the cases that are done; run none")
    parser.add_argument("--json", action="store_true", help="end with one JSON object on the last line")
    parser.add_argument("--write", action="store_true", help="write docs/blind.md")
    options = parser.parse_args()
    for name, least in (("seeds", 0), ("healthy", 0), ("pairs", 0), ("workers", 1)):
        if getattr(options, name) < least:
            parser.error(f"--{name} is {getattr(options, name)}, want at least {least}")
    return options


if __name__ == "__main__":
    main()
