"""Detection of mains hum and other lines at a fixed frequency, which do not move with the shaft's speed.

A line is told from noise, and from a natural frequency that noise excites, by its phase: from one segment of the
recording to the next it advances by exactly 2 pi f hop, again and again, where a resonance has forgotten its phase
(down to a damping of 0.3 % at 40 Hz; one of 0.1 % that is excited all the time is taken for a line). Every pair of
segments has one vote, so that a knock or a passing resonance decides nothing. Segments in which an order of the shaft
came near the frequency do not count, and a line counts only if the speed changed meanwhile.

What a line adds to a row's vectors is a remark and masks nothing: a model knows the hum, and for that it needs the rows
it falls into. The covariance of these rows has a line that is not of the mains in it (noise).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.noise.hum_phase import MAINS, HumPhase
from rotorrig.processing.response import MainsHum, OrderTrackedResponse, Window
from rotorrig.processing.rows import Rows
from rotorrig.processing.shaft_angle import TURN
from rotorrig.processing.tracking import support
from rotorrig.processing.windows import blackman, hann
from rotorrig.rig.config import micrometres

MAINS_WITHIN = 0.005  # of the frequency: a grid holds 0.2 %, a diesel generator 0.5 %
LOWEST = 5.0  # Hz: below, drift and the lines' own width leave no floor to stand above
FLOOR_REACH = 15.0  # Hz on either side, for the noise a line must stand above
LOBE = 3.0  # Hz: of that, what the segments' window spreads the line over
STANDS_OUT = 10.0  # times the noise in power
COHERENT = 0.8  # of 1: mean unit phasor of the phase's advance; white noise has 1 / sqrt(pairs)
FALSE_ALARM = 1e-4  # chance that noise in a bin is as coherent: exp(-pairs coherence^2), Rayleigh
FEWEST = 10  # pairs of segments, and bins of noise about a line
SPEED_CHANGE = 1.2  # highest to lowest speed over the segments that count
FALLS_IN = 0.1  # of its amplitude: what a row's window must let through to be told
NOTICED = 0.5  # of a vector's sigma, and
SHARE = 0.002  # of the vector itself: what adds less is no matter
POINTS = 24  # per turn, of a row's window
_COSINES = {"hann": hann, "blackman": blackman}
_BINS = 3.0  # from a line on either window passes less than FALLS_IN

Remarks = tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """A line at a fixed frequency."""

    frequency: float  # Hz
    amplitude: NDArray[np.float64]  # (probe,) m 0-peak; 0 where that probe has none that can be told from noise

    @property
    def harmonic(self) -> int:
        """Which harmonic of the mains it is, 1 the mains themselves; 0: none."""
        nearest = [(round(self.frequency / mains), mains) for mains in MAINS]
        within = [n for n, mains in nearest if n and abs(self.frequency - n * mains) <= MAINS_WITHIN * n * mains]
        return min(within, default=0)

    @property
    def name(self) -> str:
        """Name for a reader: "mains hum at 50.0 Hz" or "a fixed line at 37.2 Hz"."""
        return f"{'mains hum' if self.harmonic else 'a fixed line'} at {self.frequency:.1f} Hz"


class LineSearch:
    """Search for lines in the spectra of a recording's segments, one after another; keeps a few numbers per bin."""

    def __init__(
        self, frequency: NDArray[np.float64], *, taper: NDArray[np.float64], rate: float, hop: int, probes: int
    ) -> None:
        """Take `frequency` (bin,) [Hz], the segments' window, the sample rate [Hz] and their distance in samples."""
        self._frequency, self._taper, self._rate, self._hop = frequency, taper, rate, hop
        self._cross = np.zeros((len(frequency), probes), dtype=complex)
        self._pairs = np.zeros(len(frequency), dtype=np.int64)
        self._log_power = np.zeros((len(frequency), probes))
        self._seen = np.zeros(len(frequency), dtype=np.int64)
        self._slowest = np.full(len(frequency), np.inf)
        self._fastest = np.zeros(len(frequency))
        self._last: tuple[int, NDArray[np.complex128], NDArray[np.bool_]] | None = None
        self._hum = HumPhase(frequency, taper=taper, rate=rate)

    def add_segment(
        self, begin: int, spectrum: NDArray[np.complex128], clear: NDArray[np.bool_], *, speeds: tuple[float, float]
    ) -> None:
        """Add the Fourier transform (bin, probe) [m] of the tapered segment that begins at sample `begin`.

        `clear` (bin,) are the bins that no order came near; `speeds` the shaft's lowest and highest in it [rad/s].
        """
        self._hum.add_segment(begin, spectrum, clear)
        power = np.abs(spectrum) ** 2
        unit = spectrum / np.sqrt(np.maximum(power, np.finfo(float).tiny))
        self._log_power[clear] += np.log(np.maximum(power[clear], np.finfo(float).tiny))
        self._seen += clear
        self._slowest[clear] = np.minimum(self._slowest[clear], speeds[0])
        self._fastest[clear] = np.maximum(self._fastest[clear], speeds[1])
        if self._last is not None and begin - self._last[0] == self._hop:
            both = clear & self._last[2]
            self._cross[both] += unit[both] * self._last[1][both].conj()
            self._pairs += both
        self._last = (begin, unit, clear)

    def lines(self) -> tuple[Line, ...]:
        """Return the lines found, by rising frequency."""
        pairs = np.maximum(self._pairs, 1)[:, None]
        least = np.maximum(COHERENT, np.sqrt(-np.log(FALSE_ALARM) / pairs))
        moved = self._fastest >= SPEED_CHANGE * self._slowest
        judged = (self._frequency >= LOWEST) & (self._pairs >= FEWEST) & moved
        detected = (np.abs(self._cross) / pairs > least) & judged[:, None]
        power = np.exp(self._log_power / np.maximum(self._seen, 1)[:, None])
        above = np.zeros(len(power))
        for k in np.flatnonzero(detected.any(axis=1)):
            ratio = power[k] / self._floor(int(k), power, judged)
            detected[k] &= ratio > STANDS_OUT
            above[k] = np.max(ratio, where=detected[k], initial=0.0)
        lines = []
        while above.max(initial=0.0) > 0:
            peak = int(above.argmax())
            lines.append(self._line(peak, power[peak], detected[peak]))
            above[np.abs(self._frequency - self._frequency[peak]) <= LOBE] = 0
        return tuple(sorted(lines, key=lambda line: line.frequency))

    def follow(self, line: Line) -> MainsHum:
        """Return how the phase of a line found, a harmonic of the mains up to `FOLLOWED`, went through the segments."""
        return self._hum.follow(line.frequency)

    def _floor(self, k: int, power: NDArray[np.float64], judged: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return the noise floor (probe,) about bin `k`: the median of near bins outside a line's width.

        Infinite where too little is known of it: no line stands above that.
        """
        apart = np.abs(self._frequency - self._frequency[k])
        near = judged & (apart > LOBE) & (apart <= FLOOR_REACH)
        if near.sum() < FEWEST:
            return np.full(power.shape[1], np.inf)
        return np.maximum(np.median(power[near], axis=0), np.finfo(float).tiny)

    def _line(self, peak: int, power: NDArray[np.float64], detected: NDArray[np.bool_]) -> Line:
        """Return the line in bin `peak`: its frequency by the phase's advance, its amplitude by the window's transform.

        `power` (probe,) is the geometric mean over the segments, which of a line in weaker noise is the line's own.
        """
        strongest = int(np.where(detected, power, 0).argmax())
        advance = np.angle(self._cross[peak, strongest]) / TURN  # turns per hop, whole ones unknown
        cycles = self._frequency[peak] * self._hop / self._rate
        frequency = (advance + np.round(cycles - advance)) * self._rate / self._hop
        offset = TURN * (frequency - self._frequency[peak]) / self._rate
        passed = np.abs(self._taper @ np.exp(1j * offset * np.arange(len(self._taper))))
        amplitude = 2 * np.sqrt(power) / passed
        return Line(frequency=float(frequency), amplitude=np.where(detected, amplitude, 0.0))


def line_remarks(lines: tuple[Line, ...], response: OrderTrackedResponse, rows: Rows) -> Remarks:
    """Return remarks (row,) on the lines that fall into a row's vectors, and how much they add at the most.

    A line lost in the noise of a vector, or that adds less than 0.2 % to it, is left out.
    """
    words: list[list[str]] = [[] for _ in rows.t]
    variance = np.diagonal(response.covariance, axis1=2, axis2=3)
    sigma = np.sqrt((variance[..., 0::2] + variance[..., 1::2]) / 2)  # (row, order, probe)
    for line in lines:
        p = int(line.amplitude.argmax())
        for n, order in enumerate(response.orders):
            if not order:
                continue  # a line is no gap
            passed = line_transmission(rows, order=order, frequency=line.frequency, window=response.window)
            added, z = passed * line.amplitude[p], np.abs(response.z[:, p, n])
            detected = (passed > FALLS_IN) & (added > NOTICED * sigma[:, n, p]) & (added > SHARE * z)
            for i in np.flatnonzero(detected):
                share = f", {added[i] / z[i]:.1%} of it" if z[i] > added[i] else ""
                words[i].append(
                    f"{line.name}, {_um(line.amplitude[p])} at {response.probes[p]}, falls into {order:g}X: "
                    f"adds up to {_um(added[i])}{share}"
                )
    return tuple(tuple(row) for row in words)


def line_transmission(
    rows: Rows, *, order: float, frequency: float, window: Window = "blackman"
) -> NDArray[np.float64]:
    """Return the share (row,) of a line's amplitude that the window of each row lets into the vector of an order.

    |mean of e^{j (2 pi f t - n psi)} under the window|, with t(psi) of a steady acceleration: a quickly rising speed
    spends little time at the line.
    """
    psi, weight = _weights(window, rows.turns)
    passed = np.zeros(len(rows.t))
    duration = rows.end - rows.begin
    sweep = np.abs(order * rows.alpha) / TURN * duration**2  # how far the order moves in a row, in its bins
    near = np.abs(frequency * duration - abs(order) * rows.turns) < _BINS + _BINS * sweep
    omega, alpha = rows.omega[near, None], rows.alpha[near, None]
    t = psi / omega - alpha * psi**2 / (2 * omega**3)
    passed[near] = np.abs(np.exp(1j * (TURN * frequency * t - abs(order) * psi)) @ weight)
    return passed


def _weights(window: Window, turns: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return angles psi [rad] about a row's middle and the weights there, of sum 1: see resampling, vold_kalman."""
    length = support(turns) if window == "vold-kalman" else float(turns)
    count = int(np.ceil(POINTS * length))
    psi = TURN * length * ((np.arange(count) + 0.5) / count - 0.5)
    if window == "vold-kalman":
        u = 4 * np.abs(psi) / (TURN * turns)
        weight = np.exp(-u) * (np.cos(u) + np.sin(u))
    else:
        weight = _COSINES[window](psi, turns=turns) if window in _COSINES else np.ones(count)
    return psi, weight / weight.sum()


def _um(metres: float) -> str:
    return f"{micrometres(metres)} um"
