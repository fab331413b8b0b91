"""Kernels that numba compiles: for numbers that are the same to the last bit they have to come from its cache.

Where a kernel was compiled in a process, its callers find another copy of what it calls than where all were loaded, and
with sums that may be reordered that changes the last digits of a fit (by 1e-10, measured). So a process that has
compiled hands its recordings to a new one, which finds every kernel in the cache.
"""

import os
import pickle
import subprocess
import sys
import threading
from typing import Any

from numba.core import event

_compilations = event.RecordingListener()
event.register("numba:compile", _compilations)  # from here on: kernels that are loaded from the cache do not count


def has_compiled() -> bool:
    """Return whether this process has compiled a kernel."""
    return bool(_compilations.buffer)


def do_in_new_process(module: str, job: Any) -> bool:
    """Run `module` as a program on `job`, and return whether it ended well; it ends with this process."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    with subprocess.Popen([sys.executable, "-m", module], stdin=subprocess.PIPE, env=environment) as process:
        assert process.stdin is not None
        try:
            pickle.dump(job, process.stdin)
            process.stdin.flush()
            return process.wait() == 0
        except BrokenPipeError:
            return False
        finally:
            process.kill()  # of no effect on one that has ended


def receive_job() -> Any:
    """Return the job that `do_in_new_process` sent to this process, which from then on ends when the other does."""
    job = pickle.load(sys.stdin.buffer)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    return job


def _end_with_parent() -> None:
    while os.read(sys.stdin.fileno(), 1):  # nothing comes, until the other end is closed
        pass
    os._exit(1)
