"""Phase of the mains' hum through a recording: the grid strays by some hundredths of a hertz.

Of every segment in which no order of the shaft came near, the phasor of all probes together is known. Between them,
and for the seconds in which an order crosses the frequency, it is the smoothest sequence that stays near them: least
squares with a penalty on second differences (Eilers, A perfect smoother, Analytical Chemistry 75 (2003) 3631).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded

from rotorrig.processing.response import MainsHum
from rotorrig.processing.shaft_angle import TURN

MAINS = (50.0, 60.0)  # Hz
FOLLOWED = 2  # harmonics of them whose hum is no noise: a fit has it among its nuisances
STEP = 1.0  # s
KEPT = 20.0  # s: half of a straying of that period is kept; grids hunt over a minute and longer


class HumPhase:
    """Phasors at the mains' frequencies, segment by segment."""

    def __init__(self, frequency: NDArray[np.float64], *, taper: NDArray[np.float64], rate: float) -> None:
        """Take `frequency` (bin,) [Hz] of the segments' spectra, their window and the sample rate [Hz]."""
        nominal = np.unique([n * f for f in MAINS for n in range(1, FOLLOWED + 1)])
        self._nominal = nominal[nominal < frequency[-1]]
        self._bins = np.searchsorted(frequency, self._nominal - (frequency[1] - frequency[0]) / 2)
        self._offset = self._nominal - frequency[self._bins]
        self._rate, self._size = rate, len(taper)
        self._middles: list[float] = []
        self._phasors: list[NDArray[np.complex128]] = []

    def add_segment(self, begin: int, spectrum: NDArray[np.complex128], clear: NDArray[np.bool_]) -> None:
        """Add the transform (bin, probe) [m] of the tapered segment from sample `begin` on; `clear` as there."""
        lag = TURN * (self._nominal * begin + self._offset * (self._size - 1) / 2) / self._rate
        self._middles.append((begin + (self._size - 1) / 2) / self._rate)
        self._phasors.append(np.where(clear[self._bins], spectrum[self._bins].sum(axis=1) * np.exp(-1j * lag), 0))

    def follow(self, frequency: float) -> MainsHum:
        """Return how the phase of the mains' harmonic next to `frequency` [Hz] went."""
        which = int(np.abs(self._nominal - frequency).argmin())
        t = np.arange(self._middles[0], self._middles[-1] + STEP, STEP)
        sums = np.zeros(len(t), complex)
        for middle, phasors in zip(self._middles, self._phasors, strict=True):
            sums[round((middle - t[0]) / STEP)] += phasors[which]
        seen = sums != 0
        unit = np.divide(sums, np.abs(sums), out=np.zeros_like(sums), where=seen)
        smooth = _smooth(unit, seen.astype(float), strength=(KEPT / STEP / TURN) ** 4)
        return MainsHum(frequency=float(self._nominal[which]), t=t, stray=np.unwrap(np.angle(smooth)))


def _smooth(values: NDArray[np.complex128], weight: NDArray[np.float64], *, strength: float) -> NDArray[np.complex128]:
    """Return s that minimises sum weight |s - values|^2 + strength sum |second difference of s|^2."""
    if len(values) < 3:
        return values
    second = (1.0, -2.0, 1.0)
    bands = np.zeros((3, len(values)))  # main diagonal first, as solveh_banded has them below it
    bands[0] = weight
    for i in range(3):
        for j in range(i + 1):
            bands[i - j, j : len(values) - 2 + j] += strength * second[i] * second[j]
    smoothed: NDArray[np.complex128] = solveh_banded(bands, values * weight, lower=True)
    return smoothed
