"""Reader of an MCAP file's records one by one, which trusts no length in the file.

It walks the file by https://mcap.dev/spec instead of using the `mcap` package's reader, which allocates what a length
field asks for, reports an unfinished file as a record too long, and cannot go on behind a damaged record.
"""

import mmap
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, Header, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import breakup_chunk
from mcap.writer import MCAP0_MAGIC

from rotorrig.rig import DataError

CHUNK_LIMIT = 64 * 2**20  # bytes of one chunk unpacked; ours are about 1 MiB
TOTAL_LIMIT = 16 * 2**30  # bytes of all chunks unpacked: five hours of 8 channels at 50 kS/s
# and of a small file in proportion: silent inputs pack to a few thousandths, a file made to fill the memory to less
SPARE_LIMIT, RATIO_LIMIT = 256 * 2**20, 1000

RELEASE = 8 * 2**20  # bytes of the file shown in memory at once

_HEAD = struct.Struct("<BQ")  # opcode, length of the body
_CRC = struct.Struct("<I")
_CHUNK_FIXED = 8 + 8 + 8 + 4  # bytes before the name of the compression
_ZSTD_NAME = b"\x04\x00\x00\x00zstd"
_READERS: dict[int, Any] = {
    Opcode.HEADER: Header,
    Opcode.SCHEMA: Schema,
    Opcode.CHANNEL: Channel,
    Opcode.ATTACHMENT: Attachment,
    Opcode.METADATA: Metadata,
}


@dataclass(frozen=True, slots=True)
class Fault:
    """Bytes from `start` to `end` of the file that are no whole record."""

    start: int
    end: int
    what: str
    cut: bool  # the file ends here: nothing is behind it


class Place(NamedTuple):
    """Position of a record: the offset of its chunk, or its own outside of one, and its number in the chunk."""

    offset: int
    number: int


def read_records(path: Path) -> Iterator[McapRecord | Fault]:
    """Yield the data section's records, chunks opened, up to its end; a `Fault` for every stretch that is damaged.

    Behind a damaged chunk the walk goes on; where a length cannot be trusted it looks for the next whole chunk. A
    file that ends before its data section does yields a `Fault` with `cut` last. Raises DataError if the file cannot
    be read or is no MCAP file.
    """
    for record, _ in records_with_places(path):
        yield record


def records_with_places(path: Path) -> Iterator[tuple[McapRecord | Fault, Place]]:
    """Yield the same records with their places, where `chunk_at` finds them again."""
    try:
        with path.open("rb") as file:
            if file.read(len(MCAP0_MAGIC)) != MCAP0_MAGIC:
                raise DataError(f"{path}: is no MCAP file (its first bytes are not MCAP's), want one of this program's")
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
                for offset, records in _walk(data):
                    for number, record in enumerate(records):
                        yield record, Place(offset, number)
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from error


def chunk_at(file: BinaryIO, offset: int) -> list[McapRecord | Fault]:
    """Return the records of the chunk at `offset` of a file that was walked over before."""
    file.seek(offset)
    head = file.read(_HEAD.size)
    if len(head) < _HEAD.size:
        return [Fault(offset, offset, "the file ends too early", cut=True)]
    opcode, length = _HEAD.unpack(head)
    if opcode != Opcode.CHUNK or length > 2 * CHUNK_LIMIT:
        return [Fault(offset, offset, "this is no chunk", cut=False)]
    return _open_record(opcode, file.read(length), offset)


def _walk(data: mmap.mmap) -> Iterator[tuple[int, list[McapRecord | Fault]]]:
    """Yield the records, those of a chunk together, with the offset of the record or its chunk."""
    offset, unpacked, released = len(MCAP0_MAGIC), 0, 0
    limit = min(TOTAL_LIMIT, SPARE_LIMIT + RATIO_LIMIT * len(data))
    while True:
        if offset + _HEAD.size > len(data):
            yield offset, [Fault(offset, len(data), "the file ends too early", cut=True)]
            return
        opcode, length = _HEAD.unpack_from(data, offset)
        end = offset + _HEAD.size + length
        if opcode == Opcode.DATA_END and length == _CRC.size and end <= len(data):
            yield offset, [*_ending_faults(data, offset, end)]
            return
        if end > len(data) or not 0 < opcode < 0x80:
            following = _find_next_chunk(data, offset + 1)
            what = "the file ends too early" if following is None else "this is no record"
            end = len(data) if following is None else following
            yield offset, [Fault(offset, end, what, cut=following is None)]
            if following is None:
                return
        else:
            records = _open_record(opcode, data[offset + _HEAD.size : end], offset)
            unpacked += sum(len(r.data) for r in records if isinstance(r, Message))
            if unpacked > limit:
                yield offset, [Fault(offset, len(data), f"more than {limit / 2**30:.2g} GiB unpacked", cut=False)]
                return
            yield offset, records
        offset = end
        if offset - released > RELEASE:
            released = _release(data, offset)


def _open_record(opcode: int, body: bytes, offset: int) -> list[McapRecord | Fault]:
    """Return the record in `body`, or those inside it if it is a chunk, or the fault; `offset` is that of the record.

    A fault reaches to the body's end.
    """
    end = offset + _HEAD.size + len(body)
    try:
        if opcode == Opcode.CHUNK:
            return [*breakup_chunk(_check_chunk(body), validate_crc=True)]
        if opcode not in _READERS:
            return []
        if opcode == Opcode.ATTACHMENT and zlib.crc32(body[:-4]) != int.from_bytes(body[-4:], "little"):
            raise ValueError("wrong CRC")
        return [_READERS[opcode].read(_stream(body))]
    except Exception as error:  # whatever a reader or the decompressor makes of hostile bytes: it becomes a Fault
        return [Fault(offset, end, f"{Opcode(opcode).name.lower()} record: {error or type(error).__name__}", cut=False)]


def _check_chunk(body: bytes) -> Chunk:
    """Return the chunk if it unpacks to no more than it may; raises ValueError."""
    chunk = Chunk.read(_stream(body))
    if chunk.compression not in ("", "zstd"):
        raise ValueError(f"compressed with {chunk.compression!r}, want zstd (`mcap compress` rewrites it)")
    declared = _zstd_content_size(chunk.data) if chunk.compression else len(chunk.data)
    if max(declared, chunk.uncompressed_size) > CHUNK_LIMIT:
        raise ValueError(f"would unpack to more than {CHUNK_LIMIT >> 20} MiB")
    return chunk


def _zstd_content_size(frame: bytes) -> int:
    """Return the size a zstd frame says it unpacks to, 0 if it does not say; RFC 8878, section 3.1.1.1.

    `zstandard.decompress` allocates that much whatever limit it is given.

    >>> _zstd_content_size(bytes.fromhex("28b52ffd 20 05 290000"))  # single segment, one byte of size
    5
    """
    descriptor = frame[4] if len(frame) > 4 else 0
    single_segment = bool(descriptor & 0x20)
    width = (int(single_segment), 2, 4, 8)[descriptor >> 6]
    start = 5 + (not single_segment) + (0, 1, 2, 4)[descriptor & 3]
    return int.from_bytes(frame[start : start + width], "little") + (256 if width == 2 else 0)


def _ending_faults(data: mmap.mmap, start: int, end: int) -> Iterator[Fault]:
    """Look at the end of the data section, from `start` to `end`: its CRC, and whether the file's end is there."""
    (crc,) = _CRC.unpack_from(data, start + _HEAD.size)
    if crc != 0 and _checksum(data, start) != crc:
        yield Fault(start, start, "the CRC of all before is wrong", cut=False)
    if data[-len(MCAP0_MAGIC) :] != MCAP0_MAGIC or len(data) - len(MCAP0_MAGIC) < end:
        yield Fault(end, len(data), "the index at the end is not whole", cut=True)


def _checksum(data: mmap.mmap, end: int) -> int:
    """Return the CRC of the first `end` bytes."""
    crc = 0
    with memoryview(data) as view:
        for start in range(0, end, RELEASE):
            crc = zlib.crc32(view[start : min(start + RELEASE, end)], crc)
            _release(data, start)
    return crc


def _release(data: mmap.mmap, end: int) -> int:
    """Let the system take back the memory in which it showed the file up to `end`, and return that."""
    if hasattr(mmap, "MADV_DONTNEED"):  # not everywhere; without it the pages count as ours until they are wanted
        data.madvise(mmap.MADV_DONTNEED, 0, max(end, 1))
    return end


def _find_next_chunk(data: mmap.mmap, start: int) -> int | None:
    """Return the offset of the next chunk that can be opened, None if there is none."""
    name = data.find(_ZSTD_NAME, start)
    while name >= 0:
        offset = name - _CHUNK_FIXED - _HEAD.size
        if offset >= start:
            opcode, length = _HEAD.unpack_from(data, offset)
            end = offset + _HEAD.size + length
            if opcode == Opcode.CHUNK and end <= len(data):
                records = _open_record(opcode, data[offset + _HEAD.size : end], offset)
                if not any(isinstance(record, Fault) for record in records):
                    return offset
        name = data.find(_ZSTD_NAME, name + 1)
    return None


def _stream(body: bytes) -> ReadDataStream:
    return ReadDataStream(BytesIO(body))  # a read beyond the body ends there, whatever a length inside it says
