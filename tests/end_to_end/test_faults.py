"""A handful of the fault campaign's runs (benchmarks/soak.py), one per motor controller: the rest is `make soak`."""

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor

import pytest

from benchmarks.parts.soak.judge import judge
from benchmarks.parts.soak.rigs import DRIVES
from benchmarks.parts.soak.run import Case, run

#: drive -> a fault; above real time, where a dead program or DAQ would hold up the simulated time
RUNS = dict.fromkeys(DRIVES, ("drive", "drive trips")) | {
    "m-max": ("DAQ", "one frame corrupted"),
    "vfd-ed": ("DAQ", "keyphasor lost"),
    "acs355": ("program", "SIGTERM"),
    "powerflex400-tcp": ("motor link", "one message lost"),
    "serial-line": ("program", "Ctrl-C"),
    "canopen": ("program", "disk full"),
}
RATE = 8.0


@pytest.fixture(scope="module")
def runs() -> Iterator[dict[str, Future]]:
    """All runs under way, two at a time: they are programs of their own, and wait for most of the time."""
    with ThreadPoolExecutor(2) as pool:
        yield {
            drive: pool.submit(run, Case(drive=drive, where=where, fault=fault, number=0), rate=RATE)
            for drive, (where, fault) in RUNS.items()
        }


@pytest.mark.parametrize("drive", DRIVES)
def test_a_fault_is_seen_the_rotor_stopped_and_no_sample_lost(drive: str, runs: dict[str, Future]) -> None:
    judgement = judge(runs[drive].result())
    assert judgement.wrong == ()
    assert (judgement.injected, judgement.detected, judgement.stopped, judgement.lost) == (True, True, True, 0)
