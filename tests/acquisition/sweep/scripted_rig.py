"""A shaft, a drive and a DAQ as small state machines, with a script of what shall go wrong and when."""

import math
from collections.abc import Callable
from types import TracebackType
from typing import Self

import numpy as np

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.motor.base import MotorInfo, MotorState, Stop
from rotorrig.rig.probes.base import Block, DaqCounters, DaqInfo
from tests.manual_clock import ManualClock

SCANS = 200


class Shaft:
    """Follows its setpoint at the ramp rate; without power it slows down at 40 rad/s^2.

    `factor` is its speed over the drive's: 2 where the config has twice the motor's pole pairs. `steepest` [rad/s^2] is
    the steepest ramp the drive has; `angle` [rad] is where the shaft stands before the start, `speed` what it has then.
    """

    def __init__(
        self,
        *,
        slip: float = 0.0,
        stuck_at: float = math.inf,
        factor: float = 1.0,
        steepest: float = math.inf,
        angle: float = 0.0,
        speed: float = 0.0,
    ) -> None:
        self.speed, self.angle, self.factor = speed, angle, factor
        self.setpoint, self.ramp, self.powered = 0.0, 1.0, False
        self.held: float | None = None  # a script's: the speed it has, whatever is asked for
        self._slip, self._stuck_at, self._steepest = slip, stuck_at, steepest

    def advance(self, dt: float) -> float:
        """Move on by dt [s] and return the angle turned through [rad]."""
        goal = min(self.factor * self.setpoint * (1 - self._slip), self._stuck_at) if self.powered else 0.0
        step = (self.factor * min(self.ramp, self._steepest) if self.powered else 40.0) * dt
        before = self.speed
        self.speed += min(max(goal - self.speed, -step), step)
        if self.powered and self.held is not None:
            self.speed = self.held
        turned = (before + self.speed) / 2 * dt
        self.angle += turned
        return turned


class ScriptedMotor:
    """A drive in front of `Shaft`; `on_read` and `on_stop` may raise, `obeys` are the stops it acts on."""

    def __init__(self, shaft: Shaft) -> None:
        self.commands: list[tuple[object, ...]] = []
        self.on_read: Callable[[MotorState], MotorState] = lambda state: state
        self.on_stop: Callable[[Stop], None] = lambda kind: None
        self.obeys = set(Stop)
        self.opened = 0
        self._shaft = shaft

    def open(self) -> MotorInfo:
        self.opened += 1
        return MotorInfo(model="scripted", link="none")

    def read(self) -> MotorState:
        shaft = self._shaft
        return self.on_read(
            MotorState(
                speed=shaft.speed / shaft.factor,
                setpoint=shaft.setpoint,
                running=shaft.powered,
                at_setpoint=shaft.powered and shaft.speed >= shaft.factor * shaft.setpoint * 0.94,
            )
        )

    def set_speed(self, speed: float, *, ramp: float) -> None:
        self.commands.append(("set", speed, ramp))
        self._shaft.setpoint, self._shaft.ramp, self._shaft.powered = speed, ramp, True

    def stop(self, kind: Stop) -> None:
        self.commands.append(("stop", kind))
        self.on_stop(kind)
        if kind in self.obeys:
            self._shaft.powered = False

    def close(self) -> None: ...

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


class ScriptedDaq:
    """Samples the shaft, 20 ms at a time, and moves the clock; `on_block` may change a block or raise."""

    def __init__(self, rig: RigConfig, info: DaqInfo, shaft: Shaft, clock: ManualClock) -> None:
        self.vibration: Callable[[float], float] = lambda speed: 50e-6  # m, 0-peak
        self.on_block: Callable[[Block], Block] = lambda block: block
        self.sense = 1.0  # of the shaft's rotation: -1 from y to x
        self.streaming = False
        self.counters = DaqCounters()
        self._rig, self._info, self._shaft, self._clock = rig, info, shaft, clock
        self._first = 0
        self._noise = np.random.default_rng(1)  # 2 mV, of every real chain: samples that never differ are no samples

    def open(self) -> DaqInfo:
        return self._info

    def start(self) -> None:
        self.streaming, self._first = True, 0

    def read(self, timeout: float = 1.0) -> Block:
        assert self.streaming
        dt = SCANS / self._info.sample_rate
        before = self._shaft.angle
        angle = before + np.arange(SCANS) / SCANS * self._shaft.advance(dt)
        self._clock.sleep(dt)
        block = Block(
            counts=np.round(self._volts(angle) / np.array(self._info.volts_per_count)).astype(np.int32),
            first_sample=self._first,
            t_ns=round(self._first * 1e9 / self._info.sample_rate),
        )
        self._first += SCANS
        return self.on_block(block)

    def _volts(self, angle: np.ndarray) -> np.ndarray:
        volts = np.zeros((SCANS, self._info.channels))
        amplitude = self.vibration(self._shaft.speed)
        for probe in self._rig.probes:
            wave = amplitude * np.cos(angle - self.sense * probe.angle)
            volts[:, probe.channel] = probe.gap_voltage + probe.sensitivity * wave + self._noise.normal(0, 2e-3, SCANS)
        assert self._rig.keyphasor
        volts[:, self._rig.keyphasor.channel] = -2.0 - 8.0 * notch(angle)
        return volts

    def stop(self) -> None:
        self.streaming = False

    def close(self) -> None:
        self.stop()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def notch(angle: np.ndarray) -> np.ndarray:
    """A notch from 0 to 0.6 rad, 0 outside and 1 within, its edges 0.2 rad wide and centred: it begins at angle 0."""
    turn = (angle + math.pi) % (2 * math.pi) - math.pi
    return np.clip((turn + 0.1) / 0.2, 0, 1) - np.clip((turn - 0.5) / 0.2, 0, 1)
