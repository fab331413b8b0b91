"""The framed serial DAQ, device side: the firmware of docs/daq-stream.md and the port it sits on.

Where the document leaves a choice, this board: counts in `sequence` the frames it sends (so samples lost in the
board show in index and flag alone); answers STOP with the DATA frame being sent, drops frames still queued, and
reports in STOPPED all scans it framed since START, lost and dropped ones included; drops scans not yet framed.
"""

import asyncio
import json
import struct
import zlib
from collections import deque

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.wire.cables import Cable
from rotorrig.sims.wire.plant_port import Plant

FRAME_TIME = 0.02  # s of samples in a DATA frame
FIFO_TIME = 1.0  # s of samples a board that cannot wait keeps for its reader
PATIENCE = 0.5  # s of wall time for which a board that can wait does: a drive that is braking must not hold for longer
BACKLOG = 64_000_000  # bytes it keeps for a reader that takes none meanwhile
MODEL = "rotorrig simulated DAQ"

_SYNC = b"\xa5\x5a"
_INFO, _DATA, _STOPPED, _ERROR = 0x01, 0x02, 0x03, 0x7F
_OVERRUN = 0x01
_DATA_HEAD = struct.Struct("<IQHB")  # sequence, index, scans, channels
_LONGEST_PAYLOAD = 0xFFFF
_LONGEST_LINE = 64
_WANTED = "want ID?, START or STOP"


class Firmware:
    """The board without its port: hears bytes, takes samples, fills `outbox` with frames.

    Without `waits` it keeps a second of samples for its reader and loses what comes after, as a board with a real ADC
    does. With it, it asks for none before its reader has taken the last frame (see `room`); from one who takes nothing
    for `PATIENCE` it goes on, and keeps `BACKLOG`.
    """

    def __init__(self, plant: Plant, *, serial: str, waits: bool) -> None:
        self._plant, self._serial, self._waits = plant, serial, waits
        fit = (_LONGEST_PAYLOAD - _DATA_HEAD.size) // (3 * plant.channels)
        self._frame_scans = min(fit, max(1, round(FRAME_TIME * plant.sample_rate)))
        kept = BACKLOG / (3 * plant.channels) if waits else FIFO_TIME * plant.sample_rate  # scans
        self._fifo_frames = kept / self._frame_scans
        self._deserted = False  # its reader has taken nothing for `PATIENCE`
        self.overrunning = False  # a script's: all samples are lost
        self.lost = 0  # scans, by overruns of either kind
        self._line = b""
        self.outbox: deque[bytes] = deque()
        self._scans: NDArray[np.int32]  # (sample, channel) not yet framed
        self._changed = asyncio.Event()
        self.streaming = False
        self._begin()

    def hear(self, data: bytes) -> None:
        """Take bytes from the host; act on every complete line."""
        *lines, self._line = (self._line + data).split(b"\n")
        for line in lines:
            self._obey(line)
        if len(self._line) > _LONGEST_LINE:
            self._send(frame(_ERROR, f"got a line longer than {_LONGEST_LINE} bytes, {_WANTED}".encode()))
            self._line = b""

    def measure(self, counts: NDArray[np.int32]) -> None:
        """Take samples (sample, channel); frame them while streaming, else forget them."""
        if not self.streaming:
            return
        self._scans = np.concatenate((self._scans, counts))
        while len(self._scans) >= self._frame_scans:
            self._emit(self._scans[: self._frame_scans])
            self._scans = self._scans[self._frame_scans :]

    async def room(self) -> None:
        """Return when samples are welcome: at once, or with `waits` when the last frame is on its way."""
        while self._waits and self.streaming and self.outbox and not self._deserted:
            try:
                async with asyncio.timeout(PATIENCE):
                    await self._change()
            except TimeoutError:
                self._deserted = True

    async def next_frame(self) -> bytes:
        """Wait for the next frame to send and take it out of the outbox."""
        while not self.outbox:
            await self._change()
        self._deserted = False
        self._changed.set()
        return self.outbox.popleft()

    def _obey(self, line: bytes) -> None:
        match line:
            case b"ID?":
                self._send(frame(_INFO, self._info()))
            case b"START":
                self._drop_data()
                self._begin()
                self.streaming = True
            case b"STOP":
                self._drop_data()
                self.streaming = False
                self._send(frame(_STOPPED, struct.pack("<Q", self._index)))
            case _:
                text = line.decode("utf-8", errors="replace")
                self._send(frame(_ERROR, f"got {text!r}, {_WANTED}".encode()))

    def _begin(self) -> None:
        self._sequence = 0
        self._index = 0
        self._lost = False
        self._scans = np.empty((0, self._plant.channels), dtype=np.int32)

    def _emit(self, scans: NDArray[np.int32]) -> None:
        if not self.overrunning and len(self.outbox) < self._fifo_frames:
            head = _DATA_HEAD.pack(self._sequence, self._index, *scans.shape)
            self._send(frame(_DATA, head + int24(scans), flags=_OVERRUN if self._lost else 0))
            self._sequence = (self._sequence + 1) % 2**32
            self._lost = False
        else:
            self._lost = True
            self.lost += len(scans)
        self._index += len(scans)

    def _info(self) -> bytes:
        return json.dumps(
            {
                "protocol": 1,
                "model": MODEL,
                "serial": self._serial,
                "sample_rate_hz": float(self._plant.sample_rate),
                "channels": self._plant.channels,
                "volts_per_count": list(self._plant.volts_per_count),
                "full_scale_counts": self._plant.full_scale_counts,
                "simulated": True,
            }
        ).encode()

    def _drop_data(self) -> None:
        self.outbox = deque(f for f in self.outbox if f[2] != _DATA)
        self._changed.set()

    def _send(self, data: bytes) -> None:
        self.outbox.append(data)
        self._changed.set()

    async def _change(self) -> None:
        self._changed.clear()
        await self._changed.wait()


async def serve(firmware: Firmware, cable: Cable) -> None:
    """Connect the board to its port, until cancelled."""

    async def hear(data: bytes) -> None:
        firmware.hear(data)

    async def talk() -> None:
        while True:
            await cable.write(await firmware.next_frame())

    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(cable.run(hear))
        tasks.create_task(talk())


def frame(kind: int, payload: bytes, *, flags: int = 0) -> bytes:
    """Return one frame of docs/daq-stream.md: sync, type, flags, length, payload, CRC-32.

    >>> frame(0x03, bytes(8)).hex(" ")
    'a5 5a 03 00 08 00 00 00 00 00 00 00 00 00 6b 54 9c 1f'
    """
    body = struct.pack("<BBH", kind, flags, len(payload)) + payload
    return _SYNC + body + struct.pack("<I", zlib.crc32(body))


def int24(counts: NDArray[np.int32]) -> bytes:
    """Return counts as little-endian int24, scan by scan.

    >>> int24(np.array([[1, -2]], dtype=np.int32)).hex(" ")
    '01 00 00 fe ff ff'
    """
    return counts.astype("<i4").reshape(-1, 1).view(np.uint8)[:, :3].tobytes()
