"""1X while the speed moves, as a tracking filter sees it: the lag of a sweep and the smear of the window.

`swept_response` needs no parameter of its own: the keyphasor tells the speed at every instant. Against integration in
time of configs/rk4.toml through its resonance the error is 2e-6 of the peak (30 rpm/s up, 60 rpm/s down, damping ratio
0.02); the steady response would be wrong by 0.13 and 0.24. With a damping ratio of 0.001 it is up to 1e-3: the beat
behind the resonance then lasts until it is too fast to be followed from turn to turn.
"""

from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.rig.errors import DataError
from rotorrig.sims.rotor.assembly import RotorModel
from rotorrig.sims.rotor.passage import Complex, march, passage
from rotorrig.sims.rotor.timeline import TURN, Timeline, Turns

Window = Literal["hann", "rectangular"]

POINTS = 16  # Gauss points per window; enough for two beats of a free vibration within it
SPILL = 0.5  # turns a window may reach over either end of the pulses: rounding of the row's time


def swept_response(
    model: RotorModel,
    timeline: Timeline,
    *,
    t: ArrayLike,
    revolutions: ArrayLike,
    window: Window,
    unbalance: Mapping[str, complex],
) -> NDArray[np.complex128]:
    """Return the 1X amplitudes z [m, 0-peak] at the probes as tracked in rows around the times `t` [s], (row, probe).

    A row averages the amplitude A(t) of Re(A e^{j theta}) over `revolutions` turns centred, in shaft angle, on its
    time: evenly ("rectangular") or weighted 1 + cos(psi / turns), |psi| <= pi turns ("hann"). The rotor starts in the
    steady state of the first pulse. Give a reduced model: eigenvalues cost dof^3. `unbalance` as in steady_response.
    Raises DataError on a row that is not within the pulses, ValueError on an unknown window.
    """
    turn, weight = _window(timeline, np.asarray(t, dtype=float), revolutions, window)
    turns = timeline.turns
    speeds = np.append(turns.omega, turns.omega_mid)
    modes = passage(model, slowest=speeds.min(), fastest=speeds.max(), unbalance=unbalance)
    omega, alpha, a = _between(turns, *march(modes, turns), turn)
    power = (weight[:, None] * modes.powers(omega)).swapaxes(1, 2)  # (row, power, point)
    passed = power @ a  # (row, power, mode)
    others = power @ (omega**2 - 1j * alpha)[..., None]  # (row, power, 1)
    return np.tensordot(passed, modes.shape, 2) + others[..., 0] @ modes.others


def _window(
    timeline: Timeline, t: NDArray[np.float64], revolutions: ArrayLike, window: Window
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where each row looks, in turns since the first pulse (row, point), and the weights (point,)."""
    x, weight = np.polynomial.legendre.leggauss(POINTS)
    if window == "hann":
        weight = weight * (1 + np.cos(np.pi * x))
    elif window != "rectangular":
        raise ValueError(f"window is {window!r}, want 'hann' or 'rectangular'")
    half = np.broadcast_to(np.asarray(revolutions, dtype=float), t.shape) / 2
    middle = timeline.theta(t) / TURN
    last = len(timeline.t) - 1
    inside = (middle - half > -SPILL) & (middle + half < last + SPILL)  # False for NaN
    if not np.all(inside):
        row = int(np.argmin(inside))
        raise DataError(
            f"row {row}: its window of {2 * half[row]:g} turns about {t[row]:g} s is not within the keyphasor pulses, "
            f"{timeline.t[0]:g} to {timeline.t[-1]:g} s"
        )
    return np.clip(middle[:, None] + half[:, None] * x, 0, last), weight / weight.sum()


def _between(
    turns: Turns, a: Complex, rate: Complex, turn: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], Complex]:
    """Return speed, acceleration and passed amplitudes at fractional turns, by cubics in angle (alpha: straight)."""
    k = np.minimum(turn.astype(np.intp), len(turns.t) - 2)
    s = turn - k
    start, end = 2 * s**3 - 3 * s**2 + 1, 3 * s**2 - 2 * s**3  # Hermite's cubics: values, then slopes
    leave, arrive = s**3 - 2 * s**2 + s, s**3 - s**2
    per_turn = TURN / turns.omega  # s: d/dturn = per_turn d/dt
    slope = per_turn * turns.alpha
    omega = start * turns.omega[k] + end * turns.omega[k + 1] + leave * slope[k] + arrive * slope[k + 1]
    alpha = (1 - s) * turns.alpha[k] + s * turns.alpha[k + 1]
    start, end, leave, arrive = (weight[..., None] for weight in (start, end, leave, arrive))
    rate = per_turn[:, None] * rate
    return omega, alpha, start * a[k] + end * a[k + 1] + leave * rate[k] + arrive * rate[k + 1]
