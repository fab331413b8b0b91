"""A clock that moves only when told to."""


class ManualClock:
    """Time as a test sets it; waiting takes none."""

    def __init__(self, start: float = 0.0) -> None:
        self._now = start

    def now(self) -> float:
        """Return the time it was last set to [s]."""
        return self._now

    def sleep(self, seconds: float) -> None:
        """Move on by `seconds` at once."""
        self._now += seconds
