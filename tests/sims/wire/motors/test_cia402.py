"""Object by object and transition by transition, as CiA 402-2 (IEC 61800-7-201) has them."""

import math
from typing import Any

import pytest

from rotorrig.sims.wire.motors.cia402 import Cia402, Refused
from tests.manual_clock import ManualClock

RPM = math.pi / 30
SWITCH_ON_DISABLED, READY, SWITCHED_ON, ENABLED, QUICK_STOP, FAULT = 0x40, 0x21, 0x23, 0x27, 0x07, 0x08
MASTER = 127


@pytest.fixture
def sent() -> list[tuple[int, int]]:
    return []


@pytest.fixture
def drive(plant: Any, clock: ManualClock, sent: list[tuple[int, int]]) -> Cia402:
    drive = Cia402(plant, max_speed=4200 * RPM, rpm_per_unit=1.0, clock=clock)
    drive.emergency = lambda code, register: sent.append((code, register))
    return drive


def state(drive: Cia402) -> int:
    """The state's bits of the statusword, with voltage and remote checked."""
    word = drive.read(0x6041, 0)
    assert isinstance(word, int)
    assert word & 0x210 == 0x210
    return word & (0x4F if word & 0x48 else 0x6F)


def control(drive: Cia402, *words: int) -> int:
    for word in words:
        drive.write(0x6040, 0, word)
    return state(drive)


@pytest.fixture
def turning(drive: Cia402, plant: Any) -> Cia402:
    """At 600 rpm, reached at 30 rpm/s; it quick-stops at 600 rpm/s."""
    for place, value in {
        (0x6060, 0): 2, (0x605B, 0): 1,
        (0x6048, 1): 3000, (0x6048, 2): 100, (0x6049, 1): 3000, (0x6049, 2): 100, (0x604A, 1): 600, (0x604A, 2): 1,
    }.items():  # fmt: skip
        drive.write(*place, value)
    assert control(drive, 0x06, 0x07, 0x7F) == ENABLED
    drive.write(0x6042, 0, 600)
    plant.advance(plant.t + 25.0)
    return drive


def test_it_starts_switch_on_disabled_and_is_a_drive_with_velocity_mode(drive: Cia402) -> None:
    assert state(drive) == SWITCH_ON_DISABLED
    assert drive.read(0x1000, 0) == 0x00010192  # 402, frequency converter
    assert drive.read(0x6502, 0) == 0b10
    assert (drive.read(0x6046, 1), drive.read(0x6046, 2)) == (0, 4200)


@pytest.mark.parametrize(
    ("words", "after"),
    [
        ([0x06], READY),  # 2
        ([0x07], SWITCH_ON_DISABLED),
        ([0x0F], SWITCH_ON_DISABLED),
        ([0x06, 0x07], SWITCHED_ON),  # 3
        ([0x06, 0x0F], ENABLED),  # 3 and 4
        ([0x06, 0x07, 0x0F], ENABLED),  # 4
        ([0x06, 0x07, 0x0F, 0x07], SWITCHED_ON),  # 5
        ([0x06, 0x07, 0x06], READY),  # 6
        ([0x06, 0x00], SWITCH_ON_DISABLED),  # 7
        ([0x06, 0x02], SWITCH_ON_DISABLED),  # 7
        ([0x06, 0x07, 0x0F, 0x06], READY),  # 8
        ([0x06, 0x07, 0x0F, 0x00], SWITCH_ON_DISABLED),  # 9
        ([0x06, 0x07, 0x00], SWITCH_ON_DISABLED),  # 10
        ([0x06, 0x07, 0x02], SWITCH_ON_DISABLED),  # 10
        ([0x06, 0x07, 0x0F, 0x02], SWITCH_ON_DISABLED),  # 11, and 12 at once: at rest
        ([0x80], SWITCH_ON_DISABLED),
    ],
)
def test_at_rest_the_controlword_leads_where_the_standard_says(drive: Cia402, words: list[int], after: int) -> None:
    assert control(drive, *words) == after


def test_it_follows_the_target_at_the_ramp(turning: Cia402, plant: Any) -> None:
    assert plant.commands[-1] == (pytest.approx(600 * RPM), pytest.approx(30 * RPM), True)
    assert plant.speed == pytest.approx(600 * RPM)
    assert turning.read(0x6043, 0) == turning.read(0x6044, 0) == 600
    assert turning.read(0x6041, 0) == ENABLED | 0x10 | 0x200 | 0x400  # target reached
    turning.write(0x6042, 0, 1200)
    plant.advance(plant.t + 10.0)
    assert turning.read(0x6044, 0) == 900
    assert turning.read(0x6041, 0) == ENABLED | 0x10 | 0x200


def test_enabling_clears_the_target(drive: Cia402, plant: Any) -> None:
    drive.write(0x6060, 0, 2)
    drive.write(0x6042, 0, 600)
    control(drive, 0x06, 0x07, 0x7F)
    assert drive.read(0x6042, 0) == 0
    assert all(command[0] == 0.0 for command in plant.commands)


@pytest.mark.parametrize("word", [0x0F, 0x3F, 0x5F, 0x6F, 0x17F])
def test_a_ramp_generator_that_is_not_released_or_is_halted_goes_to_zero(
    turning: Cia402, plant: Any, word: int
) -> None:
    assert control(turning, word) == ENABLED
    assert plant.commands[-1][0] == 0.0


def test_a_shutdown_goes_down_the_ramp_and_then_ends_ready(turning: Cia402, plant: Any) -> None:
    assert control(turning, 0x06) == ENABLED
    assert plant.commands[-1] == (0.0, pytest.approx(30 * RPM), True)
    plant.advance(plant.t + 10.0)
    assert (state(turning), turning.read(0x6044, 0)) == (ENABLED, 300)
    plant.advance(plant.t + 11.0)
    turning.tick()
    assert (state(turning), plant.commands[-1][2]) == (READY, False)


def test_a_shutdown_under_way_is_taken_back_by_enabling(turning: Cia402, plant: Any) -> None:
    control(turning, 0x06)
    plant.advance(plant.t + 10.0)
    assert control(turning, 0x7F) == ENABLED
    assert plant.commands[-1] == (pytest.approx(600 * RPM), pytest.approx(30 * RPM), True)


def test_a_shutdown_with_option_0_coasts(turning: Cia402, plant: Any) -> None:
    turning.write(0x605B, 0, 0)
    assert control(turning, 0x06) == READY
    assert plant.commands[-1][2] is False


def test_a_quick_stop_goes_down_its_own_ramp_and_ends_switch_on_disabled(turning: Cia402, plant: Any) -> None:
    assert control(turning, 0x02) == QUICK_STOP
    assert plant.commands[-1] == (0.0, pytest.approx(600 * RPM), True)
    assert control(turning, 0x06, 0x07, 0x7F) == QUICK_STOP  # nothing softens it
    plant.advance(plant.t + 1.1)
    turning.tick()
    assert state(turning) == SWITCH_ON_DISABLED


@pytest.mark.parametrize(("option", "ramp"), [(5, 30), (6, 600)])
def test_a_quick_stop_that_stays_may_be_left_by_enabling(turning: Cia402, plant: Any, option: int, ramp: float) -> None:
    turning.write(0x605A, 0, option)
    assert control(turning, 0x02) == QUICK_STOP
    assert plant.commands[-1][1] == pytest.approx(ramp * RPM)
    plant.advance(plant.t + 21.0)
    turning.tick()
    assert state(turning) == QUICK_STOP
    assert control(turning, 0x7F) == ENABLED  # 16
    assert plant.commands[-1] == (pytest.approx(600 * RPM), pytest.approx(30 * RPM), True)


def test_disabled_voltage_coasts(turning: Cia402, plant: Any) -> None:
    assert control(turning, 0x00) == SWITCH_ON_DISABLED
    assert plant.commands[-1][2] is False
    assert turning.read(0x6044, 0) == 0


def test_a_trip_is_a_fault_with_its_code_until_a_rising_edge_resets_it(
    turning: Cia402, plant: Any, sent: list[tuple[int, int]]
) -> None:
    turning.drive.trip(0x3210)
    turning.tick()
    assert (state(turning), turning.read(0x603F, 0), turning.read(0x1001, 0)) == (FAULT, 0x3210, 0x01)
    assert plant.commands[-1][2] is False
    assert control(turning, 0x06, 0x07, 0x0F) == FAULT
    assert control(turning, 0x80) == SWITCH_ON_DISABLED  # 15
    assert (turning.read(0x603F, 0), turning.read(0x1001, 0)) == (0, 0)
    assert sent == [(0x3210, 0x01), (0, 0)]
    turning.drive.trip(0x3210)
    assert control(turning, 0x80) == FAULT  # no edge
    assert control(turning, 0x00, 0x80) == SWITCH_ON_DISABLED


@pytest.mark.parametrize(
    ("option", "after", "powered"),
    [(0, ENABLED, True), (1, FAULT, False), (2, SWITCH_ON_DISABLED, False), (3, QUICK_STOP, True)],
)
def test_a_heartbeat_that_stays_away_has_the_effect_of_6007h(
    turning: Cia402, plant: Any, clock: ManualClock, sent: list[tuple[int, int]], option: int, after: int, powered: bool
) -> None:
    turning.write(0x6007, 0, option)
    turning.write(0x1016, 1, MASTER << 16 | 1000)
    clock.sleep(60.0)
    turning.tick()
    assert state(turning) == ENABLED  # watched from its first heartbeat on
    turning.hear_heartbeat(MASTER)
    clock.sleep(0.99)
    turning.hear_heartbeat(5)  # another node's
    turning.tick()
    assert sent == []
    clock.sleep(0.02)
    turning.tick()
    assert (state(turning), plant.commands[-1][2]) == (after, powered)
    assert turning.master_lost
    assert sent[0] == (0x8130, 0x11)
    assert turning.read(0x1001, 0) == 0x11
    turning.hear_heartbeat(MASTER)
    assert not turning.master_lost
    assert sent[-1] == (0, 0)


def test_a_target_beyond_the_maximum_is_limited_and_said(turning: Cia402, plant: Any) -> None:
    turning.write(0x6046, 2, 700)
    turning.write(0x6042, 0, 1000)
    assert plant.commands[-1][0] == pytest.approx(700 * RPM)
    word = turning.read(0x6041, 0)
    assert isinstance(word, int)
    assert word & 0x800


@pytest.mark.parametrize(
    ("index", "subindex", "value", "code"),
    [
        (0x6041, 0, 0, 0x06010002),  # read-only
        (0x6042, 0, -1, 0x06090032),  # one direction: too low
        (0x6046, 2, 4201, 0x06090031),  # beyond what the motor is commissioned for
        (0x6048, 1, 0, 0x06090032),
        (0x6060, 0, 1, 0x06090030),  # profile position
        (0x605A, 0, 3, 0x06090030),
        (0x6007, 0, 4, 0x06090031),
    ],
)
def test_what_it_does_not_take_is_refused_with_the_abort_code(
    drive: Cia402, index: int, subindex: int, value: int, code: int
) -> None:
    with pytest.raises(Refused) as refusal:
        drive.write(index, subindex, value)
    assert refusal.value.code == code


def test_an_object_it_has_not_is_a_key_error(drive: Cia402) -> None:
    for access in (lambda: drive.read(0x2000, 0), lambda: drive.write(0x6046, 3, 0)):
        with pytest.raises(KeyError):
            access()
