"""Change of the mean shaft position along a sweep: of the gap (0X), which in a linear rotor is the same at every speed.

Where a run has its mean position is the probes' setting and the weight of the rotor, so only a change counts, and of
that no even drift in time, which is a probe that warms up. What is left is compared with

- its own scatter from row to row;
- the curvature that calibration leaves of a probe's scale factor (`prior.probe_linearity`), which makes a mean of a
  vibration: of r (1 + even r / 300 um), even r^2 / (2 * 300 um), r^2 summed over the orders;
- the shaft's own roundness: y aside of a probe's axis, the surface of a shaft of radius R is farther by y^2 / 2R, on
  the mean |y|^2 / 4R. The field of a probe is wider than a point, so it sees between nothing and that.

The last two are allowed for as errors of one standard deviation, the second at half its largest. Of 24 simulated
healthy rigs with two planes, two recordings of each, none had a stretch beyond 2.0 sigma; it is told of from 2.5 on, so
with 95 % confidence of fewer than 12 % of healthy rigs. A mean that a force makes and that goes as the square of the
vibration is taken for the probes' unless it is larger than theirs. Source: Bently, Hatch, Fundamentals of Rotating
Machinery Diagnostics (2002), ch. 6, on shaft centreline plots.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.adequacy.settings import ADEQUACY
from rotorrig.identify.extended_model import CURVED_AT, EXTENDED_MODEL
from rotorrig.identify.measurement import SLOW_ROLL
from rotorrig.processing import OrderTrackedResponse, measured_planes

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

MEAN = 0.0  # the order of the gap
NORMAL = 0.6745  # of a standard deviation: the median of what is normally distributed, without its sign


def departures(response: OrderTrackedResponse) -> tuple[Reals, Reals]:
    """Return the change of the mean position along its run, (speed, probe) m, and the same in sigmas.

    Above zero it is nearer to the probe. NaN in a slow roll, in a run of fewer than `ADEQUACY.fewest_rows`, where a row
    is not usable, and everywhere if the gap was not tracked.
    """
    change = np.full(response.z.shape[:2], np.nan)
    sigma = np.full(response.z.shape[:2], np.nan)
    if MEAN not in response.orders:
        return change, sigma
    place = response.orders.index(MEAN)
    gap = response.z[:, :, place].real
    variance = np.diagonal(response.covariance[:, place], axis1=1, axis2=2)[:, 0::2]
    apparent = _apparent_shift(response)
    for rows, probe in _usable_runs(response, gap):
        own = gap[rows, probe]
        scatter = np.maximum(np.sqrt(variance[rows, probe]), _scatter(own))
        sigma[rows, probe] = np.hypot(scatter, apparent[rows, probe])
        change[rows, probe] = own - _drift(own, response.t[rows], sigma[rows, probe])
    return change, change / sigma


def _usable_runs(response: OrderTrackedResponse, gap: Reals) -> Iterator[tuple[NDArray[np.intp], int]]:
    """Yield the rows with a usable gap, run by run and probe by probe."""
    usable = response.usable & np.isfinite(gap)
    for i, run in enumerate(response.runs):
        for probe in range(gap.shape[1]):
            rows = np.flatnonzero((response.run == i) & usable[:, probe])
            if run.name != SLOW_ROLL and len(rows) >= ADEQUACY.fewest_rows:
                yield rows, probe


def _scatter(values: Reals) -> float:
    """Return the standard deviation from one row to the next, of most of them."""
    return float(np.median(np.abs(np.diff(values))) / (NORMAL * np.sqrt(2)))


def _drift(values: Reals, t: Reals, sigma: Reals) -> Reals:
    """Return the straight line in time through values of these sigmas, the level alone where no time is known."""
    line = [np.ones(len(values))]
    if np.isfinite(t).all() and np.ptp(t) > 0:
        line.append((t - t.mean()) / np.ptp(t))
    columns = np.stack(line, axis=1)
    weight = 1 / np.maximum(sigma, np.finfo(float).tiny)
    return columns @ np.linalg.lstsq(columns * weight[:, None], values * weight, rcond=None)[0]


def _apparent_shift(response: OrderTrackedResponse) -> Reals:
    """Return one standard deviation of the mean that a sound probe makes of the vibration, (speed, probe) m."""
    along, across = np.zeros(response.z.shape[:2]), np.zeros(response.z.shape[:2])
    for order in response.orders:
        if order > 0:
            z = np.nan_to_num(response.order(order))
            along += np.abs(z) ** 2
            across += np.abs(_across(response, z)) ** 2
    curved = response.rig.prior.probe_linearity * along / (2 * CURVED_AT)
    round_shaft = EXTENDED_MODEL.roundness * across / (2 * response.rig.shaft.diameter)
    return np.hypot(curved, round_shaft)


def _across(response: OrderTrackedResponse, z: Complex) -> Complex:
    """Return the motion at right angles to every probe, of readings z (speed, probe); without a partner, its own."""
    across = z.copy()
    for plane, pair in measured_planes(response.rig, response.probes):
        x, y = np.moveaxis(z[:, pair] @ plane.to_xy.T, -1, 0)
        for probe in pair:
            angle = response.rig.probe(response.probes[probe]).angle
            across[:, probe] = y * np.cos(angle) - x * np.sin(angle)
    return across
