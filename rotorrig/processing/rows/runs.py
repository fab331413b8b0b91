"""Runs of a recording: from the marks of the plan, or from the speed where there are none."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from rotorrig.acquisition import Event
from rotorrig.processing.response import Run
from rotorrig.processing.shaft_angle import TURN, ShaftAngle
from rotorrig.rig.config import RPM

DIRECTION = {"slow roll": 0, "up": 1, "down": -1, "dwell": 0}  # of a mark's first word or words; others are no runs
SLOW_ROLL_BELOW = 600 * np.pi / 30  # rad/s: a dwell slower than that is a slow roll
STEADY = 0.001  # 1/s: a speed that changes by less than 0.1 % a second dwells
STEADY_SHARE = 0.05  # or by less than this share of the recording's fast changes
HUNTING = 0.03  # of the speed: a rise or a fall by less is a drive that hunts, not a run
BRIEF = 2.0  # s: a dwell as short amid a rise or fall is none
SHORTEST = 16  # turns; a shorter stretch of an unmarked recording is no run
_GRID = 0.25  # s
ENDS = ("stop", "abort", "emergency", "trip", "pause")  # what else than a mark ends a run
TrialChanges = Sequence[tuple[float, Mapping[str, complex]]]  # since when [s] which unbalance [kg m] is on per disk


@dataclass(frozen=True, slots=True, kw_only=True)
class Span:
    """A run and where it lies [s]."""

    run: Run
    begin: float
    end: float


def find_runs(events: Sequence[Event], shaft: ShaftAngle, *, trial: TrialChanges = ()) -> tuple[Span, ...]:
    """Return the runs of a recording in order of time, each with a name of its own.

    `trial` is what trial masses add, in order of time: a run has what is on when it begins, the slow roll included.
    """
    if any(event.kind == "mark" for event in events):
        spans = _from_marks(events, end=float(shaft.t[-1]))
    else:
        spans = _from_speed(shaft)
    count: dict[str, int] = {}
    named = []
    for name, direction, begin, end in spans:
        count[name] = count.get(name, 0) + 1
        own = name if count[name] == 1 else f"{name} {count[name]}"
        on = [unbalance for since, unbalance in trial if since <= begin]
        run = Run(name=own, direction=direction, trial_unbalance=dict(on[-1]) if on else {})
        named.append(Span(run=run, begin=begin, end=end))
    return tuple(named)


def _from_marks(events: Sequence[Event], *, end: float) -> list[tuple[str, int, float, float]]:
    """Return name, direction, begin and end of each run: from its mark to the next mark or end."""
    borders = sorted((e for e in events if e.kind in ("mark", *ENDS)), key=lambda e: e.t_ns)
    until = [e.t_ns / 1e9 for e in borders[1:]] + [end]
    return [
        (mark.text, direction, mark.t_ns / 1e9, stop)
        for mark, stop in zip(borders, until, strict=True)
        if mark.kind == "mark" and (direction := _direction(mark.text)) is not None
    ]


def _direction(label: str) -> int | None:
    return next((d for words, d in DIRECTION.items() if label == words or label.startswith(words + " ")), None)


def _from_speed(shaft: ShaftAngle) -> list[tuple[str, int, float, float]]:
    """Split into stretches of rising, falling and steady speed; the slowest steady one may be the slow roll."""
    t = np.arange(shaft.t[0], shaft.t[-1], _GRID)
    if len(t) < 4:
        return []
    speed = TURN * np.diff(np.interp(t, shaft.t, shaft.turn)) / _GRID  # no single pulse's error counts for much
    trend = _without_hunting(_trend(speed), speed)
    spans = []
    for a, b in _pieces(trend):
        begin, end = float(t[a]), float(t[b]) if b < len(trend) else float(shaft.t[-1])
        pulses = np.flatnonzero((shaft.t >= begin) & (shaft.t <= end))
        if len(pulses) >= SHORTEST:  # at rest there are none
            first, last = pulses[[0, -1]]
            mean = TURN * (shaft.turn[last] - shaft.turn[first]) / (shaft.t[last] - shaft.t[first])
            spans.append((int(trend[a]), begin, end, float(mean)))
    slow = min((s[3] for s in spans if s[0] == 0), default=np.inf)
    return [(_name(d, speed, slow), d, begin, end) for d, begin, end, speed in spans]


def _trend(speed: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return +1, 0, -1 (point,): speed rises, dwells, falls, by the slope of a straight line through 4 s of it."""
    points = min(17, len(speed) - 1 + len(speed) % 2)  # an odd number
    from_middle = _GRID * (np.arange(points) - points // 2)
    slopes = sliding_window_view(speed, points) @ from_middle / np.sum(from_middle**2)
    rate = np.pad(slopes, points // 2, mode="edge")  # the first line is that of all points before its middle too
    steady = np.maximum(STEADY * speed, STEADY_SHARE * np.quantile(np.abs(rate), 0.9))
    return np.where(np.abs(rate) < steady, 0, np.sign(rate)).astype(np.intp)


def _without_hunting(trend: NDArray[np.intp], speed: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the trend with small rises and falls as part of a dwell, and brief dwells as part of a rise or fall."""
    trend = trend.copy()
    for a, b in _pieces(trend):
        if trend[a] and np.ptp(speed[a:b]) < HUNTING * speed[a:b].mean():
            trend[a:b] = 0
    for a, b in _pieces(trend):
        if trend[a] == 0 and (b - a) * _GRID < BRIEF and a > 0 and b < len(trend) and trend[a - 1] == trend[b]:
            trend[a:b] = trend[b]
    return trend


def _pieces(trend: NDArray[np.intp]) -> Iterator[tuple[int, int]]:
    """Yield where each stretch of one trend begins and where the next does."""
    yield from itertools.pairwise([0, *(np.flatnonzero(np.diff(trend)) + 1).tolist(), len(trend)])


def _name(direction: int, speed: float, slowest: float) -> str:
    if direction:
        return "up" if direction > 0 else "down"
    return "slow roll" if speed == slowest and speed < SLOW_ROLL_BELOW else f"dwell {speed * RPM:.0f} rpm"
