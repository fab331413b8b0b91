"""A computer that sleeps while a rotor turns: its monotonic clock stood still, and the rotor is stopped at once."""

import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotorrig.rig.clock import WallClock
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.control import SetSpeed, ThreadedControl, guardian, sleep
from rotorrig.rig.control.line import Line, Message
from rotorrig.rig.control.sleep import SleepGuard
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.probes.base import DaqInfo
from tests.acquisition.sweep.scripted_rig import ScriptedMotor, Shaft
from tests.rig.control import guarded_sweep
from tests.rig.control.line_drive import LineDrive
from tests.rig.control.test_guardian import SOON, WITHIN, until
from tests.rig.signals import block, pulse_volts

BOOTTIME = getattr(time, "CLOCK_BOOTTIME", None)
pytestmark = pytest.mark.skipif(BOOTTIME is None, reason="this system does not tell how long it slept")


class Laptop:
    """The system's clocks: those that run during sleep are ahead by how long it slept."""

    def __init__(self) -> None:
        self._slept = 0.0
        self._ask = time.clock_gettime

    def sleep(self, seconds: float) -> None:
        self._slept += seconds

    def clock_gettime(self, which: int) -> float:
        return self._ask(which) + (self._slept if which == BOOTTIME else 0.0)


@pytest.fixture
def laptop(monkeypatch: pytest.MonkeyPatch) -> Laptop:
    made = Laptop()
    monkeypatch.setattr(time, "clock_gettime", made.clock_gettime)
    monkeypatch.setattr(sleep, "_inhibitor", list)
    return made


def test_a_sleep_is_noticed_once_and_for_how_long_it_was(laptop: Laptop) -> None:
    guard = SleepGuard()
    assert guard.slept() == 0.0
    laptop.sleep(3600.0)
    assert guard.slept() == pytest.approx(3600.0, abs=0.1)
    assert guard.slept() == 0.0
    laptop.sleep(0.1)  # two clocks read one after the other
    assert guard.slept() == 0.0


def test_a_system_that_does_not_tell_slept_never(laptop: Laptop, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(time, "CLOCK_BOOTTIME")
    guard = SleepGuard()
    laptop.sleep(3600.0)
    assert guard.slept() == 0.0


def test_the_wall_clock_goes_on_during_sleep(laptop: Laptop) -> None:
    clock = WallClock()
    before = clock.now()
    laptop.sleep(3600.0)
    assert clock.now() - before == pytest.approx(3600.0, abs=1.0)


class Guarded:
    """A guardian in a thread of this process, and the sweep's end of its line."""

    def __init__(self, drive: LineDrive, log: Path) -> None:
        self.log, self.heard = log, list[Message]()
        order = guarded_sweep.make_control(str(drive.port), log, patience=30.0)._order
        here, there = socket.socketpair()
        self.line = Line(here)
        self._guardian = guardian.Guardian(Line(there), order)
        self._thread = threading.Thread(target=self._guardian.run, name="guardian")
        self._thread.start()
        until(lambda: any("opened" in message for message in self.heard), work=self.live)

    def live(self) -> None:
        """Process samples."""
        self.line.tell(beat=time.monotonic())
        self.heard += self.line.hear(0.0)

    def said(self) -> list[str]:
        return [message["acted"] for message in self.heard if "acted" in message]

    def close(self) -> None:
        self.line.tell(close=True)
        self._thread.join(SOON)
        assert not self._thread.is_alive()
        self.line.close()
        self._guardian._line.close()


@pytest.fixture
def guarded(laptop: Laptop, tmp_path: Path) -> Iterator[tuple[Guarded, LineDrive]]:
    drive = LineDrive()
    made = Guarded(drive, tmp_path / "run.guardian.txt")
    yield made, drive
    made.close()
    drive.close()


def test_after_a_resume_the_guardian_stops_the_rotor_at_once(
    guarded: tuple[Guarded, LineDrive], laptop: Laptop
) -> None:
    sweep, drive = guarded
    sweep.line.tell(start=True)
    sweep.line.tell(set_speed=60.0, ramp=100.0)
    until(lambda: drive.inverter.output > 500, work=sweep.live)
    resumed = time.monotonic()
    laptop.sleep(600.0)
    until(lambda: drive.stops(since=resumed), work=sweep.live)
    assert drive.stops(since=resumed)[0] - resumed < WITHIN
    until(sweep.said, work=sweep.live)
    assert sweep.said() == ["the computer slept for 600 s"]
    assert "the computer slept for 600 s; sent the quick stop" in sweep.log.read_text()


def test_a_sleep_before_anything_turns_is_no_reason_to_stop(guarded: tuple[Guarded, LineDrive], laptop: Laptop) -> None:
    sweep, drive = guarded
    sweep.line.tell(start=True)
    laptop.sleep(600.0)
    until(lambda: sum("reading" in message for message in sweep.heard) > 5, work=sweep.live)
    assert sweep.said() == []
    assert drive.journal.came == []


def test_what_was_decided_before_a_sleep_starts_no_rotor_after_it(laptop: Laptop) -> None:
    """The drive's watchdog has stopped the rotor meanwhile, and somebody may have his hands at it."""
    motor = ScriptedMotor(Shaft())
    control = ThreadedControl(motor, every=60.0, watchdog=2.0)
    control.start()
    refused: list[LimitExceeded] = []

    def poll() -> None:
        try:
            control.take_readings()
        except LimitExceeded as error:
            refused.append(error)

    try:
        until(control.take_readings)
        laptop.sleep(30.0)
        control.send(SetSpeed(speed=90.0, ramp=10.0))
        until(lambda: refused, work=poll)
    finally:
        control.close()
    assert str(refused[0]).startswith("drive: was not spoken to for 30.")
    assert motor.commands == []


def test_without_a_guardian_the_samples_after_a_sleep_are_late(laptop: Laptop, rk4: RigConfig, info: DaqInfo) -> None:
    """They go on where they ended, or come from what the DAQ had kept; the clock that runs during sleep has gone on."""
    interlock, clock = Interlock(rk4, replace(info, simulated=False)), WallClock()
    turns = 20.0 * np.arange(200) / 10_000

    def take(number: int) -> None:
        one = block(pulse_volts(turns + 0.4 * number), first_sample=200 * number)
        interlock.check(one, now=clock.now())
        time.sleep(0.02)

    for number in range(20):
        take(number)
    laptop.sleep(60.0)
    with pytest.raises(LimitExceeded, match=r"DAQ: its samples arrive (59|60)\.\d s late"):
        for number in range(20, 50):  # 0.6 s
            take(number)
