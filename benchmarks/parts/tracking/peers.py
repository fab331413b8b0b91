"""The same vectors by others' means: rota-order, and a plain computed order tracking with scipy.

Both get what ours gets, the keyphasor's volts and the probes' metres, and give z (row, probe, order), 0-peak, theta = 0
at the keyphasor's falling edge.
"""

import numpy as np
import rota
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import stft

from benchmarks.parts.tracking.signal import IDLE, NOTCH

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

POINTS = 256  # per turn, of the plain resampling


def rota_harmonics(volts: Reals, x: Reals, *, rate: float, orders: tuple[float, ...], turns: int) -> Complex:
    """Return the vectors of every `turns` turns by `rota.extract.tracked_harmonics`, frame by frame.

    Its frames do not overlap, so that each has the window that ours has. It integrates a speed, whose angle drifts from
    the pulses'; its own pulses are used to bring it back, linearly between them, so that its phase can be compared.
    """
    rpm, pulses = rota.speed.tacho_to_rpm(volts, rate, edge="falling", return_info=True)
    found = rota.extract.tracked_harmonics(x, rate, rpm, orders, window_revs=turns, overlap=0.0)
    return _told_by_pulses(found, pulses, rate, orders, turns)


def rota_vold_kalman(
    volts: Reals, x: Reals, *, rate: float, orders: tuple[float, ...], turns: int, bandwidth: float
) -> Complex:
    """Return the vectors of every `turns` turns by `rota.extract.order_waveform`; -3 dB `bandwidth` in Hz."""
    rpm, pulses = rota.speed.tacho_to_rpm(volts, rate, edge="falling", return_info=True)
    found = rota.extract.order_waveform(x, rate, rpm, orders, bandwidth=bandwidth)
    return _told_by_pulses(found, pulses, rate, orders, turns)


def plain_scipy(volts: Reals, x: Reals, *, rate: float, orders: tuple[float, ...], turns: int) -> Complex:
    """Return the vectors of rows of `turns` turns, one after another, as a script of a page would.

    Edges by a threshold, a cubic spline of time over them, a cubic spline of the waveform at equal angles, and
    `scipy.signal.stft` with a Hann window.
    """
    middle = (IDLE + NOTCH) / 2
    before = np.flatnonzero((volts[:-1] > middle) & (volts[1:] <= middle))
    edges = (before + (volts[before] - middle) / (volts[before] - volts[before + 1])) / rate
    grid = np.arange((len(edges) - 1) * POINTS) / POINTS
    t = CubicSpline(np.arange(len(edges)), edges)(grid)
    resampled = CubicSpline(np.arange(len(x)) / rate, x)(t)
    window = turns * POINTS
    _, _, spectrum = stft(
        resampled, fs=POINTS, nperseg=window, noverlap=0, boundary=None, padded=False, axis=0, detrend="constant"
    )
    bins = np.round(np.array(orders) * turns).astype(int)
    return 2 * spectrum[bins].transpose(2, 1, 0)


def _told_by_pulses(found: object, pulses: dict, rate: float, orders: tuple[float, ...], turns: int) -> Complex:
    """Return the envelopes in the middle of every frame, (row, probe, order), their phase told from the pulses about.

    Frames are centred `turns` apart from the first sample on; x = Re(envelope e^{j n rev}).
    """
    rev = found.rev - found.rev[0]
    sample = np.searchsorted(rev, np.arange(0, rev[-1], turns))
    t = np.arange(len(rev)) / rate
    ahead = np.interp(pulses["pulse_times"], t, found.rev) - pulses["pulse_revs"]
    turned = 2 * np.pi * np.interp(t[sample], pulses["pulse_times"], ahead)
    return (found.envelopes[sample] * np.exp(1j * np.outer(turned, orders))[:, :, None]).swapaxes(1, 2)
