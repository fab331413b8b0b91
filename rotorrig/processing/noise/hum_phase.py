"""Phase of the mains' hum through a recording: the grid strays by some hundredths of a hertz.

Every segment in which no order of the shaft came near has a phasor at each probe, all probes turning alike. Between
them, and for the seconds in which an order crosses the frequency, it is what a Kalman filter and Rauch's, Tung's and
Striebel's smoother (AIAA Journal 3 (1965) 1445) make of a rotation whose rate wanders as a grid's does: 20 mHz within
a minute (Weissbach and Welfonder, High frequency deviations within the European power system, IEEE Power Systems
Conference 2009). The scatter from segment to segment is measured; how far the phase may be off comes with it.
"""

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.response import MainsHum
from rotorrig.processing.shaft_angle import TURN

MAINS = (50.0, 60.0)  # Hz
FOLLOWED = (
    3  # harmonics of them whose hum is no noise: a rectifier leaves the second, a saturated transformer the third
)
STEP = 1.0  # s
WANDER = 2.0 * TURN * 0.02 * TURN / 60.0  # rad/s^2: 20 mHz to and fro in a minute; twice, as it lasts for seconds
FASTEST = TURN * 0.2  # rad/s: no grid is further from nominal
DIFFERENCES = 20.0  # variance of the third differences of white noise of variance 1
FEWEST = 5  # third differences that tell the scatter, and
ROUGH = 0.3  # what it is taken for without them

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]


class HumPhase:
    """Phasors at the mains' frequencies, segment by segment."""

    def __init__(self, frequency: Reals, *, taper: Reals, rate: float) -> None:
        """Take `frequency` (bin,) [Hz] of the segments' spectra, their window and the sample rate [Hz]."""
        nominal = np.unique([n * f for f in MAINS for n in range(1, FOLLOWED + 1)])
        self._nominal = nominal[nominal < frequency[-1]]
        self._bins = np.searchsorted(frequency, self._nominal - (frequency[1] - frequency[0]) / 2)
        self._offset = self._nominal - frequency[self._bins]
        self._rate, self._size = rate, len(taper)
        self._middles: list[float] = []
        self._phasors: list[Complex] = []

    def add_segment(self, begin: int, spectrum: Complex, clear: NDArray[np.bool_]) -> None:
        """Add the transform (bin, probe) [m] of the tapered segment from sample `begin` on; `clear` as there."""
        lag = TURN * (self._nominal * begin + self._offset * (self._size - 1) / 2) / self._rate
        self._middles.append((begin + (self._size - 1) / 2) / self._rate)
        own = spectrum[self._bins] * np.exp(-1j * lag)[:, None]
        self._phasors.append(np.where(clear[self._bins, None], own, 0))

    def follow(self, frequency: float) -> MainsHum:
        """Return how the phase of the mains' harmonic next to `frequency` [Hz] went, and what each probe has of it."""
        which = int(np.abs(self._nominal - frequency).argmin())
        each = np.array([phasors[which] for phasors in self._phasors])
        most = int(np.sum(np.abs(each) ** 2, axis=0).argmax())
        together = each @ (each.T @ each[:, most].conj()).conj()  # every probe by its share, turned to that one
        t = np.arange(self._middles[0], self._middles[-1] + STEP, STEP)
        sums = np.zeros(len(t), complex)
        for middle, phasor in zip(self._middles, together, strict=True):
            sums[round((middle - t[0]) / STEP)] += phasor
        seen = sums != 0
        unit = np.divide(sums, np.abs(sums), out=np.zeros_like(sums), where=seen)
        harmonic = min(round(self._nominal[which] / f) for f in MAINS if self._nominal[which] % f == 0)
        smooth, sigma = _smooth(unit, seen, wander=harmonic * WANDER, fastest=harmonic * FASTEST)
        stray = np.unwrap(np.angle(smooth))
        shares = np.exp(-1j * np.interp(self._middles, t, stray)) @ each
        return MainsHum(
            frequency=float(self._nominal[which]),
            t=t,
            stray=stray,
            sigma=sigma,
            shares=shares / np.sqrt(np.mean(np.abs(shares) ** 2)),
        )


def _smooth(values: Complex, seen: NDArray[np.bool_], *, wander: float, fastest: float) -> tuple[Complex, Reals]:
    """Return the smoothed values (time,), and the standard deviation of either part of them.

    `wander` is that of the second difference of the truth from one value to the next, `fastest` that of the first at
    the beginning.
    """
    step, noise = np.array([[1.0, 1.0], [0.0, 1.0]]), np.diag([0.0, wander**2])
    scatter = _scatter(values, seen) ** 2
    state, P = np.zeros(2, complex), np.diag([1.0, fastest**2])
    states, covariances = [], []
    for value, known in zip(values, seen, strict=True):
        state, P = step @ state, step @ P @ step.T + noise
        if known:
            gain = P[:, 0] / (P[0, 0] + scatter)
            state, P = state + gain * (value - state[0]), P - np.outer(gain, P[0])
        states.append(state)
        covariances.append(P)
    for i in range(len(values) - 2, -1, -1):
        ahead = step @ covariances[i] @ step.T + noise
        back = np.linalg.solve(ahead, step @ covariances[i]).T
        states[i] = states[i] + back @ (states[i + 1] - step @ states[i])
        covariances[i] = covariances[i] + back @ (covariances[i + 1] - ahead) @ back.T
    return np.array([s[0] for s in states]), np.sqrt([P[0, 0] for P in covariances])


def _scatter(values: Complex, seen: NDArray[np.bool_]) -> float:
    """Return the standard deviation of either part of the values from one to the next, by their third differences."""
    if len(values) < 4:
        return ROUGH
    together = np.convolve(seen, np.ones(4), mode="valid") == 4
    if together.sum() < FEWEST:
        return ROUGH
    return float(np.sqrt(np.mean(np.abs(np.diff(values, 3)[together]) ** 2) / 2 / DIFFERENCES))
