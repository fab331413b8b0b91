"""The correction by least squares: what to add on each plane so that the vibration of all entries is least.

W minimises |z + H W|^2. Its covariance is that of z and H, to first order:
dW = -(H^H H)^-1 (H^H (dz + dH W) + dH^H r), r = z + H W.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import f as f_distribution
from scipy.stats import t as t_distribution

from rotorrig.balancing.influence import Influence

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]

LEVEL = 0.95


@dataclass(frozen=True, slots=True, kw_only=True)
class Correction:
    """Unbalance to add on each plane, kg m, its angle from the keyphasor mark in the sense of rotation."""

    by: str  # "influence coefficients", "fitted model" or both
    planes: tuple[str, ...]
    W: Complex  # (plane,) kg m
    covariance: Reals  # (2 plane, 2 plane) (kg m)^2 of (re W_1, im W_1, ...), one standard deviation
    dof: float  # of the covariance

    @property
    def half_widths(self) -> list[tuple[float, float]]:
        """Half the 95 % interval of the amount [kg m] and of the angle [rad], plane by plane; infinite: any angle."""
        t = t_quantile(self.dof)
        return [
            (t * along, t * across / abs(w) if t * across < abs(w) else math.inf)
            for w, (along, across) in zip(self.W, self._sigmas, strict=True)
        ]

    @property
    def reach(self) -> Reals:
        """How far the true correction may be from this one, plane by plane [kg m]: the radius of the 95 % region."""
        largest = [np.linalg.eigvalsh(self.covariance[i : i + 2, i : i + 2])[-1] for i in range(0, len(self.W) * 2, 2)]
        return region_radius(self.dof) * np.sqrt(np.maximum(largest, 0.0))

    @property
    def _sigmas(self) -> list[tuple[float, float]]:
        """Standard deviations along and across each vector."""
        found = []
        for i, w in enumerate(self.W):
            part = self.covariance[2 * i : 2 * i + 2, 2 * i : 2 * i + 2]
            along = np.array([w.real, w.imag]) / abs(w) if w else np.array([1.0, 0.0])
            across = np.array([-along[1], along[0]])
            found.append((math.sqrt(along @ part @ along), math.sqrt(across @ part @ across)))
        return found


def t_quantile(dof: float) -> float:
    """Return half the 95 % interval of a number, in standard deviations that were estimated with `dof`.

    >>> round(t_quantile(math.inf), 3), round(t_quantile(4), 3)
    (1.96, 2.776)
    """
    return float(t_distribution.ppf((1 + LEVEL) / 2, dof if math.isfinite(dof) else 1e9))


def region_radius(dof: float) -> float:
    """Return the radius of the 95 % region of a vector (re, im), in standard deviations estimated with `dof`.

    >>> round(region_radius(math.inf), 3)
    2.448
    """
    return math.sqrt(2 * float(f_distribution.ppf(LEVEL, 2, dof if math.isfinite(dof) else 1e9)))


def least_squares_correction(influence: Influence) -> Correction:
    """Return the correction that makes the sum of squared amplitudes of all entries least."""
    W: Complex = np.asarray(np.linalg.lstsq(influence.H, -influence.z, rcond=None)[0], complex)
    return Correction(
        by=influence.by,
        planes=influence.planes,
        W=W,
        covariance=covariance_of(influence, W),
        dof=influence.dof,
    )


def covariance_of(influence: Influence, W: Complex) -> Reals:
    """Return the covariance (2 plane, 2 plane) of a least-squares correction W."""
    H, r = influence.H, influence.z + influence.H @ W
    gain = np.linalg.pinv(H.conj().T @ H)
    change = influence.z_columns + np.einsum("mpk,p->mk", influence.H_columns, W)
    shared = H.conj().T @ change + np.einsum("mpk,m->pk", influence.H_columns.conj(), r)
    amounts = np.sqrt(influence.own / 2)
    part = np.concatenate([influence.spread, 1j * influence.spread], axis=1)  # (1 + plane, column) of re and im
    alone = H.conj()[:, :, None] * (part[0] + W @ part[1:]) + part[1:].conj()[None] * r[:, None, None]
    columns = np.concatenate([shared, np.moveaxis(amounts[:, None, None] * alone, 0, 1).reshape(len(W), -1)], axis=1)
    moved = -gain @ columns
    pairs = np.stack([moved.real, moved.imag], axis=1).reshape(2 * len(W), -1)
    return np.asarray(pairs @ pairs.T)
