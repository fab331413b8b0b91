"""Conversion of imported values to a RawRecording: int32 counts, exact to less than 1 nm or 1 uV."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.importers.channels import KEYPHASOR, Channel, Format
from rotorrig.acquisition.recording import Event, RawRecording
from rotorrig.rig import DataError, Provenance, code_version, file_hash
from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block, DaqInfo, channels_used

RESOLUTION = 1e-9  # m, twice the rounding error of a displacement made counts
FINEST = 1e-6  # V per count at the most: 0.13 nm on an 8 mm probe, and a range of 2147 V
FULL_SCALE = 2**31
RATES = (1.0, 1e9)  # Hz; a rate beyond them is a mistake in the file


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """Scale of the DAQ behind a file that still holds its counts: with it a clipped input is seen."""

    volts_per_count: tuple[float, ...]  # of each channel that is read
    full_scale_counts: int


def make_recording(
    path: Path,
    rig: RigConfig,
    channels: Sequence[Channel],
    pieces: Iterable[NDArray[np.float64]],
    *,
    rate: float,
    rate_source: str,
    form: Format,
    scale: Scale | None = None,
) -> RawRecording:
    """Return `pieces` of values (sample, channel), in the file's units, as a recording of the rig at `rate` [Hz].

    `rate_source` says where the rate comes from, for the note on what was assumed. Raises DataError for a value that
    is not a number or too large for its unit, and for a rate no recording has.
    """
    if not RATES[0] <= rate <= RATES[1]:
        raise DataError(f"{path}: says a sample rate of {rate:.6g} Hz, want one from {RATES[0]:g} to {RATES[1]:g} Hz")
    info = _info(path, rig, channels, rate, form, scale)
    return RawRecording(
        rig=rig,
        daq=info,
        blocks=tuple(_blocks(path, pieces, channels, rig, info, form)),
        events=(Event(t_ns=0, kind="note", text=_import_note(path, channels, rate, rate_source, form, scale)),),
        motor=(),
        source=Provenance(
            config_hash=rig.hash, code_version=code_version(), source=path.name, source_hash=file_hash(path)
        ),
        complete=True,
    )


def _info(
    path: Path, rig: RigConfig, channels: Sequence[Channel], rate: float, form: Format, scale: Scale | None
) -> DaqInfo:
    finest = [FINEST] * channels_used(rig)
    for i, (channel, place) in enumerate(zip(channels, _places(rig, channels), strict=True)):
        if scale is not None:
            finest[place] = scale.volts_per_count[i]
        elif channel.name != KEYPHASOR:
            finest[place] = min(FINEST, RESOLUTION * rig.probe(channel.name).sensitivity)
    return DaqInfo(
        model=f"{form.name} import",
        serial=path.name,
        sample_rate=rate,
        channels=len(finest),
        volts_per_count=tuple(finest),
        full_scale_counts=scale.full_scale_counts if scale else FULL_SCALE,
    )


def _places(rig: RigConfig, channels: Sequence[Channel]) -> list[int]:
    """Return the config's channel of each channel that is read."""
    keyphasor = rig.keyphasor.channel if rig.keyphasor else 0
    return [keyphasor if channel.name == KEYPHASOR else rig.probe(channel.name).channel for channel in channels]


def _blocks(
    path: Path,
    pieces: Iterable[NDArray[np.float64]],
    channels: Sequence[Channel],
    rig: RigConfig,
    info: DaqInfo,
    form: Format,
) -> Iterator[Block]:
    """Yield each piece as counts in the config's channels; a channel that is not read is zero."""
    places = _places(rig, channels)
    factor, offset = (np.array([getattr(c, name) for c in channels]) for name in ("factor", "offset"))
    scale = np.array(info.volts_per_count)[places]
    first = 0
    for values in pieces:
        with np.errstate(over="ignore", invalid="ignore"):  # too large values are reported below, with their place
            scaled = (values * factor + offset) / scale
            bad = np.argwhere(~(np.abs(scaled) <= info.full_scale_counts))  # NaN is not
        if len(bad):
            row, c = (int(i) for i in bad[0])
            where = f"{path}, {form.sample} {first + row + form.first}, {form.channel} '{channels[c].name}'"
            raise DataError(_misfit(where, float(values[row, c]), channels[c], info.full_scale_counts * scale[c]))
        counts = np.zeros((len(values), info.channels), dtype=np.int32)
        top = info.full_scale_counts - 1
        counts[:, places] = np.clip(np.round(scaled), -info.full_scale_counts, top).astype(np.int32)
        yield Block(counts=counts, first_sample=first, t_ns=round(first * 1e9 / info.sample_rate))
        first += len(values)


def _misfit(where: str, value: float, channel: Channel, limit: float) -> str:
    if not np.isfinite(value):
        return f"{where}: got {value}, want a finite number"
    return f"{where}: is too large for a signal in [{channel.unit}], want less than {limit:.0f} V; is the unit right?"


def _import_note(
    path: Path, channels: Sequence[Channel], rate: float, rate_source: str, form: Format, scale: Scale | None
) -> str:
    """Return the note on what the file did not say and the import assumed; it goes into the recording."""
    units = ", ".join(f"{c.name} [{c.unit}]" for c in channels)
    lengths = [c.name for c in channels if c.is_length]
    words = f"imported from {path.name}: {units}; {rate:.9g} Hz {rate_source}"
    if lengths:
        words += (
            f"; {', '.join(lengths)} taken as displacement towards the probe from its gap voltage, "
            "made volts with the config's sensitivity"
        )
    return words + ("" if scale else f"; clipping cannot be seen in {'an' if form.name[0] in 'U' else 'a'} {form.name}")
