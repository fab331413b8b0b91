"""Interlock: limits that stop the rotor whatever the plan says, checked on every sample.

`check` takes every Block, `check_motor` every reading of the drive; both raise LimitExceeded in one sentence. A link
that dies is raised by its driver, as LinkLost. Vibration has a limit per probe, and others inside a critical band.
"""

import math

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RPM, Limits, RigConfig
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.motor import MotorState
from rotorrig.rig.probes import Block, DaqInfo, KeyphasorSpeed, ProbeScale

MEAN_SECONDS = (
    1.0  # time constant of the running mean; it follows 1X by 1 / (omega * 1 s): 4 % at 240 rpm, 0.4 % at 2400
)
STRAY_SAMPLES = 2  # so many samples of a block beyond a limit are a spike on the wire, one more is vibration
SILENT_TURNS = 5.0  # a keyphasor silent for so many turns ...
SILENT_SECONDS = 2.0  # ... and for this long is lost


class Interlock:
    """Overspeed, vibration, clipped probes, a lost keyphasor, a drive in fault; limits are the config's [limits].

    Without [limits] only the keyphasor and the drive are watched; without [keyphasor], the speed is the drive's own.
    """

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        self.keyphasor = KeyphasorSpeed(rig, info) if rig.keyphasor else None
        self._limits = rig.limits
        self._scale = ProbeScale.of(rig, info)
        self._vibration = VibrationLimits(rig.limits, self._scale.names) if rig.limits else None
        self._gain = np.abs(self._scale.gain)  # (probe,) m per count; an inverting input has a negative one
        self._volts_per_count = np.array(info.volts_per_count)[self._scale.channels]
        self._clip = (-info.full_scale_counts, info.full_scale_counts - 1)
        self._mean_samples = MEAN_SECONDS * info.sample_rate
        self._seen = 0  # samples in the running mean
        self._mean = np.zeros(len(rig.probes))  # (probe,) counts
        self._turning_since: float | None = None  # keyphasor.time at which the drive was first seen to turn

    def check(self, block: Block) -> None:
        """Check one block. Raises LimitExceeded."""
        self.follow(block)
        if self._vibration is None or not len(block.counts):
            return
        if self.keyphasor:
            self._check_speed(self.keyphasor.steady_speed, "keyphasor")
        self._check_probes(block.counts, self._vibration)

    def follow(self, block: Block) -> None:
        """Update the speed from a block without checking it: the rotor is being stopped already."""
        if self.keyphasor:
            self.keyphasor.update(block)

    def check_motor(self, state: MotorState) -> None:
        """Check one reading of the drive. Raises LimitExceeded."""
        if state.fault:
            speed = state.speed or (self.keyphasor.steady_speed if self.keyphasor else 0.0)  # its output may be off
            raise LimitExceeded(f"drive: has tripped with '{state.fault}' at {speed * RPM:.0f} rpm")
        if self._limits:
            self._check_speed(state.speed, "drive")
        if self.keyphasor:
            self._check_pulses(state, self.keyphasor)

    def _check_speed(self, speed: float, source: str) -> None:
        assert self._limits is not None
        if speed > self._limits.overspeed:
            raise LimitExceeded(
                f"overspeed: {speed * RPM:.0f} rpm by the {source}, limit {self._limits.overspeed * RPM:.0f} rpm"
            )

    def _check_probes(self, counts: NDArray[np.int32], vibration: "VibrationLimits") -> None:
        """Compare the block's excursions from the running mean with the limits; counts (sample, channel)."""
        signals = [counts[:, channel] for channel in self._scale.channels]
        low = np.array([signal.min() for signal in signals])
        high = np.array([signal.max() for signal in signals])
        centre = self._centre(signals, low, high)
        peak = np.maximum(high - centre, centre - low) * self._gain
        limit, band = vibration.at(self.keyphasor.steady_speed if self.keyphasor else 0.0)
        for i in map(int, np.flatnonzero(peak > limit)):
            excursion = np.abs(signals[i] - centre[i]) * self._gain[i]
            if np.count_nonzero(excursion > limit[i]) > STRAY_SAMPLES:
                raise LimitExceeded(
                    f"probe {self._scale.names[i]}: {peak[i] * 1e6:.0f} um{self._at_speed()}, "
                    f"limit {limit[i] * 1e6:.0f} um{band}"
                )
        for i in map(int, np.flatnonzero((low <= self._clip[0]) | (high >= self._clip[1]))):
            self._check_clipped(i, signals[i])

    def _check_clipped(self, i: int, counts: NDArray[np.int32]) -> None:
        clipped = (counts <= self._clip[0]) | (counts >= self._clip[1])
        if np.count_nonzero(clipped) > STRAY_SAMPLES:
            end = float(counts[clipped][0] * self._volts_per_count[i])
            raise LimitExceeded(
                f"probe {self._scale.names[i]}: reads {end:.1f} V{self._at_speed()}, the end of the DAQ's range, "
                "where its vibration cannot be watched; check its gap and cable"
            )

    def _centre(
        self, signals: list[NDArray[np.int32]], low: NDArray[np.int32], high: NDArray[np.int32]
    ) -> NDArray[np.float64]:
        """Update the running mean by the block; return the centre of vibration, (probe,) counts.

        The mean of the first blocks may be that of half a turn; until it has settled the middle between the block's
        extremes stands in for it, which makes too little of a slow turn but never too much.
        """
        settled = self._seen >= self._mean_samples
        samples = len(signals[0])
        self._seen += samples
        weight = samples / max(min(self._seen, self._mean_samples), samples)
        mean = np.array([signal.sum(dtype=np.int64) for signal in signals]) / samples
        self._mean += weight * (mean - self._mean)
        return self._mean if settled else (low + high) / 2.0

    def _at_speed(self) -> str:
        speed = self.keyphasor.speed if self.keyphasor else 0.0
        return f" at {speed * RPM:.0f} rpm" if speed else ""

    def _check_pulses(self, state: MotorState, keyphasor: KeyphasorSpeed) -> None:
        """Check that the keyphasor pulses while the drive reports a speed."""
        if not state.running or state.speed <= 0:
            self._turning_since = None
            return
        if self._turning_since is None:
            self._turning_since = keyphasor.time
        silent = min(keyphasor.age, keyphasor.time - self._turning_since)
        if silent > max(SILENT_SECONDS, SILENT_TURNS * 2 * math.pi / state.speed):
            raise LimitExceeded(
                f"keyphasor: no pulse for {silent:.1f} s while the drive reports {state.speed * RPM:.0f} rpm, "
                "want one every turn; check the probe and the coupling"
            )


class VibrationLimits:
    """Vibration limits of each probe over speed: 0-peak about the mean, inside and outside critical bands."""

    def __init__(self, limits: Limits, names: tuple[str, ...]) -> None:
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
