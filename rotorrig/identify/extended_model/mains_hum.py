"""Hum of the mains in the vectors, a nuisance of every fit: one phasor of each line in each recording.

Each cable picks up its own (Ott, Electromagnetic Compatibility Engineering (2009), ch. 2 and 3), and the mains stray by
some hundredths of a hertz, their harmonics with them: of a line that tracking found, it says both. What it did not find
is at most what a window averages out of the noise: alike at all probes, and where nothing was found at all, steady.
"""

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing import OrderTrackedResponse
from rotorrig.sims.effects import HARMONICS, MAINS, ReadingContext, leak

FOLLOWED = (1, 2, 3)  # harmonics that tracking follows: a saturated transformer leaves the third

HumLine = tuple[int, float]  # number of the recording, Hz
Strays = dict[float, tuple[NDArray[np.float64], NDArray[np.float64]]]  # Hz -> s, and rad ahead of 2 pi f t then
Leaks = dict[float, NDArray[np.complex128]]  # frequency -> (row + 1, probe)


def hum_names(lines: Iterable[HumLine]) -> list[str]:
    """Return the unknowns, re and im [m], of one line after the other."""
    return [f"hum {frequency:.0f} Hz {number + 1} {part}" for number, frequency in lines for part in ("re", "im")]


def hum_strays(response: OrderTrackedResponse) -> Strays:
    """Return how the phases of the mains went, by the line of theirs that was found where another was not."""
    found = {hum.frequency: (hum.t, hum.stray) for hum in response.mains}
    strays = dict(found)
    for mains in MAINS:
        known = {n: found[n * mains] for n in FOLLOWED if n * mains in found}
        for n in FOLLOWED if known else ():
            if n not in known:
                nearest = max((m for m in known if m < n), default=min(known))
                t, stray = known[nearest]
                strays[n * mains] = (t, stray * n / nearest)
    return strays


def hum_leaks(
    response: OrderTrackedResponse, rows: NDArray[np.intp], views: Mapping[int, ReadingContext]
) -> dict[int, Leaks]:
    """Return by order and frequency what a line of 1 m leaves in the vectors, nothing in the slow roll's.

    Who does not know the time to a fraction of the mains' period knows no phase of theirs: then there are none.
    """
    known = not response.derived_times and len(response.keyphasor_t) > 3 and np.isfinite(response.t[rows]).all()
    lines = sorted(hum_strays(response)) or [n * mains for mains in MAINS for n in HARMONICS]
    frequencies = lines if known else []
    return {
        order: {f: np.pad(leak(view, np.arange(len(rows)), f), ((0, 1), (0, 0))) for f in frequencies}
        for order, view in views.items()
    }
