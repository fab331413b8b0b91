"""What every motor driver and every DAQ owes its user, run against the emulators over real ttys.

One simulated bench serves the whole file; its drive and DAQ are in another process and know nothing of the drivers.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from rotorrig.rig import connect
from rotorrig.rig.description import RigConfig, load
from rotorrig.rig.errors import ConfigError, LimitExceeded, LinkLost, RigError
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.motor import modbus_motor
from rotorrig.rig.motor.base import MotorDriver, Stop
from rotorrig.rig.probes import stream_daq
from rotorrig.rig.probes.base import Block, Daq, DaqInfo
from rotorrig.rig.probes.calibration import ProbeScale
from rotorrig.sims.wire.launch import BenchPorts, simulated_bench

CONFIG = Path(__file__).parents[2] / "configs" / "rk4.toml"
RPM = math.pi / 30
RAMP = 300 * RPM  # 300 rpm/s: a second or two of simulated time per test


@dataclass(frozen=True)
class Bench:
    rig: RigConfig
    ports: BenchPorts

    def motor(self) -> MotorDriver:
        return connect.motor(self.rig, port=self.ports.motor_port)

    def daq(self) -> Daq:
        return connect.daq(self.rig, port=self.ports.daq_port)


@pytest.fixture(scope="module")
def bench() -> Iterator[Bench]:
    with simulated_bench(CONFIG, seed=5) as ports:
        yield Bench(load(CONFIG), ports)


@pytest.fixture
def motor(bench: Bench) -> Iterator[MotorDriver]:
    with bench.motor() as motor:
        motor.open()
        yield motor
        motor.stop(Stop.EMERGENCY)


@pytest.fixture
def daq(bench: Bench) -> Iterator[Daq]:
    with bench.daq() as daq:
        yield daq


@dataclass
class Stream:
    """A running DAQ and what watches it."""

    daq: Daq
    info: DaqInfo
    interlock: Interlock

    def blocks(self, seconds: float) -> list[Block]:
        """Read so many seconds of the sample clock."""
        until, blocks = self.time() + seconds, []
        while self.time() < until:
            blocks.append(self.daq.read(timeout=5))
            self.interlock.check(blocks[-1])
        return blocks

    def until(self, reached: Callable[[], bool], *, seconds: float = 20.0) -> None:
        """Read until something is so, or fail after so many seconds of the sample clock."""
        deadline = self.time() + seconds
        while not reached():
            assert self.time() < deadline, f"not so after {seconds:g} s, at {self.speed() / RPM:.0f} rpm"
            self.blocks(0.02)

    def steady_at(self, rpm: float) -> None:
        """Read until the speed has been within 1 % of `rpm` for a second."""
        since = self.time()

        def long_enough() -> bool:
            nonlocal since
            if abs(self.speed() / RPM / rpm - 1) > 0.01:
                since = self.time()
            return self.time() - since > 1.0

        self.until(long_enough)

    def time(self) -> float:
        assert self.interlock.keyphasor
        return self.interlock.keyphasor.time

    def speed(self) -> float:
        assert self.interlock.keyphasor
        return self.interlock.keyphasor.steady_speed


@pytest.fixture
def stream(bench: Bench, daq: Daq) -> Iterator[Stream]:
    info = daq.open()
    daq.start()
    yield Stream(daq, info, Interlock(bench.rig, info))
    daq.stop()


def test_motor_and_daq_say_what_they_are(motor: MotorDriver, daq: Daq, bench: Bench) -> None:
    info = daq.open()
    assert info.sample_rate == 10_000
    assert info.channels == len(info.volts_per_count) == 5
    assert motor.open().model == "PowerFlex 400"
    assert bench.ports.motor_port in motor.open().link


def test_a_drive_not_yet_started_is_at_rest(motor: MotorDriver) -> None:
    motor.stop(Stop.COAST)
    state = motor.read()
    assert (state.running, state.setpoint, state.fault) == (False, 0.0, "")


def test_the_stream_is_whole_and_in_time(stream: Stream) -> None:
    blocks = stream.blocks(2.0)
    samples = 0
    for block in blocks:
        assert block.first_sample == samples
        assert block.t_ns == round(samples * 1e9 / stream.info.sample_rate)
        assert block.counts.dtype == np.int32
        assert block.counts.shape[1] == stream.info.channels
        assert not block.overrun
        samples += len(block.counts)


def test_the_probes_of_a_rotor_at_rest_see_little(bench: Bench, motor: MotorDriver, stream: Stream) -> None:
    motor.stop(Stop.EMERGENCY)
    stream.blocks(1.0)
    counts = np.concatenate([b.counts for b in stream.blocks(0.5)])
    metres = ProbeScale.of(bench.rig, stream.info).displacement(counts)
    assert np.all(np.abs(metres.mean(axis=0)) < 400e-6)  # sag, run-out and gap setting
    assert np.all(np.ptp(metres, axis=0) < 20e-6)


def test_the_rotor_goes_where_it_is_told_and_the_keyphasor_agrees(motor: MotorDriver, stream: Stream) -> None:
    motor.set_speed(900 * RPM, ramp=RAMP)
    stream.steady_at(900)
    state = motor.read()
    assert state.running
    assert state.at_setpoint
    assert state.setpoint == pytest.approx(900 * RPM, abs=0.3 * RPM)  # the reference counts 0.6 rpm
    assert state.speed == pytest.approx(900 * RPM, rel=0.01)
    stream.interlock.check_motor(state)


def test_the_ramp_is_the_one_asked_for(motor: MotorDriver, stream: Stream) -> None:
    motor.set_speed(600 * RPM, ramp=RAMP)
    stream.steady_at(600)
    motor.set_speed(1200 * RPM, ramp=60 * RPM)  # ten seconds
    crossings = []
    for rpm in (700, 1100):
        stream.until(lambda rpm=rpm: stream.speed() > rpm * RPM)
        crossings.append(stream.time())
    assert (1100 - 700) / (crossings[1] - crossings[0]) == pytest.approx(60, rel=0.05)


def test_a_coasting_rotor_is_unpowered_and_slows_down_by_itself(motor: MotorDriver, stream: Stream) -> None:
    motor.set_speed(900 * RPM, ramp=RAMP)
    stream.steady_at(900)
    motor.stop(Stop.COAST)
    assert not motor.read().running
    stream.until(lambda: stream.speed() < 880 * RPM)
    began = stream.time()
    stream.until(lambda: stream.speed() < 800 * RPM)
    assert stream.time() - began > 0.5  # the ramp takes 0.27 s, the emergency stop none


def test_stops_brake_as_asked_and_may_be_repeated(motor: MotorDriver, stream: Stream) -> None:
    for kind in (Stop.RAMP, Stop.EMERGENCY):
        motor.set_speed(900 * RPM, ramp=RAMP)
        stream.steady_at(900)
        motor.stop(kind)
        motor.stop(kind)
        stream.until(lambda: stream.speed() < 300 * RPM, seconds=8)  # ramp 2 s, and the queue; coasting takes 15 s
        stream.until(lambda: not motor.read().running)


def test_speeds_and_ramps_beyond_the_rig_are_refused_before_anything_moves(motor: MotorDriver) -> None:
    motor.stop(Stop.EMERGENCY)
    with pytest.raises(LimitExceeded, match="asked for 4300 rpm"):
        motor.set_speed(4300 * RPM, ramp=RAMP)
    with pytest.raises(ConfigError, match=r"ramp: got 0\.5 rpm/s"):
        motor.set_speed(900 * RPM, ramp=0.5 * RPM)
    assert not motor.read().running


def test_a_stream_may_be_stopped_and_started_again(daq: Daq) -> None:
    daq.open()
    for _ in range(2):
        daq.start()
        assert daq.read(timeout=5).first_sample == 0
        assert daq.read(timeout=5).first_sample > 0
        daq.stop()
        daq.stop()


@pytest.mark.parametrize("kind", ["motor", "daq"])
def test_an_open_port_is_refused_to_a_second_user(bench: Bench, kind: str) -> None:
    with getattr(bench, kind)() as first, getattr(bench, kind)() as second:
        first.open()
        with pytest.raises(LinkLost, match="in use by another program"):
            second.open()


@pytest.mark.parametrize("kind", ["motor", "daq"])
def test_closing_twice_is_closing(bench: Bench, kind: str) -> None:
    device = getattr(bench, kind)()
    device.open()
    device.close()
    device.close()
    with device:
        device.open()


def test_ports_that_were_swapped_are_said(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream_daq, "ANSWER_SECONDS", 1.0)
    monkeypatch.setattr(modbus_motor, "ANSWER_SECONDS", 0.2)
    with connect.daq(bench.rig, port=bench.ports.motor_port) as daq, pytest.raises(LinkLost, match="no DAQ answered"):
        daq.open()
    with connect.motor(bench.rig, port=bench.ports.daq_port) as motor, pytest.raises(RigError, match="asked to read"):
        motor.open()
