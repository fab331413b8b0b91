"""Covariance of order vectors, estimated from the data: noise is what does not follow the shaft.

Three sources, added: everything in the waveforms between the order lines, as a cross-spectral matrix S(f) of the
probes seen through each row's window; the timing error of the keyphasor's edges, which turns a vector by a random
angle; and how far the phase of the mains' hum may be off that is followed. A natural frequency that the bearings excite
so raises the covariance of the rows whose order crosses it, and correlates the probes as it does itself. Mains hum does
not: it keeps its phase, so it is no noise, and every fit has it among its nuisances.

Welch, IEEE Trans. Audio Electroacoust. AU-15 (1967) 70. S(f) keeps its shape over the whole recording; how loud it is
may rise or fall with speed, as bearings do.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.processing.noise.hum_phase import FOLLOWED
from rotorrig.processing.noise.mains_lines import Line, LineSearch, line_transmission
from rotorrig.processing.response import MainsHum, Window
from rotorrig.processing.rows import Rows
from rotorrig.processing.shaft_angle import TURN, ShaftAngle
from rotorrig.processing.tracking import NoiseResponse, angular_resampling
from rotorrig.processing.waveform import Waveforms
from rotorrig.processing.windows import BLACKMAN_BANDWIDTH
from rotorrig.rig import DataError

SEGMENT = 2.0  # s: resolves a natural frequency damped by 1 % at 40 Hz
BETA = 16.0  # of the segments' Kaiser window: side lobes at -118 dB, since a resonance may stand 108 dB above the noise
GUARD = 3.0  # Hz on either side of an order line: the window's main lobe is 2.6 Hz wide
HUM = 3.0  # Hz on either side of the mains and its harmonics: the window's main lobe, and what the grid strays
LINES = 6  # orders 0 to 6 and those asked for are kept out
CHANGED = 0.2  # of the mean speed: less tells no growth of the noise with speed
OUTLIER = 10.0  # times the median power of a bin: a knock, not noise
MOST = 512  # segments averaged, evenly spread over a longer recording: memory that does not grow with it
FEWEST = 8  # segments a bin must have been seen in, more for more probes
FLOOR = 0.01  # counts rms added: nothing for a live channel, keeps a dead one's matrix invertible
REACH = 32  # times 1 / turns: 1e-9 of the power passes a cosine window further off
_FINE = 128  # entries of the table of |H|^2 per 1 / turns


@dataclass(frozen=True, slots=True, kw_only=True)
class NoiseSpectrum:
    """Two-sided cross-spectral density at f >= 0; at -f it is the conjugate."""

    frequency: NDArray[np.float64]  # (bin,) Hz, equally spaced from 0
    density: NDArray[np.complex128]  # (bin, probe, probe) m^2/Hz, Hermitian, positive definite
    growth: float = 0.0  # s/rad, of the logarithm of the density with speed, over that at standstill
    lines: tuple[Line, ...] = ()  # at fixed frequencies
    mains: tuple[MainsHum, ...] = ()  # those of them that are not in the density


def noise_spectrum(
    waveforms: Waveforms, shaft: ShaftAngle, *, orders: tuple[float, ...], up_to: float
) -> NoiseSpectrum:
    """Return the noise between the order lines, from 0 to `up_to` [Hz], over the whole recording.

    Raises DataError if no stretch of the recording leaves room between the lines.
    """
    size = round(SEGMENT * waveforms.rate)
    taper = np.kaiser(size, BETA)
    frequency = np.arange(size // 2 + 1, dtype=np.float64) * (waveforms.rate / size)
    frequency = frequency[frequency <= up_to]
    scale = 1 / (waveforms.rate * np.sum(taper**2))
    lines = sorted({*range(LINES + 1), *(abs(order) for order in orders)})
    spectra, clear, speeds = [], [], []
    search = LineSearch(frequency, taper=taper, rate=waveforms.rate, hop=size // 2, probes=waveforms.probes)
    starts = _segment_starts(waveforms, shaft, size)
    stride = -(-len(starts) // MOST)
    for number, begin in enumerate(starts):
        stretch = waveforms.samples(begin, begin + size)
        if stretch is not None:
            x = stretch.x - stretch.x.mean(axis=0)
            x *= taper[:, None]
            omega = shaft.omega(stretch.t[::50])
            spectrum = np.fft.rfft(x, axis=0)[: len(frequency)]
            free = _clear_of_lines(frequency, omega / TURN, lines)
            if number % stride == 0:
                spectra.append((spectrum * np.sqrt(scale)).astype(np.complex64))
                clear.append(free)
                speeds.append(float(omega.mean()))
            search.add_segment(begin, spectrum, free, speeds=(float(omega.min()), float(omega.max())))
    if not spectra:
        raise DataError(
            f"{waveforms.where}: has no {SEGMENT:g} s of running without a gap, want some to tell noise from vibration"
        )
    each, free = np.stack(spectra), np.stack(clear)
    density = _average(frequency, each, free, waveforms.where)
    growth = _growth(each, free, np.array(speeds), density)
    each *= np.exp(-growth / 2 * np.array(speeds))[:, None, None]
    density = _average(frequency, each, free, waveforms.where)
    floor = np.diag((FLOOR * waveforms.metres_per_count) ** 2 / waveforms.rate)
    found = search.lines()
    hum = [line for line in found if 0 < line.harmonic <= FOLLOWED]
    return NoiseSpectrum(
        frequency=frequency,
        density=_cut(frequency, density, hum) + floor,
        growth=growth,
        lines=found,
        mains=tuple(search.follow(line) for line in hum),
    )


def row_covariance(
    spectrum: NoiseSpectrum,
    rows: Rows,
    *,
    orders: tuple[float, ...],
    response: NoiseResponse = angular_resampling.noise_response,
) -> NDArray[np.float64]:
    """Return the covariance (row, order, 2 probe, 2 probe) [m^2] that the noise spectrum gives each row.

    E[z z^H] = 4 integral S(f) |H(f)|^2 df with S two-sided and H what the tracking method, a filter about the row's
    order, lets through, 1 at the order itself. For white noise of variance s^2, n samples and Blackman's window this
    is var(re z) = var(im z) = 1.73 * 2 s^2 / n. Order 0 is a real mean of a quarter of that power; its imaginary part,
    zero by definition, is given the same variance so that the matrix can be inverted.
    """
    probes = spectrum.density.shape[1]
    density = np.concatenate([spectrum.density[:0:-1].conj(), spectrum.density])  # from -f to f
    covariance = np.empty((len(rows.t), len(orders), 2 * probes, 2 * probes))
    offset = np.arange(-REACH * _FINE, REACH * _FINE + 1) / _FINE
    for k, order in enumerate(orders):
        table = response(offset, order=order, orders=orders, turns=rows.turns)
        power = _filtered_power(
            density, spectrum.frequency[1], order * rows.omega / TURN, rows.turns * TURN / rows.omega, table
        )
        power *= np.exp(spectrum.growth * rows.omega)[:, None, None]
        covariance[:, k] = _real_pairs(4 * power) if order else _real_pairs(2 * power.real.astype(complex))
    return covariance


def jitter_covariance(
    z: NDArray[np.complex128],
    shaft: ShaftAngle,
    rows: Rows,
    *,
    orders: tuple[float, ...],
    bandwidth: float = BLACKMAN_BANDWIDTH,
) -> NDArray[np.float64]:
    """Return the covariance (row, order, 2 probe, 2 probe) [m^2] that the keyphasor's timing error gives `z`.

    A row whose mean shaft angle is wrong by d turns by n d at order n, all probes alike.
    """
    variance = shaft.row_angle_sigma(rows.middle, turns=rows.turns, bandwidth=bandwidth) ** 2
    turned = np.nan_to_num(1j * z * np.array(orders)).transpose(0, 2, 1)  # (row, order, probe)
    pairs = np.stack([turned.real, turned.imag], axis=-1).reshape(*turned.shape[:2], -1)
    return variance[:, None, None, None] * pairs[..., :, None] * pairs[..., None, :]


def hum_covariance(
    spectrum: NoiseSpectrum, rows: Rows, *, orders: tuple[float, ...], window: Window
) -> NDArray[np.float64]:
    """Return the covariance (row, order, 2 probe, 2 probe) [m^2] of what the followed hum's phase may be off.

    All probes are off alike; which way that turns their vectors is taken for random.
    """
    probes = spectrum.density.shape[1]
    covariance = np.zeros((len(rows.t), len(orders), 2 * probes, 2 * probes))
    followed = [line for line in spectrum.lines if 0 < line.harmonic <= FOLLOWED]
    for line, hum in zip(followed, spectrum.mains, strict=True):
        sigma = np.interp(rows.t, hum.t, hum.sigma)
        for k, order in enumerate(orders):
            if order:
                off = sigma * line_transmission(rows, order=order, frequency=hum.frequency, window=window)
                power = off[:, None, None] ** 2 * np.outer(line.amplitude, line.amplitude)
                covariance[:, k] += _real_pairs(power.astype(complex))
    return covariance


def _segment_starts(waveforms: Waveforms, shaft: ShaftAngle, size: int) -> list[int]:
    """Return the first samples of half-overlapping segments, within the pulses and the gap-free stretches."""
    starts: list[int] = []
    for first, counts in waveforms.segments:
        begin = max(first, int(np.ceil(shaft.t[0] * waveforms.rate)))
        end = min(first + len(counts), int(shaft.t[-1] * waveforms.rate))
        starts += range(begin, end - size, size // 2)
    return starts


def _clear_of_lines(
    frequency: NDArray[np.float64], shaft_frequency: NDArray[np.float64], lines: list[float]
) -> NDArray[np.bool_]:
    """Return the mask (bin,) of bins no order line came near while the shaft turned at `shaft_frequency` [Hz]."""
    low, high = shaft_frequency.min(), shaft_frequency.max()
    clear = np.ones(len(frequency), dtype=bool)
    for line in lines:
        clear &= (frequency < line * low - GUARD) | (frequency > line * high + GUARD)
    return clear


def _average(
    frequency: NDArray[np.float64], spectra: NDArray[np.complex64], clear: NDArray[np.bool_], where: str
) -> NDArray[np.complex128]:
    """Average outer products of `spectra` (segment, bin, probe) over the segments that are `clear` (segment, bin)."""
    power = np.where(clear, np.sum(np.abs(spectra, dtype=np.float64) ** 2, axis=2), np.nan)
    seen = clear.any(axis=0)
    median = np.full(len(frequency), np.inf)
    median[seen] = np.nanmedian(power[:, seen], axis=0)
    used = clear & (np.nan_to_num(power, nan=np.inf) <= OUTLIER * median)
    observed = used.sum(axis=0)
    enough = observed >= max(FEWEST, 2 * spectra.shape[2])
    if not enough.any():
        raise DataError(f"{where}: too short to tell noise from vibration, want some ten seconds at changing speed")
    total = np.einsum("sfp,sfq,sf->fpq", spectra, spectra.conj(), used, dtype=np.complex128)
    return _interpolate(frequency, frequency[enough], total[enough] / observed[enough, None, None])


def _growth(
    spectra: NDArray[np.complex64],
    clear: NDArray[np.bool_],
    speeds: NDArray[np.float64],
    density: NDArray[np.complex128],
) -> float:
    """Return the growth of the logarithm of the noise with speed [s/rad], as bearings get noisier the faster they turn.

    A straight line through the levels of all segments, each the mean over its clear bins of |X|^2 over the density.
    """
    own = np.einsum("fpp->fp", density).real
    ratio = np.minimum(np.mean(np.abs(spectra) ** 2 / np.maximum(own, np.finfo(np.float32).tiny), axis=2), OUTLIER)
    bins = clear.sum(axis=1)
    total = np.sum(ratio, axis=1, where=clear)
    some = (bins >= FEWEST) & (total > 0)
    if some.sum() < FEWEST or np.ptp(speeds[some]) < CHANGED * speeds[some].mean():
        return 0.0
    level, off = np.log(total[some] / bins[some]), speeds[some] - speeds[some].mean()
    return float(off @ level / (off @ off))


def _cut(frequency: NDArray[np.float64], density: NDArray[np.complex128], hum: list[Line]) -> NDArray[np.complex128]:
    """Return the density with the bins about the lines of `hum` taken from those beside them."""
    kept = np.ones(len(frequency), dtype=bool)
    for line in hum:
        kept &= np.abs(frequency - line.frequency) > HUM
    return _interpolate(frequency, frequency[kept], density[kept])


def _interpolate(
    frequency: NDArray[np.float64], known: NDArray[np.float64], density: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """Return matrices at all frequencies by those `known`: between positive definite ones, they are so again."""
    whole = np.empty((len(frequency), *density.shape[1:]), dtype=complex)
    for p in range(density.shape[1]):
        for q in range(density.shape[1]):
            whole[:, p, q] = np.interp(frequency, known, density[:, p, q])
    return whole


@njit(cache=True)
def _filtered_power(
    density: NDArray[np.complex128],
    step: float,
    centre: NDArray[np.float64],
    duration: NDArray[np.float64],
    table: NDArray[np.float64],
) -> NDArray[np.complex128]:
    """Return the integral of `density` (bin, probe, probe) times |H|^2, (row, probe, probe).

    The bins are `step` [Hz] apart and the one in the middle is at 0 Hz; |H|^2 is a table over (f - centre) times
    duration, of REACH either way. A bin may be as wide as |H|^2: its sum over the bins is set to its integral.
    """
    bins, probes, _ = density.shape
    area, top = table.sum() / _FINE, (bins // 2) * step
    power = np.zeros((len(centre), probes, probes), dtype=np.complex128)
    for row in range(len(centre)):
        middle, reach = min(max(centre[row], -top), top), REACH / duration[row]  # beyond the spectrum, as at its end
        first = max(int(np.ceil((middle - reach) / step)) + bins // 2, 0)
        last = min(int(np.floor((middle + reach) / step)) + bins // 2, bins - 1)
        total = 0.0
        for bin in range(first, last + 1):
            place = (((bin - bins // 2) * step - middle) * duration[row] + REACH) * _FINE
            entry = min(int(place), len(table) - 2)
            weight = table[entry] + (place - entry) * (table[entry + 1] - table[entry])
            total += weight
            for p in range(probes):
                for q in range(p + 1):  # the rest is its conjugate
                    power[row, p, q] += weight * density[bin, p, q]
        power[row] *= area / duration[row] / total
        for p in range(probes):
            for q in range(p):
                power[row, q, p] = power[row, p, q].conjugate()
    return power


def _real_pairs(power: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return the covariance of (re z_1, im z_1, ...) of circular z with E[z z^H] = `power` (row, probe, probe).

    E[re re] = E[im im] = re / 2, E[im_i re_k] = im / 2, E[re_i im_k] = -im / 2.
    """
    rows, probes, _ = power.shape
    real = np.empty((rows, probes, 2, probes, 2))
    real[:, :, 0, :, 0] = real[:, :, 1, :, 1] = power.real / 2
    real[:, :, 1, :, 0] = power.imag / 2
    real[:, :, 0, :, 1] = -power.imag / 2
    return real.reshape(rows, 2 * probes, 2 * probes)
