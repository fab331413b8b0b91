"""Time as an argument: wall time for links, sample time for sweeps.

A sweep is paced by the DAQ's sample clock, never by this one; a `Clock` only says how long a link has been silent.
"""

import time
from typing import Protocol

_SLEEPLESS: int | None = getattr(time, "CLOCK_BOOTTIME", None)  # CLOCK_MONOTONIC stands still in suspend on Linux


class Clock(Protocol):
    """Anything that tells monotonic seconds and can wait."""

    def now(self) -> float:
        """Return monotonic time [s]."""
        ...

    def sleep(self, seconds: float) -> None:
        """Wait for `seconds`."""
        ...


class WallClock:
    """The machine's monotonic clock; time passes while the machine sleeps, where the system can tell (Linux)."""

    def now(self) -> float:
        """Return monotonic time [s]."""
        return time.monotonic() if _SLEEPLESS is None else time.clock_gettime(_SLEEPLESS)

    def sleep(self, seconds: float) -> None:
        """Wait for `seconds` of real time."""
        time.sleep(seconds)
