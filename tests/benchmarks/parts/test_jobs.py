"""Jobs in other processes end as they should: with results, with an error, or with their parent."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from benchmarks.parts.jobs import WorkerDied, in_parallel
from rotorrig.app.lab.cluster import connect

ROOT = Path(__file__).parents[3]
SLEEPING = """
from benchmarks.parts.jobs import in_parallel
from tests.benchmarks.parts.test_jobs import sleep_and_tell
if __name__ == "__main__":
    in_parallel(sleep_and_tell, [r"{folder}"], workers=1)
"""


def double(number: int) -> int:
    return 2 * number


def die_at_three(number: int) -> int:
    if number == 3:
        os._exit(9)  # as a crash in a compiled library, or the kernel for want of memory
    return number


def fail(number: int) -> int:
    raise ValueError(f"job {number}")


def sleep_and_tell(folder: str) -> None:
    (Path(folder) / "part").write_text(str(os.getpid()))
    (Path(folder) / "part").rename(Path(folder) / "pid")
    time.sleep(60)


def test_results_come_in_the_order_of_the_jobs() -> None:
    told: list[int] = []
    assert in_parallel(double, [1, 2, 3], workers=2, done=told.append) == [2, 4, 6]
    assert sorted(told) == [2, 4, 6]


def test_the_workers_may_be_those_of_a_scheduler() -> None:
    with connect(workers=1) as client:
        address = client.cluster.scheduler_address
        assert in_parallel(double, [1, 2], scheduler=address) == [2, 4]


def test_a_worker_that_dies_is_an_error_and_no_wait() -> None:
    with pytest.raises(WorkerDied, match="died"):
        in_parallel(die_at_three, [1, 2, 3, 4], workers=1)


def test_an_exception_of_a_job_is_passed_on() -> None:
    with pytest.raises(ValueError, match="job 7"):
        in_parallel(fail, [7], workers=1)


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_workers_end_with_their_parent(tmp_path: Path, how: signal.Signals) -> None:
    script = tmp_path / "parent.py"
    script.write_text(SLEEPING.format(folder=tmp_path))
    parent = subprocess.Popen(
        [sys.executable, str(script)], env={**os.environ, "PYTHONPATH": str(ROOT)}, stderr=subprocess.DEVNULL
    )
    assert waited_for(lambda: (tmp_path / "pid").exists())
    worker = int((tmp_path / "pid").read_text())
    parent.send_signal(how)
    parent.wait(timeout=10)
    assert waited_for(lambda: not is_alive(worker))


def waited_for(what: Callable[[], bool], seconds: float = 20.0) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if what():
            return True
        time.sleep(0.05)
    return False


def is_alive(pid: int) -> bool:
    """Say whether a process runs; one that has ended and waits for its parent does not."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"
