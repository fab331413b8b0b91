"""Two other ways to the minimum of an objective on amplitudes: CHEA that is shown its value alone, and brute force."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from rotorrig.identify.chea.chea import chea
from rotorrig.identify.chea.least_absolute import descend_absolute
from rotorrig.identify.chea.levenberg_marquardt import Residual
from rotorrig.identify.objective import Amplitudes, Name

Real = NDArray[np.float64]

BUDGET = 10_000  # calls of the black box
_EXACT = {"f1": 1e-6, "f2": 1e-6, "f3": 1e-10}  # of an amplitude; off resonance damping is 1e-6 of f3's
_RADIUS = 0.05  # of the cube: first step of a descent in sums of absolute values
_DESCENT = 300  # calls of one
_FIT = 100  # of a least-squares fit
_SCATTERED = 8  # starts about the best
_SCATTER = 0.02  # of the cube: in stiffness a factor of 1.4
_SAME = 1e-5  # of the cube: ends of fits this close are one
_INSIDE = 1e-9  # of the cube: scipy's method wants starts that far inside


def box(amplitudes: Amplitudes) -> Real:
    """Return the bounds of kxx, kyy, cxx, cyy and u, (5, 2) in SI."""
    space = amplitudes.steady.space
    return np.array([*space.bounds, *((amount.low, amount.high) for amount in space.amounts)])


def black_box(amplitudes: Amplitudes, *, objective: Name, seed: int) -> tuple[Real, float, int]:
    """Return where CHEA (profile modern) ends, (5,) in SI, the objective there, and the calls that took.

    CHEA is shown the value alone. It searches stiffness and damping by their mobility (`Steady.starts`), the amount
    being the best for each: over the logarithms of all five, most of the box is a plateau on which the rotor is free or
    held and no search is told anything, and it ended elsewhere in five runs of six. A fit within `_EXACT` of the
    amplitudes ends the search: no objective here can be less than nothing.
    """
    steady = amplitudes.steady

    def value(points: Real) -> Real:
        return np.array([amplitudes.least_cost(u, objective=objective)[0] for u in steady.starts(points)])

    box = [(0.0, 1.0)] * steady.dim
    target = amplitudes.size(objective) * _EXACT[objective] ** (2 if objective == "f1" else 1)
    found = chea(value, box, rng=np.random.default_rng(seed), vectorized=True, max_nfev=BUDGET, f_target=target)
    u = steady.starts(found.x[None])[0]
    least, amount = amplitudes.least_cost(u, objective=objective)
    return np.array(amplitudes.theta(np.append(u, amount))), least, found.nfev


def least_of_many(
    amplitudes: Amplitudes, *, objective: Name, starts: int, near: Real, rng: np.random.Generator
) -> float:
    """Return the least value of the objective met from `near` (5,) SI, from random starts and from about the best.

    Of the random starts half are uniform in the logarithmic box, half where rotors answer to their bearings. Sums of
    absolute values descend from none of them (f3 ended seven times too high in 40 of 40): there the logarithmic
    amplitudes are fitted first. More starts, for descents on the objective itself, are scattered about the best. All
    local methods but that for absolute values are scipy's.
    """
    low, high = np.log(box(amplitudes)).T
    best, least = _descended(amplitudes, objective, np.clip((np.log(near) - low) / (high - low), 0.0, 1.0))
    seen: list[Real] = []
    for start in _starts(amplitudes, starts, rng):
        v = start if objective == "f1" else _least_squares(amplitudes.log_ratios, start)[0]
        if any(np.abs(v - other).max() < _SAME for other in seen):
            continue
        seen.append(v)
        best, least = min((best, least), _descended(amplitudes, objective, v), key=lambda end: end[1])
    for _ in range(_SCATTERED):
        v = np.clip(best + _SCATTER * rng.standard_normal(len(best)), 0.0, 1.0)
        best, least = min((best, least), _descended(amplitudes, objective, v), key=lambda end: end[1])
    return least


def _starts(amplitudes: Amplitudes, count: int, rng: np.random.Generator) -> Iterator[Real]:
    yield from rng.random((count - count // 2, amplitudes.dim))
    for u in amplitudes.steady.starts(rng.random((count // 2, amplitudes.steady.dim))):
        yield np.append(u, amplitudes.amount(u))


def _descended(amplitudes: Amplitudes, objective: Name, v: Real) -> tuple[Real, float]:
    fun = amplitudes.vector(objective)
    if objective == "f1":
        return _least_squares(fun, v)
    return descend_absolute(fun, v, radius=_RADIUS, max_calls=_DESCENT)[:2]


def _least_squares(fun: Residual, v: Real) -> tuple[Real, float]:
    """Return the end of scipy's trust region within bounds, and the sum of squares there."""

    def residual(v: Real) -> Real:
        return fun(v)[0]

    def jacobian(v: Real) -> Real:
        return fun(v)[1]

    found = least_squares(
        residual,
        np.clip(v, _INSIDE, 1 - _INSIDE),
        jac=jacobian,
        bounds=(0.0, 1.0),
        x_scale="jac",
        ftol=1e-12,
        xtol=1e-12,
        gtol=None,
        max_nfev=_FIT,
    )
    return found.x, 2 * float(found.cost)
