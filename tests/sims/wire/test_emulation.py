"""The drive in front of the simulated rig itself: what it believes is what the rotor does, within lag and hunting."""

import math
import time
from pathlib import Path
from typing import Any

import pytest
import serial

from rotorrig.rig.config.description import load
from rotorrig.sims.plant.draw import draw
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.wire.motors.powerflex400 import PowerFlex400
from tests.manual_clock import ManualClock

CONFIG = Path(__file__).parents[3] / "configs" / "rk4.toml"


@pytest.fixture(scope="module")
def rotor() -> Plant:
    rig = load(CONFIG)
    return Plant(rig, draw(rig, seed=1))


def test_the_simulated_rotor_goes_where_the_drive_believes_it_is(rotor: Plant, clock: ManualClock) -> None:
    drive = PowerFlex400(rotor, rpm_per_hz=60.0, max_frequency=70.0, clock=clock)

    def believed() -> float:
        return drive.read(8451, 1)[0] / 100 * 2 * math.pi

    drive.write(39, [1400, 700])  # 5 Hz/s up, 10 Hz/s down
    drive.write(8192, [0b10, 1500])
    rotor.advance(rotor.t + 2.0)
    assert believed() == pytest.approx(10 * 2 * math.pi)
    assert rotor.speed == pytest.approx(believed(), rel=0.04)  # 50 ms behind
    rotor.advance(rotor.t + 2.0)
    assert rotor.speed == pytest.approx(believed(), rel=0.005)

    drive.write(37, [1])
    drive.write(8192, [0b01])
    rotor.advance(rotor.t + 2.0)
    coasted = rotor.speed
    assert 0.3 < coasted / (15 * 2 * math.pi) < 0.99

    drive.write(8192, [0b10])
    assert believed() == pytest.approx(coasted, abs=0.05)
    rotor.advance(rotor.t + 3.0)
    assert rotor.speed == pytest.approx(15 * 2 * math.pi, rel=0.005)

    drive.write(37, [0])
    drive.write(8192, [0b01])
    rotor.advance(rotor.t + 2.5)
    assert believed() == 0.0
    assert rotor.speed < 0.05 * 15 * 2 * math.pi


def test_time_waits_half_a_second_for_a_reader_and_loses_it_nothing(emulating: Any, plant: Any) -> None:
    with emulating(rate=20.0) as (_, port), serial.Serial(port, timeout=2.0) as daq:
        daq.write(b"START\n")
        time.sleep(0.3)
        held = plant.t
        assert held < 2.5  # what the line holds of 9 bytes a scan, at 1000 Hz
        time.sleep(0.7)
        assert plant.t > held + 1.0
        first_scans, flags = [], set()
        while len(first_scans) < 300:
            head = daq.read(6 + 15)  # docs/daq-stream.md: sync, type, flags, length; sequence, index, scans, channels
            assert head[:3] == b"\xa5\x5a\x02"
            flags.add(head[3])
            first_scans.append(int.from_bytes(head[10:18], "little"))
            daq.read(int.from_bytes(head[4:6], "little") - 15 + 4)
    assert first_scans == list(range(0, 6000, 20))
    assert flags == {0}
