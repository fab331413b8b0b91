"""Layout of a response's rows: `turns` turns each, one after another, or by steps of speed or time.

Rows never overlap: their noise would be correlated, and a fit takes rows as independent. Where steps are shorter than
a row, rows follow on one another as closely as they can; `crowded_share` tells how many.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.settings import Spacing
from rotorrig.processing.shaft_angle import TURN, ShaftAngle


@dataclass(frozen=True, slots=True, kw_only=True)
class Rows:
    """Rows and their places; all arrays (row,)."""

    turns: int
    run: NDArray[np.intp]
    first_turn: NDArray[np.float64]  # a row spans first_turn to first_turn + turns; whole numbers are keyphasor edges
    begin: NDArray[np.float64]  # s
    end: NDArray[np.float64]  # s
    t: NDArray[np.float64]  # s, at the middle angle
    omega: NDArray[np.float64]  # rad/s, at the middle
    alpha: NDArray[np.float64]  # rad/s^2, at the middle

    @property
    def middle(self) -> NDArray[np.float64]:
        """Turn (fractional) in the middle of each row."""
        return self.first_turn + np.float64(self.turns / 2)


def lay_rows(
    shaft: ShaftAngle,
    spans: Sequence[tuple[float, float]],
    *,
    turns: int,
    every: Sequence[Spacing | None] | None = None,
) -> Rows:
    """Place rows within each span (begin, end) [s], as `every` says of each span; the run of a row is the span's index.

    None: one after another. By steps of speed, a row stands where the speed first passes each multiple of the
    step; by steps of time, at each multiple of it on the recording's clock.
    """
    first: list[NDArray[np.float64]] = []
    for (begin, end), spacing in zip(spans, every or [None] * len(spans), strict=True):
        inside = shaft.turn[(shaft.t >= begin) & (shaft.t <= end)].astype(float)
        low, high = (inside[0], inside[-1]) if len(inside) else (0.0, 0.0)
        if spacing is None:
            first.append(np.arange(low, high - turns + 0.5, turns))
        else:
            middles = (_by_speed if spacing.of == "speed" else _by_time)(shaft, low, high, turns, spacing.step)
            first.append(np.array([*_without_overlap(middles - turns / 2, low, high, turns)]))
    first_turn = np.concatenate([*first, np.empty(0)])
    t = shaft.time_at(first_turn + turns / 2)
    return Rows(
        turns=turns,
        run=np.repeat(np.arange(len(spans)), [len(starts) for starts in first]),
        first_turn=first_turn,
        begin=shaft.time_at(first_turn),
        end=shaft.time_at(first_turn + turns),
        t=t,
        omega=shaft.omega(t),
        alpha=shaft.alpha(t),
    )


def crowded_share(response: OrderTrackedResponse, every: Spacing) -> float:
    """Return the share of rows that stand further from the next than `every` asked for, since they would overlap.

    Further is by a half and more: the speed may hunt. In a dwell there are no steps of speed to keep.
    """
    place = response.omega if every.of == "speed" else response.t
    stepped = np.array([run.direction != 0 or every.of == "time" for run in response.runs])
    following = (response.run[1:] == response.run[:-1]) & stepped[response.run[1:]]
    step = np.abs(np.diff(place))[following]
    return float(np.mean(step > 1.5 * every.step)) if len(step) else 0.0


def _by_speed(shaft: ShaftAngle, low: float, high: float, turns: int, step: float) -> NDArray[np.float64]:
    """Return the turns at which the speed in a row's middle first passes each multiple of `step`, in order."""
    middle = np.arange(low + turns / 2, high - turns / 2 + 0.5)
    if len(middle) < 2:
        return np.empty(0)
    speed = shaft.omega(shaft.time_at(middle))
    passed: dict[int, float] = {}
    for k, (a, b) in enumerate(zip(speed[:-1] / step, speed[1:] / step, strict=True)):
        for multiple in _between(a, b):
            passed.setdefault(multiple, float(middle[k] + (multiple - a) / (b - a)))
    return np.array(sorted(passed.values()))


def _between(a: float, b: float) -> range:
    """Return the whole numbers from a up to b, or down to it; `a` counts, `b` does not, so that each counts once."""
    if a < b:
        return range(int(np.ceil(a)), int(np.ceil(b)))
    return range(int(np.floor(a)), int(np.floor(b)), -1)


def _by_time(shaft: ShaftAngle, low: float, high: float, turns: int, step: float) -> NDArray[np.float64]:
    """Return the turns at each multiple of `step` on the recording's clock."""
    begin, end = shaft.time_at(np.array([low, high]))
    return shaft.theta(step * np.arange(np.ceil(begin / step), np.floor(end / step) + 1)) / TURN


def _without_overlap(first_turn: NDArray[np.float64], low: float, high: float, turns: int) -> Iterator[float]:
    """Yield those of the increasing starts whose row lies between turns `low` and `high` and behind the one before."""
    free = low
    for start in first_turn:
        if free <= start <= high - turns:
            free = start + turns
            yield float(start)
