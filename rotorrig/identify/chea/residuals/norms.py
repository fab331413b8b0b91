"""What is made of a vector of residuals, and the way down that suits it: sums of squares, or of absolute values."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.residuals.least_absolute import lower_absolute, sum_of_absolutes
from rotorrig.identify.chea.residuals.levenberg_marquardt import SEARCH, Stop, descend_squares
from rotorrig.identify.chea.residuals.point import Point, Residuals, sum_of_squares

Array = NDArray[np.float64]
Watch = Callable[[Point, Sequence[float]], Stop | None]  # of the lowest point, and the lowest values until every call


class Descent(Protocol):
    """A way down from a point."""

    def __call__(
        self, start: Point, *, reach: float, share: float, max_calls: int, watch: Watch
    ) -> Residuals[tuple[Point, Stop]]:
        """Descend by steps of `reach` in any parameter, the first one at least, until one promises a `share` less."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Norm:
    """The value of residuals, and a way down to where it is least."""

    value: Callable[[Array], float]
    descend: Descent


def _by_squares(
    start: Point, *, reach: float, share: float, max_calls: int, watch: Watch
) -> Residuals[tuple[Point, Stop]]:
    end = yield from descend_squares(
        start,
        bounds=(np.zeros(len(start.p)), np.ones(len(start.p))),
        settings=replace(SEARCH, reach=reach),
        share=share,
        max_calls=max_calls,
        watch=lambda progress: watch(progress.point, progress.costs),
    )
    return end.point, end.stop


SQUARES = Norm(value=sum_of_squares, descend=_by_squares)  # by Levenberg and Marquardt
ABSOLUTES = Norm(value=sum_of_absolutes, descend=lower_absolute)  # by linear programs
