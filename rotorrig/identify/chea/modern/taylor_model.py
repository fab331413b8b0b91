"""`TaylorModel`: what values at scattered points say about a function near one of them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.modern.settings import MODERN, TaylorSettings

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class TaylorModel:
    """A polynomial of fourth degree about `centre`: m(x) = fun + b x + x B x / 2 + sum of a_i k(x_i x), k below.

    x is measured from the centre in radii. k(t) = sum over the orders of (size / order!)^2 t^order.
    """

    centre: Array  # (dim,)
    radius: float
    fun: float
    slope: Array  # (dim,) b
    bend: Array  # (dim, dim) B, of the Hessian expected before
    anchors: Array  # (n, dim) x_i
    shares: Array  # (n,) a_i
    doubt: Array  # (dim, dim) covariance of the slope, in units of the remainder's size
    variances: tuple[float, float, float]  # (size / order!)^2

    def value(self, x: Array) -> float:
        """Return the model's value at x (dim,)."""
        t = self.anchors @ x
        c2, c3, c4 = self.variances
        return float(
            self.fun + self.slope @ x + 0.5 * x @ self.bend @ x + self.shares @ ((c2 + (c3 + c4 * t) * t) * t * t)
        )

    def gradient(self, x: Array) -> Array:
        """Return the gradient (dim,) at x (dim,), per radius."""
        t = self.anchors @ x
        c2, c3, c4 = self.variances
        return self.slope + self.bend @ x + self.anchors.T @ (self.shares * (2 * c2 + (3 * c3 + 4 * c4 * t) * t) * t)

    def hessian(self, x: Array) -> Array:
        """Return the Hessian (dim, dim) at x (dim,), per squared radius."""
        t = self.anchors @ x
        c2, c3, c4 = self.variances
        return self.bend + (self.anchors.T * (self.shares * (2 * c2 + (6 * c3 + 12 * c4 * t) * t))) @ self.anchors


def fit(
    points: Array,
    values: Array,
    *,
    centre: Array,
    radius: float,
    hessian: Array,
    settings: TaylorSettings = MODERN.descent.taylor,
) -> TaylorModel:
    """Fit finite `values` (n,) at `points` (n, dim) about `centre`, where the Hessian is expected to be `hessian`.

    The terms of Taylor's series are taken as Gaussian with the sizes in `settings`, the remainder at distance r as
    noise that grows as r^5. The model is the mean to be expected then (kriging with a linear drift, Cressie, Statistics
    for Spatial Data (1993), 3.4): it takes from each point what its distance is worth, so that none needs to be chosen.
    Few points make the least change of the Hessian that explains them (Powell, Math. Program. 100 (2004) 183), many
    make a fit of fourth degree, in which a curved valley is no obstacle.
    """
    x = (points - centre) / radius
    bend = hessian * radius**2
    offset = values.min()
    excess = values - offset - 0.5 * ((x @ bend) * x).sum(axis=1)
    squared = np.einsum("ij,ij->i", x, x) + settings.nearest**2
    weights = squared ** (-0.5 * (len(settings.sizes) + 1)) / np.sqrt(settings.remainder)
    t = x @ x.T
    c2, c3, c4 = settings.variances
    covariance = weights[:, None] * ((c2 + (c3 + c4 * t) * t) * t * t) * weights
    covariance[np.diag_indices(len(x))] += 1.0
    factor = np.linalg.cholesky(covariance)
    drift = np.column_stack([np.ones(len(x)), x, excess]) * weights[:, None]
    white = np.linalg.solve(factor, drift)  # LAPACK's triangular solver is no faster alone, and far slower threaded
    linear, doubt = _least_squares(white[:, :-1], white[:, -1], flat=settings.flat)
    unexplained = white[:, -1] - white[:, :-1] @ linear
    return TaylorModel(
        centre=centre,
        radius=radius,
        fun=float(offset + linear[0]),
        slope=linear[1:],
        bend=bend,
        anchors=x,
        shares=weights * np.linalg.solve(factor.T, unexplained),
        doubt=doubt[1:, 1:],
        variances=settings.variances,
    )


def _least_squares(design: Array, wanted: Array, *, flat: float) -> tuple[Array, Array]:
    """Return the coefficients (p,) and their covariance (p, p); those the points leave open are 0, and in doubt."""
    p = design.shape[1]
    open_end = np.diag(np.concatenate([[0.0], np.full(p - 1, 1 / flat)]))
    q, r = np.linalg.qr(np.vstack([design, open_end]))
    inverse = np.linalg.inv(r)
    return inverse @ (q[: len(design)].T @ wanted), inverse @ inverse.T
