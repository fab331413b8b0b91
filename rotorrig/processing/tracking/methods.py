"""Tracking methods by their names: function, window, length and noise response of each."""

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
    """Tracking function of a method."""

    def __call__(
        self,
        waveforms: Waveforms,
        shaft: ShaftAngle,
        rows: Rows,
        *,
        orders: tuple[float, ...],
        progress: Callable[[float], None] | None = None,
    ) -> NDArray[np.complex128]:
        """Return z (row, probe, order) [m, 0-peak], NaN where samples are missing; `progress` gets the share done."""


class NoiseResponse(Protocol):
    """Response of a method to what lies beside the order it tracks."""

    def __call__(
        self, offset: NDArray[np.float64], *, order: float, orders: tuple[float, ...], turns: int
    ) -> NDArray[np.float64]:
        """Return |H|^2 at `offset` = (orders from `order`) * turns when tracking `orders` through rows of `turns`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackingMethod:
    """Tracking method with what the model and the noise need to know of it."""

    track: Track
    window: Window  # the weights under which a row is the mean of an order's amplitude
    revolutions: Callable[[float], float]  # turns of that window for rows of so many turns
    noise_response: NoiseResponse
    bandwidth: float  # integral of that, in 1 / turns


def _all_of(turns: float) -> float:
    return turns


def _vold_kalman_noise(
    offset: NDArray[np.float64], *, order: float, orders: tuple[float, ...], turns: int
) -> NDArray[np.float64]:
    """Return the filter's own response: what the other orders' equations take out of it is not counted."""
    return vold_kalman.power_response(offset)


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
