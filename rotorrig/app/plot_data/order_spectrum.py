"""The full spectrum of the tracked orders over speed: forward and backward whirl in a plane of probes."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.plot_data.curves import BINS, binned_rms, slow_roll_known, speed_edges, sweeps
from rotorrig.processing import OrderTrackedResponse, Plane
from rotorrig.processing.tracking import whirl_vectors
from rotorrig.rig.config import RPM, UM


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderSpectrum:
    """One plane in one run."""

    plane: Plane
    run: str
    orders: tuple[float, ...]  # (order,) from the highest forward to the highest backward one (negative)
    edges: NDArray[np.float64]  # (bin + 1,) rpm
    amplitude: NDArray[np.float64]  # (order, bin) µm 0-peak, root mean square over the bin; NaN: no usable row
    peak_rpm: float  # where the largest 1X vector of the plane is
    at_peak: NDArray[np.float64]  # (order,) µm 0-peak there


def order_spectra(response: OrderTrackedResponse) -> Iterator[OrderSpectrum]:
    """Yield the full spectrum of every plane of two probes in every run whose speed changes."""
    positive = sorted(order for order in response.orders if order > 0)
    orders = (*reversed(positive), *(-order for order in positive))
    edges = speed_edges(response, BINS)
    by_order = [whirl_vectors(response, order=o, compensated=slow_roll_known(response, o)) for o in positive]
    for whirl in zip(*by_order, strict=True):  # a plane
        forward = [np.abs(vectors.forward) * UM for vectors in reversed(whirl)]
        size = np.array([*forward, *(np.abs(vectors.backward) * UM for vectors in whirl)])
        for i in sweeps(response):
            rows = np.flatnonzero((response.run == i) & whirl[0].usable)
            if len(rows):
                yield _spectrum(whirl[0].plane, response, i, rows, orders, size[:, rows], edges)


def _spectrum(
    plane: Plane,
    response: OrderTrackedResponse,
    run: int,
    rows: NDArray[np.intp],
    orders: tuple[float, ...],
    size: NDArray[np.float64],
    edges: NDArray[np.float64],
) -> OrderSpectrum:
    """Return the spectrum of the rows of one run; `size` (order, row) are their amplitudes [µm]."""
    rpm = response.omega[rows] * RPM
    peak = int(np.argmax(np.nan_to_num(size[orders.index(1.0)] + size[orders.index(-1.0)])))
    return OrderSpectrum(
        plane=plane,
        run=response.runs[run].name,
        orders=orders,
        edges=edges,
        amplitude=np.array([binned_rms(rpm, values, edges) for values in size]),
        peak_rpm=float(rpm[peak]),
        at_peak=size[:, peak],
    )
