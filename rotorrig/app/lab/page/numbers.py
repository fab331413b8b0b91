"""Numbers as a page wants them: finite, and no longer than they are true."""

import math

DIGITS = 6  # of a value on a page: more than any measurement has


def shorten(value: float | None, factor: float = 1.0) -> float | None:
    """Return a number times a factor, rounded; None if it is none, or not finite.

    >>> shorten(34233.66213, 1e-3), shorten(float("nan")), shorten(None)
    (34.2337, None, None)
    """
    if value is None or not math.isfinite(value):
        return None
    return float(f"{value * factor:.{DIGITS}g}")
