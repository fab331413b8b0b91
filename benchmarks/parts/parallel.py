"""Jobs in processes of their own: they end when the parent does, and one that dies is an error, no endless wait."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import TypeVar

from threadpoolctl import threadpool_limits

Job = TypeVar("Job")
Result = TypeVar("Result")


class WorkerDied(RuntimeError):
    """A process ended in the middle of a job: killed, out of memory, or crashed outside Python."""


def in_parallel(
    work: Callable[[Job], Result],
    jobs: Sequence[Job],
    *,
    workers: int,
    done: Callable[[Result], None] = lambda result: None,
) -> list[Result]:
    """Return `work(job)` for every job, in their order, telling `done` of each as it ends.

    Jobs begin in their order. Whatever interrupts it, an exception of a job too, ends the processes at once. Raises
    WorkerDied if one of them ended by itself.
    """
    others = multiprocessing.active_children()
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=spawn, initializer=begin_worker) as pool:
        try:
            futures = [pool.submit(work, job) for job in jobs]
            for future in as_completed(futures):
                done(future.result())
            return [future.result() for future in futures]
        except BaseException as error:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in set(multiprocessing.active_children()) - set(others):
                process.terminate()
            if isinstance(error, BrokenProcessPool):
                raise WorkerDied("a worker process died: killed, out of memory, or crashed") from error
            raise


def begin_worker() -> None:
    """Leave Ctrl-C to the parent, end with it, and use one BLAS thread."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    threadpool_limits(1)


def _end_with_parent() -> None:
    """Wait for the parent's end, however it comes, and leave without a word."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
