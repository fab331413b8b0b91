"""What is made of a vector of residuals, and the way down that suits it: sums of squares, or of absolute values."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.residuals.least_absolute import lower_absolute, sum_of_absolutes
from rotorrig.identify.chea.residuals.levenberg_marquardt import SEARCH, Stop, descend_squares
from rotorrig.identify.chea.residuals.point import Point, Residuals, sum_of_squares

Array = NDArray[np.float64]
Watch = Callable[[Point, Sequence[float]], Stop | None]  # of the lowest point, and the lowest values until every call


@dataclass(frozen=True, slots=True, kw_only=True)
class Descent:
    """How far a descent goes."""

    reach: float  # longest step in any parameter, of absolute values: the first one
    share: float  # of the value: it ends when a step promises less
    max_calls: int
    watch: Watch = lambda point, values: None


@dataclass(frozen=True, slots=True, kw_only=True)
class Norm:
    """The value of residuals, and a descent of it from a point."""

    value: Callable[[Array], float]
    descend: Callable[[Point, Descent], Residuals[tuple[Point, Stop]]]


def _by_squares(start: Point, how: Descent) -> Residuals[tuple[Point, Stop]]:
    end = yield from descend_squares(
        start,
        bounds=(np.zeros(len(start.p)), np.ones(len(start.p))),
        settings=replace(SEARCH, reach=how.reach),
        share=how.share,
        max_calls=how.max_calls,
        watch=lambda progress: how.watch(progress.point, progress.costs),
    )
    return end.point, end.stop


def _by_linear_programs(start: Point, how: Descent) -> Residuals[tuple[Point, Stop]]:
    return (
        yield from lower_absolute(
            start, radius=how.reach, tolerance=how.share, max_calls=how.max_calls, watch=how.watch
        )
    )


SQUARES = Norm(value=sum_of_squares, descend=_by_squares)  # by Levenberg and Marquardt
ABSOLUTES = Norm(value=sum_of_absolutes, descend=_by_linear_programs)
