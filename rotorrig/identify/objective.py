"""The chapter's three objectives on 1X amplitudes, eq. (14)-(16), for the global search.

They know amplitudes only, so the phase of the unbalance drops out. Where the measurement had its slow-roll vector
subtracted, so has the prediction: at 500 rpm a good part of the "slow roll" is unbalance response, and comparing
with an uncompensated prediction puts k wrong by 12 % to 84 % on data without any noise.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Amplitudes = NDArray[np.float64]  # (..., speed, probe) m, 0-peak


def f1(measured: Amplitudes, predicted: Amplitudes) -> NDArray[np.float64]:
    """Return the sum of squared differences [um^2], eq. (14)."""
    return np.nansum(((measured - predicted) * 1e6) ** 2, axis=(-2, -1))


def f2(measured: Amplitudes, predicted: Amplitudes) -> NDArray[np.float64]:
    """Return the sum of absolute differences of the logarithms to base 10, eq. (15)."""
    return np.nansum(np.abs(np.log10(measured) - np.log10(predicted)), axis=(-2, -1))


def f3(measured: Amplitudes, predicted: Amplitudes) -> NDArray[np.float64]:
    """Return the sum of absolute differences [um], eq. (16)."""
    return np.nansum(np.abs(measured - predicted) * 1e6, axis=(-2, -1))


OBJECTIVES: dict[str, Callable[[Amplitudes, Amplitudes], NDArray[np.float64]]] = {"f1": f1, "f2": f2, "f3": f3}
