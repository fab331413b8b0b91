"""Hum of the mains in the vectors, a nuisance of every fit: a phasor per recording and frequency.

The mains stray by some hundredths of a hertz. Tracking follows the phase of a hum that it finds, and leaves it out of
the noise; any other is weaker than the noise and is taken for steady.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing import OrderTrackedResponse
from rotorrig.sims.effects import ReadingContext, leak

FREQUENCIES = (50.0, 60.0, 100.0, 120.0)  # Hz, and twice that: what a rectifier leaves in the supply of the probes


def hum_names(recordings: int) -> list[str]:
    """Return the unknowns, re and im [m] at every frequency, of one recording after the other."""
    return [f"hum {f:.0f} Hz {i + 1} {part}" for i in range(recordings) for f in FREQUENCIES for part in ("re", "im")]


def hum_leaks(
    response: OrderTrackedResponse, rows: NDArray[np.intp], views: Mapping[int, ReadingContext]
) -> dict[int, NDArray[np.complex128]]:
    """Return order -> (row + 1, frequency): what hum of 1 m leaves in the vectors, and nothing in the slow roll's.

    Who does not know the time to a fraction of the mains' period knows no phase of theirs: then nothing at all.
    """
    found = {order: np.zeros((len(rows) + 1, len(FREQUENCIES)), complex) for order in views}
    if response.derived_times or len(response.keyphasor_t) <= 3 or not np.isfinite(response.t[rows]).all():
        return found
    for order, view in views.items():
        for i, frequency in enumerate(FREQUENCIES):
            found[order][:-1, i] = leak(view, np.arange(len(rows)), frequency)
    return found
