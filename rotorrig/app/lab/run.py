"""A lab at work: which recordings there are, which are done, and the rest on many processes, with a progress bar.

Nothing is kept but what the workers write: a computation is done when its part-file of `runs` stands. So Ctrl-C, kill
-9 and a power cut cost what is under way, and the same command goes on.
"""

import time
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from distributed import Client, Future, KilledWorker
from distributed.comm import CommClosedError

from rotorrig.app.lab.cluster import KILLS, connect, do_jobs, restart
from rotorrig.app.lab.settings import LabSettings
from rotorrig.app.lab.steps import Job, Outcome, find_jobs
from rotorrig.app.lab.storage import read_all
from rotorrig.app.lab.task import STATUS, work_through, write_outcome
from rotorrig.app.terminal import progress_bars
from rotorrig.rig import DataError

Status = dict[str, Any]  # run_id, key, file, status, step, sentence


@dataclass(slots=True, kw_only=True)
class LabSummary:
    """What a run of a lab came to."""

    recordings: int = 0
    before: int = 0  # that were worked through already, done or failed
    done: int = 0  # in this run
    failed: list[Status] = field(default_factory=list)  # in this run or before, in the order of the files
    interrupted: bool = False
    seconds: float = 0.0

    @property
    def left(self) -> int:
        """How many are still to be worked through."""
        return self.recordings - self.before - self.done - sum(not row["before"] for row in self.failed)

    def lines(self) -> list[str]:
        """Return for a person what was done, what failed first, and what is left."""
        number = self.recordings
        line = f"{number} recording{'s' * (number != 1)}: {self.done} done in {self.seconds:.0f} s"
        if good := self.before - sum(row["before"] for row in self.failed):
            line += f", {good} done before"
        lines = [line + (f", {len(self.failed)} failed" if self.failed else "")]
        if self.failed:
            first = self.failed[0]
            said = first["sentence"] if first["file"] in first["sentence"] else f"{first['file']}: {first['sentence']}"
            lines.append(f"first of those that failed: {said}")
        if self.interrupted:
            lines.append(f"interrupted with {self.left} left; the same command goes on")
        return lines

    def facts(self) -> dict[str, Any]:
        """Return the same as plain values, with every failure."""
        return {
            "recordings": self.recordings,
            "done": self.done,
            "before": self.before,
            "failed": [{name: row[name] for name in ("file", "step", "sentence")} for row in self.failed],
            "left": self.left,
            "interrupted": self.interrupted,
            "seconds": self.seconds,
        }


def run_lab(
    folder: Path,
    settings: LabSettings,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    retry: bool = False,
) -> LabSummary:
    """Work through every recording of a folder that is not done, on local processes or those of a `scheduler`.

    With `retry` those that failed before are tried again. Ctrl-C ends it, which the summary then says. Raises DataError
    if the folder cannot be read or written, ConfigError if a worker runs another version of the program.
    """
    began = time.perf_counter()
    summary = LabSummary()
    try:
        jobs = _jobs_left(_look(folder, settings), summary, retry=retry)
        if jobs:
            _work(jobs, summary, workers=workers, scheduler=scheduler)
    except KeyboardInterrupt:
        summary.interrupted = True
    summary.failed.sort(key=lambda row: str(row["file"]))
    summary.seconds = time.perf_counter() - began
    return summary


def _look(folder: Path, settings: LabSettings) -> list[Job]:
    with progress_bars() as bars:
        task = bars.add_task("looking for recordings", total=None, note="")

        def show(done: int, of: int) -> None:
            bars.update(task, completed=done, total=of)

        jobs = find_jobs(folder, settings, progress=show)
    if not jobs:
        raise DataError(f"{folder}: holds no recording, want run.mcap or response.mcap files in it or below it")
    return jobs


def _jobs_left(jobs: Sequence[Job], summary: LabSummary, *, retry: bool) -> list[Job]:
    """Return the jobs that are not done, and note those that are in the summary; one whose file was moved is not."""
    rows = read_all(jobs[0].lab, "runs").select(STATUS).to_pylist()
    made = {(row["key"], row["file"]): row for row in rows}
    summary.recordings = len(jobs)
    left = []
    for job in jobs:
        row = made.get((job.key, job.recording.file))
        if retry and row and row["status"] == "failed":
            job.lab.part("runs", job.recording.run_id, job.key).unlink(missing_ok=True)
            row = None
        if row is None:
            left.append(job)
            continue
        summary.before += 1
        if row["status"] == "failed":
            summary.failed.append({**row, "before": True})
    return left


def _work(jobs: Sequence[Job], summary: LabSummary, *, workers: int | None, scheduler: str | None) -> None:
    with progress_bars() as bars, connect(workers=workers, scheduler=scheduler) as client:
        task = bars.add_task("working", total=len(jobs), note="", unit="recordings/min", scale=60.0)
        for status in statuses(client, jobs):
            if status["status"] == "failed":
                summary.failed.append({**status, "before": False})
            else:
                summary.done += 1
            failed = len(summary.failed)
            bars.update(task, advance=1, note=f"{failed} failed" if failed else "")


def statuses(client: Client, jobs: Sequence[Job]) -> Iterator[Status]:
    """Yield the status of every job as it ends. Raises DataError if the scheduler is gone."""
    for job, future in do_jobs(client, work_through, jobs, name=lambda job: f"lab-{job.recording.run_id}-{job.key}"):
        status = _status(job, future)
        if worker := status.pop("to_restart", ""):  # it has compiled kernels, and would hand on all it gets
            restart(client, worker)
        yield status


def _status(job: Job, future: Future) -> Status:
    try:
        status: Status = future.result()
    except KilledWorker:
        sentence = (
            f"it ended {KILLS + 1} workers one after the other (out of memory, killed, or crashed outside Python); "
            "run it by itself with rotor track to see why"
        )
        status = write_outcome(job, Outcome(sentence=sentence))
    except (CancelledError, CommClosedError) as error:
        raise DataError("the scheduler is gone; start it, and the same command goes on") from error
    return status
