"""Which channels of a foreign file are the config's: by their names or a mapping, each with what makes volts of it."""

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
    """How a kind of file calls its parts, for sentences."""

    name: str  # "CSV"
    channel: str  # what it calls a channel: "column"
    sample: str = "sample"  # what it calls a scan: "row"
    first: int = 1  # number of the first scan
    heading: str = ""  # where channels are named: ", row 1"
    example: str = "{name}"  # how a channel the config wants would stand in the file
    unnamed: str = "none"  # said where no channel has a name


@dataclass(frozen=True, slots=True)
class Offer:
    """A channel of a foreign file: what it may be called, the first name to show, and its unit if the file says."""

    names: tuple[str, ...]
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Channel:
    """A channel that is read: value * factor + offset is volts."""

    name: str  # the probe's, or "keyphasor"
    unit: str
    index: int  # of the offer
    factor: float
    offset: float = 0.0
    is_length: bool = False


def wanted(
    path: Path, rig: RigConfig, offers: Sequence[Offer], mapping: ChannelMapping | None, *, form: Format
) -> tuple[Channel, ...]:
    """Return the config's channels, keyphasor first, probes in its order. Raises DataError for one that is not there.

    Without a mapping they are looked for under the config's names.
    """
    channels: list[Channel] = []
    for name in channel_names(rig):
        asked = mapping.of(name) if mapping else None
        index = find(path, offers, name, asked.channel if asked else name, form=form)
        channels.append(_channel(path, rig, name, index, offers[index], asked, form=form))
        if (twice := next((c for c in channels[:-1] if c.index == index), None)) is not None:
            label = offers[index].names[0]
            raise DataError(f"{path}: {form.channel} '{label}' is mapped to '{twice.name}' and '{name}', want one each")
    return tuple(channels)


def channel_names(rig: RigConfig) -> tuple[str, ...]:
    """Return what an import looks for."""
    return (*([KEYPHASOR] if rig.keyphasor else []), *(probe.name for probe in rig.probes))


def find(path: Path, offers: Sequence[Offer], name: str, place: str | int, *, form: Format) -> int:
    """Return the index of the offer at `place`, a name or a number from 1, wanted as `name`. Raises DataError."""
    if isinstance(place, int):
        if not 1 <= place <= len(offers):
            raise DataError(f"{path}: has {len(offers)} {form.channel}s, the mapping wants number {place} for '{name}'")
        return place - 1
    found = [i for i, offer in enumerate(offers) if place in offer.names]
    if len(found) > 1:
        raise DataError(f"{path}{form.heading}: {_count(len(found))} {form.channel}s are named '{place}', want one")
    if not found:
        shown = ", ".join(f"'{offer.names[0]:.40}'" for offer in offers if offer.names) or form.unnamed
        raise DataError(
            f"{path}{form.heading}: has no {form.channel} '{form.example.format(name=place)}', "
            f"{'the config wants it' if place == name else f'the mapping wants it for {name}'}; the file has {shown}"
        )
    return found[0]


def _channel(
    path: Path, rig: RigConfig, name: str, index: int, offer: Offer, asked: MappedChannel | None, *, form: Format
) -> Channel:
    where = f"{path}{form.heading}: {form.channel} '{offer.names[0]}'"
    probe = None if name == KEYPHASOR else rig.probe(name)
    wants = "V or mV" if probe is None else "V or a length such as um"
    unit = asked.unit if asked and asked.unit else f"1 {offer.unit}" if offer.unit else ""
    if not unit:
        raise DataError(f"{where} says no unit, want one in a mapping: what a 1 stands for, such as '1 V'")
    factor, is_length = signal_factor(unit, length=probe is not None) or (0.0, False)
    if not factor:  # neither one, or 0 of it
        raise DataError(f"{where} is in [{unit.removeprefix('1 ')}], want {wants}")
    if asked and asked.unit and offer.unit and not asked.override:
        stated = signal_factor(f"1 {offer.unit}", length=True)
        if stated is None or stated[1] != is_length or not math.isclose(stated[0], factor):
            raise DataError(
                f"{where} is in [{offer.unit}] as the file says, but the mapping says a 1 is {asked.unit}; "
                "want them to agree, the mapping's unit left out, or override = true beside it"
            )
    if is_length and probe:
        return Channel(name, unit.removeprefix("1 "), index, factor * probe.sensitivity, probe.gap_voltage, True)
    return Channel(name, unit.removeprefix("1 "), index, factor)


def _count(number: int) -> str:
    return "two" if number == 2 else str(number)
