"""Worker processes: in order, side by side, and gone afterwards, whatever happens to them."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import psutil
import pytest

from rotorrig.identify.chea.calls.workers import Workers

POINTS = np.arange(12.0)[:, None]

#: A search whose objective takes a minute from the 31st call on; says so on the way.
SLOW = """
import os, sys, time
from rotorrig.identify.chea import chea

def fun(x):
    if os.path.exists(sys.argv[1]):
        time.sleep(60)
    return (x ** 2).sum()

def shown(intermediate_result):
    open(sys.argv[1], "w").close()

if __name__ == "__main__":
    print("begun", flush=True)
    result = chea(fun, [(-1, 1)] * 2, rng=0, workers=2, callback=shown)
    print(result.stop_reason, result.nfev, result.fun < 1, flush=True)
"""


def same(x: np.ndarray) -> float:
    return float(x[0])


def last_first(x: np.ndarray) -> float:
    time.sleep(0.02 * (3 - x[0] % 4))
    return float(x[0])


def pid(x: np.ndarray) -> int:
    time.sleep(0.01)
    return os.getpid()


def crash_at_five(x: np.ndarray) -> float:
    if x[0] == 5:
        os.kill(os.getpid(), signal.SIGKILL)
    return float(x[0])


def leave(x: np.ndarray) -> float:
    raise SystemExit(3)


def sleep(x: np.ndarray) -> float:
    time.sleep(60 if x[0] else 0)
    return 0.0


def no_number(x: np.ndarray) -> object:
    return (y for y in x)  # nor could it be sent back


class Unreadable:
    """Can be pickled, but not read again."""

    def __call__(self, x: np.ndarray) -> float:
        return 0.0

    def __reduce__(self) -> tuple:
        return int, ("no function",)


@pytest.fixture
def before() -> set[int | None]:
    """Processes that other tests have running beside these, as a lab's cluster."""
    return {child.pid for child in multiprocessing.active_children()}


def own_children(before: set[int | None]) -> list[int | None]:
    return [child.pid for child in multiprocessing.active_children() if child.pid not in before]


@pytest.fixture
def workers(request: pytest.FixtureRequest, before: set[int | None]) -> Iterator[Workers]:
    workers = Workers(request.param, 3)
    yield workers
    workers.close()
    assert own_children(before) == []


@pytest.mark.parametrize("workers", [same, last_first], indirect=True)
def test_outcomes_come_in_order_and_batch_after_batch(workers: Workers) -> None:
    for points in (POINTS, POINTS[:1], POINTS[:0], POINTS):
        assert [outcome.values.item() for outcome in workers.map(points)] == points[:, 0].tolist()


@pytest.mark.parametrize("workers", [pid], indirect=True)
def test_as_many_processes_as_asked_for_do_the_work_and_stay(workers: Workers) -> None:
    pids = [{int(outcome.values.item()) for outcome in workers.map(POINTS)} for _ in range(2)]
    assert len(pids[0]) == 3
    assert pids[1] == pids[0]
    assert os.getpid() not in pids[0]


@pytest.mark.parametrize("workers", [pid], indirect=True)
def test_no_more_processes_are_started_than_there_are_points(workers: Workers, before: set[int | None]) -> None:
    list(workers.map(POINTS[:1]))
    assert len(own_children(before)) == 1


@pytest.mark.parametrize("workers", [crash_at_five], indirect=True)
def test_a_crash_fails_its_point_and_the_process_is_replaced(workers: Workers) -> None:
    for _ in range(2):
        outcomes = list(workers.map(POINTS))
        assert [i for i, outcome in enumerate(outcomes) if np.isnan(outcome.values)] == [5]
        assert outcomes[5].failure == "its worker process ended with exit code -9"
        assert outcomes[6].values == 6


@pytest.mark.parametrize("workers", [leave], indirect=True)
def test_a_function_that_always_leaves_fails_at_every_point(workers: Workers) -> None:
    outcomes = list(workers.map(POINTS))
    assert {outcome.failure for outcome in outcomes} == {"its worker process ended with exit code 3"}


@pytest.mark.parametrize("workers", [no_number], indirect=True)
def test_what_is_no_number_is_refused_as_without_workers(workers: Workers) -> None:
    with pytest.raises(TypeError, match=r"fun returned object of shape \(\), expected 1 real number$"):
        list(workers.map(POINTS))


@pytest.mark.parametrize("workers", [Unreadable()], indirect=True)
def test_a_function_the_process_cannot_read_is_refused(workers: Workers) -> None:
    with pytest.raises(TypeError, match="fun cannot be read by a worker process"):
        list(workers.map(POINTS))


@pytest.mark.parametrize("workers", [sleep], indirect=True)
def test_calls_nobody_waits_for_are_ended_at_once(workers: Workers, before: set[int | None]) -> None:
    began = time.monotonic()
    assert next(workers.map(POINTS)).values == 0
    workers.close()
    assert time.monotonic() - began < 5
    assert own_children(before) == []


def test_ctrl_c_during_long_calls_keeps_the_best_and_leaves_no_process(tmp_path: Path) -> None:
    with started(tmp_path, SLOW) as process:
        children = wait_until_busy(tmp_path, process)
        os.killpg(process.pid, signal.SIGINT)  # as the terminal does: to all of them
        out, err = process.communicate(timeout=20)
        reason, nfev, found = out.split()
        assert (reason, found) == ("interrupted", "True")
        assert int(nfev) > 10
        assert err == ""
        assert psutil.wait_procs(children, timeout=5)[1] == []


def test_workers_end_with_their_parent_even_if_it_is_killed(tmp_path: Path) -> None:
    script = SLOW.replace("time.sleep(60)", "time.sleep(0.5)")
    with started(tmp_path, script) as process:
        children = wait_until_busy(tmp_path, process)
        process.kill()
        assert psutil.wait_procs(children, timeout=10)[1] == []


def test_a_script_without_its_guard_is_told_so_where_processes_begin_afresh(tmp_path: Path) -> None:
    script = """
import multiprocessing
multiprocessing.set_start_method("spawn", force=True)
from scipy.optimize import rosen
from rotorrig.identify.chea import chea
chea(rosen, [(-1, 1)] * 2, workers=2)
"""
    with started(tmp_path, script) as process:
        err = process.communicate(timeout=60)[1]
    assert (
        "RuntimeError: its worker process ended with exit code 1 before it was ready, expected `if __name__ ==" in err
    )


def started(folder: Path, text: str) -> subprocess.Popen:
    script = folder / "script.py"
    script.write_text(text)
    words = [sys.executable, str(script), str(folder / "slow")]
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)


def wait_until_busy(folder: Path, process: subprocess.Popen) -> list[psutil.Process]:
    """Return the workers of a script once it is at its slow calls."""
    assert process.stdout.readline() == "begun\n"
    deadline = time.monotonic() + 20
    while not (folder / "slow").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(0.2)
    children = psutil.Process(process.pid).children()
    assert len(children) == 2
    return children
