"""Waveforms of a recording by time: raw counts, converted to volts and metres for the stretch asked for."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition import WaveformSource
from rotorrig.rig import DataError
from rotorrig.rig.probes import ProbeScale, channels_used

PIECE = 2**16  # samples of one channel at a time


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """Consecutive samples of the probes."""

    t: NDArray[np.float64]  # (sample,) s
    counts: NDArray[np.int32]  # (sample, probe)
    x: NDArray[np.float64]  # (sample, probe) m towards the probe, 0 at its gap voltage


class Waveforms:
    """Samples of a recording, read when they are asked for; time is the sample index over the sample rate."""

    def __init__(self, recording: WaveformSource) -> None:
        """Take the samples of a recording. Raises DataError if there are none or too few channels."""
        rig, daq = recording.rig, recording.daq
        self.where = recording.source.source or rig.name
        self.rate = daq.sample_rate
        self.full_scale = daq.full_scale_counts
        self.segments = [(first, counts) for first, counts in recording.segments() if len(counts)]
        if not self.segments:
            raise DataError(f"{self.where}: holds no samples, want a recorded sweep")
        if rig.keyphasor is None:
            raise DataError(f"{self.where}: the config has no [keyphasor], want one: orders are tracked by its pulses")
        present = min(counts.shape[1] for _, counts in self.segments)
        if channels_used(rig) > present:
            raise DataError(f"{self.where}: has {present} channels, the config uses {channels_used(rig)}")
        self._scale = ProbeScale.of(rig, daq)
        self.keyphasor = rig.keyphasor
        self._volts_per_count = daq.volts_per_count

    @property
    def probes(self) -> int:
        """Number of probes."""
        return len(self._scale.names)

    @property
    def metres_per_count(self) -> NDArray[np.float64]:
        """Displacement of one count of the ADC (probe,) [m]."""
        return np.abs(self._scale.gain)

    @property
    def gaps(self) -> list[tuple[float, float]]:
        """Stretches [s] between samples that are missing."""
        ends = [(first + len(counts) - 1) / self.rate for first, counts in self.segments[:-1]]
        starts = [first / self.rate for first, _ in self.segments[1:]]
        return list(zip(ends, starts, strict=True))

    def keyphasor_pieces(self) -> Iterator[tuple[int, NDArray[np.float64]]]:
        """Yield the keyphasor's samples piece by piece as (first sample, volts (sample,)), no gap within a piece."""
        channel = self.keyphasor.channel
        scale = np.float64(self._volts_per_count[channel])
        for first, counts in self.segments:
            for start in range(0, len(counts), PIECE):
                yield first + start, counts[start : start + PIECE][:, channel] * scale

    def between(self, begin: float, end: float) -> Stretch | None:
        """Return the samples with begin <= t < end, or None if any of them is missing."""
        return self.samples(int(np.ceil(begin * self.rate)), int(np.ceil(end * self.rate)))

    def samples(self, first: int, last: int) -> Stretch | None:
        """Return the samples from index `first` up to `last`, or None if any of them is missing."""
        for start, counts in self.segments:
            if start <= first and last <= start + len(counts):
                part = counts[first - start : last - start]
                return Stretch(
                    t=np.arange(first, last) / self.rate,
                    counts=part[:, self._scale.channels],
                    x=self._scale.displacement(part),
                )
        return None
