"""Hum of the mains in the vectors, a nuisance of every fit: phasors of each line in each recording.

Each cable picks up its own (Ott, Electromagnetic Compatibility Engineering (2009), ch. 2 and 3), so a line that
tracking found has a phasor at every probe. The mains stray by some hundredths of a hertz, and their harmonics with
them: tracking follows that. What it did not find is at most what a window averages out of the noise: one phasor of all
probes, and where nothing was found at all, taken for steady.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing import OrderTrackedResponse
from rotorrig.sims.effects import ReadingContext, leak

MAINS = (50.0, 60.0)  # Hz
HARMONICS = (1, 2, 3)  # a rectifier leaves the second, a saturated transformer the third
UNSEEN = (1, 2)  # of either, where no line was found

Strays = dict[float, tuple[NDArray[np.float64], NDArray[np.float64]]]  # Hz -> s, and rad ahead of 2 pi f t then
Leaks = dict[float, NDArray[np.complex128]]  # frequency -> (row + 1,)


class HumLine(NamedTuple):
    """A line of the mains in one recording."""

    recording: int  # number of it
    frequency: float  # Hz
    of_each: bool  # every probe has a phasor of its own; or all have one together

    def names(self, probes: Sequence[str]) -> list[str]:
        """Return its unknowns, re and im [m], of one probe after the other or of all."""
        stem = f"hum {self.frequency:.0f} Hz {self.recording + 1}"
        return [f"{stem}{of} {part}" for of in self.shown(probes) for part in ("re", "im")]

    def shown(self, probes: Sequence[str]) -> list[str]:
        """Return " 2y" of every probe that has a phasor of its own, or "" for all of them."""
        return [f" {probe}" for probe in probes] if self.of_each else [""]


def find_hum_lines(number: int, response: OrderTrackedResponse, leaks: Iterable[float]) -> Iterator[HumLine]:
    """Yield the lines of a recording, of the frequencies that leak into its vectors."""
    found = {hum.frequency for hum in response.mains}
    for frequency in leaks:
        yield HumLine(number, frequency, frequency in found)


def hum_strays(response: OrderTrackedResponse) -> Strays:
    """Return how the phases of the mains went, by the line of theirs that was found where another was not."""
    found = {hum.frequency: (hum.t, hum.stray) for hum in response.mains}
    strays = dict(found)
    for mains in MAINS:
        known = {n: found[n * mains] for n in HARMONICS if n * mains in found}
        for n in HARMONICS if known else ():
            if n not in known:
                nearest = max((m for m in known if m < n), default=min(known))
                t, stray = known[nearest]
                strays[n * mains] = (t, stray * n / nearest)
    return strays


def hum_leaks(
    response: OrderTrackedResponse, rows: NDArray[np.intp], views: Mapping[int, ReadingContext]
) -> dict[int, Leaks]:
    """Return by order and frequency what a line of 1 m leaves in the vectors (row + 1,), nothing in the slow roll's.

    Who does not know the time to a fraction of the mains' period knows no phase of theirs: then there are none.
    """
    known = not response.derived_times and len(response.keyphasor_t) > 3 and np.isfinite(response.t[rows]).all()
    lines = sorted(hum_strays(response)) or [n * mains for mains in MAINS for n in UNSEEN]
    frequencies = lines if known else []
    return {
        order: {f: np.append(leak(view, np.arange(len(rows)), f), 0.0) for f in frequencies}
        for order, view in views.items()
    }
