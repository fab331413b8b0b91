"""The ACS355's behaviour, user's manual pages 312-319, on a rotor that follows exactly; 4xxxx is sent as xxxx - 1."""

import math
from typing import Any

import pytest

from rotorrig.rig.errors import ConfigError
from rotorrig.sims.wire.motors.acs355 import Acs355
from tests.manual_clock import ManualClock

# ABB drives profile: ready to switch on, ready to operate, operation enabled; OFF1, OFF2, OFF3 are bits 0, 1, 2 at 0
ON, READY, RUN, RESET = 0x476, 0x477, 0x47F, 0x4F6
OFF1, OFF2, OFF3 = 0x47E, 0x47D, 0x47B
RDY_ON, RDY_RUN, RDY_REF, TRIPPED, OFF2_STA, OFF3_STA, INHIBITED, AT_SETPOINT, REMOTE = (
    1 << bit for bit in (0, 1, 2, 3, 4, 5, 6, 8, 9)
)
RAD_PER_HZ = 2 * math.pi  # two poles: 60 rpm per Hz


@pytest.fixture
def drive(plant: Any, clock: ManualClock) -> Acs355:
    """REF1 MAX and maximum frequency 70 Hz, 10 Hz/s up and 20 Hz/s down."""
    drive = Acs355(plant, rpm_per_hz=60.0, max_frequency=70.0, clock=clock)
    write(drive, 2202, 70, 35)
    return drive


def write(drive: Acs355, number: int, *values: int) -> None:
    drive.write(number - 1, list(values))


def read(drive: Acs355, number: int) -> int:
    return drive.read(number - 1, 1)[0]


def command(drive: Acs355, *words: int) -> None:
    for word in words:
        write(drive, 1, word)


def run_up(drive: Acs355, plant: Any) -> None:
    write(drive, 2, 10_000)  # half of REF1 MAX
    command(drive, ON, READY, RUN)
    plant.advance(plant.t + 10.0)


def test_the_states_are_gone_through_in_order(drive: Acs355) -> None:
    assert read(drive, 4) == INHIBITED | REMOTE  # OFF2 and OFF3 are active while the control word is 0
    command(drive, RUN)
    assert read(drive, 4) & (INHIBITED | RDY_REF) == INHIBITED  # not from there
    command(drive, ON)
    assert read(drive, 4) == RDY_ON | OFF2_STA | OFF3_STA | REMOTE
    command(drive, READY)
    assert read(drive, 4) == RDY_ON | RDY_RUN | OFF2_STA | OFF3_STA | REMOTE
    command(drive, RUN)
    assert read(drive, 4) & (RDY_ON | RDY_RUN | RDY_REF) == RDY_ON | RDY_RUN | RDY_REF


def test_twenty_thousand_are_ref1_max_and_the_ramp_its_time_to_the_maximum(drive: Acs355, plant: Any) -> None:
    write(drive, 2, 10_000)
    command(drive, ON, READY, RUN)
    plant.advance(1.0)
    assert read(drive, 5) == 100  # actual value 1, 10.0 Hz
    assert not read(drive, 4) & AT_SETPOINT
    plant.advance(3.5)
    assert plant.speed == pytest.approx(35.0 * RAD_PER_HZ)
    assert read(drive, 4) & AT_SETPOINT


def test_the_maximum_frequency_limits_a_higher_reference(drive: Acs355, plant: Any) -> None:
    write(drive, 1105, 1400)  # 140 Hz
    run_up(drive, plant)
    assert read(drive, 5) == 700
    write(drive, 2, 20_000)
    plant.advance(plant.t + 10.0)
    assert read(drive, 5) == 700


@pytest.mark.parametrize(("word", "tenths", "powered"), [(OFF1, 250, True), (OFF2, 0, False), (OFF3, 0, False)])
def test_off1_ramps_off2_coasts_and_off3_hurries(
    drive: Acs355, plant: Any, word: int, tenths: int, powered: bool
) -> None:
    run_up(drive, plant)
    command(drive, word)
    plant.advance(plant.t + 0.5)  # OFF3: 1.0 s from 70 Hz, so half a second from 35 Hz
    assert read(drive, 5) == tenths
    assert not read(drive, 4) & RDY_REF
    assert plant.commands[-1][2] is powered
    assert bool(read(drive, 4) & INHIBITED) is (word != OFF1)
    if word == OFF2:
        assert plant.speed > 30 * RAD_PER_HZ


def test_a_start_after_off3_goes_through_the_states(drive: Acs355, plant: Any) -> None:
    run_up(drive, plant)
    command(drive, OFF3)
    command(drive, RUN)
    assert not read(drive, 4) & RDY_REF
    command(drive, ON, READY, RUN)
    assert read(drive, 4) & RDY_REF


def test_a_word_without_remote_command_does_nothing(drive: Acs355, plant: Any) -> None:
    run_up(drive, plant)
    command(drive, 0)
    plant.advance(plant.t + 1.0)
    assert plant.speed == pytest.approx(35.0 * RAD_PER_HZ)


def test_inhibited_operation_is_no_power(drive: Acs355, plant: Any) -> None:
    run_up(drive, plant)
    command(drive, READY)  # bit 3 at 0
    assert plant.commands[-1][2] is False
    assert read(drive, 4) & (RDY_RUN | RDY_REF) == RDY_RUN


@pytest.mark.parametrize(("function", "tripped"), [(0, False), (1, True), (3, False)])
def test_a_silent_master_is_fault_28_where_3018_says_so(
    drive: Acs355, plant: Any, clock: ManualClock, function: int, tripped: bool
) -> None:
    write(drive, 3018, function, 20)  # 2.0 s
    run_up(drive, plant)
    clock.sleep(1.9)
    drive.drive.tick()
    assert plant.commands[-1][2] is True
    clock.sleep(0.2)
    drive.drive.tick()
    assert plant.commands[-1][2] is not tripped
    assert bool(read(drive, 4) & TRIPPED) is tripped
    assert read(drive, 401) == (28 if tripped else 0)


def test_a_fault_is_reset_by_the_edge_of_bit_7_and_remembered(drive: Acs355, plant: Any) -> None:
    run_up(drive, plant)
    drive.drive.trip(2)
    assert read(drive, 4) & (TRIPPED | INHIBITED | RDY_REF) == TRIPPED | INHIBITED
    command(drive, ON, READY, RUN)
    assert not drive.drive.active
    command(drive, ON, RESET, ON)
    assert not read(drive, 4) & TRIPPED
    assert read(drive, 401) == 2
    command(drive, READY, RUN)
    assert drive.drive.active


def test_actual_values_are_the_signals_they_are_mapped_to(drive: Acs355, plant: Any) -> None:
    write(drive, 5310, 0, 103)
    run_up(drive, plant)
    assert drive.read(4, 2) == [0, 350]


@pytest.mark.parametrize(
    ("number", "value"),
    [(1, 0x40F), (1, RUN | 1 << 11), (2, 0x8000), (1105, 5001), (2202, 18_001), (3018, 2), (3018, 4), (3019, 601)],
)
def test_a_value_out_of_range_is_refused(drive: Acs355, number: int, value: int) -> None:
    with pytest.raises(ValueError):
        write(drive, number, value)


@pytest.mark.parametrize("number", [4, 5, 12, 401, 2201, 9999])
def test_a_register_that_cannot_be_written_is_refused(drive: Acs355, number: int) -> None:
    with pytest.raises(KeyError):
        write(drive, number, 0)


def test_a_rotor_the_drive_cannot_turn_so_fast_is_refused(plant: Any, clock: ManualClock) -> None:
    with pytest.raises(ConfigError, match="500 Hz"):
        Acs355(plant, rpm_per_hz=5.0, max_frequency=840.0, clock=clock)
