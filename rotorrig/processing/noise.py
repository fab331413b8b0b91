"""The covariance of order vectors, from the data: noise is what does not follow the shaft.

Two sources, added: everything in the waveforms between the order lines, as a cross-spectral matrix S(f) of the
probes seen through each row's window; and the timing error of the keyphasor's edges, which turns a vector by a
random angle. A line of noise, a natural frequency excited by the bearings or mains hum, so raises the covariance of
the rows whose order crosses it, and correlates the probes as it does itself.

Welch, IEEE Trans. Audio Electroacoust. AU-15 (1967) 70. S(f) is taken as the same over the whole recording.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal.windows import kaiser

from rotorrig.processing.orders import Rows
from rotorrig.processing.tacho import TURN, ShaftAngle
from rotorrig.processing.waveform import Waveforms
from rotorrig.rig.errors import DataError

SEGMENT = 2.0  # s: resolves a natural frequency damped by 1 % at 40 Hz
BETA = 16.0  # of the segments' Kaiser window: side lobes at -118 dB, since a resonance may stand 108 dB above the noise
GUARD = 3.0  # Hz on either side of an order line: the window's main lobe is 2.6 Hz wide
LINES = 6  # orders 0 to 6 and those asked for are kept out
OUTLIER = 10.0  # times the median power of a bin: a knock, not noise
FEWEST = 8  # segments a bin must have been seen in, more for more probes
FLOOR = 0.01  # counts rms added: nothing for a live channel, keeps a dead one's matrix invertible
HANN_BANDWIDTH = 1.5  # bins: equivalent noise bandwidth of a Hann window


@dataclass(frozen=True, slots=True, kw_only=True)
class NoiseSpectrum:
    """Two-sided cross-spectral density at f >= 0; at -f it is the conjugate."""

    frequency: NDArray[np.float64]  # (bin,) Hz, equally spaced from 0
    density: NDArray[np.complex128]  # (bin, probe, probe) m^2/Hz, Hermitian, positive definite


def noise_spectrum(
    waveforms: Waveforms, shaft: ShaftAngle, *, orders: tuple[float, ...], up_to: float
) -> NoiseSpectrum:
    """Return the noise between the order lines, from 0 to `up_to` [Hz], over the whole recording.

    Raises DataError if no stretch of the recording leaves room between the lines.
    """
    size = round(SEGMENT * waveforms.rate)
    taper = kaiser(size, BETA)
    frequency = np.arange(size // 2 + 1, dtype=np.float64) * (waveforms.rate / size)
    frequency = frequency[frequency <= up_to]
    scale = 1 / (waveforms.rate * np.sum(taper**2))
    lines = sorted({*range(LINES + 1), *(abs(order) for order in orders)})
    spectra, clear = [], []
    for begin in _segment_starts(waveforms, shaft, size):
        stretch = waveforms.samples(begin, begin + size)
        if stretch is not None:
            x = (stretch.x - stretch.x.mean(axis=0)) * taper[:, None]
            spectra.append(np.fft.rfft(x, axis=0)[: len(frequency)] * np.sqrt(scale))
            clear.append(_clear_of_lines(frequency, shaft.omega(stretch.t[::50]) / TURN, lines))
    if not spectra:
        raise DataError(
            f"{waveforms.where}: has no {SEGMENT:g} s of running without a gap, want some to tell noise from vibration"
        )
    density = _average(frequency, np.array(spectra), np.array(clear), waveforms.where)
    floor = np.diag((FLOOR * waveforms.metres_per_count) ** 2 / waveforms.rate)
    return NoiseSpectrum(frequency=frequency, density=density + floor)


def row_covariance(spectrum: NoiseSpectrum, rows: Rows, *, orders: tuple[float, ...]) -> NDArray[np.float64]:
    """Return the covariance (row, order, 2 probe, 2 probe) [m^2] that the noise spectrum gives each row.

    E[z z^H] = 4 integral S(f) |W(f - n f_shaft)|^2 df with S two-sided and W the row's Hann window, W(0) = 1. For
    white noise of variance s^2 and n samples this is var(re z) = var(im z) = 1.5 * 2 s^2 / n. Order 0 is a real
    mean of a quarter of that power; its imaginary part, zero by definition, is given the same variance so that the
    matrix can be inverted.
    """
    step = spectrum.frequency[1]
    f = np.concatenate([-spectrum.frequency[:0:-1], spectrum.frequency])
    density = np.concatenate([spectrum.density[:0:-1].conj(), spectrum.density])
    duration = rows.end - rows.begin
    covariance = np.empty((len(rows.t), len(orders), 2 * density.shape[1], 2 * density.shape[1]))
    for k, order in enumerate(orders):
        kernel = _hann_power((f - (order * rows.omega / TURN)[:, None]) * duration[:, None])
        # a bin may be as wide as the kernel: its area is set to the exact HANN_BANDWIDTH / duration
        kernel *= (HANN_BANDWIDTH / duration / (kernel.sum(axis=1) * step))[:, None]
        power = np.einsum("rf,fpq->rpq", kernel * step, density)
        covariance[:, k] = _pairs(4 * power) if order else _pairs(2 * power.real.astype(complex))
    return covariance


def jitter_covariance(
    z: NDArray[np.complex128], shaft: ShaftAngle, rows: Rows, *, orders: tuple[float, ...]
) -> NDArray[np.float64]:
    """Return the covariance (row, order, 2 probe, 2 probe) [m^2] that the keyphasor's timing error gives `z`.

    An edge that comes late by tau makes the angle lag by omega tau about it: the row turns by n times the mean of
    that under its window, of variance 1.5 (omega tau)^2 / turns, all probes alike.
    """
    timing = np.zeros(len(rows.t))
    for run in np.unique(rows.run):
        mine = rows.run == run
        first, last = int(rows.first_turn[mine].min()), int(rows.first_turn[mine].max()) + rows.turns
        timing[mine] = shaft.jitter(rows.middle[mine], first=first, last=last)
    variance = HANN_BANDWIDTH / rows.turns * (rows.omega * timing) ** 2
    turned = np.nan_to_num(1j * z * np.array(orders)).transpose(0, 2, 1)  # (row, order, probe)
    pairs = np.stack([turned.real, turned.imag], axis=-1).reshape(*turned.shape[:2], -1)
    return variance[:, None, None, None] * pairs[..., :, None] * pairs[..., None, :]


def _segment_starts(waveforms: Waveforms, shaft: ShaftAngle, size: int) -> list[int]:
    """Return at which sample half-overlapping segments begin, within the pulses and the gap-free stretches."""
    starts: list[int] = []
    for first, counts in waveforms.segments:
        begin = max(first, int(np.ceil(shaft.t[0] * waveforms.rate)))
        end = min(first + len(counts), int(shaft.t[-1] * waveforms.rate))
        starts += range(begin, end - size, size // 2)
    return starts


def _clear_of_lines(
    frequency: NDArray[np.float64], shaft_frequency: NDArray[np.float64], lines: list[float]
) -> NDArray[np.bool_]:
    """Return which bins no order line came near while the shaft turned at `shaft_frequency` [Hz]."""
    low, high = shaft_frequency.min(), shaft_frequency.max()
    clear = np.ones(len(frequency), dtype=bool)
    for line in lines:
        clear &= (frequency < line * low - GUARD) | (frequency > line * high + GUARD)
    return clear


def _average(
    frequency: NDArray[np.float64], spectra: NDArray[np.complex128], clear: NDArray[np.bool_], where: str
) -> NDArray[np.complex128]:
    """Average outer products of `spectra` (segment, bin, probe) over the segments that are `clear` (segment, bin)."""
    power = np.where(clear, np.sum(np.abs(spectra) ** 2, axis=2), np.nan)
    seen = clear.any(axis=0)
    median = np.full(len(frequency), np.inf)
    median[seen] = np.nanmedian(power[:, seen], axis=0)
    used = clear & (np.nan_to_num(power, nan=np.inf) <= OUTLIER * median)
    observed = used.sum(axis=0)
    enough = observed >= max(FEWEST, 2 * spectra.shape[2])
    if not enough.any():
        raise DataError(f"{where}: too short to tell noise from vibration, want some ten seconds at changing speed")
    total = np.einsum("sfp,sfq,sf->fpq", spectra, spectra.conj(), used.astype(float))
    known = total[enough] / observed[enough, None, None]
    density = np.empty_like(total)
    for p in range(total.shape[1]):
        for q in range(total.shape[1]):  # entries between positive definite matrices: positive definite again
            density[:, p, q] = np.interp(frequency, frequency[enough], known[:, p, q])
    return density


def _hann_power(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return |W|^2 of a Hann window at x = frequency times duration, 1 at 0: (sinc(x) / (1 - x^2))^2."""
    near = np.abs(np.abs(x) - 1) < 1e-6
    return np.where(near, 0.25, (np.sinc(x) / np.where(near, 1.0, 1 - x**2)) ** 2)


def _pairs(power: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return the covariance of (re z_1, im z_1, ...) of circular z with E[z z^H] = `power` (row, probe, probe).

    E[re re] = E[im im] = re / 2, E[im_i re_k] = im / 2, E[re_i im_k] = -im / 2.
    """
    rows, probes, _ = power.shape
    real = np.empty((rows, probes, 2, probes, 2))
    real[:, :, 0, :, 0] = real[:, :, 1, :, 1] = power.real / 2
    real[:, :, 1, :, 0] = power.imag / 2
    real[:, :, 0, :, 1] = -power.imag / 2
    return real.reshape(rows, 2 * probes, 2 * probes)
