"""Check of a DAQ's sample rate and channels against the config."""

from rotorrig.rig.errors import ConfigError
from rotorrig.rig.probes.base import DaqInfo

RATE_TOLERANCE = 1e-6  # relative


def check_requirements(info: DaqInfo, *, where: str, sample_rate: float, channels: int) -> None:
    """Raise ConfigError unless the DAQ at `where` samples at the rate [Hz] and has as many channels as wanted."""
    if abs(info.sample_rate - sample_rate) > RATE_TOLERANCE * sample_rate:
        raise ConfigError(
            f"daq.sample_rate: got {sample_rate:.10g} Hz in the config, "
            f"want {info.sample_rate:.10g} Hz as the DAQ '{info.model}' at {where} samples"
        )
    if info.channels < channels:
        raise ConfigError(
            f"channel {channels - 1}: is named in the config, but the DAQ '{info.model}' at {where} "
            f"has {info.channels} channels, want at least {channels}"
        )
