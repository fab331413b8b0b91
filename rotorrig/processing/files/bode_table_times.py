"""Times of a Bode table's rows, derived from what the mapping says of a run, so that a model can follow the speed.

A run whose rows are consecutive revolutions tells its times by adding these up. A run at a known ramp tells them by
its speeds, t = (Omega - Omega_0) / ramp, and keyphasor pulses follow at whole turns of that. Such times give every row
its speed and acceleration, which is what a passage through a resonance depends on; between runs nobody knows how much
time went by, so runs stand one after the other in the order of the mapping, `SETTLED` apart. Times by a ramp, and those
of several runs, are no clock's: see `OrderTrackedResponse.derived_times`.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.files.bode_table_mapping import DIRECTIONS, SLOW_ROLL, TableRun

Reals = NDArray[np.float64]

TURN = 2 * np.pi
SETTLED = 5.0  # s at the first speed of a run after another: a vibration of 2 % damping at 20 Hz has died to e^-12
SLOWEST = 0.5  # of a run's lowest speed, where it is followed to before its first row or after its last
SPARE = 2  # turns beyond half a window, before the first row and after the last
ONE_TURN = (
    "one turn supposed: the table gives a ramp but not over how many turns a row was averaged (revolutions in [[runs]])"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class TableTimes:
    """What is known of when the rows were."""

    t: Reals  # (row,) s, NaN: unknown
    alpha: Reals  # (row,) rad/s^2, NaN: unknown
    revolutions: Reals  # (row,) turns, NaN: unknown
    pulses: Reals  # (pulse,) s, empty: unknown
    derived: bool  # from a ramp, or over several runs
    remarks: tuple[tuple[str, ...], ...]  # (row,) what was supposed; empty: nothing


@dataclass(frozen=True, slots=True, kw_only=True)
class _Passage:
    """One run on a time line of its own, which begins at 0."""

    interval: Reals  # (turn,) s, how long every turn took
    t: Reals  # (row,) s
    alpha: Reals  # (row,) rad/s^2
    first: float  # rad/s, at its begin
    last: float


def derive_times(omega: Reals, runs: tuple[TableRun, ...], run: NDArray[np.intp]) -> TableTimes:
    """Return the times of rows of speeds `omega` (row,) [rad/s] that are of the runs `run` (row,).

    They are known if every run but a slow roll has a ramp or a row per revolution, as the mapping ensures.
    """
    unknown = np.full(len(omega), np.nan)
    times = TableTimes(
        t=unknown,
        alpha=np.array([0.0 if runs[i].direction == "dwell" else np.nan for i in run]),
        revolutions=np.array([_revolutions(runs[i]) for i in run]),
        pulses=np.empty(0),
        derived=False,
        remarks=(),
    )
    timed = [i for i, each in enumerate(runs) if each.name != SLOW_ROLL and (run == i).any()]
    if not timed or not all(runs[i].rows or runs[i].ramp is not None for i in timed):
        return times
    times = _with_passages(times, omega, run, {i: _passage(runs[i], omega[run == i]) for i in timed})
    supposed = [runs[i].ramp is not None and runs[i].revolutions is None for i in run]
    return replace(
        times,
        derived=len(timed) > 1 or any(runs[i].ramp is not None for i in timed),
        revolutions=np.where(supposed, 1.0, times.revolutions),
        remarks=tuple((ONE_TURN,) if one else () for one in supposed) if any(supposed) else (),
    )


def _revolutions(run: TableRun) -> float:
    """Return the turns per row; NaN: unknown."""
    if run.rows:
        return 1.0
    return run.revolutions if run.revolutions is not None else math.nan


def _passage(run: TableRun, omega: Reals) -> _Passage:
    """Return a run, its rows at speeds `omega` (row,) [rad/s], on a time line of its own."""
    if run.rows:
        interval = TURN / omega
        t = np.cumsum(interval) - interval / 2
        alpha = np.gradient(omega, t) if len(t) > 1 else np.full(1, np.nan)
        return _Passage(interval=interval, t=t, alpha=alpha, first=float(omega[0]), last=float(omega[-1]))
    assert run.ramp is not None
    alpha = DIRECTIONS[run.direction] * run.ramp
    begin, end = (omega.min(), omega.max()) if alpha > 0 else (omega.max(), omega.min())
    lead = math.ceil((run.revolutions or 1.0) / 2) + SPARE
    turns = math.ceil((end**2 - begin**2) / (2 * alpha) / TURN)
    speed = _speeds(float(begin), alpha, np.arange(-lead, turns + lead + 1), floor=SLOWEST * float(omega.min()))
    interval = _intervals(speed)
    t = interval[:lead].sum() + (omega - begin) / alpha
    return _Passage(interval=interval, t=t, alpha=np.full(len(t), alpha), first=float(speed[0]), last=float(speed[-1]))


def _speeds(begin: float, alpha: float, turn: NDArray[np.intp], *, floor: float) -> Reals:
    """Return the speed at every turn after that of `begin` [rad/s], at a constant acceleration; never below `floor`."""
    return np.sqrt(np.maximum(begin**2 + 2 * alpha * TURN * turn, floor**2))


def _intervals(speed: Reals) -> Reals:
    """Return how long the turns between speeds (turn + 1,) take at constant acceleration [s]."""
    return 2 * TURN / (speed[1:] + speed[:-1])


def _with_passages(times: TableTimes, omega: Reals, run: NDArray[np.intp], passages: dict[int, _Passage]) -> TableTimes:
    """Return the times with the passages (run -> passage) one after the other."""
    t, alpha = times.t.copy(), times.alpha.copy()
    intervals: list[Reals] = []
    before: _Passage | None = None
    for i, passage in passages.items():
        if before is not None:
            intervals.append(_between(before, passage.first))
        rows = run == i
        t[rows] = passage.t + sum(float(part.sum()) for part in intervals)
        alpha[rows] = passage.alpha
        intervals.append(passage.interval)
        before = passage
    pulses = np.concatenate([[0.0], np.cumsum(np.concatenate(intervals))])
    return replace(times, t=t, alpha=alpha, pulses=pulses)


def _between(before: _Passage, first: float) -> Reals:
    """Return the intervals of a way to the first speed of a run, as many turns as the run before, and a hold there."""
    way = np.sqrt(np.linspace(before.last**2, first**2, max(len(before.interval), 2)))
    hold = np.full(math.ceil(SETTLED * first / TURN), TURN / first)
    return np.concatenate([_intervals(way), hold])
