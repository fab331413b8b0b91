"""Round numbers for scales and axes."""

import math


def nice(value: float) -> float:
    """Return the next round number at or above `value`.

    >>> nice(143.0), nice(0.21), nice(0.0)
    (150.0, 0.3, 1.0)
    """
    if not value > 0:
        return 1.0
    decade = 10.0 ** math.floor(math.log10(value))
    return next(round(m * decade, 12) for m in (1, 1.5, 2, 3, 4, 5, 6, 8, 10) if m * decade >= value * (1 - 1e-9))
