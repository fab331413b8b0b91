"""`SearchState`: a search as plain data, to be pickled and gone on with."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.session.scaling import Scaling
from rotorrig.identify.chea.session.stopping import Stop

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class SearchState:
    """Start of a search and every value it was told: told again, they lead to the same place.

    Eight bytes per evaluation: the points follow from the rest, and only their checksum is kept, so that a version of
    the algorithm that would have asked for others is noticed.
    """

    scaling: Scaling
    profile: str
    settings: Any  # None: the profile's own
    local: str | None = None  # the local search; None: the profile's own
    stop: Stop = "natural"  # where it is to end
    seed: tuple[int, ...]  # of the search's generator
    values: Array = field(default_factory=lambda: np.empty(0))  # (nfev,) in the order told; +inf where there was none
    checksum: int = 0  # of the points they belong to
    failure: str = ""  # why fun failed at first

    def __repr__(self) -> str:
        """Return a line: a printed result should not list every value."""
        return f"SearchState(profile={self.profile!r}, dim={self.scaling.dim}, nfev={len(self.values)})"
