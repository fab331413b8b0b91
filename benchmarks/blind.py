"""The blind benchmark: faults hidden in simulated rigs, and how often the diagnosis finds and names them.

    python benchmarks/blind.py --seeds 1 --healthy 2 --pairs 0 --effects bow runout        (a look)
    python benchmarks/blind.py --write                                   (all; docs/blind.md; `make blind`)
    python benchmarks/blind.py --summary --json      (of the cases that are done; JSON on the last line)

Every case is sealed, swept, tracked and diagnosed on its own, and leaves in the folder what was measured (kept until
the plant changes), the sealed truth, written before the sweep, and the diagnosis. Then lam of every case of one fault
is computed (blind_lam.py). What is there is not run again, but for cases that ended in an error, and Ctrl-C loses only
what is under way. Judging is done afterwards, from the files alone.
"""

import argparse
import json
import multiprocessing
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from threadpoolctl import threadpool_limits

from benchmarks.blind_cases import (
    DESIGNS,
    HEALTHY,
    Case,
    Design,
    cases,
    files,
    modelled,
    outsiders,
    write_whole,
)
from benchmarks.blind_lam import compute, lam_file, lam_of, template
from benchmarks.blind_measured import measured
from benchmarks.blind_page import page, text
from benchmarks.blind_score import FAILED, Score, score, summarise
from rotorrig.identify.diagnosis import diagnose
from rotorrig.identify.result_files import write_diagnosis
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.provenance import code_version
from rotorrig.sims.plant.truth import unseal

ROOT = Path(__file__).parents[1]
ARRAYS = ("residual", "sigmas", "extended_residual")  # of diagnosis.json; not kept
Job = tuple[Case, Path]


def main() -> None:
    """Run what is not done yet, judge what is done, print, and write the page if asked."""
    options = arguments()
    folder = options.folder / "blind"
    wanted = {design: chosen(design, options) for design in options.design}
    if not options.summary:
        run_all([case for listed in wanted.values() for case in listed], folder, workers=options.workers)
    judged = {design: [judge(c, folder) for c in listed if is_done(c, folder)] for design, listed in wanted.items()}
    summaries = {design: summarise(scores) for design, scores in judged.items()}
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


def run_all(wanted: Sequence[Case], folder: Path, *, workers: int) -> None:
    """Run the cases that are not done well, then lam of those without; on Ctrl-C say so and leave with status 130."""
    try:
        _in_parallel("blind cases", run, [(c, folder) for c in wanted if not is_good(c, folder)], workers=workers)
        single = [c for c in wanted if c.kind == "single" and not lam_file(c, folder).exists()]
        for design in dict.fromkeys(case.design for case in single):
            template(design, folder)  # once, not by every worker
        _in_parallel("lam", compute, [(c, folder) for c in single], workers=workers)
    except KeyboardInterrupt:
        print("stopped; what is done is kept, the same command goes on with the rest", file=sys.stderr)
        sys.exit(130)


def _in_parallel(title: str, work: Callable[[Job], str], jobs: Sequence[Job], *, workers: int) -> None:
    """Do the jobs in processes of their own, with a progress bar."""
    if not jobs:
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with (
        multiprocessing.get_context("spawn").Pool(workers, initializer=_quiet) as pool,
        Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True)) as bars,
    ):
        task = bars.add_task(title, total=len(jobs))
        for name in pool.imap_unordered(work, jobs):
            bars.update(task, advance=1, description=f"{title}: {name}")


def run(job: Job) -> str:
    """Run one case and return its name; whatever goes wrong is written down as its result."""
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
    return f"{case.design} {case.name}"


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


def versions(judged: dict[Design, list[Score]], folder: Path) -> list[str]:
    """Return the versions of the code that the cases were run with: more than one if the run was taken up again."""
    paths = [files(s.case, folder)[0] for scores in judged.values() for s in scores]
    return sorted({json.loads(path.read_text(encoding="utf-8"))["code_version"] for path in paths})


def _quiet() -> None:
    """Leave Ctrl-C to the parent, and use one BLAS thread."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threadpool_limits(1)


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
