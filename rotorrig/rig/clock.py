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


class ManualClock:
    """A clock that moves only when told to: for tests and for replay."""

    def __init__(self, start: float = 0.0) -> None:
        self._now = start

    def now(self) -> float:
        """Return the time it was last set to [s]."""
        return self._now

    def sleep(self, seconds: float) -> None:
        """Move on by `seconds` at once."""
        self._now += seconds
