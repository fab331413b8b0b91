"""Processes to work on: of this machine, begun here and bound to 127.0.0.1, or those of a Dask scheduler elsewhere."""

import logging
import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any, TypeVar

import dask
from distributed import Client, Future, LocalCluster, as_completed

from rotorrig.rig import DataError

Job = TypeVar("Job")

TLS = "distributed.comm.tls"  # where Dask's config has its certificates
PATIENCE = "20 s"  # for a scheduler's answer
WAIT_FOR_WORKERS = 60.0  # s, of a scheduler that has none yet
LOOK_AGAIN = 5.0  # s between two looks at how many workers a scheduler has
KILLS = 1  # times a recording may lose its worker and be tried again
ONE_THREAD = dict.fromkeys(
    ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)  # read as numpy is loaded: set before a worker starts
TRIM = {"MALLOC_TRIM_THRESHOLD_": "65536"}  # Dask's own: memory that a recording took goes back to the system
#: of the local cluster; another's settings are its own. No web pages are served
LOCAL = {
    "distributed.scheduler.allowed-failures": KILLS,
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    "distributed.nanny.pre-spawn-environ": ONE_THREAD | TRIM,
    "distributed.worker.profile.enabled": False,  # else every second's call stacks are kept for an hour
    "distributed.worker.daemon": True,  # a worker ends with the process that began it
    "distributed.scheduler.active-memory-manager.start": False,  # nothing is kept in the workers
}


def cores() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def connect(*, workers: int | None = None, scheduler: str | None = None) -> Iterator[Client]:
    """Open a client of a scheduler's address, or of `workers` local processes of one thread each, by default the cores.

    However the block is left, the local processes end. Raises DataError if the scheduler does not answer or has no
    worker. TLS is as Dask's own config says (`TLS`), for an address that begins with tls://.
    """
    _silence()
    if scheduler:
        with _remote(scheduler) as client:
            yield client
        return
    with (
        dask.config.set(LOCAL),
        LocalCluster(
            n_workers=workers or cores(),
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


@contextmanager
def _remote(address: str) -> Iterator[Client]:
    try:
        client = Client(address, timeout=PATIENCE)
    except (OSError, ValueError, RuntimeError) as error:
        raise DataError(f"{address}: no scheduler answers, want one such as tcp://10.0.0.5:8786 ({error})") from error
    except TypeError as error:  # what Dask makes of a config without keys
        raise DataError(f"{address}: Dask's config has no certificate, want ca-file and client of {TLS}") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=WAIT_FOR_WORKERS)
        except TimeoutError as error:
            raise DataError(f"{address}: the scheduler has no worker, want at least one") from error
        yield client


def do_jobs(
    client: Client, work: Callable[[Job], Any], jobs: Sequence[Job], *, name: Callable[[Job], str]
) -> Iterator[tuple[Job, Future]]:
    """Yield every job with its future as it ends; `name` tells jobs apart.

    As many are under way as there are threads: a worker that is killed takes one with it, and no other is suspected.
    """
    waiting, running = list(reversed(jobs)), dict[str, Job]()
    done = as_completed([])
    threads, looked = 0, -LOOK_AGAIN
    while waiting or running:
        if time.monotonic() - looked > LOOK_AGAIN:
            threads, looked = max(threads, sum(client.nthreads().values())), time.monotonic()
        while waiting and len(running) < max(threads, 1):
            job = waiting.pop()
            future = client.submit(work, job, key=name(job), pure=False)
            running[str(future.key)] = job
            done.add(future)
        ended = next(done)
        yield running.pop(str(ended.key)), ended


def restart(client: Client, worker: str) -> None:
    """Begin a worker anew that has nothing under way; without a nanny, which could do so, it stays as it is."""
    with suppress(ValueError, TimeoutError):
        client.restart_workers([worker], timeout=30, raise_for_error=False)


def _silence() -> None:
    """Keep what Dask logs off the terminal: what matters comes as a row or as an error."""
    for name in ("distributed", "distributed.nanny", "distributed.scheduler", "distributed.worker", "tornado"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
