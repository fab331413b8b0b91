"""Import of waveforms from WAV: PCM of 8 to 32 bits or floating point, any number of channels.

A WAV names neither channels nor units, so a mapping does (`channel_mapping`): channels count from 1, and `unit` is what
full scale stands for, the number 1.0 of a floating-point file. RIFF/WAVE as in IBM and Microsoft, Multimedia
Programming Interface and Data Specifications 1.0 (1991), with WAVE_FORMAT_EXTENSIBLE; RF64 and BW64 (EBU Tech 3306)
beyond 4 GiB.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.importers.channel_mapping import ChannelMapping
from rotorrig.acquisition.importers.channels import Channel, Format
from rotorrig.acquisition.importers.signals import Signal, read_signals
from rotorrig.acquisition.importers.waveforms import Scale
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig import ConfigError, DataError
from rotorrig.rig.config import RigConfig

FORM = Format(name="WAV", channel="channel", example="{name}")
UNKNOWN = 0xFFFFFFFF  # a size kept elsewhere (ds64), or never filled in: to the end of the file
_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE
_CHUNK = struct.Struct("<4sI")
_FMT = struct.Struct("<HHIIHH")  # format, channels, rate, bytes per second, bytes per scan, bits per sample


@dataclass(frozen=True, slots=True)
class Layout:
    """Sample format by the `fmt ` chunk, and place of the scans."""

    is_float: bool
    channels: int
    rate: int
    width: int  # bytes of a sample
    offset: int = 0
    scans: int = 0

    @property
    def full_scale(self) -> int:
        """Counts at full scale."""
        return 1 << (8 * self.width - 1)


def read_wav(path: Path, rig: RigConfig, mapping: ChannelMapping | None) -> RawRecording:
    """Read a WAV file as the recording of a rig; PCM in volts keeps its counts, so that a clipped input is seen.

    Raises ConfigError without a mapping, DataError for a file that cannot be used.
    """
    if mapping is None:
        raise ConfigError(f"{path}: a WAV names neither channels nor units, want a mapping (--mapping) that does")
    try:
        with path.open("rb") as file:
            layout = _layout(path, file)
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from error
    signals = [
        Signal(
            names=(str(number + 1),),
            rate=float(layout.rate),
            samples=layout.scans,
            values=partial(_values, path, layout, number),
        )
        for number in range(layout.channels)
    ]
    return read_signals(path, rig, signals, mapping, form=FORM, scale=partial(_scale, layout))


def _layout(path: Path, file: BinaryIO) -> Layout:
    """Walk the chunks up to the data. Raises DataError for what is no WAV file, cut short or of another coding."""
    size = path.stat().st_size
    riff = file.read(12)
    if len(riff) < 12 or riff[:4] not in (b"RIFF", b"RF64", b"BW64") or riff[8:] != b"WAVE":
        raise DataError(f"{path}: is no WAV file (it does not begin with RIFF and WAVE)")
    layout, long_size = None, None
    while len(head := file.read(_CHUNK.size)) == _CHUNK.size:
        name, length = _CHUNK.unpack(head)
        start = file.tell()
        if name == b"data":
            if layout is None:
                raise DataError(f"{path}: has its samples before the 'fmt ' chunk that describes them")
            if length == UNKNOWN:
                length = size - start if long_size is None else long_size
            return _locate_samples(path, layout, start, length, size)
        body = file.read(min(length, 40))
        if name == b"fmt ":
            layout = _read_format(path, body)
        elif name == b"ds64" and len(body) >= 16:
            long_size = struct.unpack_from("<Q", body, 8)[0]
        file.seek(start + length + length % 2)
    raise DataError(f"{path}: ends before its samples (there is no 'data' chunk)")


def _read_format(path: Path, body: bytes) -> Layout:
    if len(body) < _FMT.size:
        raise DataError(f"{path}: its 'fmt ' chunk has {len(body)} bytes, want {_FMT.size} or more")
    coding, channels, rate, _, per_scan, bits = _FMT.unpack_from(body)
    if coding == _EXTENSIBLE and len(body) >= 26:
        (coding,) = struct.unpack_from("<H", body, 24)  # the first two bytes of the sub-format's GUID
    width = per_scan // channels if channels else 0
    sound = width in {_PCM: (1, 2, 3, 4), _FLOAT: (4, 8)}.get(coding, ())
    if not sound or per_scan != width * channels or not 8 * (width - 1) < bits <= 8 * width:
        raise DataError(
            f"{path}: is coded as format {coding} with {bits} bits in {per_scan} bytes for {channels} channels, "
            "want PCM of 8 to 32 bits or floating point"
        )
    if not rate:
        raise DataError(f"{path}: says a sample rate of 0 Hz, want one above it")
    return Layout(is_float=coding == _FLOAT, channels=channels, rate=rate, width=width)


def _locate_samples(path: Path, layout: Layout, start: int, length: int, size: int) -> Layout:
    if length > size - start:
        raise DataError(f"{path}: is cut short, {size - start} of {length} bytes of samples are there")
    per_scan = layout.width * layout.channels
    if length % per_scan:
        raise DataError(f"{path}: has {length} bytes of samples, want whole scans of {per_scan} bytes")
    return Layout(layout.is_float, layout.channels, layout.rate, layout.width, start, length // per_scan)


def _values(path: Path, layout: Layout, channel: int) -> NDArray[np.float64]:
    """Return one channel (sample,), 1.0 at full scale."""
    shape = (layout.scans, layout.channels, layout.width)
    data = np.memmap(path, np.uint8, "r", layout.offset, shape)[:, channel]
    if layout.is_float:
        with np.errstate(invalid="ignore"):  # of NaNs, which are found with their place
            return np.ascontiguousarray(data).view(f"<f{layout.width}")[:, 0].astype(np.float64)
    if layout.width == 1:  # the only size without a sign
        return (data[:, 0].astype(np.float64) - 128.0) / 128.0
    high = np.zeros((layout.scans, 4), np.uint8)  # the bytes at the high end of 32 bits, for the sign
    high[:, 4 - layout.width :] = data
    return high.view("<i4")[:, 0] / 2.0**31


def _scale(layout: Layout, channels: Sequence[Channel]) -> Scale | None:
    """Return the counts of a PCM file; None for one in floating point, or with a length among its channels."""
    if layout.is_float or any(channel.is_length or channel.factor <= 0 for channel in channels):
        return None
    counts = tuple(channel.factor / layout.full_scale for channel in channels)
    return Scale(volts_per_count=counts, full_scale_counts=layout.full_scale)
