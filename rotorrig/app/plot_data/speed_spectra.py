"""Spectra of a recording over shaft speed, by frequency: the numbers of a cascade.

Where two probes make a plane they are full spectra, forward whirl at positive frequencies and backward whirl at
negative ones; a probe alone has frequencies from 0. A spectrum is of one stretch of samples about the middle of a row
of the response, under a Hann window. On a ramp of a Hz per second a line at 1X moves by T a in a stretch of T seconds,
and lines nearer than 1.5 / T are not told apart: the stretch is 1 / sqrt(a) long, where both are about alike.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len

from rotorrig.app.plot_data.curves import sweeps
from rotorrig.processing import OrderTrackedResponse, Plane, Waveforms, measured_planes
from rotorrig.rig.config import RPM, UM

SPECTRA = 52  # of a run
BINS = 336  # of frequency: of a picture half as wide as a page
HIGHEST = 5.0  # order at the top speed, where the frequencies end, unless the samples end below
UNALIASED = 0.45  # of the sample rate
SHORTEST, LONGEST, STEADY = 0.2, 2.0, 1.0  # s of a stretch: the limits, and where no ramp is known
DECADES = 4  # of amplitude that a picture's colours span, below the largest
DRAWN_ORDERS = (0.5, 1.0, 2.0)  # lines in a picture, on either side of a full spectrum
PADDING = 8  # of the FFT: a steady line reads no more than 0.3 % low between two of its frequencies
NOISE_BANDWIDTH = 1.5  # of a Hann window, in 1 / T
Reals = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedSpectra:
    """Spectra of one plane, or of one probe without a partner, in one run."""

    place: str  # name of the plane or of the probe
    run: str
    direction: int  # +1 speed rises, -1 falls
    rpm: Reals  # (speed,) rising
    frequency: Reals  # (bin,) Hz, equal steps: -F to F of a plane, 0 to F of a probe
    amplitude: Reals  # (speed, bin) µm 0-peak, the largest in the bin; NaN where samples are missing
    seconds: float  # of a spectrum

    @property
    def full(self) -> bool:
        """Whether forward and backward whirl are told apart."""
        return bool(self.frequency[0] < 0)

    @property
    def resolution(self) -> float:
        """Noise bandwidth of a spectrum [Hz]."""
        return NOISE_BANDWIDTH / self.seconds

    @property
    def orders(self) -> tuple[float, ...]:
        """Orders to draw lines at."""
        return (*(-order for order in DRAWN_ORDERS), *DRAWN_ORDERS) if self.full else DRAWN_ORDERS

    @property
    def step(self) -> float:
        """Width of a bin [Hz]."""
        return float(self.frequency[1] - self.frequency[0])

    @property
    def largest(self) -> tuple[float, float, float]:
        """Amplitude [µm], frequency [Hz] and speed [rpm] of the largest line."""
        row, column = np.unravel_index(np.nanargmax(self.amplitude), self.amplitude.shape)
        return float(self.amplitude[row, column]), float(self.frequency[column]), float(self.rpm[row])


def order_mark(order: float) -> str:
    """Return the name of an order's line, whichever side it is on, as short as it can be.

    >>> [order_mark(order) for order in (-0.5, 1.0, -2.0)]
    ['½X', '1X', '2X']
    """
    return "½X" if abs(order) == 0.5 else f"{abs(order):g}X"


def speed_spectra(response: OrderTrackedResponse, waveforms: Waveforms) -> tuple[SpeedSpectra, ...]:
    """Return the spectra of every plane and lone probe in every run whose speed changes, run by run.

    `waveforms` are those the response was tracked from; of each run SPECTRA stretches are read, one after the other. A
    run of a single row, or without samples at its rows, has none.
    """
    return tuple(spectra for run in sweeps(response) for spectra in _of_run(response, waveforms, run))


def _of_run(response: OrderTrackedResponse, waveforms: Waveforms, run: int) -> Iterator[SpeedSpectra]:
    rows, seconds = rows_by_speed(response, run, SPECTRA), stretch_seconds(response, run)
    top = min(HIGHEST * float(np.max(response.omega)) / (2 * np.pi), UNALIASED * waveforms.rate)
    places = [(*motion, _edges(top, motion[2])) for motion in motions(response)]
    amplitude = np.full((len(places), len(rows), BINS), np.nan)
    for row, t in enumerate(response.t[rows]):
        stretch = waveforms.between(t - seconds / 2, t + seconds / 2)
        if stretch is None:
            continue
        for i, (_, columns, combine, edges) in enumerate(places):
            lines = spectrum(stretch.x[:, columns] @ combine, rate=waveforms.rate)
            amplitude[i, row] = highest_in_bins(*lines, edges)
    if len(rows) < 2 or not np.isfinite(amplitude).any():
        return
    for of_place, (place, _, _, edges) in zip(amplitude, places, strict=True):
        yield SpeedSpectra(
            place=place,
            run=response.runs[run].name,
            direction=response.runs[run].direction,
            rpm=response.omega[rows] * RPM,
            frequency=(edges[1:] + edges[:-1]) / 2,
            amplitude=of_place * UM,
            seconds=seconds,
        )


def _edges(top: float, combine: NDArray[np.complex128] | Reals) -> Reals:
    """Return the edges of the bins [Hz]: of an orbit on either side of 0."""
    return np.linspace(-top if np.iscomplexobj(combine) else 0.0, top, BINS + 1)


def rows_by_speed(response: OrderTrackedResponse, run: int, count: int) -> NDArray[np.intp]:
    """Return about `count` rows of a run, evenly spread in speed, rising; that of its largest 1X is among them."""
    rows = np.flatnonzero((response.run == run) & np.isfinite(response.t))
    if not len(rows):
        return rows
    omega = response.omega[rows]
    wanted = np.linspace(omega.min(), omega.max(), count)
    if (peak := row_of_largest(response, run)) is not None:
        wanted[int(np.argmin(np.abs(wanted - response.omega[peak])))] = response.omega[peak]
    nearest = np.unique([int(rows[np.argmin(np.abs(omega - speed))]) for speed in wanted])
    return nearest[np.argsort(response.omega[nearest], kind="stable")]


def row_of_largest(response: OrderTrackedResponse, run: int) -> int | None:
    """Return the row of a run where a usable 1X vector is largest, of any probe; None without any."""
    if 1.0 not in response.orders:
        return None
    usable = response.usable & (response.run == run)[:, None] & np.isfinite(response.t)[:, None]
    size = np.where(usable, np.abs(response.order(1.0)), np.nan)
    return int(np.unravel_index(np.nanargmax(size), size.shape)[0]) if np.isfinite(size).any() else None


def stretch_seconds(response: OrderTrackedResponse, run: int) -> float:
    """Return the length of a spectrum's stretch [s] by the run's acceleration, which all but a tenth of it is below."""
    rate = np.abs(response.alpha[response.run == run]) / (2 * np.pi)
    rate = rate[np.isfinite(rate)]
    if not len(rate):
        return STEADY
    fast = max(float(np.quantile(rate, 0.9)), LONGEST**-2)
    return max(fast**-0.5, SHORTEST)


def motions(response: OrderTrackedResponse) -> Iterator[tuple[str, list[int], NDArray[np.complex128] | Reals]]:
    """Yield each plane, then each probe without one: name, its probes' indices in the config, weights to be summed.

    The sum of a plane is its orbit, x + jy or, for rotation from y to x, x - jy: forward whirl turns positively.
    """
    names = [probe.name for probe in response.rig.probes]
    paired: set[str] = set()
    for plane, _ in measured_planes(response.rig, response.probes):
        paired |= set(plane.probes)
        yield plane.name, [names.index(name) for name in plane.probes], _orbit_of(plane, response.rig.rotation)
    for name in response.probes:
        if name not in paired:
            yield name, [names.index(name)], np.ones(1)


def _orbit_of(plane: Plane, rotation: str) -> NDArray[np.complex128]:
    return plane.to_xy.T @ np.array([1.0, 1j if rotation == "x-to-y" else -1j])


def spectrum(motion: NDArray[np.complex128] | Reals, *, rate: float) -> tuple[Reals, Reals]:
    """Return frequencies [Hz], rising, and the amplitude at each of `motion` (sample,), 0-peak, its mean taken out.

    Under a Hann window. A line of amplitude r has r at its frequency; of a complex motion, which is an orbit, a circle
    of radius r has, and a line r/2 on either side.

    >>> frequency, amplitude = spectrum(3.0 * np.cos(2 * np.pi * 50.0 * np.arange(1000) / 1000.0), rate=1000.0)
    >>> float(frequency[np.argmax(amplitude)]), round(float(amplitude.max()), 9)
    (50.0, 3.0)
    """
    window = np.hanning(len(motion) + 1)[:-1]
    window = window / window.sum()
    points = next_fast_len(PADDING * len(motion))
    lines = window * (motion - window @ motion)
    if not np.iscomplexobj(motion):
        return np.asarray(np.fft.rfftfreq(points, 1 / rate)), np.asarray(2 * np.abs(np.fft.rfft(lines, points)))
    frequency, amplitude = np.fft.fftfreq(points, 1 / rate), np.abs(np.fft.fft(lines, points))
    return np.fft.fftshift(frequency), np.fft.fftshift(amplitude)


def highest_in_bins(frequency: Reals, amplitude: Reals, edges: Reals) -> Reals:
    """Return the largest `amplitude` (line,) in each bin of frequency (bin,), so that no narrow line is lost.

    A bin narrower than the steps of `frequency` takes the value next to it.
    """
    first = np.minimum(np.searchsorted(frequency, edges[:-1]), len(frequency) - 1)
    last = np.maximum(np.searchsorted(frequency, edges[1:]), first + 1)
    kept = amplitude[first[0] : last[-1]]
    return np.maximum.reduceat(kept, first - first[0])


def decibels(amplitude: Reals) -> NDArray[np.int8]:
    """Return amplitudes [µm] as whole decibels above 1 µm, 20 to a factor of ten: a byte each, for a large picture.

    What is not known, and what is below 3e-7 µm, is -128.

    >>> decibels(np.array([1.0, 100.0, 0.0, np.nan])).tolist()
    [0, 40, -128, -128]
    """
    known = np.nan_to_num(amplitude)
    with np.errstate(divide="ignore"):
        return np.clip(np.round(20 * np.log10(known)), -128, 127).astype(np.int8)
