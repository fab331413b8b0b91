"""Time as an argument: wall time for links, sample time for sweeps.

A sweep is paced by the DAQ's sample clock, never by this one; a `Clock` only says how long a link has been silent.
"""

import time
from typing import Protocol


class Clock(Protocol):
    """Anything that tells monotonic seconds and can wait."""

    def now(self) -> float:
        """Return monotonic time [s]."""
        ...

    def sleep(self, seconds: float) -> None:
        """Wait for `seconds`."""
        ...


class WallClock:
    """The machine's monotonic clock."""

    def now(self) -> float:
        """Return monotonic time [s]."""
        return time.monotonic()

    def sleep(self, seconds: float) -> None:
        """Wait for `seconds` of real time."""
        time.sleep(seconds)
