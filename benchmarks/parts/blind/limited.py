"""Jobs each in a process of its own, with a limit of time: one that hangs or crashes costs its own result alone.

A job yields what it has as it goes, and what it had yielded when it was killed is kept.
"""

import multiprocessing
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Any, Generic, Literal, TypeVar

from benchmarks.parts.parallel import begin_worker

Job = TypeVar("Job")
Ending = Literal["ended", "killed", "died"]  # by itself, at the limit, of a signal or outside Python
Part = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Running(Generic[Job]):
    job: Job
    process: SpawnProcess
    pipe: Connection
    until: float  # s of the monotonic clock
    parts: Part


def run_limited(
    work: Callable[[Job], Iterator[Part]],
    jobs: Sequence[Job],
    *,
    workers: int,
    limit: float,
    done: Callable[[Job, Part, Ending], None],
) -> None:
    """Run `work(job)` for every job, begun in their order, and tell `done` what each yielded, put together.

    A process is killed after `limit` seconds, and all are when this is interrupted. An exception in a job ends its
    process, so that it has "died".
    """
    waiting = list(jobs)[::-1]
    running: dict[Connection, _Running[Job]] = {}
    try:
        while waiting or running:
            while waiting and len(running) < workers:
                started = _start(work, waiting.pop(), limit)
                running[started.pipe] = started
            soonest = min(each.until for each in running.values())
            ready = wait(list(running), timeout=max(soonest - time.monotonic(), 0.0))
            for pipe in list(running):
                ending = _receive(running[pipe]) if pipe in ready else None
                if ending is None and time.monotonic() >= running[pipe].until:
                    ending = "killed"
                if ending is not None:
                    ended = running.pop(pipe)
                    _stop(ended)
                    done(ended.job, ended.parts, ending)
    finally:
        for each in running.values():
            _stop(each)


def _start(work: Callable[[Job], Iterator[Part]], job: Job, limit: float) -> _Running[Job]:
    spawn = multiprocessing.get_context("spawn")
    ours, theirs = spawn.Pipe(duplex=False)
    process = spawn.Process(target=_work, args=(work, job, theirs), daemon=True)
    process.start()
    theirs.close()
    return _Running(job=job, process=process, pipe=ours, until=time.monotonic() + limit, parts={})


def _receive(running: _Running[Job]) -> Ending | None:
    """Take what a process has sent; return how it ended if it did."""
    try:
        part = running.pipe.recv()
    except EOFError:
        return "died"
    if part is None:
        return "ended"
    running.parts.update(part)
    return None


def _stop(running: _Running[Job]) -> None:
    running.process.kill()
    running.process.join()
    running.pipe.close()


def _work(work: Callable[[Job], Iterator[Part]], job: Job, pipe: Connection) -> None:
    begin_worker()
    for part in work(job):
        pipe.send(part)
    pipe.send(None)
