"""Kalman filter and smoother of a shaft whose acceleration drifts: theta''' is white noise of density q.

State (theta, omega, alpha), at each pulse known to have turned by a given angle, to a variance r [rad^2]. In state and
covariance theta is the deviation from the pulse's angle, which keeps digits where a shaft has made 1e5 turns.

A step of infinite q is a cut: nothing is carried across it, and the filter starts anew behind it.

Between pulses h [s] apart the state goes on by F = [[1, h, h^2/2], [0, 1, h], [0, 0, 1]] and its covariance gains
Q = q [[h^5/20, h^4/8, h^3/6], [h^4/8, h^3/3, h^2/2], [h^3/6, h^2/2, h]]. Rauch, Tung, Striebel, AIAA J. 3 (1965)
1445, the covariance as a sum of two positive terms, which rounding leaves positive.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Vector = NDArray[np.float64]

VAGUE = 1e6  # of the variance a start has from its own three pulses: they count once, and digits last


@njit(cache=True)
def innovations(h: Vector, turned: Vector, r: Vector, q: Vector, chi2: Vector, log_s: Vector) -> None:
    """Write v^2 / s and log s of every pulse's innovation v, of variance s, the pulses before it known.

    `h` (pulse - 1,) s and `turned` (pulse - 1,) rad are the steps from pulse to pulse, `q` (pulse - 1,) rad^2/s^5,
    `r` (pulse,) rad^2; `chi2` and `log_s` (pulse,) are written.
    """
    x, p, x_next, p_next = np.empty(3), np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    for k in range(len(r)):
        if k == 0 or np.isinf(q[k - 1]):
            _start(k, h, turned, r, q, x_next, p_next)
        else:
            _predict_state(x, h[k - 1], turned[k - 1], x_next)
            _predict_covariance(p, h[k - 1], q[k - 1], p_next)
        s = p_next[0, 0] + r[k]
        chi2[k] = x_next[0] ** 2 / s
        log_s[k] = np.log(s)
        _correct(x_next, p_next, r[k], x, p)


@njit(cache=True)
def smooth(h: Vector, turned: Vector, r: Vector, q: Vector) -> tuple[Vector, Vector, Vector]:
    """Return the state (pulse, 3), its covariance (pulse, 3, 3), and the covariance with the pulses so far alone.

    Arguments as of `innovations`.
    """
    n = len(r)
    x, p = np.empty((n, 3)), np.empty((n, 3, 3))
    x_next, p_next = np.empty(3), np.empty((3, 3))
    for k in range(n):
        if k == 0 or np.isinf(q[k - 1]):
            _start(k, h, turned, r, q, x_next, p_next)
        else:
            _predict_state(x[k - 1], h[k - 1], turned[k - 1], x_next)
            _predict_covariance(p[k - 1], h[k - 1], q[k - 1], p_next)
        _correct(x_next, p_next, r[k], x[k], p[k])
    so_far = p.copy()
    for k in range(n - 2, -1, -1):
        if not np.isinf(q[k]):
            _predict_state(x[k], h[k], turned[k], x_next)
            gain, p[k] = _smooth_step(so_far[k], h[k], q[k], p[k + 1])
            for i in range(3):
                for j in range(3):
                    x[k, i] += gain[i, j] * (x[k + 1, j] - x_next[j])
    return x, p, so_far


@njit(cache=True)
def covariance_between(t: Vector, knots: Vector, q: Vector, smoothed: Vector, so_far: Vector) -> Vector:
    """Return the variances (time, 3) of theta, omega and alpha at times `t` between (or beyond) the pulses `knots`.

    Amid a cut the shaft may be anywhere in the turn.
    """
    variance = np.empty((len(t), 3))
    p, p_first = np.empty((3, 3)), np.empty((3, 3))
    last = len(knots) - 1
    for i in range(len(t)):
        k = np.searchsorted(knots, t[i], side="right") - 1
        if k < 0:  # back in time omega has the other sign
            for d in range(9):
                p_first[d // 3, d % 3] = smoothed[0, d // 3, d % 3] * (-1.0) ** (d % 2)
            _predict_covariance(p_first, knots[0] - t[i], 0.0 if np.isinf(q[0]) else q[0], p)
        elif k >= last:
            _predict_covariance(smoothed[last], t[i] - knots[last], 0.0 if np.isinf(q[last - 1]) else q[last - 1], p)
        elif np.isinf(q[k]):
            for d in range(3):
                p[d, d] = (np.pi / (knots[k + 1] - knots[k]) ** d) ** 2
        else:
            _predict_covariance(so_far[k], t[i] - knots[k], q[k], p)
            p = _smooth_step(p, knots[k + 1] - t[i], q[k], smoothed[k + 1])[1]
        for d in range(3):
            variance[i, d] = p[d, d]
    return variance


@njit(cache=True)
def smoothest_path(score: NDArray[np.float32], price: float) -> NDArray[np.int64]:
    """Return the path (step,) through `score` (step, rung) of the largest sum, a change by one rung costing `price`.

    Viterbi, IEEE Trans. Inf. Theory 13 (1967) 260.
    """
    steps, rungs = score.shape
    came_from = np.empty((steps, rungs), np.int16)
    best = score[0].astype(np.float64)
    for k in range(1, steps):
        _reach(best, came_from[k], price)
        best += score[k]
    path = np.empty(steps, np.int64)
    path[-1] = np.argmax(best)
    for k in range(steps - 1, 0, -1):
        path[k - 1] = came_from[k, path[k]]
    return path


@njit(cache=True)
def smoothest_scales(
    chi2: Vector, log_s: Vector, count: Vector, scale: Vector, scale_price: float, price: float
) -> NDArray[np.int64]:
    """Return the path (block,) of scales, where a rung is chosen with each and changes of either have their price.

    `chi2` and `log_s` (block, rung) are sums of v^2 / s and log s over the `count` (block,) pulses of a block; `scale`
    (block, scale) is what s is then to be multiplied with.
    """
    blocks, scales, rungs = len(chi2), scale.shape[1], chi2.shape[1]
    came_scale = np.empty((blocks, rungs, scales), np.int16)
    came_rung = np.empty((blocks, scales, rungs), np.int16)
    best = np.zeros((scales, rungs))
    for b in range(blocks):
        if b > 0:
            for m in range(rungs):
                _reach(best[:, m], came_scale[b, m], scale_price)
            for j in range(scales):
                _reach(best[j], came_rung[b, j], price)
        for j in range(scales):
            common, part = count[b] * np.log(scale[b, j]), 1 / scale[b, j]
            for m in range(rungs):
                best[j, m] -= 0.25 * (common + log_s[b, m] + chi2[b, m] * part)
    path = np.empty(blocks, np.int64)
    j, m = divmod(int(np.argmax(best)), rungs)
    path[-1] = j
    for b in range(blocks - 1, 0, -1):
        m = came_rung[b, j, m]
        j = came_scale[b, m, j]
        path[b - 1] = j
    return path


@njit(cache=True)
def _reach(best: Vector, came_from: NDArray[np.int16], price: float) -> None:
    """Raise `best` (rung,) to what is reached from another rung at `price` per rung, and note from which."""
    rungs = len(best)
    for m in range(rungs):
        came_from[m] = m
    for m in range(1, rungs):
        if best[m - 1] - price > best[m]:
            best[m], came_from[m] = best[m - 1] - price, came_from[m - 1]
    for m in range(rungs - 2, -1, -1):
        if best[m + 1] - price > best[m]:
            best[m], came_from[m] = best[m + 1] - price, came_from[m + 1]


@njit(cache=True)
def _start(k: int, h: Vector, turned: Vector, r: Vector, q: Vector, x: Vector, p: Vector) -> None:
    """Write the state at pulse k, as good as unknown: the parabola through it and the next two, or what there is."""
    here = min(k, len(h) - 1)
    first, slope, alpha = h[here], turned[here] / h[here], 0.0
    if k + 1 < len(h) and not np.isinf(q[k]) and not np.isinf(q[k + 1]):
        second = h[k] + h[k + 1]
        alpha = 2 * ((turned[k] + turned[k + 1]) / second - slope) / (second - first)
    x[0], x[1], x[2] = 0.0, slope - alpha * first / 2, alpha
    p[:] = 0.0
    p[0, 0] = VAGUE * (r[k] if np.isinf(q[here]) else r[k] + q[here] * first**5)
    p[1, 1] = p[0, 0] / first**2
    p[2, 2] = p[0, 0] / first**4


@njit(cache=True)
def _predict_state(x: Vector, h: float, turned: float, x_next: Vector) -> None:
    """Write F x, theta counted from the next pulse's angle."""
    x_next[0] = x[0] + h * x[1] + h * h / 2 * x[2] - turned
    x_next[1] = x[1] + h * x[2]
    x_next[2] = x[2]


@njit(cache=True)
def _predict_covariance(p: Vector, h: float, q: float, p_next: Vector) -> None:
    """Write F p F^T + Q."""
    half = h * h / 2
    a0 = p[0, 0] + h * p[1, 0] + half * p[2, 0]
    a1 = p[0, 1] + h * p[1, 1] + half * p[2, 1]
    a2 = p[0, 2] + h * p[1, 2] + half * p[2, 2]
    b1, b2 = p[1, 1] + h * p[2, 1], p[1, 2] + h * p[2, 2]
    _drift(h, q, p_next)
    p_next[0, 0] += a0 + h * a1 + half * a2
    p_next[0, 1] += a1 + h * a2
    p_next[0, 2] += a2
    p_next[1, 1] += b1 + h * b2
    p_next[1, 2] += b2
    p_next[2, 2] += p[2, 2]
    p_next[1, 0], p_next[2, 0], p_next[2, 1] = p_next[0, 1], p_next[0, 2], p_next[1, 2]


@njit(cache=True)
def _drift(h: float, q: float, out: Vector) -> None:
    """Write Q."""
    out[0, 0], out[1, 1], out[2, 2] = q * h**5 / 20, q * h**3 / 3, q * h
    out[0, 1] = out[1, 0] = q * h**4 / 8
    out[0, 2] = out[2, 0] = q * h**3 / 6
    out[1, 2] = out[2, 1] = q * h**2 / 2


@njit(cache=True)
def _correct(x: Vector, p: Vector, r: float, x_out: Vector, p_out: Vector) -> None:
    """Write what a measured deviation of 0, of variance r, makes of a state and its covariance."""
    s = p[0, 0] + r
    for i in range(3):
        gain = p[i, 0] / s
        x_out[i] = x[i] - gain * x[0]
        for j in range(i, 3):
            p_out[i, j] = p[i, j] * (r / s) if i == 0 else p[i, j] - gain * p[0, j]
            p_out[j, i] = p_out[i, j]


@njit(cache=True)
def _smooth_step(p: Vector, h: float, q: float, p_after: Vector) -> tuple[Vector, Vector]:
    """Return the smoother's gain G and covariance (I - G F) p (I - G F)^T + G (p_after + Q) G^T, h before p_after."""
    carried, predicted, after = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for i in range(3):  # p F^T
        carried[i, 0] = p[i, 0] + h * p[i, 1] + h * h / 2 * p[i, 2]
        carried[i, 1] = p[i, 1] + h * p[i, 2]
        carried[i, 2] = p[i, 2]
    _predict_covariance(p, h, q, predicted)
    gain = _right_divide(carried, predicted)
    rest = np.empty((3, 3))
    for i in range(3):  # I - G F
        rest[i, 0] = -gain[i, 0]
        rest[i, 1] = -gain[i, 0] * h - gain[i, 1]
        rest[i, 2] = -gain[i, 0] * h * h / 2 - gain[i, 1] * h - gain[i, 2]
        rest[i, i] += 1.0
    _drift(h, q, after)
    for i in range(3):
        for j in range(3):
            after[i, j] += p_after[i, j]
    smoothed = np.zeros((3, 3))
    _add_sandwich(rest, p, smoothed)
    _add_sandwich(gain, after, smoothed)
    return gain, smoothed


@njit(cache=True)
def _add_sandwich(a: Vector, p: Vector, out: Vector) -> None:
    """Add a p a^T, by loops: products of matrices this small are quicker so, to compile too."""
    for i in range(3):
        for j in range(3):
            for k in range(3):
                for m in range(3):
                    out[i, j] += a[i, k] * p[k, m] * a[j, m]


@njit(cache=True)
def _right_divide(b: Vector, a: Vector) -> Vector:
    """Return b a^-1 of a symmetric positive definite `a`, by Cholesky: a scale per row and column does no harm."""
    l00 = np.sqrt(a[0, 0])
    l10, l20 = a[1, 0] / l00, a[2, 0] / l00
    l11 = np.sqrt(max(a[1, 1] - l10 * l10, 1e-16 * a[1, 1]))
    l21 = (a[2, 1] - l20 * l10) / l11
    l22 = np.sqrt(max(a[2, 2] - l20 * l20 - l21 * l21, 1e-16 * a[2, 2]))
    out = np.empty((3, 3))
    for i in range(3):
        y0 = b[i, 0] / l00
        y1 = (b[i, 1] - l10 * y0) / l11
        out[i, 2] = (b[i, 2] - l20 * y0 - l21 * y1) / l22 / l22
        out[i, 1] = (y1 - l21 * out[i, 2]) / l11
        out[i, 0] = (y0 - l10 * out[i, 1] - l20 * out[i, 2]) / l00
    return out
