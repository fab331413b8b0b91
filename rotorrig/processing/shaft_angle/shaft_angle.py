"""Keyphasor pulses to shaft angle: 2 pi times the turns made at each pulse, a smooth curve through them.

A pulse says nothing of the speed until the next; the curve takes it to change smoothly and averages the pulses' timing
errors over as many turns as the data allow (smooth_angle). Missed, extra and displaced pulses are found (pulse_train,
teeth, displaced) and repaired where the curve knows the angle well enough across them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PPoly

from rotorrig.processing.shaft_angle.displaced_pulses import drop_displaced
from rotorrig.processing.shaft_angle.multi_tooth import count_teeth, tooth_angles
from rotorrig.processing.shaft_angle.pulse_train import Gaps, PulseTrain, count_pulses
from rotorrig.processing.shaft_angle.smooth_angle import TURN, SmoothAngle, fit_angle
from rotorrig.processing.windows import BLACKMAN_BANDWIDTH

BRIDGED = 0.02  # rad (1.1 deg), 1 sigma of the angle amid missed pulses: beyond, its turns are not to be used
UNMARKED = "no tooth of the keyphasor is marked: phases compare within this recording alone"
_PER_TURN = 4  # places at which the variance of a row's angle is looked at


@dataclass(frozen=True, slots=True, kw_only=True)
class Flaw:
    """Turns that are not as they should be, and why."""

    first_turn: int
    last_turn: int
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaftAngle:
    """Shaft angle as a function of time on the recording's clock, with its uncertainty."""

    t: NDArray[np.float64]  # (pulse,) s, accepted edges; of tooth 0 where there are several per turn
    turn: NDArray[np.int64]  # (pulse,) turns since the first edge; jumps by more than one where pulses are missing
    flaws: tuple[Flaw, ...]  # angle not to be trusted
    repairs: tuple[Flaw, ...]  # pulses missed or extra, angle as good as its sigma says
    smooth: SmoothAngle
    remarks: tuple[str, ...] = ()  # of all turns

    @property
    def spline(self) -> PPoly:
        """The angle [rad] over time [s], a polynomial between pulses."""
        return self.smooth.curve

    def theta(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the shaft angle [rad] at times t [s], 0 at the first edge."""
        return self.spline(t)

    def omega(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the speed [rad/s] at times t [s]."""
        return self.spline(t, 1)

    def alpha(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the angular acceleration [rad/s^2] at times t [s]."""
        return self.spline(t, 2)

    def omega_sigma(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the 1-sigma uncertainty (time,) of the speed [rad/s]."""
        return np.sqrt(self.smooth.variance(t)[:, 1])

    def alpha_sigma(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the 1-sigma uncertainty (time,) of the acceleration [rad/s^2]."""
        return np.sqrt(self.smooth.variance(t)[:, 2])

    def row_angle_sigma(
        self, middle: NDArray[np.float64], *, turns: float, bandwidth: float = BLACKMAN_BANDWIDTH
    ) -> NDArray[np.float64]:
        """Return the 1-sigma uncertainty [rad] of the mean angle of rows of `turns` turns about turns `middle` (row,).

        Under a window of a noise bandwidth of `bandwidth` / turns. Errors of a curve that averages more turns than the
        row are alike all over it; those of one that passes through every pulse are independent, and so is what it
        leaves open between pulses. The less of the first two is taken, which is the variance or, where both lengths are
        equal, up to 1.5 times too much.
        """
        places = (np.arange(turns * _PER_TURN) + 0.5) / _PER_TURN - turns / 2
        t = self.time_at(np.ravel(np.asarray(middle)[:, None] + places))
        variance = self.smooth.variance(t)[:, 0].reshape(len(middle), -1)
        at_pulse = np.interp(t, self.spline.x, self.smooth.smoothed[:, 0, 0]).reshape(variance.shape)
        single = (self.omega(t) * np.interp(t, self.spline.x, self.smooth.sigma)).reshape(variance.shape)
        pulses = turns * (len(self.spline.x) - 1) / max(self.turn[-1], 1)
        alike = at_pulse.mean(axis=1)
        independent = bandwidth / pulses * np.mean(single**2, axis=1)
        between = bandwidth / pulses * np.maximum(variance - at_pulse, 0).mean(axis=1)
        return np.sqrt(np.minimum(alike, independent) + between)

    def time_at(self, turn: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the time [s] at which the shaft has made `turn` turns, fractions included, by Newton's method."""
        knots = self.spline.x
        angle = np.maximum.accumulate(self.theta(knots))
        wanted = TURN * np.asarray(turn, dtype=float)
        k = np.clip(np.searchsorted(angle, wanted, side="right") - 1, 0, len(knots) - 2)
        earliest, latest = knots[k], knots[k + 1]
        earliest = np.where(k == 0, 2 * knots[0] - knots[1], earliest)  # the first pulse may have come too late
        latest = np.where(k == len(knots) - 2, 2 * knots[-1] - knots[-2], latest)
        t = np.interp(wanted, angle, knots)
        for _ in range(5):
            slope = np.maximum(self.omega(t), 1e-6)  # the curve may dip where the rotor stands still
            t = np.clip(t - (self.theta(t) - wanted) / slope, earliest, latest)
        return t

    def pulses(self) -> NDArray[np.float64]:
        """Return the time [s] of every whole turn by the smooth angle, where a pulse without timing error would be."""
        return self.time_at(np.arange(self.turn[-1] + 1, dtype=float))

    def jitter(self, turn: NDArray[np.float64], *, first: int, last: int) -> NDArray[np.float64]:
        """Return the 1-sigma timing error [s] of single edges around each of `turn`, from turns `first` to `last`.

        As the smooth angle's fit found it, over some hundred pulses; zero where the range holds no edge.
        """
        inside = (self.turn >= first) & (self.turn <= last)
        if not inside.any():
            return np.zeros(len(turn))
        sigma = np.interp(self.t[inside], self.spline.x, self.smooth.sigma)
        return np.interp(turn, self.turn[inside], sigma)


def fit_shaft_angle(
    edges: NDArray[np.float64], *, gaps: Gaps = (), per_turn: int = 1, where: str = "keyphasor"
) -> ShaftAngle:
    """Return the shaft angle through keyphasor edges at times `edges` [s], increasing, `per_turn` of them a turn.

    `gaps` are stretches [s] without samples. Extra pulses are dropped and missed ones counted: a repair where the angle
    is known across them, else, as a gap, a flaw. Raises DataError for fewer than 5 edges, or turns of several edges,
    or too many flawed ones.
    """
    if per_turn > 1:
        return _fit_wheel(edges, per_turn, gaps, where)
    train = count_pulses(edges, gaps=gaps, where=where)
    train = drop_displaced(train, TURN * train.number.astype(float))
    smooth = fit_angle(train.t, TURN * train.number.astype(float), cut=train.in_gap | train.uncounted)
    flaws, repairs = _judge(train, smooth, per_turn)
    return ShaftAngle(t=train.t, turn=train.number, flaws=flaws, repairs=repairs, smooth=smooth)


def _fit_wheel(edges: NDArray[np.float64], teeth: int, gaps: Gaps, where: str) -> ShaftAngle:
    wheel = count_teeth(edges, teeth=teeth, gaps=gaps, where=where)
    places = tooth_angles(wheel, where=where)
    train = drop_displaced(wheel.train, _angle(wheel.train, places))
    smooth = fit_angle(train.t, _angle(train, places), cut=train.in_gap | train.uncounted)
    turn, tooth = np.divmod(train.number, teeth)
    flaws, repairs = _judge(train, smooth, teeth)
    return ShaftAngle(
        t=train.t[tooth == 0],
        turn=turn[tooth == 0],
        flaws=flaws,
        repairs=repairs,
        smooth=smooth,
        remarks=() if wheel.marked else (UNMARKED,),
    )


def _angle(train: PulseTrain, places: NDArray[np.float64]) -> NDArray[np.float64]:
    turn, tooth = np.divmod(train.number, len(places))
    return TURN * turn + places[tooth]


def _judge(train: PulseTrain, smooth: SmoothAngle, per_turn: int) -> tuple[tuple[Flaw, ...], tuple[Flaw, ...]]:
    """Return the flaws, whose turns cannot be used, and the repairs."""
    amid = np.sqrt(smooth.variance((train.t[1:] + train.t[:-1]) / 2)[:, 0])
    bridged = train.missed & ~train.uncounted & (amid < BRIDGED)
    flaws = _turns(train, train.in_gap, per_turn, "gap in the samples")
    flaws += _turns(train, train.missed & ~bridged, per_turn, "missed pulse")
    repairs = _turns(train, bridged, per_turn, "missed pulse bridged")
    for time in train.extra:
        k = int(np.interp(time, train.t, train.number)) // per_turn
        repairs.append(Flaw(first_turn=k, last_turn=k + 1, reason="extra pulse dropped"))
    return tuple(flaws), tuple(repairs)


def _turns(train: PulseTrain, steps: NDArray[np.bool_], per_turn: int, reason: str) -> list[Flaw]:
    begin, end = train.number[:-1] // per_turn, -(-train.number[1:] // per_turn)
    return [Flaw(first_turn=int(begin[i]), last_turn=int(end[i]), reason=reason) for i in np.flatnonzero(steps)]
