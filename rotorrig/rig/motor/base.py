"""What every motor controller offers, whatever bus it hangs on."""

from dataclasses import dataclass
from enum import StrEnum
from types import TracebackType
from typing import Protocol, Self


class Stop(StrEnum):
    """How to bring the rotor to rest: down the ramp, by its own friction, or as fast as the drive can."""

    RAMP = "ramp"
    COAST = "coast"
    EMERGENCY = "emergency"


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorInfo:
    """What a controller says of itself when opened."""

    model: str
    link: str  # for a person: "Modbus RTU, /dev/pts/3, 19200 baud, address 100"


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorState:
    """One reading of the controller; speed is its own belief, the keyphasor's is the truth."""

    speed: float  # rad/s
    setpoint: float  # rad/s
    running: bool
    at_setpoint: bool
    fault: str = ""  # empty: none


class MotorDriver(Protocol):
    """A motor controller's verbs. `stop` is idempotent and belongs in a `finally`."""

    def open(self) -> MotorInfo:
        """Open the link and check who answers. Raises LinkLost."""
        ...

    def read(self) -> MotorState:
        """Read the controller's state. Raises LinkLost."""
        ...

    def set_speed(self, speed: float, *, ramp: float) -> None:
        """Go to `speed` [rad/s] at `ramp` [rad/s^2], starting if at rest. Raises LinkLost, LimitExceeded."""
        ...

    def stop(self, kind: Stop) -> None:
        """Bring the rotor to rest; may be called twice. Raises LinkLost if the command was not confirmed."""
        ...

    def close(self) -> None:
        """Give the port back; may be called twice. Does not stop the rotor."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...
