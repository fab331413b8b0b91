"""Measurement for a fit: the rows of a response's runs, whitened by the covariance of the noise found in the data.

Once a model is known, `expecting_error` adds that of its own error (model_error.py).

What calibration leaves of a probe's scale factor over its range is no noise: it is the same in all rows, and a nuisance
of the fit (`prior.probe_linearity`). That follows a calibration table up to `FOLLOWED` and not far beyond
(extended_model/probe_curve.py): harmonics of a larger motion, which the curve makes first of all, tell of nothing else
and are left out.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.measurement.model_error import Shrinkage, error_vectors, harmonic_motion
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import DataError
from rotorrig.rig.config import RPM

SLOW_ROLL = "slow roll"
FOLLOWED = 400e-6  # m, 0-peak
_MASKED = 1.0  # m: the standard deviation of a vector that is not usable


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """Rows of 1X vectors, the slow-roll vector last; `whiten` (row, 2 probe, 2 probe) turns residuals into sigmas."""

    rows: NDArray[np.intp]  # (row,) of the response; the slow roll is not among them
    z: NDArray[np.complex128]  # (row + 1, probe) m, raw
    sigma: NDArray[np.float64]  # (row + 1, probe) m, of re or im
    whiten: NDArray[np.float64]  # (row + 1, 2 probe, 2 probe) 1/m, of (re z_1, im z_1, ...)
    usable: NDArray[np.bool_]  # (row + 1, probe)
    amplitudes_alone: bool = False  # z is real, an amplitude: no phase is known
    compensated: bool = False  # z lacks the vectors of a slow roll that nobody kept; its last row is zero by definition
    #: (row + 1, probe, column) m, one standard deviation each of the model's own error; None: it is taken for exact
    error: NDArray[np.complex128] | None = None
    shrinkage: Shrinkage | None = None  # of the whitened rows, by that error

    @property
    def size(self) -> int:
        """Number of real values measured."""
        return (1 if self.amplitudes_alone else 2) * int(self.usable.sum())

    def off(self, model: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Return what a model (row + 1, probe) [m] as stated has beyond what was measured; real of amplitudes alone."""
        return (np.abs(model) + 0j if self.amplitudes_alone else model) - self.z

    def off_derivatives(self, columns: NDArray[np.complex128], model: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Return the derivatives of `off` of amplitudes alone by those of a model, (row + 1, probe, column) m."""
        return along(self.as_stated(columns), model)

    def as_stated(self, z: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Return a model's vectors or their derivatives, (row + 1, ...), as the table states them.

        Where it was compensated those of the slow roll, last, are subtracted from all; else they are left alone.
        """
        return z - z[-1:] if self.compensated else z

    def sigmas(self, residual: NDArray[np.complex128]) -> NDArray[np.float64]:
        """Return residuals in standard deviations of noise and the model's own error, as independent values.

        (row + 1, probe) become (row + 1, 2 probe), and columns of them (row + 1, probe, column) become
        (row + 1, 2 probe, column).
        """
        white = self.row_sigmas(residual)
        if self.shrinkage is None:
            return white
        return self.shrinkage(white.reshape(-1, *white.shape[2:])).reshape(white.shape)

    def row_sigmas(self, residual: NDArray[np.complex128]) -> NDArray[np.float64]:
        """Return the same in standard deviations of the noise alone, which is independent from row to row."""
        columns = self.as_stated(residual).reshape(*self.usable.shape, -1)
        pairs = _as_pairs(np.where(self.usable[..., None], columns, 0).swapaxes(1, 2)).swapaxes(1, 2)
        return (self.whiten @ pairs).reshape(len(columns), -1, *residual.shape[2:])

    def less_error(self, residual: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Return a residual (row + 1, probe) [m] less what of it may be the model's own error."""
        if self.shrinkage is None:
            return residual
        left = np.linalg.solve(self.whiten, self.sigmas(residual)[..., None])[..., 0]
        return left[:, 0::2] + 1j * left[:, 1::2]

    def where_usable(self, sigmas: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return residuals in standard deviations (row + 1, 2 probe) with NaN where nothing was measured."""
        return np.where(np.repeat(self.usable, 2, axis=1), sigmas, np.nan)

    def louder(self, factor: NDArray[np.float64]) -> "Measurement":
        """Return the same with the variance of every row but the slow roll's times `factor` (row,)."""
        by = np.sqrt(np.append(factor, 1.0))
        return self._with(sigma=self.sigma * by[:, None], whiten=self.whiten / by[:, None, None])

    def only(self, usable: NDArray[np.bool_]) -> "Measurement":
        """Return the same with nothing usable but what is so in `usable` too, (row + 1, probe) or (row + 1, 1)."""
        return self._with(usable=self.usable & usable)

    def at(self, kept: NDArray[np.intp]) -> "Measurement":
        """Return the same of some of the rows and of the slow roll, for a model without an error of its own."""
        rows = np.append(kept, len(self.rows))
        own = {"z": self.z[rows], "sigma": self.sigma[rows], "whiten": self.whiten[rows], "usable": self.usable[rows]}
        return self._with(rows=self.rows[kept], error=None, **own)

    def expecting_error(
        self,
        model: NDArray[np.complex128],
        response: OrderTrackedResponse,
        *,
        order: int = 1,
        known: NDArray[np.complex128] | None = None,
    ) -> "Measurement":
        """Return the same with the error, at this order, of a model that predicts `model` (row + 1, probe) [m] at 1X.

        It is a share of its motion, which is what a vector, as stated, has beyond that of the slow roll: `model_error`
        and `repeatability` of the priors in the rig of the `response`, above 1X `harmonic_error`. Then comes what is
        `known` of that error's shape at this order, (row + 1, probe, column) m, as of ExtendedProblem.known_error.
        """
        prior, motion = response.rig.prior, model[:-1] - model[-1]
        share, repeatability = prior.model_error, prior.repeatability
        if order > 1:
            motion, share, repeatability = harmonic_motion(motion, order), prior.harmonic_error, 0.0
        omega, run = response.omega[self.rows], response.run[self.rows]
        parts = []
        if share or repeatability:
            parts.append(error_vectors(motion, omega, run, share=share, repeatability=repeatability))
        if known is not None and known.any():
            parts.append(known[:-1])
        if not parts:
            return self.taken_for_exact()
        error = _pad_row(np.concatenate(parts, axis=-1))
        return self._with(error=along(error, model) if self.amplitudes_alone else error)

    def taken_for_exact(self) -> "Measurement":
        """Return the same for a model without an error of its own."""
        return self._with(error=None)

    def in_metres(self) -> "Measurement":
        """Return the same with "sigmas" in metres, of every vector."""
        unit = np.broadcast_to(np.eye(self.whiten.shape[-1]), self.whiten.shape)
        return self._with(whiten=unit, usable=np.ones_like(self.usable), error=None)

    def _with(self, **changes: Any) -> "Measurement":
        """Return the same with some changes, and the shrinkage that belongs to it."""
        new = replace(self, **changes, shrinkage=None)
        if new.error is None:
            return new
        figures = new.row_sigmas(new.error)
        return replace(new, shrinkage=Shrinkage.of(figures.reshape(-1, figures.shape[-1])))

    def noise(self, rng: np.random.Generator) -> NDArray[np.complex128]:
        """Draw errors (row + 1, probe) [m] of the noise, and of the model if it has any; none of what is not usable."""
        white = rng.standard_normal((len(self.z), 2 * self.z.shape[1], 1))
        pairs = np.linalg.solve(self.whiten, white)[..., 0]
        drawn = pairs[:, 0::2] + 1j * pairs[:, 1::2]
        if self.error is not None:
            drawn += self.error @ rng.standard_normal(self.error.shape[-1])
        return np.where(self.usable, drawn, 0)


def measure(
    response: OrderTrackedResponse, *, order: float = 1.0, band: tuple[float, float] | None = None
) -> Measurement:
    """Gather the rows of one order within `band` [rad/s]. Raises DataError if too few are left to fit anything."""
    names = [run.name for run in response.runs]
    swept = np.array([name != SLOW_ROLL for name in names])[response.run]
    low, high = band or (0.0, np.inf)
    inside = (response.omega >= low) & (response.omega <= high)
    rows = np.flatnonzero(swept & inside & response.usable.any(axis=1))
    if len(rows) < 5:
        raise DataError(
            f"{response.source.source or 'response'}: {len(rows)} usable rows between {low * RPM:.0f} and "
            f"{high * RPM:.0f} rpm, want at least 5"
        )
    n = response.orders.index(order)
    z = np.concatenate([response.z[rows, :, n], response.slow_roll[None, :, n]])
    good = response.usable[rows]
    if order > 1:
        good = good & (np.abs(np.nan_to_num(response.order(1.0)[rows])) < FOLLOWED)
    usable = np.concatenate([good, np.ones((1, z.shape[1]), dtype=bool)]) & np.isfinite(z)
    compensated = bool(np.isfinite(response.compensation_omega))
    if compensated:
        z[-1], usable[-1] = 0, False
    covariance = np.concatenate([response.covariance[rows, n], response.slow_roll_covariance[None, n]])
    variance = np.diagonal(covariance, axis1=1, axis2=2)
    return Measurement(
        rows=rows,
        z=z,
        sigma=np.sqrt((variance[:, 0::2] + variance[:, 1::2]) / 2),
        whiten=_whitening(covariance, usable),
        usable=usable,
        amplitudes_alone=response.amplitudes_alone,
        compensated=compensated,
    )


def along(columns: NDArray[np.complex128], z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return by how much vectors (row, probe, column) lengthen z (row, probe): d |z| = Re(dz conj z) / |z|.

    >>> along(np.array([[[1.0, 1.0j]]]), np.array([[-2.0j]]))
    array([[[ 0.+0.j, -1.+0.j]]])
    """
    size = np.abs(z)
    unit = np.divide(z, size, out=np.ones_like(z), where=size > 0)
    return np.asarray((columns * unit.conj()[..., None]).real + 0j)


def _pad_row(vectors: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Append a row of nothing, that of the slow roll."""
    return np.concatenate([vectors, np.zeros_like(vectors[:1])])


def _as_pairs(z: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return complex (..., probe) as real (..., 2 probe): re, im, re, im ..."""
    return np.stack([z.real, z.imag], axis=-1).reshape(*z.shape[:-1], -1)


def _whitening(covariance: NDArray[np.float64], usable: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return inverse Cholesky factors, with the vectors that are not usable put out of play."""
    out = ~np.repeat(usable, 2, axis=1)
    covariance = np.where(out[:, :, None] | out[:, None, :], 0.0, covariance)
    index = np.arange(covariance.shape[1])
    covariance[:, index, index] += np.where(out, _MASKED**2, 0.0)
    return np.linalg.inv(np.linalg.cholesky(covariance))


def trial_unbalance(response: OrderTrackedResponse, rows: NDArray[np.intp]) -> dict[str, NDArray[np.complex128]]:
    """Return the known added unbalance per disk, (row + 1,) kg m.

    That of the slow roll, last, is what its own run says; without such a run nothing was on.
    """
    runs = response.runs
    slow = next((run.trial_unbalance for run in runs if run.name == SLOW_ROLL), {})
    disks = dict.fromkeys(disk for run in runs for disk in run.trial_unbalance)
    per_run = {d: np.array([run.trial_unbalance.get(d, 0) for run in runs], dtype=complex) for d in disks}
    return {disk: np.append(amounts[response.run[rows]], slow.get(disk, 0)) for disk, amounts in per_run.items()}
