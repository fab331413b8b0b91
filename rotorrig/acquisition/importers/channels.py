"""Match of an imported file's channels to the config's, by name or mapping, each with its scale to volts."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rotorrig.acquisition.importers.channel_mapping import ChannelMapping, MappedChannel
from rotorrig.acquisition.importers.signal_units import signal_factor
from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig

KEYPHASOR = "keyphasor"


@dataclass(frozen=True, slots=True, kw_only=True)
class Format:
    """Vocabulary of a file format, for error messages."""

    name: str  # "CSV"
    channel: str  # what it calls a channel: "column"
    sample: str = "sample"  # what it calls a scan: "row"
    first: int = 1  # number of the first scan
    heading: str = ""  # where channels are named: ", row 1"
    example: str = "{name}"  # how a channel the config wants would stand in the file
    unnamed: str = "none"  # shown where no channel has a name


@dataclass(frozen=True, slots=True)
class FileChannel:
    """Channel of an imported file: its names, the first of which is shown, and its unit if the file gives one."""

    names: tuple[str, ...]
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Channel:
    """Channel to be read: value * factor + offset is volts."""

    name: str  # the probe's, or "keyphasor"
    unit: str
    index: int  # in the file
    factor: float
    offset: float = 0.0
    is_length: bool = False


def match_channels(
    path: Path, rig: RigConfig, available: Sequence[FileChannel], mapping: ChannelMapping | None, *, form: Format
) -> tuple[Channel, ...]:
    """Return the config's channels, keyphasor first, probes in its order. Raises DataError for one that is not there.

    Without a mapping they are looked for under the config's names.
    """
    channels: list[Channel] = []
    for name in channel_names(rig):
        asked = mapping.of(name) if mapping else None
        index = find_channel(path, available, name, asked.channel if asked else name, form=form)
        channels.append(_channel(path, rig, name, index, available[index], asked, form=form))
        if (twice := next((c for c in channels[:-1] if c.index == index), None)) is not None:
            label = available[index].names[0]
            raise DataError(f"{path}: {form.channel} '{label}' is mapped to '{twice.name}' and '{name}', want one each")
    return tuple(channels)


def channel_names(rig: RigConfig) -> tuple[str, ...]:
    """Return the names an import looks for."""
    return (*([KEYPHASOR] if rig.keyphasor else []), *(probe.name for probe in rig.probes))


def find_channel(path: Path, available: Sequence[FileChannel], name: str, place: str | int, *, form: Format) -> int:
    """Return the index of the channel at `place`, a name or a number from 1, for `name`. Raises DataError."""
    if isinstance(place, int):
        if not 1 <= place <= len(available):
            raise DataError(
                f"{path}: has {len(available)} {form.channel}s, the mapping wants number {place} for '{name}'"
            )
        return place - 1
    indices = [i for i, file_channel in enumerate(available) if place in file_channel.names]
    if len(indices) > 1:
        raise DataError(f"{path}{form.heading}: {_count(len(indices))} {form.channel}s are named '{place}', want one")
    if not indices:
        shown = (
            ", ".join(f"'{file_channel.names[0]:.40}'" for file_channel in available if file_channel.names)
            or form.unnamed
        )
        raise DataError(
            f"{path}{form.heading}: has no {form.channel} '{form.example.format(name=place)}', "
            f"{'the config wants it' if place == name else f'the mapping wants it for {name}'}; the file has {shown}"
        )
    return indices[0]


def _channel(
    path: Path,
    rig: RigConfig,
    name: str,
    index: int,
    file_channel: FileChannel,
    asked: MappedChannel | None,
    *,
    form: Format,
) -> Channel:
    where = f"{path}{form.heading}: {form.channel} '{file_channel.names[0]}'"
    probe = None if name == KEYPHASOR else rig.probe(name)
    wants = "V or mV" if probe is None else "V or a length such as um"
    unit = asked.unit if asked and asked.unit else f"1 {file_channel.unit}" if file_channel.unit else ""
    if not unit:
        raise DataError(f"{where} says no unit, want one in a mapping: what a 1 stands for, such as '1 V'")
    factor, is_length = signal_factor(unit, length=probe is not None) or (0.0, False)
    if not factor:  # neither one, or 0 of it
        raise DataError(f"{where} is in [{unit.removeprefix('1 ')}], want {wants}")
    if asked and asked.unit and file_channel.unit and not asked.override:
        stated = signal_factor(f"1 {file_channel.unit}", length=True)
        if stated is None or stated[1] != is_length or not math.isclose(stated[0], factor):
            raise DataError(
                f"{where} is in [{file_channel.unit}] as the file says, but the mapping says a 1 is {asked.unit}; "
                "want them to agree, the mapping's unit left out, or override = true beside it"
            )
    if is_length and probe:
        return Channel(name, unit.removeprefix("1 "), index, factor * probe.sensitivity, probe.gap_voltage, True)
    return Channel(name, unit.removeprefix("1 "), index, factor)


def _count(number: int) -> str:
    return "two" if number == 2 else str(number)
