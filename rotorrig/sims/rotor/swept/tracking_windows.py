"""Windows of a tracking filter on a timeline, row by row, laid out once for all models.

An order n of the shaft's rotation is a phase that turns n times as fast: to it the same window is n times as many
turns. All of its turns, speeds and powers are that phase's.
"""

from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from rotorrig.rig import DataError
from rotorrig.sims.rotor.swept.timeline import TURN, SpeedRange, Timeline, Turns

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]
Window = Literal["blackman", "hann", "rectangular", "vold-kalman"]

POINTS = 16  # Gauss points per window, or half of a long one; enough for two beats of a free vibration within it
KALMAN_END = 2.5 * np.pi  # u at the ends of a Vold-Kalman window: what lies beyond weighs nothing in the mean
SPILL = 0.5  # turns a window may reach over either end of the pulses: rounding of the row's time


class Points(NamedTuple):
    """Quadrature points of every row's window, and their weights."""

    omega: Reals  # (row, point) rad/s
    alpha: Reals  # (row, point) rad/s^2
    edges: Reals  # (row, point + 1) turns between which each point stands
    weighted: Reals  # (row, point, power) weight times x^power


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackedRows:
    """Rows on a timeline: everything of their averages that does not depend on the rotor.

    Powers are those of x, see SpeedRange.
    """

    timeline: Timeline
    t: Reals  # (row,) s
    revolutions: Reals  # (row,) of the shaft
    window: Window
    order: float
    turns: Turns
    speeds: SpeedRange
    power: Reals  # (turn, power)
    power_mid: Reals  # (turn - 1, power) halfway in time
    turn_index: NDArray[np.intp]  # (row, span) the whole turns a row's window spans
    moments: Reals  # (row, power, 2 span) takes values and slopes d/dt at those turns to the averages of x^power a
    points: Points
    solutions: list[tuple[Any, Any]] = field(default_factory=list, repr=False, compare=False)  # of solve_sweep
    _other_orders: "dict[float, TrackedRows]" = field(default_factory=dict, repr=False, compare=False)

    def of_order(self, order: float) -> "TrackedRows":
        """Return the same rows for another order, laid out when first asked for. Raises ValueError unless positive."""
        if order == self.order:
            return self
        if order not in self._other_orders:
            self._other_orders[order] = tracked_rows(
                self.timeline, t=self.t, revolutions=self.revolutions, window=self.window, order=order
            )
        return self._other_orders[order]

    def averages(self, a: Complex, rate: Complex, *, powers: int) -> Complex:
        """Return the averages of x^power a over every row's window, (row, power, ...), from a and a', (turn, ...)."""
        out = np.zeros((len(self.turn_index), powers, a[0].size), dtype=complex)
        _average(self.moments, self.turn_index, a.reshape(len(a), -1), rate.reshape(len(a), -1), out)
        return out.reshape(*out.shape[:2], *a.shape[1:])


def tracked_rows(
    timeline: Timeline, *, t: ArrayLike, revolutions: ArrayLike, window: Window, order: float = 1.0
) -> TrackedRows:
    """Return the rows around the times `t` [s], each an average over `revolutions` turns, weighted by `window`.

    A window is centred, in shaft angle, on its row's time, and weighs by `window_weights`. Raises DataError on a row
    that is not within the pulses, ValueError on another window or an order that is not above zero.
    """
    if not order > 0:
        raise ValueError(f"order is {order:g}, want one above zero")
    t = np.asarray(t, dtype=float)
    revolutions = np.broadcast_to(np.asarray(revolutions, dtype=float), t.shape)
    turn, edges, weight = _points(timeline, t, revolutions, window)
    turn, edges, turns = order * turn, order * edges, timeline.turns(order)
    omega = np.append(turns.omega, turns.omega_mid)
    speeds = SpeedRange(float(omega.min()), float(omega.max()))
    turn_index, values, slopes = _hermite(turns, turn)
    omega, alpha = _at_points(turns, turn, turn_index, values, slopes)
    weighted = weight[:, None] * speeds.powers(omega)  # (row, point, power)
    return TrackedRows(
        timeline=timeline,
        t=t,
        revolutions=revolutions,
        window=window,
        order=order,
        turns=turns,
        speeds=speeds,
        power=speeds.powers(turns.omega),
        power_mid=speeds.powers(turns.omega_mid),
        turn_index=turn_index,
        moments=weighted.swapaxes(1, 2) @ np.concatenate([values, slopes], axis=-1),
        points=Points(omega=omega, alpha=alpha, edges=edges, weighted=weighted),
    )


def window_weights(x: Reals, window: str) -> Reals:
    """Return what a window weighs at x, -1 to 1 from its begin to its end, in shaft angle; not normalised.

    Evenly ("rectangular"), by 1 + cos(pi x) ("hann"), by 0.42 + 0.5 cos(pi x) + 0.08 cos(2 pi x) ("blackman"), or as a
    Vold-Kalman filter of two poles does, by e^{-u} (cos u + sin u), u = 5 pi |x| / 2 ("vold-kalman"). Raises ValueError
    on another window.
    """
    match window:
        case "rectangular":
            return np.ones_like(x)
        case "hann":
            return 1 + np.cos(np.pi * x)
        case "blackman":
            return 0.42 + 0.5 * np.cos(np.pi * x) + 0.08 * np.cos(2 * np.pi * x)
        case "vold-kalman":
            u = KALMAN_END * np.abs(x)
            return np.exp(-u) * (np.cos(u) + np.sin(u))
    raise ValueError(f"window is {window!r}, want one of {', '.join(map(repr, get_args(Window)))}")


def _points(timeline: Timeline, t: Reals, revolutions: Reals, window: Window) -> tuple[Reals, Reals, Reals]:
    """Return where each row looks, in turns since the first pulse, and the weights (point,).

    The points (row, point) stand for the turns between edges (row, point + 1).
    """
    x, weight = np.polynomial.legendre.leggauss(POINTS)
    if window == "vold-kalman":  # whose third derivative jumps in the middle: each half on its own
        x, weight = np.append(x - 1, x + 1) / 2, np.append(weight, weight) / 2
    edge = np.append(-1.0, np.cumsum(weight) - 1)
    weight = weight * window_weights(x, window)
    half = revolutions / 2
    middle = timeline.theta(t) / TURN
    last = len(timeline.t) - 1
    inside = (middle - half > -SPILL) & (middle + half < last + SPILL)  # False for NaN
    if not np.all(inside):
        row = int(np.argmin(inside))
        raise DataError(
            f"row {row}: its window of {2 * half[row]:g} turns about {t[row]:g} s is not within the keyphasor pulses, "
            f"{timeline.t[0]:g} to {timeline.t[-1]:g} s"
        )
    turn, edges = (np.clip(middle[:, None] + half[:, None] * at, 0, last) for at in (x, edge))
    return turn, edges, weight / weight.sum()


def _hermite(turns: Turns, turn: Reals) -> tuple[NDArray[np.intp], Reals, Reals]:
    """Return the whole turns around a row's points, (row, span), and what a cubic in angle between them weighs.

    The weights, (row, point, span) each, are of the values there and of their derivatives by time.
    """
    k = np.minimum(turn.astype(np.intp), len(turns.t) - 2)
    s = turn - k
    turn_index = k[:, :1] + np.arange(int(np.ptp(k, axis=1).max(initial=0)) + 2)
    before, after = (k[..., None] + i == turn_index[:, None] for i in (0, 1))
    turn_index = np.minimum(turn_index, len(turns.t) - 1)  # a shorter window gives its last ones no weight
    start, end = 2 * s**3 - 3 * s**2 + 1, 3 * s**2 - 2 * s**3  # Hermite's cubics: values, then slopes
    leave, arrive = s**3 - 2 * s**2 + s, s**3 - s**2
    per_turn = TURN / turns.omega[turn_index]  # s: d/dturn = per_turn d/dt
    values = start[..., None] * before + end[..., None] * after
    slopes = (leave[..., None] * before + arrive[..., None] * after) * per_turn[:, None]
    return turn_index, values, slopes


def _at_points(
    turns: Turns, turn: Reals, turn_index: NDArray[np.intp], values: Reals, slopes: Reals
) -> tuple[Reals, Reals]:
    """Return speed and acceleration at the points of the windows, (row, point): a cubic and straight lines."""
    omega = values @ turns.omega[turn_index][..., None] + slopes @ turns.alpha[turn_index][..., None]
    return omega[..., 0], np.interp(turn, np.arange(len(turns.t)), turns.alpha)


@njit(cache=True)
def _average(moments: Reals, turn_index: NDArray[np.intp], a: Complex, rate: Complex, out: Complex) -> None:
    """Add the averages of every column to `found` (row, power, column), without a copy of what the rows see."""
    rows, powers, columns = out.shape
    span = turn_index.shape[1]
    for row in range(rows):
        for power in range(powers):
            for i in range(span):
                turn = turn_index[row, i]
                by_value, by_rate = moments[row, power, i], moments[row, power, span + i]
                for c in range(columns):
                    out[row, power, c] += by_value * a[turn, c] + by_rate * rate[turn, c]
