"""The methods of tracking by their names: how to get the vectors, and what the model and the noise have to know."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.response import Method, Window
from rotorrig.processing.rows import Rows
from rotorrig.processing.shaft_angle import ShaftAngle
from rotorrig.processing.tracking import angular_resampling, harmonic_least_squares, vold_kalman
from rotorrig.processing.waveform import Waveforms
from rotorrig.processing.windows import BLACKMAN_BANDWIDTH, HANN_BANDWIDTH


class Track(Protocol):
    """What a method does."""

    def __call__(
        self,
        waveforms: Waveforms,
        shaft: ShaftAngle,
        rows: Rows,
        *,
        orders: tuple[float, ...],
        progress: Callable[[float], None] | None = None,
    ) -> NDArray[np.complex128]:
        """Return z (row, probe, order) [m, 0-peak], NaN where samples are missing; tell `progress` the share done."""


class NoiseResponse(Protocol):
    """What a method lets through beside the order it tracks."""

    def __call__(
        self, beside: NDArray[np.float64], *, order: float, orders: tuple[float, ...], turns: int
    ) -> NDArray[np.float64]:
        """Return |H|^2 at `beside` = (orders from `order`) * turns when tracking `orders` through rows of `turns`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackingMethod:
    """One way to track."""

    track: Track
    window: Window  # the weights under which a row is the mean of an order's amplitude
    revolutions: Callable[[float], float]  # turns of that window for rows of so many turns
    noise_response: NoiseResponse
    bandwidth: float  # integral of that, in 1 / turns


def _all_of(turns: float) -> float:
    return turns


def _vold_kalman_noise(
    beside: NDArray[np.float64], *, order: float, orders: tuple[float, ...], turns: int
) -> NDArray[np.float64]:
    """Return the filter's own response: what the other orders' equations take out of it is not counted."""
    return vold_kalman.power_response(beside)


METHODS: dict[Method, TrackingMethod] = {
    "resampling": TrackingMethod(
        track=angular_resampling.track,
        window="blackman",
        revolutions=_all_of,
        noise_response=angular_resampling.noise_response,
        bandwidth=BLACKMAN_BANDWIDTH,
    ),
    "least-squares": TrackingMethod(
        track=harmonic_least_squares.track,
        window="hann",
        revolutions=_all_of,
        noise_response=harmonic_least_squares.noise_response,
        bandwidth=HANN_BANDWIDTH,
    ),
    "vold-kalman": TrackingMethod(
        track=vold_kalman.track,
        window="vold-kalman",
        revolutions=vold_kalman.support,
        noise_response=_vold_kalman_noise,
        bandwidth=HANN_BANDWIDTH,
    ),
}
