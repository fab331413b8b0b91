"""Speeds to hold: where two models that fit the data at hand alike differ most from each other."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.extended_model import ExtendedProblem, Recording
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.rig.config import Limits

Reals = NDArray[np.float64]
Fit = tuple[ExtendedProblem, Solution]


def parting_speeds(best: Fit, rivals: Sequence[Fit]) -> tuple[float, ...]:
    """Return the speeds [rad/s] of the first recording at which the rivals part most from the best, in its noise.

    They are a few per cent from each other at least, and in none of the config's critical bands, where nothing is
    held. Of several rivals the nearest counts, speed by speed.
    """
    recording = best[0].recordings[0]
    omega = recording.response.omega[recording.rows]
    parted = np.min([_compare(recording, best, rival) for rival in rivals], axis=0)
    parted[_in_bands(omega, recording.rig.limits)] = 0.0
    speeds: list[float] = []
    while len(speeds) < VERDICT.dwells and parted.max() > 0.0:
        speeds.append(float(omega[parted.argmax()]))
        parted[np.abs(omega / speeds[-1] - 1) < VERDICT.apart] = 0.0
    return tuple(sorted(speeds))


def _compare(recording: Recording, best: Fit, rival: Fit) -> Reals:
    """Return chi2 (row,) between two predictions, of all orders and probes."""
    (one, *_), (other, *_) = (problem.model.predict(fit.p) for problem, fit in (best, rival))
    response, rows = recording.response, recording.rows
    parted = np.zeros(len(rows))
    for order in recording.orders:
        place = list(response.orders).index(order)
        variance = np.diagonal(response.covariance[rows, place], axis1=-2, axis2=-1)
        variance = variance.reshape(len(rows), -1, 2).mean(axis=-1)
        seen = response.usable[rows] & (variance > 0)
        squared = np.abs(one[order] - other[order])[: len(rows)] ** 2
        parted += np.sum(np.divide(squared, variance, out=np.zeros_like(squared), where=seen), axis=1)
    return np.where(np.isfinite(parted), parted, 0.0)


def _in_bands(omega: Reals, limits: Limits | None) -> NDArray[np.bool_]:
    inside = np.zeros(len(omega), dtype=bool)
    for band in limits.critical_bands if limits else ():
        inside |= (omega >= band.low) & (omega <= band.high)
    return inside
