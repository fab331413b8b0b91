"""The VFD-ED's few words, hexadecimal as in its manual, on a rotor that follows exactly."""

import math
from typing import Any

import pytest

from rotorrig.rig.errors import ConfigError
from rotorrig.sims.wire.motors.vfd_ed import VfdEd
from tests.manual_clock import ManualClock

STOP, RUN, FORWARD, REVERSE = 0b01, 0b10, 0b01 << 4, 0b10 << 4
RAD_PER_HZ = 2 * math.pi  # two poles: 60 rpm per Hz


@pytest.fixture
def drive(plant: Any, clock: ManualClock) -> VfdEd:
    """70 Hz at most, 10 Hz/s both ways, a time-out of 2 s."""
    return VfdEd(plant, rpm_per_hz=60.0, max_frequency=70.0, ramp=10 * RAD_PER_HZ, time_out=2.0, clock=clock)


def test_it_runs_to_its_frequency_and_stops_down_its_own_ramp(drive: VfdEd, plant: Any) -> None:
    drive.write(0x2001, [2000])
    drive.write(0x2000, [RUN | FORWARD])
    plant.advance(1.0)
    assert drive.read(0x2100, 4) == [0, 0, 2000, 1000]
    assert drive.read(0x2119, 1) == [0x503]  # runs forward, commanded by communication
    plant.advance(2.0)
    assert plant.speed == pytest.approx(20.0 * RAD_PER_HZ)
    drive.write(0x2000, [STOP])
    plant.advance(3.0)
    assert drive.read(0x2103, 1) == [1000]
    assert drive.read(0x2119, 1) == [0x501]  # is stopping
    plant.advance(4.0)
    assert drive.read(0x2103, 1) == [0]
    assert drive.read(0x2119, 1) == [0x500]
    assert plant.commands[-1][2] is False


def test_command_and_frequency_may_come_in_one_frame(drive: VfdEd, plant: Any) -> None:
    drive.write(0x2000, [RUN | FORWARD, 2000])
    plant.advance(5.0)
    assert plant.speed == pytest.approx(20.0 * RAD_PER_HZ)


def test_its_output_goes_off_when_its_master_is_silent_for_longer_than_set(
    drive: VfdEd, plant: Any, clock: ManualClock
) -> None:
    drive.write(0x2000, [RUN | FORWARD, 2000])
    plant.advance(5.0)
    clock.sleep(1.9)
    assert drive.read(0x2103, 1) == [2000]
    clock.sleep(2.1)
    drive.drive.tick()
    assert drive.read(0x2103, 1) == [0]
    assert plant.commands[-1][2] is False


def test_a_fault_shows_its_code_and_stays(drive: VfdEd) -> None:
    drive.drive.trip(7)
    drive.write(0x2000, [RUN | FORWARD, 2000])
    assert drive.read(0x2100, 4) == [7, 0, 2000, 0]


@pytest.mark.parametrize(
    ("address", "value"), [(0x2000, RUN | REVERSE), (0x2000, 0b11), (0x2000, RUN | 0b11 << 4), (0x2001, 7001)]
)
def test_what_it_is_not_set_up_for_is_refused(drive: VfdEd, plant: Any, address: int, value: int) -> None:
    with pytest.raises(ValueError):
        drive.write(address, [value])
    assert plant.commands == []


@pytest.mark.parametrize("address", [0x0100, 0x2002, 0x2100, 0x2103])
def test_a_register_that_cannot_be_written_is_refused(drive: VfdEd, address: int) -> None:
    with pytest.raises(KeyError):
        drive.write(address, [0])


def test_a_rotor_the_drive_cannot_turn_so_fast_is_refused(plant: Any, clock: ManualClock) -> None:
    with pytest.raises(ConfigError, match="400 Hz"):
        VfdEd(plant, rpm_per_hz=5.0, max_frequency=840.0, ramp=1.0, time_out=2.0, clock=clock)
