"""The M-Max's behaviour, MN04020003E pages 83-84 and 132-139, on a rotor that follows exactly; IDs are sent less 1."""

import math
from typing import Any

import pytest

from rotorrig.rig.errors import ConfigError
from rotorrig.sims.wire.motors.m_max import MMax
from rotorrig.sims.wire.motors.modbus_motor import Unanswered
from tests.manual_clock import ManualClock

FROM_BUS = 1 << 8 | 1 << 9
RUN, REVERSE, RESET, COAST, RAMP, BLOCK = (FROM_BUS | 1 << bit for bit in (0, 1, 2, 3, 4, 12))
READY, RUNNING, FAULT, AT_SETPOINT, ZERO_SPEED = (1 << bit for bit in (0, 1, 3, 5, 6))
RAD_PER_HZ = 2 * math.pi  # two poles: 60 rpm per Hz


@pytest.fixture
def drive(plant: Any, clock: ManualClock) -> MMax:
    """70 Hz at most, 10 Hz/s up and 20 Hz/s down."""
    drive = MMax(plant, rpm_per_hz=60.0, max_frequency=70.0, clock=clock)
    write(drive, 103, 70, 35)
    return drive


def write(drive: MMax, number: int, *values: int) -> None:
    drive.write(number - 1, list(values))


def read(drive: MMax, number: int) -> int:
    return drive.read(number - 1, 1)[0]


def run_up(drive: MMax, plant: Any) -> None:
    write(drive, 2003, 5000)  # half of 0 to 70 Hz
    write(drive, 2001, RUN)
    plant.advance(plant.t + 10.0)


def test_the_setpoint_is_a_share_of_the_range_and_the_ramp_its_time_over_it(drive: MMax, plant: Any) -> None:
    write(drive, 2003, 5000)
    write(drive, 2001, RUN)
    plant.advance(1.0)
    assert read(drive, 2104) == 1000  # 10.00 Hz
    assert read(drive, 2105) == 600  # rpm
    assert read(drive, 2103) == round(10_000 * 10 / 70)
    assert read(drive, 2101) == READY | RUNNING
    plant.advance(3.5)
    assert plant.speed == pytest.approx(35.0 * RAD_PER_HZ)
    assert read(drive, 2101) == READY | RUNNING | AT_SETPOINT


def test_a_minimum_frequency_shifts_the_range(drive: MMax, plant: Any) -> None:
    write(drive, 101, 2000)  # 20 Hz
    run_up(drive, plant)
    assert read(drive, 2104) == 4500
    assert read(drive, 2103) == 5000


@pytest.mark.parametrize(
    ("word", "hertz_after", "powered"), [(RAMP, 25.0, True), (COAST, 0.0, False), (FROM_BUS, 0.0, False)]
)
def test_bits_3_and_4_choose_the_stop_and_p6_8_otherwise(
    drive: MMax, plant: Any, word: int, hertz_after: float, powered: bool
) -> None:
    run_up(drive, plant)  # P6.8 is 0, free coasting, as delivered
    write(drive, 2001, word)
    plant.advance(plant.t + 0.5)
    assert read(drive, 2104) == 100 * hertz_after
    assert bool(read(drive, 2101) & RUNNING) is powered
    assert plant.commands[-1][2] is powered


def test_p6_8_makes_the_plain_stop_a_ramp(drive: MMax, plant: Any) -> None:
    write(drive, 506, 1)
    run_up(drive, plant)
    write(drive, 2001, FROM_BUS)
    plant.advance(plant.t + 0.5)
    assert read(drive, 2104) == 2500


def test_a_blocked_drive_stops_as_quickly_as_it_can_and_starts_at_an_edge(drive: MMax, plant: Any) -> None:
    run_up(drive, plant)
    write(drive, 2001, BLOCK | RUN)
    plant.advance(plant.t + 0.06)  # 0.1 s from 70 Hz
    assert read(drive, 2101) & (RUNNING | ZERO_SPEED) == ZERO_SPEED
    write(drive, 2001, RUN)  # run has been set all the time: no edge
    assert not read(drive, 2101) & RUNNING
    write(drive, 2001, FROM_BUS)
    write(drive, 2001, RUN)
    assert read(drive, 2101) & RUNNING


def test_control_and_setpoint_are_the_buss_only_where_the_word_says_so(drive: MMax, plant: Any) -> None:
    write(drive, 2003, 5000)
    write(drive, 2001, 1 << 0 | 1 << 9)
    assert not read(drive, 2101) & RUNNING
    write(drive, 2001, 1 << 8)
    write(drive, 2001, 1 << 0 | 1 << 8)
    plant.advance(5.0)
    assert (read(drive, 2101) & RUNNING, read(drive, 2104)) == (RUNNING, 0)
    assert read(drive, 2102) == 0b01


def test_a_silent_master_is_error_53_after_the_time_out(drive: MMax, plant: Any, clock: ManualClock) -> None:
    run_up(drive, plant)
    clock.sleep(100.0)
    drive.drive.tick()
    assert read(drive, 2101) & RUNNING  # S2.7 is 0, not used, as delivered
    write(drive, 814, 2)
    clock.sleep(2.1)
    drive.drive.tick()
    assert plant.commands[-1][2] is False
    assert read(drive, 2111) == 53
    assert read(drive, 2101) & (READY | RUNNING | FAULT) == FAULT


def test_an_error_is_reset_by_the_edge_of_bit_2(drive: MMax, plant: Any) -> None:
    run_up(drive, plant)
    drive.drive.trip(1)
    write(drive, 2001, FROM_BUS)
    write(drive, 2001, RUN)
    assert not read(drive, 2101) & RUNNING
    write(drive, 2001, RESET)
    assert read(drive, 2111) == 0
    write(drive, 2001, RUN)
    assert read(drive, 2101) & RUNNING


@pytest.mark.parametrize(("number", "value"), [(101, 100), (102, 6000), (103, 100), (104, 100), (506, 1)])
def test_what_the_manual_marks_is_not_changed_in_run(drive: MMax, plant: Any, number: int, value: int) -> None:
    before = read(drive, number)
    run_up(drive, plant)
    with pytest.raises(ValueError, match="cannot be changed while the drive runs"):
        write(drive, number, value)
    assert read(drive, number) == before
    write(drive, 814, 5)  # the time-out may


@pytest.mark.parametrize(
    ("number", "value"),
    [(2001, REVERSE), (2001, 1 << 5), (2001, 1 << 6), (2001, 1 << 7), (2003, 10_001), (103, 0), (506, 2), (814, 256)],
)
def test_a_value_out_of_range_is_refused(drive: MMax, number: int, value: int) -> None:
    with pytest.raises(ValueError):
        write(drive, number, value)


@pytest.mark.parametrize("number", [1, 105, 2101, 2111, 2112])
def test_a_register_that_cannot_be_written_is_refused(drive: MMax, number: int) -> None:
    with pytest.raises(KeyError):
        write(drive, number, 0)


def test_eleven_registers_are_all_that_is_sent(drive: MMax) -> None:
    assert len(drive.read(2100, 11)) == 11
    with pytest.raises(Unanswered):
        drive.read(2100, 12)
    assert drive.read(2110, 1) == [8]


def test_a_rotor_the_drive_cannot_turn_so_fast_is_refused(plant: Any, clock: ManualClock) -> None:
    with pytest.raises(ConfigError, match="320 Hz"):
        MMax(plant, rpm_per_hz=10.0, max_frequency=420.0, clock=clock)
