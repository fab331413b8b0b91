"""Readings, commands and stops on threads of their own: a stop overtakes, a dead loop is not spoken for."""

import math
import threading
import time
from collections.abc import Callable, Iterator

import pytest

from rotorrig.rig.control import READ_EVERY, DirectControl, Reading, SetSpeed, ThreadedControl, threaded
from rotorrig.rig.errors import LimitExceeded, LinkLost
from rotorrig.rig.motor.base import MotorDriver, Stop
from tests.acquisition.sweep.scripted_rig import ScriptedMotor, Shaft
from tests.manual_clock import ManualClock

SOON = 5.0  # s of patience on a busy machine; what is waited for takes milliseconds


def until(true: Callable[[], bool]) -> None:
    deadline = time.monotonic() + SOON
    while not true():
        assert time.monotonic() < deadline, "did not happen"
        time.sleep(0.001)


@pytest.fixture
def motor() -> ScriptedMotor:
    return ScriptedMotor(Shaft())


@pytest.fixture
def control(motor: ScriptedMotor) -> Iterator[ThreadedControl]:
    control = ThreadedControl(motor, every=0.01)
    control.start()
    yield control
    control.close()
    assert threading.active_count() == 1 or all(t.name not in ("motor", "motor stop") for t in threading.enumerate())


def confirmed(control: ThreadedControl) -> bool:
    return control.report is not None and not math.isnan(control.report.confirmed)


def test_readings_come_by_themselves_and_say_which_commands_they_know_of(
    motor: ScriptedMotor, control: ThreadedControl
) -> None:
    until(lambda: any(reading.commands_done == 0 for reading in control.take_readings()))
    number = control.send(SetSpeed(speed=60.0, ramp=10.0))
    assert number == 1
    taken: list[Reading] = []
    until(lambda: bool(taken.extend(control.take_readings()) or (taken and taken[-1].commands_done == number)))
    assert taken[-1].state.setpoint == 60.0
    assert all(reading.state.setpoint == 0.0 for reading in taken if reading.commands_done == 0)


def test_a_stop_does_not_wait_for_a_reading_that_hangs(motor: ScriptedMotor, control: ThreadedControl) -> None:
    release, reading = threading.Event(), threading.Event()

    def hang(state: object) -> object:
        reading.set()
        release.wait(SOON)
        return state

    motor.on_read = hang  # type: ignore[assignment]
    until(reading.is_set)
    control.stop(Stop.EMERGENCY)
    until(lambda: confirmed(control))
    assert not release.is_set()
    assert motor.commands == [("stop", Stop.EMERGENCY)]
    release.set()


def test_a_command_that_a_stop_overtakes_is_stopped_again_and_those_behind_it_are_never_sent(
    motor: ScriptedMotor, control: ThreadedControl
) -> None:
    release, under_way = threading.Event(), threading.Event()

    def slow_start(motor: MotorDriver) -> None:
        under_way.set()
        release.wait(SOON)
        motor.set_speed(60.0, ramp=10.0)

    control.send(slow_start)  # type: ignore[arg-type]
    control.send(SetSpeed(speed=90.0, ramp=10.0))
    until(under_way.is_set)
    control.stop(Stop.RAMP)
    until(lambda: ("stop", Stop.RAMP) in motor.commands)
    release.set()
    until(lambda: confirmed(control))
    time.sleep(0.05)
    assert motor.commands == [("stop", Stop.RAMP), ("set", 60.0, 10.0), ("stop", Stop.RAMP)]


def test_a_stop_opens_the_link_anew_until_the_drive_obeys(motor: ScriptedMotor, control: ThreadedControl) -> None:
    left = 3

    def unplugged(kind: Stop) -> None:
        nonlocal left
        left -= 1
        if left >= 0:
            raise LinkLost("port is gone")

    motor.on_stop = unplugged
    control.stop(Stop.EMERGENCY)
    until(lambda: control.report is not None and control.report.trouble == "port is gone")
    assert not confirmed(control)
    until(lambda: confirmed(control))
    assert control.report
    assert (control.report.tries, control.report.trouble, motor.opened) == (4, "", 3)
    assert control.report.handed < control.report.confirmed


def test_another_stop_stands_instead_of_one_that_is_still_tried(motor: ScriptedMotor, control: ThreadedControl) -> None:
    def refuse_ramp(kind: Stop) -> None:
        if kind is Stop.RAMP:
            raise LinkLost("no answer")

    motor.on_stop = refuse_ramp
    control.stop(Stop.RAMP)
    until(lambda: control.report is not None and control.report.tries > 0)
    control.stop(Stop.EMERGENCY)
    until(lambda: confirmed(control))
    assert control.report
    assert control.report.kind is Stop.EMERGENCY


def test_a_stop_is_sent_again_when_the_link_dies_while_the_rotor_slows_down(
    motor: ScriptedMotor, control: ThreadedControl
) -> None:
    control.stop(Stop.RAMP)
    until(lambda: confirmed(control))
    failed = threading.Event()

    def once(state: object) -> object:
        if not failed.is_set():
            failed.set()
            raise LinkLost("unplugged")
        return state

    motor.on_read = once  # type: ignore[assignment]
    until(lambda: motor.commands == [("stop", Stop.RAMP)] * 2)
    assert control.take_readings() is not None  # nothing is raised: the rotor is being stopped


@pytest.mark.parametrize("fault", [LinkLost("no answer"), LimitExceeded("has tripped")])
def test_what_goes_wrong_is_raised_where_it_can_be_acted_on(
    motor: ScriptedMotor, control: ThreadedControl, fault: Exception
) -> None:
    def refuse(motor: MotorDriver) -> None:
        raise fault

    control.send(refuse)  # type: ignore[arg-type]
    raised: list[Exception] = []

    def heard() -> bool:
        try:
            control.take_readings()
        except type(fault) as error:
            raised.append(error)
        return bool(raised)

    until(heard)
    assert raised == [fault]


def test_readings_after_a_stop_know_of_the_commands_that_failed_and_of_those_that_were_never_sent(
    motor: ScriptedMotor, control: ThreadedControl
) -> None:
    def refuse(motor: MotorDriver) -> None:
        raise LimitExceeded("has tripped")

    control.send(refuse)  # type: ignore[arg-type]
    control.stop(Stop.EMERGENCY)
    number = control.send(SetSpeed(speed=90.0, ramp=10.0))
    until(lambda: any(reading.commands_done == number for reading in control.take_readings()))
    assert motor.commands == [("stop", Stop.EMERGENCY)]


def test_a_program_that_hung_for_longer_than_the_watchdog_starts_no_rotor(
    motor: ScriptedMotor, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The drive has stopped the rotor by itself; what the program had decided before must not start it again."""
    monkeypatch.setattr(threaded, "LOOP_STALL", 0.1)
    control = ThreadedControl(motor, every=0.01, watchdog=0.3)
    control.start()
    try:
        until(lambda: bool(control.take_readings()))
        time.sleep(0.6)  # the loop hangs, so the drive hears nothing
        control.take_readings()
        control.send(SetSpeed(speed=90.0, ramp=10.0))
        until(lambda: raises(control, LimitExceeded, "was not spoken to for 0."))
    finally:
        control.close()
    assert motor.commands == []


def raises(control: ThreadedControl, kind: type[Exception], said: str) -> bool:
    try:
        control.take_readings()
    except kind as error:
        return said in str(error)
    return False


def test_of_a_program_that_hangs_the_drive_hears_nothing_more(
    motor: ScriptedMotor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(threaded, "LOOP_STALL", 0.3)
    read_at: list[float] = []
    motor.on_read = lambda state: read_at.append(time.monotonic()) or state  # type: ignore[func-returns-value]
    control = ThreadedControl(motor, every=0.01)
    control.start()
    try:
        control.beat(0.0)
        beaten = time.monotonic()
        time.sleep(1.0)
        assert 0.1 < read_at[-1] - beaten <= 0.31
        control.beat(0.0)
        until(lambda: read_at[-1] > beaten + 1.0)
    finally:
        control.close()


def test_a_stop_from_a_signal_handler_cannot_lock_itself_out(motor: ScriptedMotor, control: ThreadedControl) -> None:
    for _ in range(1000):  # as fast as handlers could come
        control.stop(Stop.EMERGENCY)
    until(lambda: confirmed(control))


def test_the_direct_control_does_the_same_by_its_callers_clock(motor: ScriptedMotor) -> None:
    clock = ManualClock()
    control = DirectControl(motor, clock=clock)
    control.start()
    control.beat(0.0)
    assert len(control.take_readings()) == 1
    control.beat(0.0)
    assert control.take_readings() == []
    clock.sleep(READ_EVERY)
    control.beat(0.0)
    assert len(control.take_readings()) == 1
    assert control.send(SetSpeed(speed=60.0, ramp=10.0)) == 1
    control.stop(Stop.RAMP)
    control.send(SetSpeed(speed=90.0, ramp=10.0))
    assert motor.commands == [("set", 60.0, 10.0), ("stop", Stop.RAMP)]
    motor.on_read = lambda state: (_ for _ in ()).throw(LinkLost("unplugged"))
    clock.sleep(1.0)
    control.beat(0.0)
    assert control.report
    assert control.report.trouble == "unplugged"
    clock.sleep(1.0)
    control.beat(0.0)
    assert motor.commands[1:] == [("stop", Stop.RAMP)] * 2
    assert motor.opened == 1


def test_a_link_closed_for_a_silence_is_opened_by_the_next_stop(motor: ScriptedMotor, control: ThreadedControl) -> None:
    closed = threading.Event()
    motor.close = closed.set  # type: ignore[method-assign]
    until(lambda: bool(control.take_readings()))
    control.fall_silent(60.0, closed=True)
    assert closed.wait(SOON)
    time.sleep(0.05)
    control.take_readings()
    control.read_soon()
    time.sleep(0.1)
    assert control.take_readings() == []  # and no fault: it was closed on purpose
    assert motor.opened == 0
    control.stop(Stop.EMERGENCY)
    until(lambda: confirmed(control))
    assert motor.opened == 1
    assert control.report
    assert control.report.tries == 1
    until(lambda: bool(control.take_readings()))
