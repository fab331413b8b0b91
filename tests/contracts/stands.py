"""The stands that drivers are tried on: a simulated bench per controller, or a real one with `--rig CONFIG`."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from rotorrig.rig import connect
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.drive_profiles import load_profile, profile_names
from rotorrig.rig.config.sweep_plans import RunUpCoastDown
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.motor.base import MotorDriver, MotorState, Stop
from rotorrig.rig.probes.base import Block, Daq, DaqInfo
from rotorrig.sims.wire.console import Console
from rotorrig.sims.wire.launch import BenchPorts

RPM = math.pi / 30
POLL = 0.25  # s of wall time between readings of the controller, as in a sweep: its watchdog listens
_RK4 = (Path(__file__).parents[2] / "configs" / "rk4.toml").read_text()
_PLAN = """[plans.default]
kind = "run-up-coast-down"
slow_roll = "600 rpm"
slow_roll_time = "1 s"
start = "1500 rpm"
end = "1600 rpm"
ramp = "150 rpm/s"

[identify]"""


def _on_a_line(profile: str) -> str:
    ramp = '\nramp = "150 rpm/s"' if load_profile(profile).ramp_by_hand else ""
    return f'driver = "modbus-rtu"\nprofile = "{profile}"\nport = "-"{ramp}'


MOTORS = {
    **{f"{profile}-rtu": _on_a_line(profile) for profile in profile_names()},
    "powerflex400-tcp": 'driver = "modbus-tcp"\nhost = "-"',
    "acs355-tcp": 'driver = "modbus-tcp"\nprofile = "acs355"\nhost = "-"',
    "serial-line": 'driver = "serial-line"\nport = "-"',
    "canopen": 'driver = "canopen"\nchannel = "-"',
}


def config(motor: str) -> str:
    """Return the RK4's config with one of `MOTORS` and a short plan."""
    table = f'[motor]\n{MOTORS[motor]}\nmax_speed = "4200 rpm"\n\n'
    before, _, after = _RK4.partition("[motor]")
    text = before + table + "[daq]" + after.partition("[daq]")[2]
    return text[: text.index("[plans.default]")] + _PLAN + text.partition("[identify]")[2]


@dataclass(frozen=True)
class Stand:
    """A rig to drive; `ports` of a simulated one."""

    rig: RigConfig
    ports: BenchPorts | None

    def motor(self) -> MotorDriver:
        return connect.motor(self.rig, at=self.ports.motor if self.ports else None)

    def daq(self) -> Daq:
        return connect.daq(self.rig, at=self.ports.daq if self.ports else None)

    @property
    def console(self) -> Console:
        """Where faults are ordered."""
        if self.ports is None:
            pytest.skip("a real rig: faults cannot be ordered")
        return self.ports.console

    @property
    def plan(self) -> RunUpCoastDown:
        """The plan whose speeds are asked for, no others."""
        plan = next((p for p in self.rig.plans.values() if isinstance(p, RunUpCoastDown)), None)
        if plan is None:
            pytest.skip(f"{self.rig.name}: has no plan of kind run-up-coast-down")
        return plan


@dataclass
class Stream:
    """A running DAQ and what watches it; keeps a controller's watchdog content meanwhile."""

    daq: Daq
    info: DaqInfo
    interlock: Interlock
    motor: MotorDriver | None = None
    _polled: float = field(default=0.0, init=False)

    def blocks(self, seconds: float) -> list[Block]:
        """Read so many seconds of the sample clock."""
        until, blocks = self.time() + seconds, []
        while self.time() < until:
            blocks.append(self.daq.read(timeout=5))
            self.interlock.check(blocks[-1])
            if self.motor and time.monotonic() - self._polled > POLL:
                self.motor.read()
                self._polled = time.monotonic()
        return blocks

    def until(self, reached: Callable[[], bool], *, seconds: float = 20.0) -> None:
        """Read until something is so, or fail after so many seconds of the sample clock."""
        deadline = self.time() + seconds
        while not reached():
            assert self.time() < deadline, f"not so after {seconds:g} s, at {self.speed() / RPM:.0f} rpm"
            self.blocks(0.02)

    def steady_at(self, speed: float, *, seconds: float = 20.0) -> None:
        """Read until the shaft has been within 1 % of `speed` for a second."""
        since = self.time()

        def long_enough() -> bool:
            nonlocal since
            if abs(self.speed() / speed - 1) > 0.01:
                since = self.time()
            return self.time() - since > 1.0

        self.until(long_enough, seconds=seconds)

    def time(self) -> float:
        assert self.interlock.keyphasor
        return self.interlock.keyphasor.time

    def speed(self) -> float:
        assert self.interlock.keyphasor
        return float(self.interlock.keyphasor.steady_speed)


def readings(motor: MotorDriver, *, seconds: float) -> list[MotorState]:
    """Read the controller for so long."""
    until, states = time.monotonic() + seconds, []
    while time.monotonic() < until:
        states.append(motor.read())
        time.sleep(0.05)
    return states


def at_rest(motor: MotorDriver) -> None:
    """Stop the rotor and wait until the controller says that it has."""
    motor.stop(Stop.EMERGENCY)
    until = time.monotonic() + 60
    while motor.read().running:
        assert time.monotonic() < until, "the controller does not come to rest"
        time.sleep(0.05)


def cleared(motor: MotorDriver) -> None:
    """Clear the trip that a drive may remember."""
    if motor.read().fault:
        motor.clear_fault()
