"""A `Block` as a message: raw counts, exact, as an array that any reader of MCAP and Protobuf can take as it is.

Channel after channel, little endian, in 16 bits where they suffice: zstd in chunks of 0.1 s packs a simulated RK4's
sweep at 10 kHz to 0.70 of its int16 so; sample after sample it would be more.

Files of before have differences instead, coding "delta", which took 0.38: folded (0, -1, 1, -2, ... as 0, 1, 2, 3,
...), then all low bytes, all high bytes. They are still read.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.files.schemas import message_type
from rotorrig.rig.probes import Block

WAVEFORM = message_type(
    "Waveform",
    {
        "t_ns": "int64",  # of the first sample
        "first_sample": "int64",
        "samples": "int64",
        "channels": "int64",
        "dtype": "string",  # "int16" or "int32": the least that holds these counts
        "counts": "bytes",  # of `dtype`, (channel, sample), little endian
        "overrun": "bool",
        "coding": "string",  # empty; "delta" in files of before: differences, see the top of this file
    },
)
DELTA, PLAIN = "delta", ""
_WIDTHS = {"int16": 2, "int32": 4}  # bytes


def pack_block(block: Block) -> dict[str, Any]:
    """Return a block as field values of WAVEFORM."""
    counts = block.counts
    narrow = np.iinfo(np.int16)
    fits = counts.size == 0 or (counts.min() >= narrow.min and counts.max() <= narrow.max)
    dtype = "int16" if fits else "int32"
    return {
        "t_ns": block.t_ns,
        "first_sample": block.first_sample,
        "samples": counts.shape[0],
        "channels": counts.shape[1],
        "dtype": dtype,
        "counts": np.ascontiguousarray(counts.T, dtype=f"<i{_WIDTHS[dtype]}").tobytes(),
        "overrun": block.overrun,
        "coding": PLAIN,
    }


def counts_of(message: Any) -> NDArray[Any]:
    """Return the counts (channel, sample) in a WAVEFORM message, as narrow as they came. Raises ValueError."""
    samples, channels = shape_of(message)
    shape, width = (channels, samples), _WIDTHS[message.dtype]
    if message.coding == DELTA:
        return _decode(message.counts, shape=shape, width=width)
    return np.frombuffer(message.counts, f"<i{width}").reshape(shape)


def unpack_blocks(messages: list[Any]) -> tuple[Block, ...]:
    """Return the blocks of many WAVEFORM messages, emptying the list.

    Consecutive blocks lie side by side in memory, so that joining them copies nothing; and each message is released
    once it is decoded, so that both forms of a long recording are never held at once.
    Raises ValueError if the fields of a message contradict one another.
    """
    blocks: list[Block] = []
    for run in _runs(messages):
        lengths = [message.samples for message in run]
        counts = np.empty((sum(lengths), run[0].channels), dtype=np.int32)
        at = 0
        for number, length in enumerate(lengths):
            blocks.append(_unpack_into(run[number], counts[at : at + length]))
            run[number] = None
            at += length
    return tuple(blocks)


def _decode(data: bytes, *, shape: tuple[int, int], width: int) -> NDArray[Any]:
    """Return counts (channel, sample) of byte planes of folded differences, `width` bytes each; modulo 2^(8 width)."""
    planes = np.frombuffer(data, np.uint8).reshape(width, *shape)
    folded = planes[-1].astype(f"<u{width}")
    for plane in planes[-2::-1]:  # twice as fast as a transposed copy of the bytes
        folded <<= 8
        folded |= plane
    sign = folded & 1
    folded >>= 1
    folded ^= np.negative(sign, out=sign)
    return np.cumsum(folded, axis=1, dtype=folded.dtype, out=folded).view(f"<i{width}")


def _unpack_into(message: Any, counts: NDArray[np.int32]) -> Block:
    """Decode a message into `counts` (sample, channel) and return the block."""
    counts[:] = counts_of(message).T
    return Block(counts=counts, first_sample=message.first_sample, t_ns=message.t_ns, overrun=message.overrun)


def shape_of(message: Any) -> tuple[int, int]:
    """Return (samples, channels) of a WAVEFORM message once they agree with its bytes; raises ValueError."""
    if message.dtype not in _WIDTHS:
        raise ValueError(f"dtype is {message.dtype!r}, want int16 or int32")
    if message.coding not in (DELTA, PLAIN):
        raise ValueError(f"coding is {message.coding!r}, want {DELTA!r} or none")
    samples, channels = message.samples, message.channels
    if min(samples, channels) < 0 or len(message.counts) != samples * channels * _WIDTHS[message.dtype]:
        raise ValueError(
            f"{len(message.counts)} bytes of {message.dtype} counts for {channels} channels of {samples} samples"
        )
    return samples, channels


def _runs(messages: list[Any]) -> Sequence[list[Any]]:
    """Return the checked messages in runs without a gap, emptying the list. Raises ValueError."""
    runs: list[list[Any]] = []
    expected: tuple[int, int] | None = None  # first sample, channels
    for message in messages:
        samples, channels = shape_of(message)
        if expected == (message.first_sample, channels):
            runs[-1].append(message)
        else:
            runs.append([message])
        expected = (message.first_sample + samples, channels)
    messages.clear()
    return runs
