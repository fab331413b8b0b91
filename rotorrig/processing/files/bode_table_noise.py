"""Uncertainty of a Bode table's vectors: as stated, or from the scatter of neighbouring rows.

Scatter tells the noise, not what a window makes of a vector that changes while it is taken, nor a filter's or a
converter's own error: where nothing is stated, that is `UNSTATED` of the 1X vector at the row, at all orders.
"""

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.files.bode_table_mapping import Uncertainty
from rotorrig.rig import DataError

PARABOLA = 7  # rows a local parabola is fitted to, for the scatter about it
UNSTATED = 0.003  # of the 1X vector: an estimate, as of what calibration leaves of a probe's scale (`[prior]`)
ROUNDING = 1e-9  # of the largest vector: a scatter of less is of the arithmetic
POOL = 41  # neighbouring rows whose scatter is pooled: known to 8 %, yet follows the noise along the sweep


def estimate_covariance(
    z: NDArray[np.complex128],
    run: NDArray[np.intp],
    stated: Uncertainty | None,
    *,
    absolute: NDArray[np.float64],
    first: int | None,
    amplitudes_alone: bool = False,
) -> NDArray[np.float64]:
    """Return the covariance (row, order, 2 probe, 2 probe) [m^2], probes and parts uncorrelated; NaN where z is.

    `z` is (row, probe, order), `absolute` (row, order) m the absolute part of what is `stated`, `first` the place of 1X
    among the orders; None: it is not in the table. With `amplitudes_alone` z is real, and its variance the amplitude's.

    Raises DataError if nothing is stated and there are too few rows to estimate it, or rows that do not scatter.
    """
    if stated is not None:
        variance = absolute[:, None] ** 2 + (stated.relative * np.abs(z)) ** 2
    else:
        variance = np.full(z.shape, np.nan)
        for index, p, n in itertools.product(np.unique(run), range(z.shape[1]), range(z.shape[2])):
            rows = run == index
            if np.isfinite(z[rows, p, n]).any():
                variance[rows, p, n] = scatter_variance(z[rows, p, n], real=amplitudes_alone)
        if (np.sqrt(variance) < ROUNDING * np.nanmax(np.abs(z), initial=0.0)).any():
            raise DataError(
                "neighbouring rows do not scatter at all, as they are rounded or computed; want [uncertainty] in the "
                "mapping, half a last digit at the least"
            )
        if first is not None:
            variance += (UNSTATED * np.nan_to_num(np.abs(z[:, :, first, None]))) ** 2
    pairs = np.repeat(variance.transpose(0, 2, 1), 2, axis=2)  # (row, order, 2 probe)
    covariance = np.zeros((*pairs.shape, pairs.shape[2]))
    diagonal = np.arange(pairs.shape[2])
    covariance[..., diagonal, diagonal] = pairs
    return covariance


def scatter_variance(z: NDArray[np.complex128], *, real: bool = False) -> NDArray[np.float64]:
    """Return the variance (row,) of the real or imaginary part of z (row,), from its scatter about local parabolas.

    With `real` there is no imaginary part.

    A parabola through 7 rows leaves of independent errors the share 1 - h in the middle; the median over 41 rows
    and both parts makes it robust. Follows a curve whose resonance is wider than 7 rows; what is narrower counts as
    noise, on the safe side. Raises DataError for fewer than 8 rows with a value.
    """
    good = np.isfinite(z)
    if good.sum() <= PARABOLA:
        raise DataError(
            f"a run has {good.sum()} rows with values, want more than {PARABOLA} to estimate their uncertainty "
            "from, or [uncertainty] stated in the mapping"
        )
    half = PARABOLA // 2
    k = np.arange(-half, half + 1)
    basis = np.stack([np.ones(PARABOLA), k, k**2], axis=1)
    middle = basis[half] @ np.linalg.pinv(basis)
    kept = z[good]
    residual = kept[half:-half] - np.convolve(kept, middle[::-1], mode="valid")
    each = [residual.real] if real else [residual.real, residual.imag]
    parts = np.abs(np.stack(each, axis=1)) / math.sqrt(1 - middle[half])
    size = min(POOL, len(parts))
    pooled = np.median(np.lib.stride_tricks.sliding_window_view(parts, size, axis=0), axis=(1, 2))
    places = np.flatnonzero(good)[half:-half][(size - 1) // 2 :][: len(pooled)]
    return np.interp(np.arange(len(z)), places, 1.4826 * pooled) ** 2
