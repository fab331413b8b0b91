"""Order vectors: the complex amplitude of vibration at multiples of the shaft speed, row by row.

A row is `turns` whole turns about the shaft angle theta_0 in its middle, weighted by a Hann window in *angle*:

    z_n = 2 * integral w(psi) x e^{-j n theta} d psi / integral w d psi,  w = 1 + cos(psi / turns), |psi| <= pi turns

so for x = Re(A(theta) e^{j n theta}) with A smooth, z_n is the mean of A under w: the smear a model has to apply too.
Order 0 is the weighted mean itself. The integral is a sum over the samples as they are, weighted by d(theta) =
omega dt; nothing is resampled. w and its slope vanish at both ends, so the sum converges fast: with 20 samples per
turn it is off by 1e-6 of the amplitude.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.tacho import TURN, ShaftAngle
from rotorrig.processing.waveform import Waveforms

_PER_TURN = 8  # points per turn of the fit for a row's speed


@dataclass(frozen=True, slots=True, kw_only=True)
class Rows:
    """Where the rows lie; all arrays (row,)."""

    turns: int
    run: NDArray[np.intp]
    first_turn: NDArray[np.int64]  # a row spans first_turn to first_turn + turns
    begin: NDArray[np.float64]  # s
    end: NDArray[np.float64]  # s
    t: NDArray[np.float64]  # s, at the middle angle
    omega: NDArray[np.float64]  # rad/s, at the middle
    alpha: NDArray[np.float64]  # rad/s^2, at the middle

    @property
    def middle(self) -> NDArray[np.float64]:
        """Turn (fractional) in the middle of each row."""
        return self.first_turn + np.float64(self.turns / 2)


def lay_rows(shaft: ShaftAngle, spans: list[tuple[float, float]], *, turns: int) -> Rows:
    """Place rows one after another within each span (begin, end) [s]; the run of a row is the span's index."""
    run: list[int] = []
    first: list[int] = []
    for index, (begin, end) in enumerate(spans):
        inside = shaft.turn[(shaft.t >= begin) & (shaft.t <= end)]
        if len(inside):
            starts = range(int(inside[0]), int(inside[-1]) - turns + 1, turns)
            first += starts
            run += [index] * len(starts)
    first_turn = np.array(first, dtype=np.int64)
    t, omega, alpha = _motion(shaft, first_turn + np.float64(turns / 2), turns)
    return Rows(
        turns=turns,
        run=np.array(run, dtype=np.intp),
        first_turn=first_turn,
        begin=shaft.time_at(first_turn.astype(float)),
        end=shaft.time_at((first_turn + turns).astype(float)),
        t=t,
        omega=omega,
        alpha=alpha,
    )


def track_orders(
    waveforms: Waveforms,
    shaft: ShaftAngle,
    rows: Rows,
    *,
    orders: tuple[float, ...],
    progress: Callable[[float], None] | None = None,
) -> NDArray[np.complex128]:
    """Return z (row, probe, order) [m, 0-peak]; NaN where samples are missing. `progress` is told the fraction done."""
    z = np.full((len(rows.t), waveforms.probes, len(orders)), np.nan, dtype=complex)
    for i, (begin, end) in enumerate(zip(rows.begin, rows.end, strict=True)):
        stretch = waveforms.between(begin, end)
        if stretch is not None and len(stretch.t):
            psi = shaft.theta(stretch.t) - TURN * rows.middle[i]
            z[i] = order_vectors(
                stretch.x, psi, shaft.omega(stretch.t), orders=orders, turns=rows.turns, middle=TURN * rows.middle[i]
            )
        if progress:
            progress((i + 1) / len(rows.t))
    return z


def order_vectors(
    x: NDArray[np.float64],
    psi: NDArray[np.float64],
    omega: NDArray[np.float64],
    *,
    orders: tuple[float, ...],
    turns: int,
    middle: float = 0.0,
) -> NDArray[np.complex128]:
    """Return z (probe, order) of one row: `x` (sample, probe) at angles `psi` [rad] from the row's `middle` angle.

    `omega` (sample,) is the speed, which makes d(psi) of equal steps in time. The mean is taken out first, so that
    a gap of a millimetre cannot leak into micrometres of order 1.
    """
    weight = hann_in_angle(psi, turns=turns) * omega
    weight = weight / weight.sum()
    mean = weight @ x
    turning = weight[:, None] * np.exp(-1j * np.outer(psi + middle, orders))
    z = 2 * (x - mean).T @ turning
    steady = np.array(orders) == 0
    z[:, steady] = mean[:, None]
    return z


def hann_in_angle(psi: NDArray[np.float64], *, turns: float) -> NDArray[np.float64]:
    """Return the weight of angle psi [rad] from the row's middle; zero with its slope at the row's ends."""
    return 1 + np.cos(psi / turns)


def _motion(
    shaft: ShaftAngle, middle: NDArray[np.float64], turns: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return t, omega, alpha at the middle of each row.

    A parabola t(psi) fitted under the row's own weights, so that the jitter of single pulses averages out, and its
    slope and curvature freed of what a constant acceleration adds in psi^3 and psi^4, which more terms in the fit
    would pay for in noise. omega = 1 / t', alpha = -t'' / t'^3, hence t''' = 3 t''^2 / t', t'''' = 15 t''^3 / t'^2.
    """
    psi = TURN * turns * (np.arange(turns * _PER_TURN) + 0.5) / (turns * _PER_TURN) - np.pi * turns
    root = np.sqrt(hann_in_angle(psi, turns=turns))
    basis = np.stack([np.ones_like(psi), psi, psi**2 / 2], axis=1)
    solve = np.linalg.pinv(basis * root[:, None]) * root
    t = shaft.time_at((middle[:, None] + psi / TURN).ravel()).reshape(len(middle), len(psi))
    centre = shaft.time_at(middle)
    _, slope, curvature = solve @ (t - centre[:, None]).T
    third, fourth = 3 * curvature**2 / slope, 15 * curvature**3 / slope**2
    slope = slope - third * (solve[1] @ psi**3) / 6
    curvature = curvature - fourth * (solve[2] @ psi**4) / 24
    return centre, 1 / slope, -curvature / slope**3
