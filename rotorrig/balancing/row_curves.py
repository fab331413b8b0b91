"""Rows of one condition in one direction: brought to given speeds, and the hum of the mains in them."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator

from rotorrig.processing import OrderTrackedResponse

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]

SAME_SPEED = 0.01  # relative: dwells nearer than this are at one speed; further, influence coefficients are others
WIDEST_GAP = 0.05  # relative: over a wider gap between rows nothing is interpolated
FEWEST_ROWS = 4  # of a curve that is interpolated
MOST_ROWS = 240  # per direction: evenly thinned, a row more says nothing new of a smooth curve
NEAR = 0.05  # relative: rows on either side that tell how much rows scatter about a speed
CUBIC = np.array([1, -4, 6, -4, 1]) / 6  # of equally spaced rows: the middle one less the cubic through the others


@dataclass(frozen=True, slots=True)
class Curve:
    """Rows of one condition in one direction, by rising speed."""

    omega: Reals  # (row,)
    z: Complex  # (row, probe)
    variance: Reals  # (row, probe)


def reference_speeds(curve: Curve, way: int) -> Reals:
    """Return the speeds (speed,) [rad/s] of a curve that others are brought to: some of its rows, or its dwells."""
    if way:
        count = min(len(curve.omega), MOST_ROWS)
        return curve.omega[np.unique(np.linspace(0, len(curve.omega) - 1, count).round().astype(int))]
    groups: list[list[float]] = []
    for omega in curve.omega:
        if groups and omega <= groups[-1][0] * (1 + SAME_SPEED):
            groups[-1].append(float(omega))
        else:
            groups.append([float(omega)])
    return np.array([np.mean(group) for group in groups])


def average_dwells(curve: Curve, omega: Reals) -> tuple[Complex, Reals]:
    """Return the means of the rows at each speed, and the variance of a mean."""
    near = np.abs(curve.omega[None, :] - omega[:, None]) <= SAME_SPEED * omega[:, None]
    used = near[:, :, None] & np.isfinite(curve.z)[None]
    count = used.sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        z = np.where(used, curve.z[None], 0).sum(axis=1) / count
        variance = np.where(used, curve.variance[None], 0).sum(axis=1) / count**2
    return np.where(count > 0, z, np.nan), variance


def interpolate(curve: Curve, omega: Reals) -> tuple[Complex, Reals]:
    """Return vectors between the usable rows about each speed (Akima); NaN outside them and over wide gaps."""
    shape = (len(omega), curve.z.shape[1])
    z, variance = np.full(shape, np.nan + 0j), np.full(shape, np.nan)
    for probe in range(shape[1]):
        speeds, used = np.unique(np.where(np.isfinite(curve.z[:, probe]), curve.omega, np.nan), return_index=True)
        speeds, used = speeds[np.isfinite(speeds)], used[np.isfinite(speeds)]
        if len(used) < FEWEST_ROWS:
            continue
        above = np.clip(np.searchsorted(speeds, omega), 0, len(used) - 1)
        below = np.where(speeds[above] == omega, above, above - 1)
        gap = speeds[above] - speeds[below]
        fine = (below >= 0) & (omega <= speeds[above]) & (gap <= WIDEST_GAP * omega)
        share = np.where(gap > 0, (omega - speeds[below]) / np.where(gap > 0, gap, 1), 1.0)
        low, high = used[below], used[above]
        noise = (1 - share) ** 2 * curve.variance[low, probe] + share**2 * curve.variance[high, probe]
        known = curve.z[used, probe]
        re, im = (Akima1DInterpolator(speeds, part)(omega) for part in (known.real, known.imag))
        z[:, probe], variance[:, probe] = np.where(fine, re + 1j * im, np.nan), np.where(fine, noise, np.nan)
    return z, variance


def hum_variance(response: OrderTrackedResponse, rows: NDArray[np.intp], z: Complex) -> Reals:
    """Return the variance that mains hum adds to rows of rising speed with vectors z (row, probe), as z [m^2].

    It beats through the rows whose speed is near its frequency, and the tracked noise does not have it: what is taken
    is the variance by which they depart from the cubic through their four neighbours. The weights of a row of N turns
    pass what is nearer than two of N by frequency.
    """
    omega = response.omega[rows]
    turns = np.nan_to_num(response.revolutions[rows], nan=math.inf)
    near = [np.abs(omega - math.tau * hum.frequency) < 2 * omega / turns for hum in response.mains]
    if not near:
        return np.zeros(z.shape)
    return np.where(np.any(near, axis=0)[:, None], _scatter_between_rows(omega, z), 0.0)


def _scatter_between_rows(omega: Reals, z: Complex) -> Reals:
    """Return the variance by which rows depart from the cubic through four neighbours, as z: the mean about each."""
    found = np.zeros(z.shape)
    for probe in range(z.shape[1]):
        used = np.flatnonzero(np.isfinite(z[:, probe]))
        if len(used) < len(CUBIC):
            continue
        speeds, departs = omega[used], np.convolve(z[used, probe], CUBIC, "valid")
        sums = np.concatenate([[0.0], np.cumsum(np.abs(departs) ** 2 / np.sum(CUBIC**2))])
        first, last = (np.searchsorted(speeds[2:-2], speeds * (1 + side * NEAR)) for side in (-1, 1))
        found[used, probe] = np.where(last > first, (sums[last] - sums[first]) / np.maximum(last - first, 1), 0.0)
    return found
