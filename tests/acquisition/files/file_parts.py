"""Where the parts of a recording's file lie, and whether two recordings hold the same."""

import struct
from pathlib import Path

import numpy as np

from rotorrig.rig.probes.base import Block


def same_blocks(a: tuple[Block, ...], b: tuple[Block, ...]) -> bool:
    return len(a) == len(b) and all(
        np.array_equal(x.counts, y.counts)
        and (x.first_sample, x.t_ns, x.overrun) == (y.first_sample, y.t_ns, y.overrun)
        for x, y in zip(a, b, strict=True)
    )


def chunks(path: Path) -> list[tuple[int, int]]:
    """Return where each chunk record begins and ends."""
    found, data, offset = [], path.read_bytes(), 8
    while offset + 9 <= len(data):
        opcode, length = struct.unpack_from("<BQ", data, offset)
        if opcode == 6:
            found.append((offset, offset + 9 + length))
        offset += 9 + length
    return found


def with_index(path: Path) -> list[int]:
    """Return where each chunk's message index ends, which is where the next flush begins."""
    data = path.read_bytes()
    ends = []
    for _, end in chunks(path):
        offset = end
        while data[offset] == 7:
            offset += 9 + struct.unpack_from("<Q", data, offset + 1)[0]
        ends.append(offset)
    return ends
