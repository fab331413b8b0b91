"""The jobs of a benchmark on the lab's engine: Dask workers of this machine, or of a scheduler elsewhere."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from typing import Any, TypeVar

from distributed import Client, KilledWorker

from benchmarks.parts.alone import Ending, Part, pack, run_alone
from rotorrig.app.lab.cluster import connect, do_jobs
from rotorrig.rig import DataError

Job = TypeVar("Job")
Result = TypeVar("Result")


class WorkerDied(RuntimeError):
    """A process ended in the middle of a job: killed, out of memory, or crashed outside Python."""


def run_limited(
    work: Callable[[Job], Iterator[Part]],
    jobs: Sequence[Job],
    *,
    limit: float,
    done: Callable[[Job, Part, Ending], None],
    workers: int | None = None,
    scheduler: str | None = None,
) -> None:
    """Run `work(job)` for every job, begun in their order, and tell `done` what each yielded, put together.

    Each has a process of its own beside a worker, and is killed after `limit` seconds (alone.py); all are when this is
    interrupted. Leaves with a sentence if the scheduler does not answer.
    """
    if not jobs:
        return
    numbered = [(number, pack(work, job)) for number, job in enumerate(jobs)]
    run = partial(_run_numbered, limit=limit)
    with _connected(workers, scheduler) as client:
        for (number, _), future in do_jobs(client, run, numbered, name=lambda each: f"job-{each[0]}"):
            try:
                parts, ending = future.result()
            except KilledWorker:
                parts, ending = {}, "died"
            done(jobs[number], parts, ending)


def in_parallel(
    work: Callable[[Job], Result],
    jobs: Sequence[Job],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    done: Callable[[Result], None] = lambda result: None,
) -> list[Result]:
    """Return `work(job)` for every job, in their order, telling `done` of each as it ends.

    Jobs begin in their order, in the workers themselves. Whatever interrupts it, an exception of a job too, ends them.
    Raises WorkerDied if one of them ended by itself; leaves with a sentence if the scheduler does not answer.
    """
    results: dict[int, Result] = {}
    if not jobs:
        return []
    with _connected(workers, scheduler) as client:
        numbered = list(enumerate(jobs))
        for (number, _), future in do_jobs(client, _Plain(work), numbered, name=lambda each: f"job-{each[0]}"):
            try:
                results[number] = future.result()
            except KilledWorker as error:
                raise WorkerDied("a worker process died: killed, out of memory, or crashed") from error
            done(results[number])
    return [results[number] for number in range(len(jobs))]


@contextmanager
def _connected(workers: int | None, scheduler: str | None) -> Iterator[Client]:
    with ExitStack() as stack:
        try:
            client = stack.enter_context(connect(workers=workers, scheduler=scheduler))
        except DataError as error:
            sys.exit(str(error))
        yield client


def _run_numbered(job: tuple[int, bytes], *, limit: float) -> tuple[Part, Ending]:
    return run_alone(job[1], limit=limit)


class _Plain:
    """Work on a job that has a number."""

    def __init__(self, work: Callable[[Any], Any]) -> None:
        self.work = work

    def __call__(self, job: tuple[int, Any]) -> Any:
        return self.work(job[1])
