"""Measurement for a fit: the rows of a response's runs, whitened by their covariance.

The covariance is the noise found in the data plus what calibration leaves of a probe's scale factor over its range
(`prior.probe_linearity` of the reading): a model may not be called wrong for that.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import DataError
from rotorrig.rig.config import RPM

SLOW_ROLL = "slow roll"
_MASKED = 1.0  # m: the standard deviation of a vector that is not usable


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """Rows of 1X vectors, the slow-roll vector last; `whiten` (row, 2 probe, 2 probe) turns residuals into sigmas."""

    rows: NDArray[np.intp]  # (row,) of the response; the slow roll is not among them
    z: NDArray[np.complex128]  # (row + 1, probe) m, raw
    sigma: NDArray[np.float64]  # (row + 1, probe) m, of re or im
    whiten: NDArray[np.float64]  # (row + 1, 2 probe, 2 probe) 1/m, of (re z_1, im z_1, ...)
    usable: NDArray[np.bool_]  # (row + 1, probe)

    @property
    def size(self) -> int:
        """Number of real values measured."""
        return 2 * int(self.usable.sum())

    def sigmas(self, residual: NDArray[np.complex128]) -> NDArray[np.float64]:
        """Return residuals in standard deviations, as independent values.

        (row + 1, probe) become (row + 1, 2 probe), and columns of them (row + 1, probe, column) become
        (row + 1, 2 probe, column).
        """
        columns = residual.reshape(*self.usable.shape, -1)
        pairs = _as_pairs(np.where(self.usable[..., None], columns, 0).swapaxes(1, 2)).swapaxes(1, 2)
        return (self.whiten @ pairs).reshape(len(columns), -1, *residual.shape[2:])

    def noise(self, rng: np.random.Generator) -> NDArray[np.complex128]:
        """Draw errors (row + 1, probe) [m] of the covariance; none of what is not usable."""
        white = rng.standard_normal((len(self.z), 2 * self.z.shape[1], 1))
        pairs = np.linalg.solve(self.whiten, white)[..., 0]
        return np.where(self.usable, pairs[:, 0::2] + 1j * pairs[:, 1::2], 0)


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
    usable = np.concatenate([response.usable[rows], np.ones((1, z.shape[1]), dtype=bool)]) & np.isfinite(z)
    noise = np.concatenate([response.covariance[rows, n], response.slow_roll_covariance[None, n]])
    first = response.orders.index(1.0)  # 1X is the motion a probe's curvature bends, into 2X as well
    motion = np.concatenate([response.z[rows, :, first], response.slow_roll[None, :, first]])
    covariance = _with_linearity(noise, motion - np.nan_to_num(response.slow_roll[:, first]), response)
    variance = np.diagonal(covariance, axis1=1, axis2=2)
    return Measurement(
        rows=rows,
        z=z,
        sigma=np.sqrt((variance[:, 0::2] + variance[:, 1::2]) / 2),
        whiten=_whitening(covariance, usable),
        usable=usable,
    )


def _as_pairs(z: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return complex (..., probe) as real (..., 2 probe): re, im, re, im ..."""
    return np.stack([z.real, z.imag], axis=-1).reshape(*z.shape[:-1], -1)


def _with_linearity(
    noise: NDArray[np.float64], motion: NDArray[np.complex128], response: OrderTrackedResponse
) -> NDArray[np.float64]:
    """Add the scale factor's residual error, a share of the synchronous motion, to re and im alike."""
    share = (response.rig.prior.probe_linearity * np.abs(np.nan_to_num(motion))) ** 2
    return noise + np.einsum("rp,pq->rpq", np.repeat(share, 2, axis=1), np.eye(2 * share.shape[1]))


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
