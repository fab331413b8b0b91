"""Motor control during a sweep: commands, readings and stops; the loop that watches samples never waits for a wire.

`ThreadedControl` does it on threads of its own, `GuardedControl` in another process, `DirectControl` in the caller's
thread.
"""

import math
from dataclasses import dataclass, replace
from typing import Protocol, Self

from rotorrig.rig.motor import MotorDriver, MotorState, Stop

READ_EVERY = 0.25  # s between readings
READ_SOON = 0.05  # s, while the drive's word is all that is missing
LOOP_STALL = 3.0  # s without a sign of life after which the loop is taken to hang; a silent DAQ is waited for 2 s
STOP_RETRY = 0.2  # s between tries


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """One reading of the controller."""

    state: MotorState
    commands_done: int  # commands carried out before it


@dataclass(frozen=True, slots=True, kw_only=True)
class StopReport:
    """Progress of a stop; times on the control's clock [s], NaN: not yet."""

    kind: Stop
    handed: float = math.nan  # when the driver was first called
    confirmed: float = math.nan  # when the drive had obeyed
    tries: int = 0
    trouble: str = ""  # why the last try failed

    def after_try(self, trouble: str, now: float) -> Self:
        """Return the report after one more try, which failed by `trouble`, or succeeded if that is empty."""
        return replace(self, tries=self.tries + 1, trouble=trouble, confirmed=math.nan if trouble else now)


@dataclass(frozen=True, slots=True, kw_only=True)
class SetSpeed:
    """Command to go to a speed [rad/s] at a ramp [rad/s^2]."""

    speed: float
    ramp: float

    def __call__(self, motor: MotorDriver) -> None:
        """Send it."""
        motor.set_speed(self.speed, ramp=self.ramp)


@dataclass(frozen=True, slots=True, kw_only=True)
class StopForNow:
    """Command to stop as a step of the plan: the drive may be started again."""

    kind: Stop

    def __call__(self, motor: MotorDriver) -> None:
        """Send it."""
        motor.stop(self.kind)


Command = SetSpeed | StopForNow


class MotorControl(Protocol):
    """Motor controller as the session sees it. Nothing but `close` waits."""

    @property
    def report(self) -> StopReport | None:
        """Progress of the last stop; None: there was none."""
        ...

    def start(self) -> None:
        """Start to take readings."""
        ...

    def beat(self, processed: float) -> None:
        """Give a sign of life, with the sample time [s] up to which the loop has processed the samples."""
        ...

    def send(self, command: Command) -> int:
        """Queue a command, to be carried out unless a stop comes first; return its number, counted from 1."""
        ...

    def read_soon(self) -> None:
        """Have the next reading taken soon."""
        ...

    def take_readings(self) -> list[Reading]:
        """Return the readings since the last call. Raises what a reading or command raised, once, until a stop."""
        ...

    def stop(self, kind: Stop) -> None:
        """Send a stop at once; commands after it are refused. What goes wrong is tried again, see `report`.

        May be called from a signal handler, and again with another kind, which then stands instead.
        """
        ...

    def fall_silent(self, seconds: float, *, closed: bool = False) -> None:
        """Send nothing for so long, or until another stop: a drive that obeys nothing else has its watchdog left.

        With `closed` the link is closed too, as if its cable were pulled; the next stop opens it again.
        """
        ...

    def close(self, *, at_rest: bool = True) -> None:
        """End; may be called twice. Does not stop the rotor. `at_rest` False: it may turn, who can goes on stopping."""
        ...
