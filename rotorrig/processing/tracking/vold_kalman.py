"""Vold-Kalman filter: order vectors of all orders at once, so that close orders are separated.

The waveform is Re(sum_n A_n(theta) e^{j n theta}) plus a rest, and the A_n are as smooth as they can be: they minimise

    integral (x - Re sum_n A_n e^{j n theta})^2 d theta + lambda integral sum_n |A_n''|^2 d theta,

the second-generation filter with two poles (Vold & Leuridan, SAE 931288, 1993; Feldbauer & Hoeldrich, DAFX-00; Tuma,
ICCC 2005), here in shaft angle: its bandwidth is in orders and its smear in turns, the same at any speed. Far from the
ends of the recording and of the other orders, z_n is the mean of A_n under the weights

    w = e^{-u} (cos u + sin u),  u = 4 |psi| / (2 pi turns),

a filter of the response 1 / (1 + (f / f0)^4) at f orders beside its own, f0 = 2 sqrt(2) / (pi turns) orders: as much
white noise passes as through a Hann window of `turns` turns. A parabola passes as it is (the second moment of w is
zero), which a Hann window flattens. The weights are negligible beyond u = 5 pi / 2, where what is cut off weighs
nothing in the mean: `support` turns in all, which a row needs around it.

The A_n are cubic splines, in blocks that overlap: memory does not grow with the recording.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.rows import Rows
from rotorrig.processing.shaft_angle import TURN, ShaftAngle
from rotorrig.processing.tracking.envelope_splines import SPAN, EnvelopeSplines
from rotorrig.processing.tracking.row_samples import angle_and_speed
from rotorrig.processing.waveform import Waveforms

CUTOFF = 2 * math.sqrt(2) / math.pi  # f0 times turns: equal to the noise bandwidth of a Hann window, 1.5 / turns
SUPPORT = 5 * math.pi / 4  # times turns: |u| <= 5 pi / 2
KNOTS = 16  # of the splines in `turns` turns: what passes is then off by 5e-5 of the amplitude at most
BLOCK = 64  # times turns, solved at once
OVERLAP = SUPPORT  # times turns on either side of a block: what a free end does has died down to 1.5e-7
CHUNK = 1 << 15  # samples at a time
ALWAYS = (0.0, 1.0)  # orders that are in the equations, asked for or not: they leak most

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


def support(turns: float) -> float:
    """Return the turns that a row of noise bandwidth 1.5 / `turns` orders rests on; `revolutions` of the response.

    >>> round(support(8), 3)
    31.416
    """
    return SUPPORT * turns


def power_response(x: Reals) -> Reals:
    """Return |H|^2 at x = orders beside its own times turns; its integral is 1.5, as a Hann window's."""
    return 1 / (1 + (x / CUTOFF) ** 4) ** 2


def track(
    waveforms: Waveforms,
    shaft: ShaftAngle,
    rows: Rows,
    *,
    orders: tuple[float, ...],
    progress: Callable[[float], None] | None = None,
) -> Complex:
    """Return z (row, probe, order) [m, 0-peak]; NaN where a row's support is not within gap-free samples and pulses.

    Orders less than 3 / turns apart share what modulates them: 1 / turns apart, each gets 0.8 of the noise power that
    it would get alone. `progress` gets the fraction done.
    """
    asked = np.abs(orders)
    solved = np.union1d(asked, ALWAYS)
    splines = EnvelopeSplines.of(tuple(solved), knot=rows.turns / KNOTS, cutoff=CUTOFF / rows.turns)
    column = np.searchsorted(solved, asked)
    z = np.full((len(rows.t), waveforms.probes, len(orders)), np.nan, dtype=complex)
    done = 0
    for mine, cells in _blocks(waveforms, shaft, rows, knot=splines.knot):
        moments, mean = _moments(waveforms, shaft, splines, cells)
        coefficients = splines.solve(moments, first=cells[0])
        envelopes = splines.at(coefficients, rows.middle[mine], first=cells[0])
        envelopes[:, :, splines.orders == 0] += mean[:, None]
        z[mine] = envelopes[:, :, column]
        done += len(mine)
        if progress:
            progress(done / len(rows.t))
    if progress:
        progress(1.0)  # rows without a vector are done too
    backward = np.array(orders) < 0
    z[:, :, backward] = z[:, :, backward].conj()
    return z


def _blocks(
    waveforms: Waveforms, shaft: ShaftAngle, rows: Rows, *, knot: float
) -> Iterator[tuple[NDArray[np.intp], tuple[int, int]]]:
    """Yield the rows solved at once and the cells between knots that their block covers, its overlap included."""
    half, around = support(rows.turns) / 2, OVERLAP * rows.turns
    for first, last in _stretches(waveforms, shaft):
        begin, end = shaft.theta(np.array([first, last - 1]) / waveforms.rate) / TURN
        low, high = math.ceil(begin / knot), math.floor(end / knot)
        inside = np.flatnonzero((rows.middle - half >= begin) & (rows.middle + half <= end))
        number = (rows.middle[inside] // (BLOCK * rows.turns)).astype(np.intp)
        for block in np.unique(number):
            mine = inside[number == block]
            first_cell = math.floor((rows.middle[mine].min() - around) / knot)
            last_cell = math.ceil((rows.middle[mine].max() + around) / knot)
            yield mine, (max(low, first_cell), min(high, last_cell))


def _stretches(waveforms: Waveforms, shaft: ShaftAngle) -> Iterator[tuple[int, int]]:
    """Yield the sample ranges without a gap, as far as there are pulses."""
    begin, end = math.ceil(shaft.t[0] * waveforms.rate), math.floor(shaft.t[-1] * waveforms.rate)
    for first, counts in waveforms.segments:
        if min(first + len(counts), end) > max(first, begin):
            yield max(first, begin), min(first + len(counts), end)


def _moments(
    waveforms: Waveforms, shaft: ShaftAngle, splines: EnvelopeSplines, cells: tuple[int, int]
) -> tuple[Reals, Reals]:
    """Return the equations' right-hand side (function, probe, order, 2) and the mean (probe,) taken out of it.

    That is the mean of the first samples, so that a gap of a millimetre costs no digits of micrometres.
    """
    first, last = (math.ceil(t * waveforms.rate) for t in shaft.time_at(np.array(cells) * splines.knot))
    moments = np.zeros((cells[1] - cells[0] + SPAN - 1, waveforms.probes, len(splines.orders), 2))
    mean = None
    for start in range(first, last, CHUNK):
        stretch = waveforms.samples(start, min(start + CHUNK, last))
        assert stretch is not None  # of a stretch without a gap
        mean = stretch.x.mean(axis=0) if mean is None else mean
        theta, omega = angle_and_speed(stretch.t, shaft.spline.x, shaft.spline.c)
        turns_each = omega / (TURN * waveforms.rate)
        splines.add_moments(moments, theta / TURN, turns_each, stretch.x - mean, cells=cells)
    assert mean is not None
    return moments, mean
