"""Mapping of an imported file's channels to probes, with their units: a small TOML file, checked.

rate = "25.6 kHz"       # where the file does not say; the same for all channels

[[channels]]
probe = "1x"            # of the rig's config, or "keyphasor"
channel = "AI0"         # its name in the file, or its number from 1
unit = "1 V"            # what a 1 in the file stands for, volts or any length; left out: what the file says
override = true         # the file says another unit, which is wrong

[time]                  # of a CSV whose time column has another name
column = "t"
unit = "1 ms"
"""

from pathlib import Path

from rotorrig.acquisition.importers.signal_units import signal_factor
from rotorrig.rig import ConfigError
from rotorrig.rig.config import Part, Rate, RigConfig, Time, read_toml, validate_table


class MappedChannel(Part):
    """One channel of the file and the probe, or the keyphasor, behind it."""

    probe: str
    channel: int | str
    unit: str = ""
    override: bool = False


class TimeColumn(Part):
    """The column of times in a CSV."""

    column: int | str
    unit: Time | None = None


class ChannelMapping(Part):
    """Contents of a mapping file."""

    notes: str = ""
    rate: Rate | None = None
    time: TimeColumn | None = None
    channels: tuple[MappedChannel, ...]

    def of(self, name: str) -> MappedChannel | None:
        """Return the channel mapped to a probe or the keyphasor; None: it has the same name in the file."""
        return next((channel for channel in self.channels if channel.probe == name), None)


def load_channels(path: Path, rig: RigConfig) -> ChannelMapping:
    """Read and check a mapping against the rig. Raises ConfigError: file, key, got, wanted."""
    table, _ = read_toml(path, want="a mapping")
    mapping = validate_table(ChannelMapping, table, where=str(path))
    if fault := _fault(mapping, rig):
        raise ConfigError(f"{path}: {fault}")
    return mapping


def _fault(mapping: ChannelMapping, rig: RigConfig) -> str:
    """Return what is wrong with the mapping, empty if nothing."""
    known = [*(["keyphasor"] if rig.keyphasor else []), *(probe.name for probe in rig.probes)]
    seen: set[str] = set()
    for i, channel in enumerate(mapping.channels):
        key = f"channels[{i}]"
        if channel.probe not in known:
            return f"{key}.probe: the config has no '{channel.probe}', want one of {known}"
        if channel.probe in seen:
            return f"{key}.probe: '{channel.probe}' is there twice, want it once"
        if channel.unit and signal_factor(channel.unit, length=channel.probe != "keyphasor") is None:
            wants = "'1 V'" if channel.probe == "keyphasor" else "'1 V' or '1 um'"
            return f"{key}.unit: got '{channel.unit}', want what a 1 in the file stands for, such as {wants}"
        if channel.override and not channel.unit:
            return f"{key}.override: is there without a unit, want the unit that stands instead of the file's"
        seen.add(channel.probe)
    return ""
