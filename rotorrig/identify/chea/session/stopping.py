"""Where a search is to end, and why it ended."""

from enum import StrEnum
from typing import Literal

#: "natural": once nothing lower is to be expected; "budget": never by itself; "all": once no further global minimum is
Stop = Literal["natural", "budget", "all"]


class StopReason(StrEnum):
    """Why a search ended; `status` of the result is the position in this list."""

    CONVERGED = "converged"  # the natural end: nothing is left that the search would look into
    TARGET = "target reached"
    BUDGET = "evaluation budget used up"
    STALLED = "stalled"  # ended by itself with clusters still unresolved
    CALLBACK = "stopped by the callback"
    INTERRUPTED = "interrupted"
    NO_FINITE_VALUE = "no finite value"  # fun failed at every point of the first sample
    UNFINISHED = "unfinished"  # an ask/tell search asked for its result on the way

    @property
    def status(self) -> int:
        """The integer scipy's users look for; 0 is the ordinary end."""
        return list(StopReason).index(self)
