"""Wire format to the process of a live view.

One line of JSON (rig, DAQ, where pictures go, the unit of amplitudes, the events of a recording that is played), then
blocks, each a header and its counts as int32, scan by scan. The end of the bytes is the end of the view.
"""

import json
import os
import select
import struct
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rotorrig.acquisition import Event
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.rig import RigError
from rotorrig.rig.config import RigConfig, description
from rotorrig.rig.probes import Block, DaqInfo

READY = b"ready\n"  # what the process answers when it is
MOST_SCANS = 400_000  # handed on at a time: a replay at full speed brings more than can be drawn
_HEAD = struct.Struct("<qqII")  # first sample, t_ns, scans, channels
_CHUNK = 1 << 20  # bytes read at a time; a pipe holds 64 KiB, sometimes a MiB


@dataclass(frozen=True, slots=True, kw_only=True)
class Opening:
    """First message to the process."""

    rig: RigConfig
    info: DaqInfo
    targets: tuple[str | Path, ...]
    events: tuple[Event, ...] | None  # of a recording that is played; None: the rig is live
    unit: AmplitudeUnit  # in which amplitudes are told


def opening(
    rig: RigConfig,
    info: DaqInfo,
    targets: Sequence[str | Path],
    *,
    events: Sequence[Event] | None = None,
    unit: AmplitudeUnit = AS_STATED,
) -> bytes:
    """Return the first line: what is needed to draw. `targets` are addresses of viewers and names of files."""
    where = [["file", str(t.absolute())] if isinstance(t, Path) else ["viewer", t] for t in targets]
    si = rig.model_dump(mode="json")
    message: dict[str, Any] = {"rig": si, "text": rig.text, "daq": asdict(info), "targets": where, "unit": unit.name}
    message["events"] = None if events is None else [asdict(event) for event in events]
    return json.dumps(message).encode() + b"\n"


def block_parts(block: Block) -> tuple[bytes, memoryview]:
    """Return the bytes of a block, its counts not copied."""
    counts = np.ascontiguousarray(block.counts, dtype="<i4")
    head = _HEAD.pack(block.first_sample, block.t_ns, *counts.shape)
    return head, counts.data.cast("B") if counts.size else memoryview(b"")


class BlockReader:
    """Cuts what comes in on a file descriptor into the opening line and blocks."""

    def __init__(self, fd: int) -> None:
        self.ended = False  # nothing more will come
        self._fd = fd
        self._buffer = bytearray()

    def opening(self) -> Opening:
        """Wait for the first line and return what it says. Raises RigError if it does not come."""
        while (end := self._buffer.find(b"\n")) < 0:
            if self.ended:
                raise RigError("live view: its input ended before the opening line, want the rig and the DAQ")
            self._receive(None)
        message = json.loads(self._buffer[:end])
        del self._buffer[: end + 1]
        daq: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in message["daq"].items()}
        targets = tuple(Path(where) if kind == "file" else where for kind, where in message["targets"])
        return Opening(
            rig=description.from_si(message["rig"], text=message["text"], where="live view"),
            info=DaqInfo(**daq),
            targets=targets,
            events=None if message["events"] is None else tuple(Event(**event) for event in message["events"]),
            unit=AmplitudeUnit(message["unit"]),
        )

    def blocks(self, seconds: float) -> list[Block]:
        """Return the whole blocks that come within so many seconds, sooner at the end or when there are many."""
        deadline, received, scans = time.monotonic() + seconds, [], 0
        while scans < MOST_SCANS:
            while scans < MOST_SCANS and (block := self._next()) is not None:
                received.append(block)
                scans += len(block.counts)
            left = deadline - time.monotonic()
            if self.ended or left <= 0 or scans >= MOST_SCANS:
                break
            self._receive(left)
        return received

    def _next(self) -> Block | None:
        if len(self._buffer) < _HEAD.size:
            return None
        first, t_ns, scans, channels = _HEAD.unpack_from(self._buffer)
        size = _HEAD.size + 4 * scans * channels
        if len(self._buffer) < size:
            return None
        counts = np.frombuffer(bytes(self._buffer[_HEAD.size : size]), dtype="<i4").reshape(scans, channels)
        del self._buffer[:size]
        return Block(counts=counts, first_sample=first, t_ns=t_ns)

    def _receive(self, seconds: float | None) -> None:
        if select.select([self._fd], [], [], seconds)[0]:
            data = os.read(self._fd, _CHUNK)
            self._buffer += data
            self.ended = not data
