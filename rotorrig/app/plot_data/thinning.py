"""Fewer points for a picture than a long run has rows, so that a page of 20,000 rows opens as one of 500."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.plot_data.curves import Curve

MOST = 500  # points of a run: a plot is about as many pixels wide


def thin_indices(values: NDArray[np.float64], *, most: int = MOST) -> NDArray[np.intp]:
    """Return the indices of at most `most` points: of each stretch the smallest and the largest, so that peaks stay.

    >>> thin_indices(np.array([0.0, 1.0, 9.0, 1.0, 0.0, -5.0]), most=4)  # of each half
    array([0, 2, 3, 5])
    """
    if len(values) <= most:
        return np.arange(len(values))
    edges = np.linspace(0, len(values), most // 2 + 1).astype(int)
    kept: set[int] = set()
    for first, last in pairwise(edges):
        stretch = values[first:last]
        if np.isfinite(stretch).any():
            kept |= {first + int(np.nanargmin(stretch)), first + int(np.nanargmax(stretch))}
        else:
            kept.add(int(first))  # a hole stays a hole
    return np.array(sorted(kept), dtype=np.intp)


def thin_curve(curve: Curve, *, most: int = MOST, modelled: bool = False) -> Curve:
    """Return a curve with at most `most` rows, chosen by its amplitude or by that of the model."""
    chosen = curve.model_amplitude if modelled else curve.amplitude
    assert chosen is not None
    return curve.at(thin_indices(chosen, most=most))
