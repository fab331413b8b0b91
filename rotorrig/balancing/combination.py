"""One correction of two: of the influence coefficients and of the fitted model, each by its covariance.

Both come from the same runs in part, so their errors are not independent and the plain inverse-covariance mean would
claim too much. Covariance intersection (Julier and Uhlmann, American Control Conference 1997, 2369) weights them by
w C1^-1 and (1 - w) C2^-1 and never claims more than is so, whatever they have in common.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.stats import chi2

from rotorrig.balancing.correction import LEVEL, Correction, t_quantile

Reals = NDArray[np.float64]


def disagreement(one: Correction, other: Correction) -> float:
    """Return how far two corrections are apart, over the largest distance that 95 % of chances explain."""
    off = _pairs(one) - _pairs(other)
    C = _as_normal(one) + _as_normal(other)
    return float(np.sqrt(off @ np.linalg.solve(C, off) / chi2.ppf(LEVEL, len(off))))


def combine(one: Correction, other: Correction) -> Correction:
    """Return the combination by covariance intersection with the smallest 95 % region."""
    first, second = (np.linalg.inv(_as_normal(c)) for c in (one, other))

    def log_volume(w: float) -> float:
        return -float(np.linalg.slogdet(w * first + (1 - w) * second)[1])

    w = float(minimize_scalar(log_volume, bounds=(0.0, 1.0), method="bounded").x)
    covariance = np.linalg.inv(w * first + (1 - w) * second)
    mean = covariance @ (w * first @ _pairs(one) + (1 - w) * second @ _pairs(other))
    return Correction(
        by=f"{one.by} and {other.by}",
        planes=one.planes,
        W=mean[0::2] + 1j * mean[1::2],
        covariance=covariance,
        dof=np.inf,
    )


def _pairs(correction: Correction) -> Reals:
    return np.stack([correction.W.real, correction.W.imag], axis=1).ravel()


def _as_normal(correction: Correction) -> Reals:
    """Return the covariance of normal errors with the same 95 % intervals."""
    wider = t_quantile(correction.dof) / t_quantile(np.inf)
    return correction.covariance * wider**2
