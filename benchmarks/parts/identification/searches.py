"""Two other ways to the minimum of an objective on amplitudes: CHEA that is shown its value alone, and brute force."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from benchmarks.parts.identification import valley_search
from rotorrig.identify.base_model import ObjectiveName
from rotorrig.identify.base_model.objectives import Amplitudes
from rotorrig.identify.chea import Residual, chea
from rotorrig.identify.chea.residuals import descend_absolute
from rotorrig.identify.chea.session import Record

Real = NDArray[np.float64]
Misfit = Callable[[Real], Real]  # points (n, dim) -> shares of the amplitudes (n,)

BUDGET = 10_000  # calls of the black box
_EXACT = 1e-6  # of the amplitudes
_STINT = 200  # calls of CHEA in a round of the black box: after 500 its best point leads to a true minimum no oftener
_NIL = 1e-12  # of the amplitudes: has a logarithm
_SLOW = (20, 0.05)  # steps that gain less than this share of the squared misfit end the descent of a round
_AGREED = 0.01  # of the value: rounds that end so close ended, but for what `_SLOW` leaves, in one minimum
_ENOUGH = 6  # rounds that agree: two in five end in a wide basin of f1
_RADIUS = 0.05  # of the cube: first step of a descent in sums of absolute values
_DESCENT = 300  # calls of a descent to the end
_BRIEF = 30  # of one that shows what a start is worth
_CARRIED = 8  # of these go on
_SCATTERED = 8  # starts about the best
_SCATTER = 0.02  # of the cube: in stiffness a factor of 1.4
_SAME = 1e-3  # of the cube: places this close are one, a factor of 1.02 in stiffness
_INSIDE = 1e-9  # of the cube: scipy's method wants starts that far inside


def box(amplitudes: Amplitudes) -> Real:
    """Return the bounds of kxx, kyy, cxx, cyy and u, (5, 2) in SI."""
    space = amplitudes.steady.space
    return np.array([*space.bounds, *((amount.low, amount.high) for amount in space.amounts)])


def black_box(amplitudes: Amplitudes, *, objective: ObjectiveName, seed: int) -> tuple[Real, float, int]:
    """Return where rounds of CHEA (profile modern) end, (5,) in SI, the objective there, and the calls that took.

    CHEA is shown the logarithm of the value alone: that makes wide funnels of deep and narrow minima. It searches
    coefficients on the scale of `_coefficients`, the amount being the best for each. A round is a stint of it
    and a descent with `valley_search` from its best point, for damping has 1e-4 to 1e-6 of the curvature stiffness has;
    it is given up where it slows down, for another round costs less than the end of a descent. Rounds follow until one
    fits within `_EXACT` of the amplitudes (no objective here can be less than nothing), `_ENOUGH` agree, or `BUDGET` is
    spent. The best end is then descended from once more, to the last.
    """
    size, power = amplitudes.size(objective), 0.5 if objective == "f1" else 1.0

    def misfit(points: Real) -> Real:
        return (amplitudes.least_cost(_coefficients(amplitudes, points), objective=objective)[0] / size) ** power

    rng = np.random.default_rng(seed)
    ends: list[_End] = []
    calls = 0
    while calls < BUDGET and not _settled(sorted(end.misfit for end in ends)):
        ends.append(_round(misfit, amplitudes.steady.dim, budget=BUDGET - calls, rng=rng))
        calls += ends[-1].calls
    best = _descend(misfit, min(ends, key=lambda end: end.misfit), budget=BUDGET - calls, rng=rng)
    u = _coefficients(amplitudes, best.point[None])
    (least,), (amount,) = amplitudes.least_cost(u, objective=objective)
    return np.array(amplitudes.theta(np.append(u, amount))), float(least), calls + best.calls


class _End(NamedTuple):
    """Where a part of the search ended: the point (dim,) of the cube, its misfit, and the calls it took."""

    point: Real
    misfit: float
    calls: int


def _coefficients(amplitudes: Amplitudes, points: Real) -> Real:
    """Return coefficients (n, dim), as `Steady` has them, for points (n, dim) of the cube that is searched.

    Stiffness by its mobility (`Steady.starts`): over its logarithm most of the box is a plateau on which the rotor is
    free or held and no search is told anything. Damping by the cube root of its ratio to the typical: what rules the
    peaks is far below what rules the motion off resonance, and where there is none next to nothing depends on it.
    """
    space = amplitudes.steady.space
    damping = np.array([name[0] == "c" for name in space.coefficients * len(space.groups)])
    ratio = points / np.maximum(1 - points, _INSIDE)
    return amplitudes.steady.starts(np.where(damping, ratio**3 / (1 + ratio**3), points))


def _settled(ends: list[float]) -> bool:
    """Return whether the least of the misfits, in ascending order, is as good as nothing or was met often enough."""
    if not ends:
        return False
    return ends[0] <= _EXACT or (len(ends) >= _ENOUGH and ends[_ENOUGH - 1] - ends[0] <= _AGREED * ends[0])


def _round(misfit: Misfit, dim: int, *, budget: int, rng: np.random.Generator) -> _End:
    """Return the end of a stint of CHEA and a descent from its best point, with the calls of both, at most `budget`."""

    def logarithm(points: Real) -> Real:
        return np.log(np.maximum(misfit(points), _NIL))

    cube, target = [(0.0, 1.0)] * dim, float(np.log(_EXACT))
    found = chea(logarithm, cube, rng=rng, vectorized=True, max_nfev=min(_STINT, budget), f_target=target)
    best = _End(found.x, float(np.exp(found.fun)), found.nfev)
    end = _descend(misfit, best, budget=budget - found.nfev, rng=rng, stalled=_SLOW)
    return end._replace(calls=found.nfev + end.calls)


def _descend(
    misfit: Misfit,
    start: _End,
    *,
    budget: int,
    rng: np.random.Generator,
    stalled: tuple[int, float] = valley_search.STALLED,
) -> _End:
    """Descend on the misfit's square to the end, an exact fit or the budget; return where, with the calls of this."""
    record = Record(len(start.point), same_point=0.0)
    part = valley_search.descend(record, start.point, start.misfit**2, rng=rng, max_calls=budget, stalled=stalled)
    asked = next(part, None)
    while asked is not None and record.nfev < budget and min(start.misfit, record.best[1] ** 0.5) > _EXACT:
        values = misfit(asked[: budget - record.nfev]) ** 2
        record.add(asked[: len(values)], values)
        try:
            asked = part.send(values)
        except StopIteration:
            break
    lower = record.best[1] < start.misfit**2
    point, least = (record.best[0], record.best[1] ** 0.5) if lower else (start.point, start.misfit)
    return _End(point, least, record.nfev)


def least_of_many(
    amplitudes: Amplitudes, *, objective: ObjectiveName, starts: int, near: Real, rng: np.random.Generator
) -> float:
    """Return the least value of the objective met from `near` (5,) SI, from random starts and from about the best.

    Of the random starts half are uniform in the logarithmic box, half where rotors answer to their bearings. Sums of
    absolute values descend from none of them (f3 ended seven times too high in 40 of 40): there the logarithmic
    amplitudes are fitted first. All descend a little way; the lowest of those that are apart go on to the end. More
    starts, for descents on the objective itself, are scattered about the best. All local methods but that for absolute
    values are scipy's.
    """
    low, high = np.log(box(amplitudes)).T
    nearby = np.clip((np.log(near) - low) / (high - low), 0.0, 1.0)
    ends: list[_Descent] = []
    for start in _starts(amplitudes, starts, rng):
        v = start if objective == "f1" else _least_squares(amplitudes.log_ratios, start, calls=_BRIEF).v
        if all(np.abs(v - end.start).max() > _SAME for end in ends):
            ends.append(_follow(amplitudes, objective, v, calls=_BRIEF))
    best = _follow(amplitudes, objective, nearby)
    for v in _lowest_apart(ends):
        best = min(best, _follow(amplitudes, objective, v), key=_value)
    for _ in range(_SCATTERED):
        v = np.clip(best.v + _SCATTER * rng.standard_normal(len(best.v)), 0.0, 1.0)
        best = min(best, _follow(amplitudes, objective, v), key=_value)
    return best.value


class _Descent(NamedTuple):
    """Where a descent began and ended, (5,) of the cube, and the value there."""

    start: Real
    v: Real
    value: float


def _value(descent: _Descent) -> float:
    return descent.value


def _lowest_apart(ends: list[_Descent]) -> list[Real]:
    """Return the lowest ends, `_CARRIED` of them, no two of them the same."""
    apart: list[Real] = []
    for end in sorted(ends, key=_value):
        if len(apart) < _CARRIED and all(np.abs(end.v - other).max() > _SAME for other in apart):
            apart.append(end.v)
    return apart


def _starts(amplitudes: Amplitudes, count: int, rng: np.random.Generator) -> Iterator[Real]:
    yield from rng.random((count - count // 2, amplitudes.dim))
    for u in amplitudes.steady.starts(rng.random((count // 2, amplitudes.steady.dim))):
        yield np.append(u, amplitudes.amount(u))


def _follow(amplitudes: Amplitudes, objective: ObjectiveName, v: Real, *, calls: int = _DESCENT) -> _Descent:
    fun = amplitudes.vector(objective)
    if objective == "f1":
        return _least_squares(fun, v, calls=calls)
    return _Descent(v, *descend_absolute(fun, v, radius=_RADIUS, max_calls=calls)[:2])


def _least_squares(fun: Residual, start: Real, *, calls: int) -> _Descent:
    """Return the end of scipy's trust region within bounds, with the sum of squares there."""
    last: dict[bytes, tuple[Real, Real]] = {}

    def once(v: Real) -> tuple[Real, Real]:  # scipy asks for residuals and derivatives one after the other
        if (key := v.tobytes()) not in last:
            last.clear()
            last[key] = fun(v)
        return last[key]

    found = least_squares(
        lambda v: once(v)[0],
        np.clip(start, _INSIDE, 1 - _INSIDE),
        jac=lambda v: once(v)[1],
        bounds=(0.0, 1.0),
        x_scale="jac",
        ftol=1e-12,
        xtol=1e-12,
        gtol=None,
        max_nfev=calls,
    )
    return _Descent(start, found.x, 2 * float(found.cost))
