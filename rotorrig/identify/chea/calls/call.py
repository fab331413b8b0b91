"""One call of the objective: its values, or why there are none."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Objective = Callable[[Array], Any]


class Outcome(NamedTuple):
    """Outcome of a call."""

    values: Array  # (n,)
    failure: str  # why the first value that is not finite is not; empty if all are


def call(fun: Objective, x: Array, *, n: int) -> Outcome:
    """Return the `n` values of `fun` at `x`; whatever a user's model raises is a failure, and all of them are NaN.

    Raises TypeError if `fun` returns something else than n real numbers.
    """
    try:
        returned = fun(x.copy())  # fun may write on it
    except Exception as error:
        return failed_call(f"{type(error).__name__}: {error}", n=n)
    f = np.asarray(returned)
    if f.size != n or f.dtype.kind not in "fiub":
        raise TypeError(f"fun returned {f.dtype} of shape {f.shape}, expected {n} real number{'s'[: n > 1]}")
    values = f.astype(np.float64).reshape(n)
    bad = values[~np.isfinite(values)]
    return Outcome(values, f"fun returned {bad[0]}" if len(bad) else "")


def failed_call(why: str, *, n: int) -> Outcome:
    """Return the outcome of a call that gave no values.

    >>> failed_call("no shaft", n=2)
    Outcome(values=array([nan, nan]), failure='no shaft')
    """
    return Outcome(np.full(n, np.nan), why)
