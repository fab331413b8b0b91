"""Rotor at slow roll with instruments around its devices: what a provocation takes hold of, and what measures it."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType
from typing import Self

from rotorrig.acquisition.proof_test.turns import TurnRecord
from rotorrig.rig import Interlock, LimitExceeded
from rotorrig.rig.config import RigConfig
from rotorrig.rig.control import Command, MotorControl, Reading, StopReport
from rotorrig.rig.motor import Stop
from rotorrig.rig.probes import Block, Daq, DaqCounters, DaqInfo


class AlteredDaq:
    """A DAQ whose blocks are measured as they come, and altered before the interlock gets them."""

    def __init__(self, daq: Daq, turns: TurnRecord) -> None:
        self.alter: Callable[[Block], Block] = lambda block: block
        self._daq, self._turns = daq, turns

    @property
    def counters(self) -> DaqCounters:
        """Data received and lost."""
        return self._daq.counters

    def open(self) -> DaqInfo:
        """Open the port."""
        return self._daq.open()

    def start(self) -> None:
        """Begin to stream."""
        self._daq.start()

    def read(self, timeout: float = 1.0) -> Block:
        """Return the next block, altered. Raises LinkLost."""
        block = self._daq.read(timeout)
        self._turns.take(block)
        return self.alter(block)

    def stop(self) -> None:
        """End the stream."""
        self._daq.stop()

    def close(self) -> None:
        """Give the port back."""
        self._daq.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class WatchedControl:
    """A motor control that notes when a stop is asked of it, and gives no sign of life while it is `mute`."""

    def __init__(self, control: MotorControl, turns: TurnRecord) -> None:
        self.mute = False
        self.stopped_at = math.nan  # s of the sample clock: the first stop was decided
        self.harder: list[str] = []  # measures after it, which a drive that obeys does not need
        self._control, self._turns = control, turns

    @property
    def report(self) -> StopReport | None:
        """Progress of the last stop."""
        return self._control.report

    def start(self) -> None:
        """Start to take readings."""
        self._control.start()

    def beat(self, processed: float) -> None:
        """Give a sign of life, or none."""
        if not self.mute:
            self._control.beat(processed)

    def send(self, command: Command) -> int:
        """Queue a command."""
        return self._control.send(command)

    def read_soon(self) -> None:
        """Have the next reading taken soon."""
        self._control.read_soon()

    def take_readings(self) -> list[Reading]:
        """Return the readings since the last call. Raises what a reading has raised, or the guardian's stop."""
        try:
            return self._control.take_readings()
        except LimitExceeded:
            self._note_stop()
            raise

    def stop(self, kind: Stop) -> None:
        """Send a stop at once."""
        self._control.stop(kind)
        if kind is Stop.COAST:  # the ladder's; a sweep ends by one of the other two
            self.harder.append(kind.value)
        self._note_stop()

    def fall_silent(self, seconds: float, *, closed: bool = False) -> None:
        """Send nothing for so long, or until another stop."""
        self._control.fall_silent(seconds, closed=closed)
        if not math.isnan(self.stopped_at):
            self.harder.append("silence")

    def close(self, *, at_rest: bool = True) -> None:
        """End."""
        self._control.close(at_rest=at_rest)

    def _note_stop(self) -> None:
        self.mute = False
        if math.isnan(self.stopped_at):
            self.stopped_at = self._turns.time


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """A part of the test, with its rig in operation."""

    rig: RigConfig
    info: DaqInfo
    speed: float  # rad/s, at which protections are provoked
    control: WatchedControl
    daq: AlteredDaq
    turns: TurnRecord
    interlock: Interlock
    watchdog: float | None  # s, the drive's; None: it has none
    guardian: float | None  # s without a processed sample that the guardian allows; None: there is no guardian
