"""Interface of every motor controller: its verbs, its state, the kinds of stop."""

from dataclasses import dataclass
from enum import StrEnum
from types import TracebackType
from typing import Protocol, Self

REMEDY = "see to its cause, then clear it: `rotor check CONFIG --clear-fault`"  # for a drive that has tripped


class Stop(StrEnum):
    """Kind of stop: down the ramp, by friction alone, or as fast as the drive can."""

    RAMP = "ramp"
    COAST = "coast"
    EMERGENCY = "emergency"


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorInfo:
    """Identity and abilities of a controller, read when it is opened."""

    model: str
    link: str  # for a person: "Modbus RTU, /dev/pts/3, 19200 baud, address 100"
    watchdog: float | None = None  # s of silence after which it stops the rotor by itself; None: it never does
    coasts: bool = True  # whether it can be told to; else a coast stop goes down the ramp
    one_ramp: bool = False  # whether it keeps the ramp it has while it turns
    remarks: tuple[str, ...] = ()  # what a user should know of it: "cannot be told to coast, it stops down its ramp"


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorState:
    """One reading of the controller; speed is its own belief, the keyphasor's is the truth."""

    speed: float  # rad/s, never negative
    setpoint: float  # rad/s
    running: bool
    at_setpoint: bool
    fault: str = ""  # empty: none
    reverse: bool = False  # it reports that it turns backward; False also where it cannot tell


class MotorDriver(Protocol):
    """A motor controller's verbs. `stop` is idempotent and belongs in a `finally`.

    They may be called from several threads: a poller reads while another thread stops the rotor.
    """

    def open(self) -> MotorInfo:
        """Open the link, check who answers, set its watchdog; may be called again after a loss. Raises LinkLost."""
        ...

    def read(self) -> MotorState:
        """Read the controller's state. Raises LinkLost."""
        ...

    def set_speed(self, speed: float, *, ramp: float) -> None:
        """Go to `speed` [rad/s] at `ramp` [rad/s^2], starting if at rest. Raises LinkLost, LimitExceeded."""
        ...

    def stop(self, kind: Stop) -> None:
        """Bring the rotor to rest; may be called twice. The command goes out first, what makes it faster after it.

        Raises LinkLost if it was not confirmed.
        """
        ...

    def clear_fault(self) -> None:
        """Clear a fault the controller remembers. Raises LinkLost, LimitExceeded if its cause is still there."""
        ...

    def close(self) -> None:
        """Give the port back; may be called twice. Does not stop the rotor."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...
