"""Drives one part of a search by hand: gives it the values it asks for."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from rotorrig.identify.chea.session.record import Evaluations, Record

T = TypeVar("T")


def drive(part: Evaluations[T], fun: Callable[[np.ndarray], np.ndarray], record: Record) -> T:
    """Return the finding of `part`, after calls of `fun`, points (n, dim) -> values (n,), kept in `record`."""
    try:
        points = next(part)
        while True:
            values = np.asarray(fun(points), dtype=np.float64)
            record.add(points, values)
            points = part.send(np.where(np.isfinite(values), values, np.inf))
    except StopIteration as end:
        return end.value
