"""Slow-roll vector: run-out and bow as a probe reads them where the rotor turns too slowly to respond.

Estimated once, kept beside the raw vectors, subtracted and restored by pure functions: a response is never stored
compensated, since at a few hundred rpm part of the "slow roll" is response to unbalance, which a model can tell.
`find.py` chooses the rows, `checks.py` says what speaks against them, `waveform.py` makes the waveform.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig import DataError

STEADY = 0.02  # of the mean speed: a dwell whose rows differ by more is no dwell
SCATTER = 3.0  # times the noise: rows that differ by more did not measure one vector


@dataclass(frozen=True, slots=True, kw_only=True)
class SlowRoll:
    """One vector per probe and order; all NaN where there is none."""

    z: NDArray[np.complex128]  # (probe, order) m
    covariance: NDArray[np.float64]  # (order, 2 probe, 2 probe) m^2
    omega: float  # rad/s
    used: NDArray[np.bool_]  # (row,) of the rows it was chosen from
    remarks: tuple[str, ...]  # what speaks against it, in words; empty: nothing


def estimate(
    z: NDArray[np.complex128],
    covariance: NDArray[np.float64],
    omega: NDArray[np.float64],
    *,
    usable: NDArray[np.bool_],
    dwell: bool = True,
) -> SlowRoll:
    """Return the mean over the rows of a slow roll and its covariance.

    `z` (row, probe, order), `covariance` (row, order, 2 probe, 2 probe), `omega` (row,) and `usable` (row, probe).
    A probe never usable has NaN; of the others only rows are taken in which all are usable. Where the rows scatter
    more than their covariance says, the result's is enlarged by that ratio.

    Its speed is the root mean square of theirs: a response that grows with the square of speed then has at it the
    mean it has over the rows. Unless they are a `dwell`, the speed may vary, and rows scatter about such a growth.
    """
    present = np.asarray(usable.any(axis=0))
    good = np.asarray(usable[:, present].all(axis=1) & present.any())
    if not good.any():
        return none(rows=len(z), probes=z.shape[1], orders=z.shape[2], remarks=("no usable row in the slow roll",))
    covariance, omega = covariance[good], omega[good]
    z = np.where(present[:, None], z[good], np.nan)
    remarks = []
    spread = float(np.ptp(omega) / omega.mean())
    if dwell and spread > STEADY:
        remarks.append(f"the speed varies by {spread:.1%} during the slow roll, want less than {STEADY:.0%}")
    excess = scatter(z, covariance, omega=None if dwell else omega)
    if excess.max() > SCATTER:
        remarks.append(f"the slow-roll rows scatter {excess.max():.1f} times more than the noise")
    enlarged = np.maximum(excess, 1.0) ** 2
    return SlowRoll(
        z=z.mean(axis=0),
        covariance=covariance.mean(axis=0) / len(z) * enlarged[:, None, None],
        omega=float(np.sqrt(np.mean(omega**2))),
        used=good,
        remarks=tuple(remarks),
    )


def none(*, rows: int = 0, probes: int, orders: int, remarks: tuple[str, ...] = ()) -> SlowRoll:
    """Return the slow roll of a recording that has none."""
    return SlowRoll(
        z=np.full((probes, orders), np.nan, dtype=complex),
        covariance=np.full((orders, 2 * probes, 2 * probes), np.nan),
        omega=np.nan,
        used=np.zeros(rows, dtype=bool),
        remarks=remarks,
    )


def scatter(
    z: NDArray[np.complex128], covariance: NDArray[np.float64], *, omega: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Return (order,) the root mean square of the rows' deviation from their mean, in their own sigma; 1: as expected.

    With `omega` (row,) from the straight line over its square instead. Zero for too few rows; probes with NaN do not
    count. Uses the diagonal of `covariance` (row, order, 2 probe, 2 probe).
    """
    rows, known = len(z), np.isfinite(z).all(axis=(0, 2))
    terms = [np.ones(rows)] if omega is None or not np.ptp(omega) else [np.ones(rows), (omega / omega.max()) ** 2]
    if rows <= len(terms) or not known.any():
        return np.zeros(z.shape[2])
    basis, _ = np.linalg.qr(np.stack(terms, axis=1))
    flat = z.reshape(rows, -1)
    deviation = (flat - basis @ (basis.T @ flat)).reshape(z.shape).transpose(0, 2, 1)  # (row, order, probe)
    variance = np.diagonal(covariance, axis1=2, axis2=3)
    power = np.abs(deviation) ** 2 / (variance[..., 0::2] + variance[..., 1::2])
    return np.sqrt(power[..., known].sum(axis=(0, 2)) / ((rows - len(terms)) * known.sum()))


def subtract(z: NDArray[np.complex128], slow_roll: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return z (row, probe, order) less the slow-roll vector (probe, order). Raises DataError where it is missing."""
    if not np.isfinite(slow_roll).all():
        raise DataError("the response has no slow-roll vector to subtract, want a recording with a slow-roll dwell")
    return z - slow_roll


def restore(compensated: NDArray[np.complex128], slow_roll: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Undo `subtract`."""
    if not np.isfinite(slow_roll).all():
        raise DataError("the response has no slow-roll vector to restore")
    return compensated + slow_roll
