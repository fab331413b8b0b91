"""Vibration: the excursion of every probe from its running mean, and probes at the end of the DAQ's range.

A probe has its limit from [limits], and another inside a critical band. Without [limits] it is where the probe's
linear range ends: what is beyond cannot be measured.
"""

import math

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RPM, Probe, RigConfig
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.probes import DaqInfo, ProbeScale

MEAN_SECONDS = (
    1.0  # time constant of the running mean; it follows 1X by 1 / (omega * 1 s): 4 % at 240 rpm, 0.4 % at 2400
)
STRAY_SAMPLES = 2  # so many samples of a block beyond a limit are a spike on the wire, one more is vibration


class Vibration:
    """Follows the running mean of every probe and compares each block with the limits."""

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        self._scale = ProbeScale.of(rig, info)
        self._limits = VibrationLimits(rig)
        self._gain = np.abs(self._scale.gain)  # (probe,) m per count; an inverting input has a negative one
        self._volts_per_count = np.array(info.volts_per_count)[self._scale.channels]
        self._clip = (-info.full_scale_counts, info.full_scale_counts - 1)
        self._mean_samples = MEAN_SECONDS * info.sample_rate
        self._seen = 0  # samples in the running mean
        self._mean = np.zeros(len(rig.probes))  # (probe,) counts

    def check(self, counts: NDArray[np.int32], *, speed: float, steady_speed: float) -> NDArray[np.float64]:
        """Compare a block's counts (sample, channel) with the limits at `steady_speed` [rad/s]; return means [V].

        `speed` is for the words alone. Raises LimitExceeded.
        """
        signals = [counts[:, channel] for channel in self._scale.channels]
        low = np.array([signal.min() for signal in signals])
        high = np.array([signal.max() for signal in signals])
        mean = np.array([signal.sum(dtype=np.int64) for signal in signals]) / len(counts)
        centre = self._centre(mean, low, high, samples=len(counts))
        peak = np.maximum(high - centre, centre - low) * self._gain
        limit, band = self._limits.at(steady_speed)
        for i in map(int, np.flatnonzero(peak > limit)):
            excursion = np.abs(signals[i] - centre[i]) * self._gain[i]
            if np.count_nonzero(excursion > limit[i]) > STRAY_SAMPLES:
                raise LimitExceeded(
                    f"probe {self._scale.names[i]}: {peak[i] * 1e6:.0f} um{_at(speed)}, "
                    f"limit {limit[i] * 1e6:.0f} um{band}"
                )
        for i in map(int, np.flatnonzero((low <= self._clip[0]) | (high >= self._clip[1]))):
            self._check_clipped(i, signals[i], speed)
        return mean * self._volts_per_count

    def _check_clipped(self, i: int, counts: NDArray[np.int32], speed: float) -> None:
        clipped = (counts <= self._clip[0]) | (counts >= self._clip[1])
        if np.count_nonzero(clipped) > STRAY_SAMPLES:
            end = float(counts[clipped][0] * self._volts_per_count[i])
            raise LimitExceeded(
                f"probe {self._scale.names[i]}: reads {end:.1f} V{_at(speed)}, the end of the DAQ's range, "
                "where its vibration cannot be watched; check its gap and cable"
            )

    def _centre(
        self, mean: NDArray[np.float64], low: NDArray[np.int32], high: NDArray[np.int32], *, samples: int
    ) -> NDArray[np.float64]:
        """Update the running mean by the block's; return the centre of vibration, (probe,) counts.

        The mean of the first blocks may be that of half a turn; until it has settled the middle between the block's
        extremes stands in for it, which makes too little of a slow turn but never too much.
        """
        settled = self._seen >= self._mean_samples
        self._seen += samples
        weight = samples / max(min(self._seen, self._mean_samples), samples)
        self._mean += weight * (mean - self._mean)
        return self._mean if settled else (low + high) / 2.0


class VibrationLimits:
    """Vibration limits of each probe over speed: 0-peak about the mean, inside and outside critical bands."""

    def __init__(self, rig: RigConfig) -> None:
        limits = rig.limits
        if limits is None:
            self._outside = np.array([linear_amplitude(probe) for probe in rig.probes])
            self._bands = []
            return
        names = [probe.name for probe in rig.probes]
        self._outside = np.array([limits.probes.get(name, limits.vibration) for name in names])
        self._bands = [
            (band, np.array([band.probes.get(name, band.vibration) for name in names]))
            for band in limits.critical_bands
        ]

    def at(self, speed: float) -> tuple[NDArray[np.float64], str]:
        """Return the limits (probe,) [m] at a speed [rad/s], and the name of their band, for the error."""
        for band, limit in self._bands:
            if band.low <= speed <= band.high:
                return limit, f" in the critical band {band.low * RPM:.0f}-{band.high * RPM:.0f} rpm"
        return self._outside, ""


def linear_amplitude(probe: Probe) -> float:
    """Return the displacement [m] from the gap voltage to the nearer end of the linear range.

    Infinite where the gap voltage is outside the range: then it is not that probe's, but the default.
    """
    low, high = sorted(probe.linear_range)
    room = min(high - probe.gap_voltage, probe.gap_voltage - low)
    return room / probe.sensitivity if room > 0 else math.inf


def _at(speed: float) -> str:
    return f" at {speed * RPM:.0f} rpm" if speed else ""
