"""Runs of a lab that are measured: by `rotor lab run` as a user calls it, and by plain processes side by side."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import psutil

from rotorrig.app.lab import LabSettings, find_jobs, work_through

ROOT = Path(__file__).parents[3]
MIB = 2**20
LOOK_EVERY = 0.5  # s
PATIENCE = 20.0  # s, in which processes have to end after their command


@dataclass(slots=True, kw_only=True)
class Memory:
    """Resident memory of the largest worker [MiB], over the recordings done."""

    seen: list[tuple[int, float]] = field(default_factory=list)

    def after(self, share: float, *, of: int) -> float:
        """Return the largest within a tenth of all recordings from that share on."""
        near = [size for done, size in self.seen if share * of <= done <= (share + 0.1) * of]
        return max(near or [size for _, size in self.seen[-1:]])


def run_command(folder: Path, *, workers: int, steps: str, memory: Memory | None = None) -> float:
    """Run `rotor lab run` to its end and return its time [s]; the workers' memory is noted in `memory`."""
    began = time.perf_counter()
    with begin(folder, workers=workers, steps=steps) as process:
        while process.poll() is None:
            time.sleep(LOOK_EVERY)
            if memory is not None and (sizes := [_resident(worker) for worker in workers_of(process)]):
                memory.seen.append((len(done(folder)), max(sizes)))
    if process.returncode:
        raise RuntimeError(f"rotor lab run ended with {process.returncode}")
    return time.perf_counter() - began


@contextmanager
def begin(folder: Path, *, workers: int, steps: str) -> Iterator["subprocess.Popen[bytes]"]:
    """Begin `rotor lab run`; it is killed if the block is left before its end."""
    words = ["-m", "rotorrig.app.cli", "lab", "run", str(folder), "--workers", str(workers), "--steps", steps]
    process = subprocess.Popen([sys.executable, *words], cwd=ROOT, stdout=subprocess.DEVNULL)
    try:
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.wait()


def run_plainly(folder: Path, *, workers: int, steps: str) -> float:
    """Work through a folder by plain processes, each with every so many-th recording, and return the time [s]."""
    began = time.perf_counter()
    spawn = multiprocessing.get_context("spawn")
    os.environ["OPENBLAS_NUM_THREADS"] = os.environ["NUMBA_NUM_THREADS"] = "1"
    processes = [spawn.Process(target=_work_plainly, args=(folder, i, workers, steps)) for i in range(workers)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    return time.perf_counter() - began


def _work_plainly(folder: Path, first: int, step: int, steps: str) -> None:
    for job in find_jobs(folder, LabSettings.read(steps))[first::step]:
        work_through(job)


@dataclass(frozen=True, slots=True, kw_only=True)
class Resumed:
    """What kill -9 cost: of a worker, then of the command, before the same command went on."""

    before: int  # recordings done when the command was killed
    twice: int  # of those, done again
    orphans: int  # processes left after the command was killed
    missing: int  # recordings without a row in the end


def run_with_kills(folder: Path, *, workers: int, steps: str) -> Resumed:
    """Kill a worker when a quarter is done, the command when half is, and let the same command go on."""
    number = sum(path.suffix == ".mcap" for path in folder.iterdir())
    with begin(folder, workers=workers, steps=steps) as process:
        _wait_until(lambda: len(done(folder)) >= number // 4, process)
        workers_of(process)[0].kill()
        _wait_until(lambda: len(done(folder)) >= number // 2, process)
        at_work = workers_of(process)
        process.send_signal(signal.SIGKILL)
        process.wait()
    _, orphans = psutil.wait_procs(at_work, timeout=PATIENCE)
    before = done(folder)
    run_command(folder, workers=workers, steps=steps)
    after = done(folder)
    return Resumed(
        before=len(before),
        twice=sum(after.get(name) != written for name, written in before.items()),
        orphans=len(orphans),
        missing=number - len(after),
    )


def done(folder: Path) -> dict[str, int]:
    """Return when the row of every recording that is done was written."""
    return {path.name: path.stat().st_mtime_ns for path in folder.glob("lab/catalogue/runs/*.parquet")}


def workers_of(process: "subprocess.Popen[bytes]") -> Sequence[psutil.Process]:
    """Return the processes that a command has spawned to work."""
    try:
        below = psutil.Process(process.pid).children(recursive=True)
        return [child for child in below if "spawn_main" in " ".join(child.cmdline())]
    except psutil.Error:
        return []


def _resident(process: psutil.Process) -> float:
    try:
        return process.memory_info().rss / MIB
    except psutil.Error:
        return 0.0


def _wait_until(met: Callable[[], bool], process: "subprocess.Popen[bytes]") -> None:
    while not met():
        if process.poll() is not None:
            raise RuntimeError("rotor lab run ended before it was killed; want more recordings")
        time.sleep(0.05)
