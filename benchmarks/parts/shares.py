"""Shares of cases with their bounds."""

from typing import Any

from scipy.stats import binomtest


def share(hits: int, of: int) -> dict[str, Any]:
    """Return hits and their share with its 95 % bounds (Clopper and Pearson); of no case the counts alone.

    >>> share(9, 10)
    {'hits': 9, 'of': 10, 'share': 0.9, 'low': 0.555, 'high': 0.997}
    """
    if not of:
        return {"hits": 0, "of": 0}
    bounds = binomtest(hits, of).proportion_ci(0.95, method="exact")
    found = {"share": hits / of, "low": float(bounds.low), "high": float(bounds.high)}
    return {"hits": hits, "of": of, **{key: round(value, 3) for key, value in found.items()}}


def to_text(value: Any) -> str:
    """Return a figure of a summary for a person: a share with its bounds, anything else as it is.

    >>> to_text(share(9, 10))
    ' 90.0 %  9 of 10, 56 to 100 %'
    """
    if isinstance(value, dict) and value["of"]:
        bounds = f"{100 * value['low']:.0f} to {100 * value['high']:.0f} %"
        return f"{100 * value['share']:5.1f} %  {value['hits']} of {value['of']}, {bounds}"
    return str(value)
