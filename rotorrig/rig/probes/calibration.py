"""Counts to volts to metres, for the probes a config names.

A probe's volts are gap_voltage + sensitivity * displacement towards it, so displacement is measured from the place
where the probe reads its gap voltage. Straight lines only: a probe's own curvature belongs to its error budget.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.probes.base import DaqInfo


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeScale:
    """The line from counts to metres of every probe, in the config's order: displacement = counts * gain + offset."""

    names: tuple[str, ...]
    channels: NDArray[np.intp]  # (probe,) column of a block's counts
    gain: NDArray[np.float64]  # (probe,) m per count, positive towards the probe
    offset: NDArray[np.float64]  # (probe,) m at zero counts

    @classmethod
    def of(cls, rig: RigConfig, info: DaqInfo) -> Self:
        """Return the scale of the config's probes on this DAQ. Raises ConfigError if a probe has no channel there."""
        check_channels(rig, info)
        channels = np.array([probe.channel for probe in rig.probes], dtype=np.intp)
        sensitivity = np.array([probe.sensitivity for probe in rig.probes])
        return cls(
            names=tuple(probe.name for probe in rig.probes),
            channels=channels,
            gain=np.array(info.volts_per_count)[channels] / sensitivity,
            offset=-np.array([probe.gap_voltage for probe in rig.probes]) / sensitivity,
        )

    def displacement(self, counts: NDArray[np.int32]) -> NDArray[np.float64]:
        """Return metres towards each probe, (sample, probe), from counts (sample, channel)."""
        metres = counts[:, self.channels] * self.gain
        metres += self.offset
        return metres


def channel_volts(counts: NDArray[np.int32], *, channel: int, info: DaqInfo) -> NDArray[np.float64]:
    """Return the volts of one channel, (sample,), from counts (sample, channel)."""
    return np.multiply(counts[:, channel], info.volts_per_count[channel], dtype=np.float64)


def channels_used(rig: RigConfig) -> int:
    """Return how many channels a DAQ must have for this config: one more than the highest it names."""
    named = [probe.channel for probe in rig.probes]
    named += [rig.keyphasor.channel] if rig.keyphasor else []
    return 1 + max(named)


def check_channels(rig: RigConfig, info: DaqInfo) -> None:
    """Raise ConfigError if the config names a channel the DAQ does not have."""
    if channels_used(rig) > info.channels:
        raise ConfigError(
            f"channel {channels_used(rig) - 1}: the DAQ '{info.model}' has {info.channels} channels, "
            f"want one with at least {channels_used(rig)} or other channel numbers in the config"
        )
