"""Ctrl-C and kill -9, of the command and of its processes: what was done stays, and nothing goes on by itself."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest

from rotorrig.app.lab.catalogue import query_table
from rotorrig.rig.config.description import RigConfig
from tests.app.lab.conftest import write_responses

NUMBER = 6
ROOT = Path(__file__).parents[3]
PATIENCE = 90.0  # s, on a busy machine

pytestmark = pytest.mark.campaign


@pytest.fixture
def folder(rig_config: RigConfig, tmp_path: Path) -> Path:
    """A lab of six responses, whose fits take a second or two each."""
    write_responses(tmp_path, rig_config, NUMBER)
    return tmp_path


@pytest.fixture
def begin(folder: Path) -> Iterator[Callable[[], "subprocess.Popen[str]"]]:
    """Begin `rotor lab run` on two processes, in a session of its own."""
    begun = []

    def start() -> "subprocess.Popen[str]":
        words = [sys.executable, "-m", "rotorrig.app.cli", "lab", "run", str(folder), "--workers", "2"]
        begun.append(
            subprocess.Popen(
                words, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
            )
        )
        return begun[-1]

    yield start
    for process in begun:
        if process.poll() is None:
            process.kill()
        process.communicate()


def done(folder: Path) -> dict[str, int]:
    """Return when the rows of every recording that is done were written."""
    return {path.name: path.stat().st_mtime_ns for path in folder.glob("lab/catalogue/runs/*.parquet")}


def wait_until(met: Callable[[], bool]) -> None:
    until = time.monotonic() + PATIENCE
    while not met():
        assert time.monotonic() < until
        time.sleep(0.05)


def workers_of(process: "subprocess.Popen[str]") -> list[psutil.Process]:
    """Return the processes that work: those that multiprocessing has spawned."""
    below = psutil.Process(process.pid).children(recursive=True)
    return [child for child in below if "spawn_main" in " ".join(child.cmdline())]


def finish(begin: Callable[[], "subprocess.Popen[str]"], folder: Path, before: dict[str, int]) -> None:
    """Let the same command go on; what was done is not done again."""
    process = begin()
    said, wrong = process.communicate(timeout=PATIENCE)
    assert (process.returncode, wrong) == (0, "")
    assert f"{NUMBER} recordings: {NUMBER - len(before)} done" in said
    after = done(folder)
    assert len(after) == NUMBER
    assert before.items() <= after.items()
    statuses = query_table(folder, "select distinct status, step from runs_all").to_pylist()
    assert statuses == [{"status": "done", "step": "identify"}]


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_a_command_that_ends_leaves_no_process_and_the_same_goes_on(
    folder: Path, begin: Callable[[], "subprocess.Popen[str]"], how: signal.Signals
) -> None:
    process = begin()
    wait_until(lambda: len(done(folder)) >= 2)
    workers = workers_of(process)
    assert len(workers) == 2
    if how == signal.SIGINT:
        os.killpg(process.pid, how)  # as a terminal does on Ctrl-C: to all of them
    else:
        process.kill()
    said, _ = process.communicate(timeout=PATIENCE)
    if how == signal.SIGINT:
        assert process.returncode == 130
        assert "left; the same command goes on" in said
    _, alive = psutil.wait_procs(workers, timeout=20)
    assert alive == []
    before = done(folder)
    assert 2 <= len(before) < NUMBER
    finish(begin, folder, before)


def test_a_worker_that_is_killed_costs_what_it_had_under_way(
    folder: Path, begin: Callable[[], "subprocess.Popen[str]"]
) -> None:
    process = begin()
    wait_until(lambda: len(done(folder)) >= 1)
    before = done(folder)
    workers_of(process)[0].kill()
    said, wrong = process.communicate(timeout=PATIENCE)
    assert (process.returncode, wrong) == (0, "")
    assert f"{NUMBER} recordings: {NUMBER} done" in said
    assert before.items() <= done(folder).items()
