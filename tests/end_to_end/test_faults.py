"""A handful of the fault campaign's runs (benchmarks/soak.py), one per motor controller: the rest is `make soak`.

Each is of programs of its own, which wait for most of the time.
"""

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
ALWAYS = "canopen"  # the others in `make test-all`


@pytest.mark.parametrize(
    "drive", [pytest.param(drive, marks=[] if drive == ALWAYS else pytest.mark.campaign) for drive in DRIVES]
)
def test_a_fault_is_seen_the_rotor_stopped_and_no_sample_lost(drive: str) -> None:
    where, fault = RUNS[drive]
    judgement = judge(run(Case(drive=drive, where=where, fault=fault, number=0), rate=RATE))
    assert judgement.wrong == ()
    assert (judgement.injected, judgement.detected, judgement.stopped, judgement.lost) == (True, True, True, 0)
