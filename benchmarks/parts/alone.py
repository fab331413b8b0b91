"""A job in a process of its own, with a limit of time: one that hangs or crashes costs its own result and no other.

A job yields what it has as it goes, and what it had yielded when it ended, however it ended, is kept. The process ends
with the one that began it.
"""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from multiprocessing.connection import Connection, Pipe
from typing import Any, Literal

import cloudpickle
from threadpoolctl import threadpool_limits

Ending = Literal["ended", "killed", "died"]  # by itself, at the limit, of a signal or outside Python
Part = dict[str, Any]
Work = Callable[[Any], Iterator[Part]]

CHILD = "import sys; from benchmarks.parts.alone import serve; serve(int(sys.argv[1]))"


def pack(work: Work, job: Any) -> bytes:
    """Return work and its job as a process elsewhere can read them, functions of a script among them."""
    packed: bytes = cloudpickle.dumps((work, job))
    return packed


def run_alone(packed: bytes, *, limit: float) -> tuple[Part, Ending]:
    """Run what `pack` returned; return what it yielded, put together, and how it ended.

    The process is killed after `limit` seconds. An exception in the job ends it, so that it has "died".
    """
    ours, theirs = Pipe()
    path = os.pathsep.join(filter(None, sys.path))
    with closing(ours):
        with closing(theirs):
            process = subprocess.Popen(
                [sys.executable, "-c", CHILD, str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                env=os.environ | {"PYTHONPATH": path},
            )
        try:
            return _talk(ours, packed, until=time.monotonic() + limit)
        finally:
            process.kill()
            process.wait()


def _talk(pipe: Connection, packed: bytes, *, until: float) -> tuple[Part, Ending]:
    parts: Part = {}
    try:
        pipe.send_bytes(packed)
        while pipe.poll(max(until - time.monotonic(), 0.0)):
            part = pipe.recv()
            if part is None:
                return parts, "ended"
            parts.update(part)
    except (EOFError, OSError):
        return parts, "died"
    return parts, "killed"


def serve(handle: int) -> None:
    """Do the job that comes through a pipe, one BLAS thread to it, and send back what it yields."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's
    pipe = Connection(handle)
    work, job = cloudpickle.loads(pipe.recv_bytes())
    threading.Thread(target=_end_with_parent, args=(pipe,), daemon=True).start()
    with threadpool_limits(1):
        for part in work(job):
            pipe.send(part)
    pipe.send(None)


def _end_with_parent(pipe: Connection) -> None:
    """Wait for the other end of the pipe to close, and leave without a word."""
    try:
        pipe.recv_bytes()
    except (EOFError, OSError):
        os._exit(1)
