"""Several parts of a search side by side: one batch of points per round instead of one per part."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.session import Evaluations

Array = NDArray[np.float64]
T = TypeVar("T")


def in_lockstep(parts: Sequence[Evaluations[T]]) -> Evaluations[list[T]]:
    """Advance all `parts` together; return their findings in order. A vectorised objective then has whole batches."""
    found: dict[int, T] = {}
    values: dict[int, Array | None] = dict.fromkeys(range(len(parts)))  # to be sent next; None begins a part
    while True:
        points: dict[int, Array] = {}
        for i, some in values.items():
            try:
                points[i] = next(parts[i]) if some is None else parts[i].send(some)
            except StopIteration as end:
                found[i] = end.value
        if not points:
            return [found[i] for i in range(len(parts))]
        joined = yield np.concatenate(list(points.values()))
        ends = np.cumsum([len(some) for some in points.values()])
        values = dict(zip(points, np.split(joined, ends[:-1]), strict=True))
