"""Levenberg-Marquardt within bounds: the local least-squares method of searches and of fits.

Measured against scipy's `least_squares` within bounds (x_scale="jac", exact Jacobians; its "lm" knows no bounds) and
against the two methods this one replaces, one for searches and one for fits. Searches: calls, median and 90 %, and ms
of CPU per search; every search shown succeeded. Fits: residuals and Jacobians, means, and ms; 12 base fits of a healthy
RK4, 15 extended fits of rigs with a fault.

| | this | searches' | fits', damped | trf | dogbox |
|---|---|---|---|---|---|
| Table 7, f2, 20 seeds | 24, 42; 5.6 | 24, 42; 4.3 | 28, 46; 11 | 23, 29; 9 to 15 | 27, 47; 10 |
| Table 7, complex | 43, 85; 14 | 43, 84; 12 | 74, 216; 60 | 40, 48; 30 | 58, 232; 69 |
| Table 7, 40 random truths | 27, 58 | 27, 58; 8 | 30, 104; 26 | 30, 132; 44 | 26, 50; 19 |
| Table 8, f1, 15 draws | 309, 499 | 342, 515; 74 | 582, 767; 183 | 371, 439; 113 | 374, 651; 120 |
| base fits | not run | 6.6, 6.6; 216 | 3.4, 3.4; 108 | 6.4, 6.4; 241 | 4.2, 4.2; 143 |
| extended fits | 7.5, 5.7; 270 | - | 10.3, 5.9; 315 | 10.0, 9.6; 461 | 7.2, 6.6; 304 |

Of the 27 fits, trf ended at the lowest minimum met, to the fit's tolerance, in 27, dogbox and the former fits' method
in 26. This one's 15 extended fits ended there in 14; the other, of 59 parameters, ended "converged" at a chi2 of
4737.82, where trf reaches 4735.91 (tolerance 0.1). Its base fits were compared only through whole `identify` runs, of
four seeds: 86 residuals and 41 Jacobians before and after, chi2 equal to four decimals. Per search of Table 7 it takes
more CPU than the searches' former method, 5.6 ms against 4.3. Where this one has no time, it was taken under another
load of the machine. Its fits are those before damped steps followed bends and two idle steps ended a fit.

Damping follows Nielsen ("Damping parameter in Marquardt's method", 1999), scaled by the columns' lengths (Marquardt
1963). Two ways to begin, in `Settings`:

- SEARCH, from far off: damped, and no step moves a parameter by more than `reach`, for the linear model of a resonance
  does not hold any farther.
- FIT, from a fair guess: full steps first. Where unknowns nearly make up for each other the sum of squares has a narrow
  valley, and where they enter nonlinearly it bends: a full step leaves it, and a damped one gets nowhere. A second step
  by the same derivatives leads back into it (Shamanskii, Ukrainian Math. J. 19 (1967) 133), for the price of one
  residual. A damped step that gains less than half of its promise follows the bend as well, by its second derivative
  along the step: geodesic acceleration (Transtrum, Machta and Sethna, Phys. Rev. E 83 (2011) 036701).

Damped, while a resonance has to move by several of its widths, the amplitude of its excitation is wrong on the way;
solved for again after a step (separable least squares, Golub and Pereyra 1973), it cannot hold the rest back.

Six fits of a diagnosis that took long (rotating damping, a cubic spring; 99 to 104 parameters), Jacobians and where
they ended, without following the bend and with it: 10 at 31330 and 17 at 31192; 14 at 30167 and 9 at 30167; 13 at 29203
and 8 at 29203; 16 at 30168 and 16 at 30176; 7 at 223873 and 8 at 223658; 20 at 223854 and 23 at 129362.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.residuals.linear_model import LinearModel
from rotorrig.identify.chea.residuals.point import Point, Residuals, answering
from rotorrig.identify.chea.residuals.settings import LINEAR_MODEL

Array = NDArray[np.float64]
T = TypeVar("T")
Solve = Callable[[Array], Array]  # p with its linear parameters at their best

_TINY = np.finfo(float).tiny


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Choice of steps."""

    full_steps: bool = True  # tried before damped ones; not where a residual takes as long as its Jacobian
    damping: float = 1e-5  # of the first damped step, in units of the columns' lengths
    reach: float = np.inf  # longest step in any parameter
    trials: int = 12  # damped steps on one Jacobian; not measured: by 2, 4, 8 .. the damping exceeds any before that
    bends: int = 4  # further full steps on it
    shortest: float = 1 / 3  # share of a full step: where the parabola is lowest sooner, damped steps lead further
    left: float = 0.05  # of its promise: a full step that leaves less needs no further one
    probed: float = 0.1  # share of a damped step at which it is seen how the valley bends
    straight: float = 0.75  # of a step's length: where its second derivative is longer, the bend is not followed
    followed: float = 0.2  # of its promise: what a step that follows the bend has to gain
    idle: float = 0.01  # of its promise: a step that gains less, or with full steps less than the tolerance, is no way
    patience: int = 2  # to the minimum; so many in a row end the descent (idle 0: none does)


FIT = Settings()
#: A tenth damps the first step where the start is anywhere. Reach: half a resonance's width; other values not measured.
SEARCH = Settings(full_steps=False, damping=0.1, reach=0.25, idle=0.0)


class Stop(StrEnum):
    """Why a descent ended."""

    CONVERGED = "converged"
    STALLED = "stalled"  # no step of any length helped, or hardly: the derivative is at its rounding
    BUDGET = "budget"  # its steps or calls were used up
    GIVEN_UP = "given up"  # what was left to gain was not worth it
    ENOUGH = "enough"  # low enough, or where it leads is known


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """State of a descent, shown to `watch` after every step."""

    point: Point  # the lowest
    costs: Sequence[float]  # the lowest until every call
    model: LinearModel  # of its surroundings


@dataclass(frozen=True, slots=True, kw_only=True)
class Minimum:
    """End of a descent."""

    point: Point
    steps: int  # Jacobians taken
    calls: int  # residuals taken, but for the start's
    stop: Stop

    @property
    def converged(self) -> bool:
        """True if a full step promised less than the tolerance."""
        return self.stop is Stop.CONVERGED


def descend_squares(
    start: Point,
    *,
    bounds: tuple[Array, Array],
    settings: Settings = FIT,
    tolerance: float = 0.0,
    share: float = 0.0,
    floor: float = 0.0,
    max_steps: int = 50,
    max_calls: int | None = None,
    solve_linear: Solve = lambda p: p,
    watch: Callable[[Progress], Stop | None] = lambda progress: None,
) -> Residuals[Minimum]:
    """Minimize the sum of squares from `start`, which is within the bounds.

    It has converged when no step promises more than `tolerance`, or than that `share` of what the sum is beyond
    `floor`. `max_steps` counts Jacobians, `max_calls` residuals. `solve_linear` returns its argument with the linear
    parameters at their best; without full steps every step is followed by it. What `watch` says after a step, if
    anything, ends the descent.

    >>> def valley(p):
    ...     return np.array([10 * (p[1] - p[0]**2), 1 - p[0]]), np.array([[-20 * p[0], 10], [-1, 0]])
    >>> from rotorrig.identify.chea.residuals import Counted
    >>> fun, box = Counted(valley), (np.full(2, -5.0), np.full(2, 5.0))
    >>> found = minimize_squares(fun, fun(np.array([-1.2, 1.0])), bounds=box, tolerance=1e-12)
    >>> found.point.p.round(6).tolist(), found.steps, str(found.stop)
    ([1.0, 1.0], 2, 'converged')
    """
    point, damping, idle = start, settings.damping, 0
    calls = _Calls(start.cost, most=max_calls)
    for step in range(1, max_steps + 1):
        model = LinearModel(point.J, point.r, point.p, bounds, reach=settings.reach)
        why, enough = None, max(tolerance, share * (point.cost - floor))
        if _is_minimum(model, enough, damping, settings):
            why = Stop.CONVERGED
        elif step > 1:
            why = watch(Progress(point=point, costs=calls.costs, model=model))
        taken = None
        if why is None:
            taken = yield from calls.count(
                try_steps(model, solve_linear=solve_linear, damping=damping, settings=settings)
            )
        if taken is not None:
            gained = point.cost - taken.point.cost
            least = max(settings.idle * model.full_promise, enough if settings.full_steps else 0.0)
            idle = idle + 1 if settings.idle and gained < least else 0
        if taken is None or idle == settings.patience:
            why = why or (Stop.BUDGET if calls.used_up else Stop.STALLED)
            return Minimum(point=point, steps=step, calls=calls.made, stop=why)
        point, damping = taken.point, taken.damping
    return Minimum(point=point, steps=max_steps, calls=calls.made, stop=Stop.BUDGET)


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """A step that lowered the sum of squares."""

    point: Point  # where it ended
    damping: float  # of the next one


def try_steps(
    model: LinearModel,
    *,
    solve_linear: Solve = lambda p: p,
    damping: float = FIT.damping,
    settings: Settings = FIT,
) -> Residuals[Step | None]:
    """Take the full step of a linear model, or the longest damped one that helps; None if none does.

    A damped step that gains less than half of its promise follows the bend of the valley. Without full steps the linear
    parameters are solved for after every one.
    """
    if settings.full_steps and (point := (yield from _take_full_step(model, settings))) is not None:
        return Step(point=point, damping=max(0.1 * damping, LINEAR_MODEL.least_damping))
    growth = 2.0
    for _ in range(settings.trials):
        aimed = model.best(damping)
        promised = model.promise(aimed)
        point = yield aimed if settings.full_steps else solve_linear(aimed)
        if settings.full_steps and model.cost - point.cost < promised / 2:
            point = yield from _follow_bend(model, point, aimed, damping, settings)
        gained = model.cost - point.cost
        if gained > 0:
            share = min(gained / max(promised, _TINY), 1.0)
            damping *= max(0.1, 1 - (2 * share - 1) ** 3)  # Nielsen, eq. (2.5)
            return Step(point=point, damping=max(damping, LINEAR_MODEL.least_damping))
        damping, growth = damping * growth, 2 * growth
    return None


minimize_squares = answering(descend_squares)
take_step = answering(try_steps)


def _is_minimum(model: LinearModel, enough: float, damping: float, settings: Settings) -> bool:
    """Say whether no step promises more than `enough`: the damped one is asked first where it is taken first."""
    if not settings.full_steps and model.promise(model.best(damping)) > enough:
        return False
    return model.full_promise <= enough


def _take_full_step(model: LinearModel, settings: Settings) -> Residuals[Point | None]:
    """Take the undamped step, and further ones by the same derivatives; None if it gains less than half its promise.

    Each of the further ones has to halve what is left of the promise, or it leads nowhere. Where the residual is large
    and bends, the sum of squares rises more steeply than its linear model knows, though that holds: then the step ends
    at the lowest point of the parabola through both ends.
    """
    promise = model.full_promise
    floor = model.cost - promise
    first = point = yield model.best(LINEAR_MODEL.least_damping)
    for _ in range(settings.bends):
        left = point.cost - floor
        if not settings.left * promise < left < np.inf:
            break
        further = yield model.further(point.p, point.r)
        if not further.cost - floor < left / 2:
            break
        point = further
    if point.cost - floor < promise / 2:
        return point
    share = promise / (first.cost - model.cost + 2 * promise)
    if not settings.shortest < share < 1:
        return None
    inner = yield model.along(share, model.best(LINEAR_MODEL.least_damping))
    return min(inner, point, key=_cost) if model.cost - inner.cost > share * promise / 2 else None


def _follow_bend(
    model: LinearModel, straight: Point, aimed: Array, damping: float, settings: Settings
) -> Residuals[Point]:
    """Return where a damped step leads if it follows the bend of the valley; its own end if that gains too little."""
    near = yield model.along(settings.probed, aimed)
    bent = model.bend(aimed, near.r, settings.probed, damping, straight=settings.straight)
    if bent is None:
        return straight
    point = yield bent
    enough = model.cost - point.cost > settings.followed * model.promise(aimed)
    return point if enough and point.cost < straight.cost else straight


def _cost(point: Point) -> float:
    return point.cost


class _Calls:
    """Calls of a descent, counted; an answer costs infinitely once they are used up."""

    def __init__(self, cost: float, *, most: int | None) -> None:
        self._most = most
        self.costs = [cost]  # the lowest until every call

    @property
    def made(self) -> int:
        return len(self.costs) - 1

    @property
    def used_up(self) -> bool:
        return self._most is not None and self.made >= self._most

    def count(self, part: Residuals[T]) -> Residuals[T]:
        """Pass on what a part of the descent asks for, while there are calls left."""
        try:
            p = next(part)
            while True:
                if self.used_up:
                    point = Point(p, np.full(1, np.inf), np.zeros((1, len(p))))
                else:
                    point = yield p
                    self.costs.append(min(point.cost, self.costs[-1]))
                p = part.send(point)
        except StopIteration as end:
            return end.value
