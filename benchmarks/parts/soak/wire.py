"""What recordings hold of what was on the DAQ's wire: nothing may be missing but what the fault itself took.

The bytes handed to the DAQ's client are kept, behind every fault; each frame among them that is whole by its CRC-32
has to be in a recording, count by count. Read here from docs/daq-stream.md alone, not with the driver's decoder.
"""

import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition import RawRecording

_SYNC = b"\xa5\x5a"
_HEAD = struct.Struct("<BBH")  # type, flags, length
_DATA = 0x02
_DATA_HEAD = struct.Struct("<IQHB")  # sequence, index, scans, channels

Counts = NDArray[np.int32]


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """The wire beside the recordings, in scans of all channels."""

    sent: int  # scans in whole frames, none counted twice
    recorded: int
    lost: int  # sent and not recorded where nothing is excused
    wrong: int  # recorded there otherwise than sent, or never sent


def compare(wire: bytes, recordings: Sequence[RawRecording], *, begin: int = 0, end: int | None = None) -> Comparison:
    """Compare the bytes on the DAQ's wire with what was recorded; judge scans `begin` to `end` alone."""
    frames = dict(_first_stream(data_frames(wire)))
    found = [segment for recording in recordings for segment in recording.segments()]
    channels = recordings[0].daq.channels if recordings else 0
    ends = [first + len(counts) for first, counts in [*found, *frames.items()]]
    size = max(ends, default=0)
    sent, values = np.zeros(size, dtype=bool), np.zeros((size, channels), dtype=np.int32)
    for index, counts in frames.items():
        sent[index : index + len(counts)] = True
        if channels:
            values[index : index + len(counts)] = counts
    recorded, wrong = np.zeros(size, dtype=bool), np.zeros(size, dtype=bool)
    for first, counts in found:
        there = slice(first, first + len(counts))
        wrong[there] |= ~sent[there] | (values[there] != counts).any(axis=1)
        recorded[there] = True
    due = np.zeros(size, dtype=bool)
    due[max(0, begin) : size if end is None else max(0, end)] = True
    return Comparison(
        sent=int(sent.sum()),
        recorded=int(recorded.sum()),
        lost=int((due & sent & ~recorded).sum()),
        wrong=int((due & wrong).sum()),
    )


def _first_stream(frames: Iterator[tuple[int, Counts]]) -> Iterator[tuple[int, Counts]]:
    """Yield the frames up to a restart of the board, which begins again at 0."""
    last = -1
    for index, counts in frames:
        if index < last:
            return
        last = index
        yield index, counts


def data_frames(wire: bytes) -> Iterator[tuple[int, Counts]]:
    """Yield index and counts (scan, channel) of every whole DATA frame among some bytes."""
    at = wire.find(_SYNC)
    while at >= 0:
        body = at + len(_SYNC)
        end = _end_of_frame(wire, body)
        if end is None:
            at = wire.find(_SYNC, at + 1)
            continue
        kind, _, _ = _HEAD.unpack_from(wire, body)
        if kind == _DATA:
            _, index, scans, channels = _DATA_HEAD.unpack_from(wire, body + _HEAD.size)
            yield index, _int24(wire[body + _HEAD.size + _DATA_HEAD.size : end - 4]).reshape(scans, channels)
        at = wire.find(_SYNC, end)


def _end_of_frame(wire: bytes, body: int) -> int | None:
    """Return where the frame with its body at `body` ends; None if there is no whole one."""
    if len(wire) < body + _HEAD.size:
        return None
    _, _, length = _HEAD.unpack_from(wire, body)
    crc = body + _HEAD.size + length
    if len(wire) < crc + 4 or zlib.crc32(wire[body:crc]) != int.from_bytes(wire[crc : crc + 4], "little"):
        return None
    return crc + 4


def _int24(data: bytes) -> Counts:
    parts = np.frombuffer(data, dtype=np.uint8).reshape(-1, 3).astype(np.int32)
    counts = parts[:, 0] | parts[:, 1] << 8 | parts[:, 2] << 16
    return (counts ^ 0x800000) - 0x800000
