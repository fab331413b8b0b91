"""Why a search ends, as a value, and the one exception that carries it out of whatever is running."""

from enum import StrEnum


class StopReason(StrEnum):
    """Why a search ended; `status` of the result is the position in this list."""

    CONVERGED = "converged"  # every cluster holds one minimum and the far search is through
    TARGET = "target reached"
    BUDGET = "evaluation budget used up"
    STALLED = "stalled"  # a cluster still held several minima when its box had been reduced max_levels times
    CALLBACK = "stopped by the callback"
    INTERRUPTED = "interrupted"
    NO_FINITE_VALUE = "no finite value"  # fun failed at every point of the first generation

    @property
    def status(self) -> int:
        """The integer scipy's users look for; 0 is the ordinary end."""
        return list(StopReason).index(self)


class Halt(Exception):
    """Ends a search from within an evaluation or a report, through scipy's SLSQP if need be; `chea` catches it."""

    def __init__(self, reason: StopReason) -> None:
        super().__init__(reason.value)
        self.reason = reason
