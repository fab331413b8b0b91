"""`LocalSearch`: a way down from one point, handed to the engine, and the `End` it leads to."""

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.session import Evaluations, Record

Array = NDArray[np.float64]
Kind = Literal["minimum", "stuck", "abandoned", "no value"]


@dataclass(frozen=True, slots=True, kw_only=True)
class End:
    """End of a local search. Listed are minima, and where it was stuck if nothing lower is known."""

    u: Array  # (dim,) the lowest point met
    fun: float
    kind: Kind
    hessian: Array | None = None  # (dim, dim) there, of a search that goes by one


class LocalSearch(Protocol):
    """A way down: by values alone, or by residuals and their derivatives, squared or absolute."""

    def __call__(
        self, record: Record, start: Array, value: float, *, radius: float | None, wary: bool
    ) -> Evaluations[End]:
        """Descend from `start` (dim,), where the function is `value`.

        `radius` is how far the ground about the start is known to be of one basin, None: as far as the method expects.
        A wary search may end where it comes upon a known minimum.
        """
