"""Curves and residual grids for plotting, as plain arrays in display units: rpm, µm 0-peak, degrees of phase lag.

Shared by the report and the viewer, so that both show the same numbers.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing import OrderTrackedResponse, measured_planes, whirl
from rotorrig.rig.config import RPM, UM

BINS = 110  # of speed, across a page's width
STRONG = 0.1  # of the largest vector: below, a phase is mostly noise and has no say in where the axis is cut


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """One run of one probe at one order; NaN where the row is not usable, so that a line breaks there."""

    run: str
    direction: int  # +1 speed rises, -1 falls
    rpm: NDArray[np.float64]  # (row,)
    amplitude: NDArray[np.float64]  # (row,) µm 0-peak
    lag: NDArray[np.float64]  # (row,) degrees; NaN where amplitudes are all that is known
    sigma: NDArray[np.float64]  # (row,) µm, one standard deviation of a component
    model_amplitude: NDArray[np.float64] | None  # (row,) every row, usable or not; None without a model
    model_lag: NDArray[np.float64] | None

    def at(self, rows: NDArray[np.intp]) -> "Curve":
        """Return the curve of these rows alone."""
        return replace(
            self,
            rpm=self.rpm[rows],
            amplitude=self.amplitude[rows],
            lag=self.lag[rows],
            sigma=self.sigma[rows],
            model_amplitude=None if self.model_amplitude is None else self.model_amplitude[rows],
            model_lag=None if self.model_lag is None else self.model_lag[rows],
        )


def slow_roll_known(response: OrderTrackedResponse, order: float = 1.0) -> bool:
    """Return whether every probe has a slow-roll vector at `order`."""
    return bool(np.isfinite(response.slow_roll[:, response.orders.index(order)]).all())


def vectors(response: OrderTrackedResponse, order: float = 1.0) -> NDArray[np.complex128]:
    """Return z (speed, probe) [m], slow-roll compensated if that is known for every probe, else raw."""
    return response.compensated(order) if slow_roll_known(response, order) else response.order(order)


def model_vectors(response: OrderTrackedResponse, prediction: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return a 1X prediction (speed, probe) [m] less the same slow-roll vector as `vectors` subtracts."""
    if not slow_roll_known(response):
        return prediction
    return prediction - response.slow_roll[:, response.orders.index(1.0)]


def sweeps(response: OrderTrackedResponse) -> list[int]:
    """Return the indices of the runs whose speed changes; dwells, such as the slow roll, make no curve."""
    return [i for i, run in enumerate(response.runs) if run.direction and (response.run == i).any()]


def curves(
    response: OrderTrackedResponse,
    probe: int,
    *,
    order: float = 1.0,
    prediction: NDArray[np.complex128] | None = None,
) -> tuple[Curve, ...]:
    """Return the curves of one probe, a run each; `prediction` (speed, probe) [m] as `Fit.prediction`, for 1X."""
    z = np.where(response.usable[:, probe], vectors(response, order)[:, probe], np.nan)
    model = None if prediction is None else model_vectors(response, prediction)[:, probe]
    start = np.nan if response.amplitudes_alone else phase_window(z)
    place = response.orders.index(order)
    variance = response.covariance[:, place, 2 * probe, 2 * probe]
    by_run = []
    for i in sweeps(response):
        rows = response.run == i
        by_run.append(
            Curve(
                run=response.runs[i].name,
                direction=response.runs[i].direction,
                rpm=response.omega[rows] * RPM,
                amplitude=np.abs(z[rows]) * UM,
                lag=lag_degrees(z[rows], start=start),
                sigma=np.sqrt(variance[rows]) * UM,
                model_amplitude=None if model is None else np.abs(model[rows]) * UM,
                model_lag=None if model is None else break_at_wraps(lag_degrees(model[rows], start=start)),
            )
        )
    return tuple(by_run)


def lag_degrees(z: NDArray[np.complex128], *, start: float = 0.0) -> NDArray[np.float64]:
    """Return the phase lag -arg z in degrees, within start .. start + 360.

    >>> lag_degrees(np.array([1 - 1j, 1 + 1j]))
    array([ 45., 315.])
    """
    return start + np.mod(-np.degrees(np.angle(z)) - start, 360.0)


def phase_window(z: NDArray[np.complex128]) -> float:
    """Return where a 360-degree phase axis should begin so that curves cross its ends least, a multiple of 45.

    It is the middle of the widest gap between the lags of the stronger vectors.

    >>> phase_window(np.exp(-1j * np.radians([350.0, 0.0, 90.0, 180.0])))  # the gap runs from 180 to 350
    -90.0
    """
    size = np.abs(z)
    strong = z[size > STRONG * np.nanmax(size)] if np.isfinite(size).any() else z[:0]
    if not strong.size:
        return 0.0
    lags = np.sort(lag_degrees(strong))
    gaps = np.diff(np.append(lags, lags[0] + 360.0))
    widest = int(np.argmax(gaps))
    middle = lags[widest] + gaps[widest] / 2
    return float(np.round(middle / 45.0) * 45.0 - (360.0 if middle > 180.0 else 0.0))


def break_at_wraps(lag: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a lag curve [deg] with NaN after every jump of more than half a turn, so that no line crosses the plot."""
    jumps = np.abs(np.diff(lag, prepend=lag[:1])) > 180.0
    return np.where(jumps, np.nan, lag)


def residual_grid(
    response: OrderTrackedResponse, sigmas: NDArray[np.float64], *, order: float = 1.0, bins: int = BINS
) -> tuple[list[str], NDArray[np.float64], NDArray[np.float64]]:
    """Return labels (row,), speed edges [rpm] (bin + 1,) and the residual's rms in sigma (row, bin) per probe and run.

    `sigmas` is (speed, probe, order) as in `Diagnosis`; NaN where nothing usable falls into a bin.
    """
    rpm, edges = response.omega * RPM, speed_edges(response, bins)
    labels, grid = [], []
    for p, probe in enumerate(response.probes):
        for i in sweeps(response):
            rows = (response.run == i) & response.usable[:, p]
            labels.append(f"{probe} {response.runs[i].name}")
            grid.append(binned_rms(rpm[rows], sigmas[rows, p, response.orders.index(order)], edges))
    return labels, edges, np.array(grid).reshape(len(labels), len(edges) - 1)


def whirl_grid(
    response: OrderTrackedResponse, residual: NDArray[np.complex128]
) -> tuple[list[str], NDArray[np.float64], NDArray[np.float64]]:
    """Return the same of forward and backward 1X whirl, rms in um 0-peak (row, bin), per pair of probes and run.

    `residual` is (speed, probe, order) [m] as in `Diagnosis`; no row where no plane has two probes.
    """
    labels, grid = [], []
    z = residual[:, :, response.orders.index(1.0)]
    edges = speed_edges(response, BINS)
    for plane, pair in measured_planes(response.rig, response.probes):
        seen = whirl(plane, z[:, pair], rotation=response.rig.rotation)
        for i in sweeps(response):
            rows = (response.run == i) & response.usable[:, pair].all(axis=1)
            for vectors, way in zip(seen, ("forward", "backward"), strict=True):
                labels.append(f"{'+'.join(plane.probes)} {response.runs[i].name}, {way}")
                grid.append(binned_rms(response.omega[rows] * RPM, np.abs(vectors[rows]) * UM, edges))
    return labels, edges, np.array(grid).reshape(len(labels), len(edges) - 1)


def speed_edges(response: OrderTrackedResponse, bins: int) -> NDArray[np.float64]:
    """Return the edges (bin + 1,) [rpm] of equal bins over the speeds of all sweeps."""
    rpm = response.omega[np.isin(response.run, sweeps(response))] * RPM
    return np.linspace(rpm.min(), rpm.max(), bins + 1) if rpm.size else np.array([0.0, 1.0])


def binned_rms(
    rpm: NDArray[np.float64], values: NDArray[np.float64], edges: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the root mean square of `values` (row,) in bins of speed (bin,); NaN where none falls into one."""
    finite = np.isfinite(values)
    square, _ = np.histogram(rpm[finite], edges, weights=values[finite] ** 2)
    count, _ = np.histogram(rpm[finite], edges)
    return np.sqrt(np.divide(square, count, out=np.full(len(square), np.nan), where=count > 0))
