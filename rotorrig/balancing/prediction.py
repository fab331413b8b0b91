"""Vibration predicted with masses added, with its 95 % region, and a later run held against it."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import ncx2

from rotorrig.balancing.correction import LEVEL, region_radius, t_quantile
from rotorrig.balancing.influence import Influence, growth

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]

DIRECTIONS = {1: "up", -1: "down", 0: "dwell"}
FAR = 30.0  # standard deviations from zero: there an amplitude is as good as normally distributed


@dataclass(frozen=True, slots=True, kw_only=True)
class Prediction:
    """Vectors before and after at every entry, m, 0-peak, less the slow-roll vector if one is known."""

    probes: tuple[str, ...]
    probe: NDArray[np.intp]  # (entry,)
    omega: Reals  # (entry,) rad/s
    direction: NDArray[np.intp]  # (entry,)
    before: Complex  # (entry,)
    after: Complex  # (entry,)
    covariance: Reals  # (entry, 2, 2) m^2 of (re, im): of another run with those masses, this prediction's error in it
    dof: float

    @property
    def band(self) -> tuple[Reals, Reals]:
        """Lower and upper end of the 95 % band of the amplitude after, (entry,) m."""
        return amplitude_band(self.after, self.covariance, self.dof)

    def rows_of(self, probe: int, direction: int) -> NDArray[np.intp]:
        """Return the entries of one probe in one direction, by their speed."""
        rows = np.flatnonzero((self.probe == probe) & (self.direction == direction))
        return rows[np.argsort(self.omega[rows])]

    def where(self, kept: NDArray[np.bool_]) -> "Prediction":
        """Return the same of some of the entries."""
        return Prediction(
            probes=self.probes,
            probe=self.probe[kept],
            omega=self.omega[kept],
            direction=self.direction[kept],
            before=self.before[kept],
            after=self.after[kept],
            covariance=self.covariance[kept],
            dof=self.dof,
        )


def predict_vibration(influence: Influence, W: Complex) -> Prediction:
    """Predict another run of the rotor with W (plane,) [kg m] added."""
    change = influence.measured_columns + np.einsum("mpk,p->mk", influence.H_columns, W)
    strays = growth(np.array([np.linalg.norm(W)]), influence.typical) * influence.next_run
    columns = np.concatenate([change, strays], axis=1)
    pairs = np.stack([columns.real, columns.imag], axis=1)
    covariance = pairs @ pairs.swapaxes(1, 2)
    weight = influence.spread[0] + W @ influence.spread[1:]
    alone = (
        influence.measured_own / 2 * (1 + float(np.sum(np.abs(weight) ** 2)))
    )  # of the estimate, and of the next run's row
    return Prediction(
        probes=influence.probes,
        probe=influence.probe,
        omega=influence.omega,
        direction=influence.direction,
        before=influence.measured,
        after=influence.measured + influence.H @ W,
        covariance=covariance + alone[:, None, None] * np.eye(2),
        dof=influence.dof,
    )


def amplitude_band(z: Complex, covariance: Reals, dof: float) -> tuple[Reals, Reals]:
    """Return the ends of the 95 % band of the amplitudes of vectors, (entry,) each.

    The amplitude of a vector with normal errors follows Rice's distribution. Where zero is within reach the band begins
    there.
    """
    sigma = np.sqrt(np.maximum(np.trace(covariance, axis1=1, axis2=2) / 2, 1e-300))
    wider = sigma * t_quantile(dof) / t_quantile(math.inf)
    ratio = np.minimum(np.abs(z) / wider, FAR)
    far = ratio >= FAR
    from_zero = ratio < region_radius(math.inf)
    tail = (1 - LEVEL) / 2
    low = np.where(from_zero, 0.0, np.sqrt(ncx2.ppf(tail, 2, ratio**2)))
    high = np.sqrt(ncx2.ppf(np.where(from_zero, LEVEL, 1 - tail), 2, ratio**2))
    half = t_quantile(math.inf)
    low, high = (np.where(far, np.abs(z) / wider + s * half, end) for s, end in ((-1, low), (1, high)))
    return low * wider, high * wider


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """A run against its prediction, entry by entry."""

    prediction: Prediction  # at the entries that the run has
    measured: Complex  # (entry,) m
    distance: Reals  # (entry,) over the edge of the 95 % region: above 1 outside

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Whether an entry is within its 95 % region."""
        return np.asarray(self.distance <= 1)

    @property
    def share(self) -> float:
        """Share of the entries inside."""
        return float(self.inside.mean())


def compare(prediction: Prediction, measured: Complex) -> Comparison:
    """Hold vectors (entry,) [m], NaN where there are none, against a prediction."""
    there = np.isfinite(measured)
    kept, z = prediction.where(there), measured[there]
    off = np.stack([(z - kept.after).real, (z - kept.after).imag], axis=1)
    floor = 1e-24 * np.eye(2)  # m^2: a picometre, against a prediction without any error
    square = np.einsum("mi,mi->m", off, np.linalg.solve(kept.covariance + floor, off[..., None])[..., 0])
    return Comparison(prediction=kept, measured=z, distance=np.sqrt(square) / region_radius(prediction.dof))
