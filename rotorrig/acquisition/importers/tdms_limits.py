"""Limits a TDMS file must keep before nptdms reads it, which trusts every number in a file."""

import os
import re
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

from rotorrig.rig import DataError

MOST_PIECES = 5_000_000  # channels in all chunks of all segments; nptdms takes a microsecond or more for each
MOST_SCALES = 10  # of a channel, one after the other; DAQmx writes two or three

_LEAD_IN = struct.Struct("<4sI")  # tag, contents of the segment
_LENGTHS = "IQQ"  # version, bytes to the next segment, bytes of metadata among them; in the segment's byte order
_LEAD_IN_SIZE = 28
_META_DATA, _BIG_ENDIAN = 1 << 1, 1 << 6
_OBJECT = 12  # bytes of the shortest object: length of its path, index, number of properties
_SCALE = re.compile(r"NI_Scale\[(\d{1,9})\d*\]_Scale_Type")


class BoundedFile:
    """Binary file that never allocates more memory than it has bytes, whatever a reader asks for."""

    def __init__(self, file: BinaryIO, size: int) -> None:
        self._file, self._size = file, size

    def read(self, count: int) -> bytes:
        """Return up to `count` bytes."""
        return self._file.read(max(0, min(count, self._size - self._file.tell())))

    def readinto(self, buffer: Any) -> int:
        """Fill `buffer` as far as there are bytes."""
        return self._file.readinto(buffer)  # type: ignore[attr-defined]

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a place in the file."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """Return the place in the file."""
        return self._file.tell()


def check_segments(path: Path, file: BinaryIO) -> None:
    """Raise DataError unless whole segments follow one another to the file's end, with few enough objects in all.

    An object may be listed anew in every segment, so that a small file could make a very long list.
    """
    size = path.stat().st_size
    at = segments = objects = 0
    while at < size:
        length, more = _segment(path, file, at, size)
        at, segments, objects = at + length, segments + 1, objects + more
        if segments * objects > MOST_PIECES:
            raise DataError(_in_pieces(path, segments * objects))
    if not segments:
        raise DataError(f"{path}: is empty, want a TDMS file")
    file.seek(0)


def _segment(path: Path, file: BinaryIO, at: int, size: int) -> tuple[int, int]:
    """Return the bytes of the segment at `at` and the number of objects in its metadata."""
    file.seek(at)
    lead_in = file.read(_LEAD_IN_SIZE + 4)
    if lead_in[:4] != b"TDSm":
        if at:
            raise DataError(f"{path}: is damaged at byte {at}, where a segment should begin")
        raise DataError(f"{path}: is no TDMS file (it does not begin with TDSm)")
    if len(lead_in) < _LEAD_IN_SIZE:
        raise DataError(f"{path}: is cut short in the segment at byte {at}")
    _, contents = _LEAD_IN.unpack_from(lead_in)
    order = ">" if contents & _BIG_ENDIAN else "<"
    _, length, metadata = struct.unpack_from(order + _LENGTHS, lead_in, _LEAD_IN.size)
    if at + _LEAD_IN_SIZE + length > size:
        raise DataError(
            f"{path}: is cut short: the segment at byte {at} should have {length} bytes, "
            f"{size - at - _LEAD_IN_SIZE} are there"
        )
    objects = 0
    if contents & _META_DATA and len(lead_in) == _LEAD_IN_SIZE + 4:
        (objects,) = struct.unpack_from(order + "I", lead_in, _LEAD_IN_SIZE)
    if metadata > length or objects * _OBJECT > metadata:
        raise DataError(f"{path}: is damaged: the segment at byte {at} has no room for what it lists")
    return _LEAD_IN_SIZE + length, objects


def check_chunks(path: Path, segments: Any) -> None:
    """Raise DataError if nptdms's `segments` claim more values than they have bytes, or are in too many pieces."""
    pieces = 0
    for segment in segments:
        room = segment.next_segment_pos - segment.data_position
        for item in segment.ordered_objects:
            if item.has_data and item.number_values > room:
                raise DataError(f"{path}: is damaged: {item.path} has {item.number_values} values in {room} bytes")
        pieces += segment.num_chunks * len(segment.ordered_objects)
        if pieces > MOST_PIECES:
            raise DataError(_in_pieces(path, pieces))


def check_scales(where: str, properties: Mapping[str, Any]) -> None:
    """Raise DataError if the properties describe a longer chain of scales than any DAQ's."""
    numbered = [int(match[1]) + 1 for name in properties if (match := _SCALE.fullmatch(name))]
    stated = properties.get("NI_Number_Of_Scales", 0)
    if max([*numbered, stated if isinstance(stated, int) else 0]) > MOST_SCALES:
        raise DataError(f"{where}: has more than {MOST_SCALES} scales, want fewer")


def _in_pieces(path: Path, pieces: int) -> str:
    return (
        f"{path}: is in {pieces} pieces or more, want at most {MOST_PIECES}; "
        "TDMS Defragment (LabVIEW) or saving it anew (DIAdem) joins them"
    )
