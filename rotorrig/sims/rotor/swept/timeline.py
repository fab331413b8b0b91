"""Shaft angle, speed and acceleration from the keyphasor's pulse times."""

from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from rotorrig.rig import DataError

TURN = 2 * np.pi
MOST_POWERS = 13  # of a polynomial in the speed
ROUNDING = 1e-9  # of the last turn's number


class Turns(NamedTuple):
    """The speed at every whole turn and halfway in time between: what the integrator steps over.

    Of the shaft, or of a phase that runs `order` times as fast: all angles and speeds are then the phase's.
    """

    t: NDArray[np.float64]  # (turn,) s
    omega: NDArray[np.float64]  # (turn,) rad/s
    alpha: NDArray[np.float64]  # (turn,) rad/s^2
    omega_mid: NDArray[np.float64]  # (turn - 1,)
    alpha_mid: NDArray[np.float64]  # (turn - 1,)
    theta_mid: NDArray[np.float64]  # (turn - 1,) rad, from the turn before


class SpeedRange(NamedTuple):
    """Lowest and highest speed, and the variable x in [-1, 1] between them that polynomials in the speed use."""

    slowest: float  # rad/s
    fastest: float  # rad/s

    @property
    def centre(self) -> float:
        """The speed [rad/s] of x = 0."""
        return (self.slowest + self.fastest) / 2

    @property
    def half(self) -> float:
        """Speed [rad/s] per unit of x; never zero."""
        return max((self.fastest - self.slowest) / 2, 1e-3 * self.fastest)

    def powers(self, omega: NDArray[np.float64], count: int = MOST_POWERS) -> NDArray[np.float64]:
        """Return 1, x, x^2.. at the speeds, (..., power)."""
        x = (omega - self.centre) / self.half
        return np.vander(x.ravel(), count, increasing=True).reshape(*x.shape, -1)


class Timeline:
    """Shaft angle, speed and acceleration over time: a cubic spline of 2 pi k at the keyphasor pulses t_k [s].

    A missed pulse is recognised by an interval of about twice (three times..) its neighbours'. Raises DataError.

    >>> steady = Timeline(np.arange(10) * 0.02)
    >>> float(round(steady.omega(0.1) / (2 * np.pi), 9))
    50.0
    """

    def __init__(self, pulse_t: ArrayLike) -> None:
        pulse_t = np.asarray(pulse_t, dtype=float)
        if pulse_t.ndim != 1 or len(pulse_t) < 4:
            raise DataError(f"keyphasor: got pulse times of shape {pulse_t.shape}, want four or more in a row")
        interval = np.diff(pulse_t)
        if not np.all(interval > 0):
            first = int(np.argmin(interval > 0)) + 1
            raise DataError(f"keyphasor: pulse {first} at {pulse_t[first]:g} s is not later than the one before")
        usual = np.median(sliding_window_view(np.pad(interval, 2, mode="edge"), 5), axis=1)
        turn = np.append(0.0, np.cumsum(np.maximum(1, np.rint(interval / usual))))
        self._turn_of = CubicSpline(pulse_t, turn)
        self._time_of = CubicSpline(turn, pulse_t)
        self.t = self._time_of(np.arange(turn[-1] + 1))  # (turn,) s, the missed ones too

    def theta(self, t: ArrayLike) -> NDArray[np.float64]:
        """Return the shaft angle [rad] since the first pulse."""
        return TURN * self._turn_of(np.asarray(t, dtype=float))

    def omega(self, t: ArrayLike) -> NDArray[np.float64]:
        """Return the speed [rad/s]."""
        return TURN * self._turn_of(np.asarray(t, dtype=float), 1)

    def alpha(self, t: ArrayLike) -> NDArray[np.float64]:
        """Return the angular acceleration [rad/s^2]."""
        return TURN * self._turn_of(np.asarray(t, dtype=float), 2)

    def turns(self, order: float = 1.0) -> Turns:
        """Return the speed of the phase `order` theta, turn by turn."""
        last = self._turn_of(self.t[-1]) * order
        t = self.t if order == 1 else self._time_of(np.arange(int(last * (1 + ROUNDING)) + 1) / order)
        mid = (t[:-1] + t[1:]) / 2
        return Turns(
            t=t,
            omega=order * self.omega(t),
            alpha=order * self.alpha(t),
            omega_mid=order * self.omega(mid),
            alpha_mid=order * self.alpha(mid),
            theta_mid=order * (self.theta(mid) - self.theta(t[:-1])),
        )
