"""What the drives scripted from their manuals say of themselves, as the profiles read it."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from rotorrig.rig.motor.modbus_frames import decode_state
from tests.peers.drives import FAMILIES
from tests.peers.inverter import Inverter
from tests.peers.journal import Journal
from tests.rig.motor.test_profiles import profile_of


@pytest.fixture
def inverter(tmp_path: Path) -> Iterator[Inverter]:
    journal = Journal(tmp_path / "journal.jsonl")
    yield Inverter(journal, clock=lambda: 0.0)
    journal.close()


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("backward", [False, True])
def test_a_drive_that_turns_backward_is_read_as_one(name: str, backward: bool, inverter: Inverter) -> None:
    drive, profile = FAMILIES[name](inverter), profile_of(name)
    values = dict(drive.initial)
    drive.refresh(values)  # takes the ramp times
    inverter.switches.backward = backward
    for setting in profile.settings:
        assert drive.write(setting.register, setting.word, values) is None
        values[setting.register] = setting.word
    for at in (False, True):  # at rest a drive has no sense
        drive.refresh(values)
        reading = decode_state([values[register] for register in profile.state_registers], profile=profile)
        assert reading.reverse is (at and backward)
        inverter.run(600.0)
        inverter.advance(1.0)


def test_a_vfd_ed_says_that_it_runs_stops_and_is_off(inverter: Inverter) -> None:
    drive, profile = FAMILIES["vfd-ed"](inverter), profile_of("vfd-ed")
    values = dict(drive.initial)

    def read() -> str:
        drive.refresh(values)
        return str(decode_state([values[register] for register in profile.state_registers], profile=profile))

    assert read() == "at rest"
    values[0x2001] = 1000
    drive.write(0x2000, 0x12, values)
    assert read() == "running"
    inverter.advance(2.0)
    assert read() == "running, at reference"
    drive.write(0x2000, 0x01, values)
    inverter.advance(0.5)
    assert read() == "decelerating"
    inverter.advance(5.0)
    assert read() == "at rest"
