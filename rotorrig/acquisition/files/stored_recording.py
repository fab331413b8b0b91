"""Recording that stays in its file: an index of its blocks in memory, the counts read when asked for."""

from array import array
from collections import OrderedDict
from itertools import pairwise
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from mcap.records import Message
from numpy.typing import NDArray

from rotorrig.acquisition.files import block_message
from rotorrig.acquisition.files.mcap_records import Fault, Place, chunk_at
from rotorrig.acquisition.recording import Event, MotorSample, RawRecording
from rotorrig.rig import DataError, Provenance
from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import DaqInfo

CACHE = (
    8 * 2**20
)  # bytes of counts kept: 10 s of 8 channels of 16 bit at 50 kS/s; a segment of the noise spectrum is 2 s


class BlockIndex:
    """Index of the blocks of a file, 40 bytes each."""

    def __init__(self) -> None:
        self.first, self.samples, self.channels = array("q"), array("q"), array("q")
        self.offset, self.number = array("q"), array("q")  # of the chunk in the file, of the record in the chunk

    def add(self, message: Any, place: Place) -> None:
        """Add the block of a WAVEFORM message. Raises ValueError if its fields contradict one another."""
        samples, channels = block_message.shape_of(message)
        for column, value in zip(
            (self.first, self.samples, self.channels, self.offset, self.number),
            (message.first_sample, samples, channels, *place),
            strict=True,
        ):
            column.append(value)


class StoredRecording:
    """Recording like `RawRecording`, without its blocks in memory; a context manager that closes the file."""

    def __init__(self, path: Path, head: RawRecording, blocks: BlockIndex) -> None:
        """Take a recording's file, what is known of it without its blocks, and where they are."""
        self.rig: RigConfig = head.rig
        self.daq: DaqInfo = head.daq
        self.events: tuple[Event, ...] = head.events
        self.motor: tuple[MotorSample, ...] = head.motor
        self.source: Provenance = head.source
        self.complete = head.complete
        self.samples = sum(blocks.samples)
        self._file = _BlockFile(path, blocks)

    def segments(self) -> list[tuple[int, "StoredCounts"]]:
        """Return gap-free stretches as (first sample, counts (sample, channel)), the counts to be sliced."""
        first, end = self._file.first, self._file.end
        borders = [0, *(np.flatnonzero(first[1:] != end[:-1]) + 1), len(first)] if len(first) else []
        return [
            (int(first[a]), StoredCounts(self._file, int(first[a]), int(end[b - 1]), self.daq.channels))
            for a, b in pairwise(borders)
        ]

    def close(self) -> None:
        """Close the file; may be called twice."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class StoredCounts:
    """Counts (sample, channel) of a gap-free stretch in a file; a slice of it is an array."""

    def __init__(self, file: "_BlockFile", first: int, end: int, channels: int) -> None:
        self._file, self._first, self._end = file, first, end
        self.shape = (end - first, channels)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, samples: slice, /) -> NDArray[np.int32]:
        """Return the counts of consecutive samples. Raises DataError if the file changed since it was opened."""
        start, stop, step = samples.indices(len(self))
        if step != 1:
            raise ValueError(f"step is {step}, want consecutive samples")
        return self._file.read(self._first + start, self._first + max(start, stop), channels=self.shape[1])


class _BlockFile:
    """Reader of an open file's blocks by their samples, with a cache of the latest chunks."""

    def __init__(self, path: Path, blocks: BlockIndex) -> None:
        self._path, self._file = path, path.open("rb")
        self.first = np.array(blocks.first, dtype=np.int64)
        self.end = self.first + np.array(blocks.samples, dtype=np.int64)
        self._offset, self._number = np.array(blocks.offset), np.array(blocks.number)
        self._chunks: OrderedDict[int, dict[int, NDArray[Any]]] = OrderedDict()
        self._bytes = 0

    def read(self, first: int, last: int, *, channels: int) -> NDArray[np.int32]:
        """Return the counts (sample, channel) from sample `first` up to `last`, all of which are there."""
        counts = np.empty((last - first, channels), dtype=np.int32)
        begin, end = np.searchsorted(self.end, first, side="right"), np.searchsorted(self.first, last)
        for block in range(int(begin), int(end)):
            start = int(self.first[block])
            a, b = max(first, start), min(last, int(self.end[block]))
            counts[a - first : b - first] = self._counts(block)[:, a - start : b - start].T
        return counts

    def close(self) -> None:
        self._file.close()
        self._chunks.clear()

    def _counts(self, block: int) -> NDArray[Any]:
        """Return the counts (channel, sample) of a block."""
        offset, number = int(self._offset[block]), int(self._number[block])
        if offset not in self._chunks:
            self._chunks[offset] = chunk = self._decode_chunk(offset)
            self._bytes += sum(counts.nbytes for counts in chunk.values())
            while self._bytes > CACHE and len(self._chunks) > 1:
                _, oldest = self._chunks.popitem(last=False)
                self._bytes -= sum(counts.nbytes for counts in oldest.values())
        self._chunks.move_to_end(offset)
        if number not in self._chunks[offset]:
            raise DataError(f"{self._path}: has changed since it was opened, at byte {offset}")
        return self._chunks[offset][number]

    def _decode_chunk(self, offset: int) -> dict[int, NDArray[Any]]:
        """Return the counts of a chunk's blocks by their number in it."""
        counts: dict[int, NDArray[Any]] = {}
        begin, end = np.searchsorted(self._offset, [offset, offset + 1])
        mine = set(self._number[begin:end].tolist())
        for number, record in enumerate(chunk_at(self._file, offset)):
            if isinstance(record, Fault):
                raise DataError(f"{self._path}: has changed since it was opened, at byte {record.start}")
            if number in mine and isinstance(record, Message):
                counts[number] = block_message.counts_of(block_message.WAVEFORM.cls.FromString(record.data))
        return counts
