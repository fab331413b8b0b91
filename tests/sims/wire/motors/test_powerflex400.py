"""The drive's behaviour, 22C-UM001J Appendix E and its parameter chapter, on a rotor that follows exactly."""

import math
from typing import Any

import pytest

from rotorrig.rig.errors import ConfigError
from rotorrig.sims.wire.motors.powerflex400 import PowerFlex400
from tests.manual_clock import ManualClock

STOP, START, CLEAR = 1, 2, 8
READY, ACTIVE, ACCELERATING, DECELERATING, FAULTED, AT_REFERENCE = 1 << 0, 1 << 1, 1 << 4, 1 << 5, 1 << 7, 1 << 8
RAD_PER_HZ = 2 * math.pi  # two poles: 60 rpm per Hz


@pytest.fixture
def drive(plant: Any, clock: ManualClock) -> PowerFlex400:
    """70 Hz at most, 10 Hz/s up and 20 Hz/s down, comm-loss time 5 s."""
    drive = PowerFlex400(plant, rpm_per_hz=60.0, max_frequency=70.0, clock=clock)
    drive.write(39, [700, 350])
    return drive


def status(drive: PowerFlex400) -> int:
    return drive.read(8448, 1)[0]


def hertz(drive: PowerFlex400) -> float:
    return drive.read(8451, 1)[0] / 100


def run_up(drive: PowerFlex400, plant: Any, reference: int = 2000) -> None:
    drive.write(8192, [START, reference])
    plant.advance(plant.t + 10.0)


def test_the_drive_ramps_up_at_its_acceleration_time(drive: PowerFlex400, plant: Any) -> None:
    drive.write(8192, [START, 2000])
    plant.advance(1.0)
    assert hertz(drive) == 10.0
    assert plant.speed == pytest.approx(10.0 * RAD_PER_HZ)
    assert status(drive) & 0x1FF == 0b1_1111  # ready, active, forward twice, accelerating
    plant.advance(1.999)
    assert not status(drive) & AT_REFERENCE
    plant.advance(2.0)
    assert hertz(drive) == 20.0
    assert status(drive) & (ACTIVE | ACCELERATING | AT_REFERENCE) == ACTIVE | AT_REFERENCE


def test_a_lower_reference_is_taken_at_the_deceleration_time(drive: PowerFlex400, plant: Any) -> None:
    run_up(drive, plant)
    drive.write(8193, [500])
    plant.advance(plant.t + 0.5)
    assert hertz(drive) == 10.0
    assert status(drive) & (ACCELERATING | DECELERATING) == DECELERATING
    assert drive.read(8450, 1) == [500]


def test_a_ramp_time_written_while_ramping_counts_at_once(drive: PowerFlex400, plant: Any) -> None:
    drive.write(8192, [START, 6000])
    plant.advance(1.0)
    drive.write(39, [350])  # 20 Hz/s
    plant.advance(2.0)
    assert hertz(drive) == 30.0


def test_a_stop_by_ramp_ends_with_the_output_off(drive: PowerFlex400, plant: Any) -> None:
    run_up(drive, plant)
    drive.write(8192, [STOP])
    plant.advance(plant.t + 0.5)
    assert (hertz(drive), status(drive) & ACTIVE) == (10.0, ACTIVE)
    plant.advance(plant.t + 0.5)
    assert (hertz(drive), status(drive) & ACTIVE) == (0.0, 0)
    assert plant.commands[-1][2] is False


def test_a_stop_by_coast_turns_the_output_off_and_leaves_the_rotor_turning(drive: PowerFlex400, plant: Any) -> None:
    run_up(drive, plant)
    drive.write(37, [1])
    drive.write(8192, [STOP])
    assert (hertz(drive), status(drive) & (ACTIVE | AT_REFERENCE)) == (0.0, 0)
    assert plant.commands[-1][2] is False
    assert plant.speed == pytest.approx(20.0 * RAD_PER_HZ)


def test_a_start_on_a_coasting_rotor_takes_it_up_from_its_speed(drive: PowerFlex400, plant: Any) -> None:
    plant.speed = 30.0 * RAD_PER_HZ
    drive.write(8192, [START, 2000])
    assert hertz(drive) == 30.0
    assert status(drive) & DECELERATING


def test_a_start_while_stopping_turns_the_ramp_round(drive: PowerFlex400, plant: Any) -> None:
    run_up(drive, plant)
    drive.write(8192, [STOP])
    plant.advance(plant.t + 0.5)
    drive.write(8192, [START])
    plant.advance(plant.t + 0.5)
    assert hertz(drive) == 15.0


def test_a_stop_outranks_a_start_in_the_same_word(drive: PowerFlex400, plant: Any) -> None:
    drive.write(8192, [START | STOP, 2000])
    assert not status(drive) & ACTIVE
    assert plant.commands == []


def test_a_second_stop_changes_nothing(drive: PowerFlex400, plant: Any) -> None:
    run_up(drive, plant)
    drive.write(37, [1])
    drive.write(8192, [STOP])
    sent = len(plant.commands)
    drive.write(8192, [STOP])
    assert len(plant.commands) == sent


def test_a_maximum_set_below_the_reference_holds(drive: PowerFlex400, plant: Any) -> None:
    run_up(drive, plant)
    drive.write(35, [1500])
    plant.advance(plant.t + 5.0)
    assert hertz(drive) == 15.0


def test_a_time_of_zero_is_the_steepest_ramp_and_no_division(drive: PowerFlex400, plant: Any) -> None:
    drive.write(39, [0])
    drive.write(8192, [START, 7000])
    plant.advance(0.01)
    assert hertz(drive) == 70.0


@pytest.mark.parametrize(("action", "faulted", "powered"), [(0, True, False), (1, False, False), (2, False, True)])
def test_a_silent_link_makes_the_drive_do_as_its_parameter_says(
    drive: PowerFlex400, plant: Any, clock: ManualClock, action: int, faulted: bool, powered: bool
) -> None:
    drive.write(105, [action])
    run_up(drive, plant)
    clock.sleep(4.9)
    drive.drive.tick()
    assert plant.commands[-1][2] is True
    clock.sleep(0.2)
    drive.drive.tick()
    assert plant.commands[-1][0::2] == (0.0, powered)
    assert drive.read(8449, 1) == [81 if faulted else 0]
    assert bool(status(drive) & FAULTED) is faulted
    assert bool(status(drive) & READY) is not faulted


def test_a_drive_told_to_go_on_ignores_a_silent_link(drive: PowerFlex400, plant: Any, clock: ManualClock) -> None:
    drive.write(105, [3])
    run_up(drive, plant)
    clock.sleep(100.0)
    drive.drive.tick()
    assert status(drive) & AT_REFERENCE


def test_every_request_keeps_the_link_alive_and_rest_needs_none(
    drive: PowerFlex400, plant: Any, clock: ManualClock
) -> None:
    clock.sleep(100.0)
    drive.drive.tick()
    assert drive.read(8449, 1) == [0]
    drive.write(106, [10])  # 1.0 s
    run_up(drive, plant)
    for _ in range(10):
        clock.sleep(0.9)
        drive.drive.tick()
        assert status(drive) & ACTIVE


@pytest.mark.parametrize("clear", [CLEAR, STOP])
def test_a_fault_keeps_the_drive_from_starting_until_it_is_cleared(
    drive: PowerFlex400, plant: Any, clock: ManualClock, clear: int
) -> None:
    run_up(drive, plant)
    clock.sleep(6.0)
    drive.drive.tick()
    drive.write(8192, [START])
    assert not status(drive) & ACTIVE
    drive.write(8192, [clear])
    assert drive.read(8449, 1) == [0]
    drive.write(8192, [START])
    assert status(drive) & ACTIVE


@pytest.mark.parametrize(
    ("address", "value"),
    [
        (8192, 1 << 2),  # jog
        (8192, 1 << 6),  # local control
        (8192, 0b10 << 4),  # reverse
        (8192, 0b10 << 8),  # acceleration time 2
        (8192, 0b100 << 12),  # preset frequency
        (8193, 7001),
        (35, 32001),
        (37, 2),
        (39, 60001),
        (40, 60001),
        (105, 4),
        (106, 0),
        (106, 601),
    ],
)
def test_a_value_out_of_range_is_refused(drive: PowerFlex400, address: int, value: int) -> None:
    with pytest.raises(ValueError):
        drive.write(address, [value])


@pytest.mark.parametrize("address", [0, 36, 41, 8194, 8447, 8448, 8449, 8450, 8451])
def test_a_register_that_cannot_be_written_is_refused(drive: PowerFlex400, address: int) -> None:
    with pytest.raises(KeyError):
        drive.write(address, [0])


def test_a_refused_write_changes_nothing(drive: PowerFlex400) -> None:
    with pytest.raises(KeyError):
        drive.write(39, [100, 100, 0])
    assert drive.read(39, 2) == [700, 350]


def test_forward_no_command_and_network_reference_are_understood(drive: PowerFlex400) -> None:
    for word in (0, 0b01 << 4, 0b11 << 4, 0b01 << 8, 0b01 << 10, 0b001 << 12, 0b011 << 12):
        drive.write(8192, [word])
        assert drive.read(8192, 1) == [word]


def test_a_rotor_the_drive_cannot_turn_so_fast_is_refused(plant: Any, clock: ManualClock) -> None:
    with pytest.raises(ConfigError, match="320 Hz"):
        PowerFlex400(plant, rpm_per_hz=10.0, max_frequency=420.0, clock=clock)
