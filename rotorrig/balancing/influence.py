"""`Influence`: vibration as a linear function of the masses added, y = z + H W, and how far either may be off.

An entry is one probe at one speed in one direction. From runs with trial masses it is estimated entry by entry, by
complex least squares with a free baseline. The errors of one condition - a mass not quite where it was meant to be, a
warmer bearing - are the same at all speeds and probes, so their covariance is that of the residuals of whole
conditions, and what it is worth is counted in conditions and not in rows.

Half of its variance is taken as the same in all conditions, half as growing with the square of the masses: on the RK4
of tests/data/kfupm-rk4 91 % of left-out vectors are then within their 95 % region, 87 % with one variance for all.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.balancing.conditions import Conditions
from rotorrig.identify.extended_model import bend
from rotorrig.rig import DataError
from rotorrig.rig.config import Prior

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]

INFLUENCE, MODEL = "influence coefficients", "fitted model"
DEAD = 1e-9  # relative: a singular value below is rounding
ODD = (3, 5)  # powers of a motion whose first order is not nothing
GROWING = 0.5  # share of the variance between conditions that grows with the square of the masses


@dataclass(frozen=True, slots=True, kw_only=True)
class Influence:
    """Vibration over what is added on each plane, entry by entry, with one-sigma columns of its errors.

    An error is the sum of all columns times independent standard normal amounts. `own` is the noise of the rows, which
    is independent from entry to entry: L e per entry, e complex of that variance, for (z, H).
    """

    by: str  # INFLUENCE or MODEL
    probes: tuple[str, ...]
    planes: tuple[str, ...]
    probe: NDArray[np.intp]  # (entry,)
    omega: Reals  # (entry,) rad/s
    direction: NDArray[np.intp]  # (entry,) +1, -1, 0
    z: Complex  # (entry,) m, of the rotor without any mass added: what the correction is to cancel
    H: Complex  # (entry, plane) m / (kg m)
    z_columns: Complex  # (entry, column) m
    H_columns: Complex  # (entry, plane, column)
    measured: Complex  # (entry,) m, the same as it was measured: what a prediction begins from
    measured_columns: Complex  # (entry, column) m
    next_run: Complex  # (entry, column) m, how far another run strays from this one
    own: Reals  # (entry,) m^2 of re and im together, in (z, H)
    measured_own: Reals  # (entry,) m^2, in what was measured
    spread: Complex  # (1 + plane, 1 + plane) L
    typical: float  # kg m, of a condition's masses; infinite: `next_run` is the same with any
    dof: float  # of the columns, as degrees of freedom of real numbers; infinite: they rest on priors or a model
    conditions: int = 0  # of the estimate; 0: of a model


def estimate_influence(conditions: Conditions, *, planes: tuple[str, ...], prior: Prior) -> Influence:
    """Estimate the influence of masses on `planes` from conditions with trial masses.

    Of the `prior` it takes the curvature of the probes, and the share by which the vibration strays from run to run,
    where no condition is left over to show that. Raises DataError if the trial masses do not tell the planes apart.
    """
    known = np.isfinite(conditions.z).all(axis=0)
    row, probe = np.nonzero(known)
    Z = conditions.z[:, row, probe]  # (condition, entry)
    order = [conditions.planes.index(p) for p in planes if p in conditions.planes]
    order += [i for i in range(len(conditions.planes)) if i not in order]
    X, unit = _design(conditions, planes, order)
    dof = len(X) - X.shape[1]
    typical = unit * float(np.sqrt(np.mean(np.sum(np.abs(X[:, 1:]) ** 2, axis=1)))) if dof else math.inf
    if dof:
        weight = 1 / growth(np.sqrt(np.sum(np.abs(X[:, 1:]) ** 2, axis=1)) * unit, typical)
        X, Z = weight[:, None] * X, weight[:, None] * Z
    beta, spread = _solve(X, Z)
    columns = _scatter(Z - X @ beta, dof) if dof else _priors(Z, prior.repeatability)
    shared = _spread_over(columns, spread, _inverse(X), scattered=dof > 0)
    bent = np.einsum("ac,cmk->amk", _inverse(X), prior.probe_linearity * _curvatures(Z, probe))
    shared = np.concatenate([shared, bent], axis=-1)
    kept = slice(1, 1 + len(planes))
    own = conditions.variance[:, row, probe].mean(axis=0) * (not dof)  # the scatter of conditions has it already
    strays = _both_parts(columns) if dof else _both_parts((Z[:1] * prior.repeatability * math.sqrt(2)).T)
    return Influence(
        by=INFLUENCE,
        probes=conditions.probes,
        planes=planes,
        probe=probe,
        omega=conditions.omega[row],
        direction=conditions.direction[row],
        z=beta[0],
        H=beta[kept].T / unit,
        z_columns=shared[0],
        H_columns=np.moveaxis(shared[kept], 0, 1) / unit,
        measured=beta[0],
        measured_columns=shared[0],
        next_run=strays,
        own=own,
        measured_own=own,
        spread=_scaled_spread(spread, kept, unit),
        typical=typical,
        dof=2.0 * dof if dof else math.inf,
        conditions=len(X),
    )


def growth(masses: Reals, typical: float) -> Reals:
    """Return by how much a condition with `masses` [kg m] strays more than the mean one, (condition,).

    >>> growth(np.array([0.0, 1.0]), 1.0).round(3), growth(np.array([5.0]), math.inf)
    (array([0.707, 1.   ]), array([1.]))
    """
    if not math.isfinite(typical):
        return np.ones_like(masses)
    return np.sqrt(1 - GROWING + GROWING * (masses / typical) ** 2)


def _design(conditions: Conditions, planes: tuple[str, ...], order: list[int]) -> tuple[Complex, float]:
    """Return the design matrix (condition, 1 + plane), in units of the trial masses' own size [kg m], which follows."""
    missing = [plane for plane in planes if plane not in conditions.planes]
    if missing:
        raise DataError(f"no run has a trial mass on '{missing[0]}', want one there for its influence coefficients")
    T = conditions.trial[:, order]
    unit = float(np.sqrt(np.mean(np.abs(T[T != 0]) ** 2)))
    X = np.concatenate([np.ones((len(T), 1)), T / unit], axis=1)
    if np.linalg.matrix_rank(X, tol=1e-6) < X.shape[1]:
        raise DataError(
            f"{len(X)} conditions with trial masses on {list(conditions.planes)} do not tell these apart, want a run "
            f"without, and one with a trial mass on each plane that differs from the others"
        )
    return X, unit


def _solve(X: Complex, Z: Complex) -> tuple[Complex, Complex]:
    """Return the coefficients (1 + plane, entry) and L with L L^H = (X^H X)^-1."""
    normal = np.linalg.inv(X.conj().T @ X)
    return _inverse(X) @ Z, np.asarray(np.linalg.cholesky((normal + normal.conj().T) / 2), complex)


def _inverse(X: Complex) -> Complex:
    return np.asarray(np.linalg.pinv(X), complex)


def _scatter(residual: Complex, dof: int) -> Complex:
    """Return columns (entry, column) m whose outer products sum to the covariance of a condition's error, complex."""
    _, size, right = np.linalg.svd(residual, full_matrices=False)
    kept = size > DEAD * max(float(size[0]), 1e-300)
    return (right[kept].T * size[kept]) / math.sqrt(dof)


def _priors(Z: Complex, repeatability: float) -> Complex:
    """Return the same of each condition, which strays in proportion to its own motion, (entry, condition)."""
    return (Z * repeatability * math.sqrt(2)).T  # that share in either part


def _curvatures(Z: Complex, probe: NDArray[np.intp]) -> Complex:
    """Return what a probe's scale that bends adds to vectors (condition, entry), (..., column): a column per bend.

    It is the same bend in all conditions, so no repetition shows it; of those of an identification (probe_curve.py),
    the odd ones change 1X.
    """
    own = probe == np.unique(probe)[:, None]
    bends = [np.where(mine, bend(Z, 1, power), 0.0) for power in ODD for mine in own]
    return np.stack(bends, axis=-1)


def _spread_over(columns: Complex, spread: Complex, inverse: Complex, *, scattered: bool) -> Complex:
    """Return columns (1 + plane, entry, column) of the coefficients.

    Of a scatter all conditions share its columns; of priors each column belongs to its condition.
    """
    by = spread if scattered else inverse
    if scattered:
        whole = np.einsum("ai,mk->amik", by, columns).reshape(len(by), len(columns), -1)
    else:
        whole = by[:, None, :] * columns[None]
    return _both_parts(whole)


def _both_parts(columns: Complex) -> Complex:
    """Return columns of complex amounts as columns of their real and imaginary parts, each of half the variance."""
    return np.asarray(np.concatenate([columns, 1j * columns], axis=-1) / math.sqrt(2), complex)


def _scaled_spread(spread: Complex, kept: slice, unit: float) -> Complex:
    """Return the rows of L that belong to z and the planes asked for, in SI."""
    return np.concatenate([spread[:1], spread[kept] / unit])
