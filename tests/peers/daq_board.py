"""A DAQ board by docs/daq-stream.md: probes and keyphasor of the peer's own rotor, in real time."""

import json
import math
import random
import struct
import time
import zlib
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.peers.cables import PtyCable, Send
from tests.peers.journal import Journal

CHANNELS = 5  # 1x, 1y, 2x, 2y, keyphasor
FULL_SCALE = 2**23
VOLTS_PER_COUNT = 24.0 / FULL_SCALE
FALLS_BEHIND = 0.5  # s per second, of samples that come late
SCANS = 100  # a frame; 20 ms at 5 kS/s
BUFFER = 65536  # bytes the board keeps for a host that does not read

GAP = -10.0  # V, of a probe with the shaft at rest
SENSITIVITY = 7.874e3  # V/m, 200 mV/mil
RUN_OUT = (6e-6, 3e-6)  # m, once and twice per turn
ECCENTRICITY = 20e-6  # m
CRITICAL = 2230.0  # rpm
DAMPING = 0.04
NOISE = 3e-3  # V rms
NOTCH = (-8.0, -14.0)  # V, of the keyphasor beside and over its notch
NOTCH_WIDTH = 0.03  # of a turn

Volts = NDArray[np.float64]


@dataclass(slots=True)
class Switches:
    """What is wrong with the board or its sensors; all off in a sound one."""

    silent: bool = False  # it streams nothing and answers nothing
    lost: float = 0.0  # share of the frames
    late: float = 0.0  # s, which the samples fall behind by half a second per second
    keyphasor: str = ""  # "dead" or "noisy"
    probe: float | None = None  # V, of a dead probe 1y


def probe_volts(angle: Volts, rpm: Volts, *, rng: np.random.Generator) -> Volts:
    """Gap voltages (scan, probe) of two planes of a Jeffcott rotor with run-out, at angles [rad] and speeds [rpm]."""
    ratio = rpm / CRITICAL
    response = ECCENTRICITY * ratio**2 / (1 - ratio**2 + 2j * DAMPING * ratio)
    once, twice = RUN_OUT
    turning = response * np.exp(1j * angle) + once * np.exp(1j * (angle + 0.4))
    whirl = turning + twice * np.cos(2 * angle)
    columns = np.stack([whirl.real, whirl.imag, 0.6 * whirl.real, 0.6 * whirl.imag], axis=1)
    return GAP + SENSITIVITY * columns + rng.normal(0.0, NOISE, columns.shape)


def keyphasor_volts(angle: Volts, *, rng: np.random.Generator) -> Volts:
    """Voltage of a proximity probe over a shaft with one notch, which begins at angle 0."""
    turn = (angle / math.tau) % 1.0
    level, notch = NOTCH
    return np.where(turn < NOTCH_WIDTH, notch, level) + rng.normal(0.0, NOISE, angle.shape)


def frame(kind: int, payload: bytes, *, flags: int = 0) -> bytes:
    """A frame of the protocol."""
    body = struct.pack("<BBH", kind, flags, len(payload)) + payload
    return b"\xa5\x5a" + body + struct.pack("<I", zlib.crc32(body))


def pack_int24(counts: NDArray[np.int64]) -> bytes:
    """Little-endian int24 of counts, row by row."""
    return np.ascontiguousarray(counts.astype("<i4").reshape(-1, 1)).view(np.uint8)[:, :3].tobytes()


class DaqBoard:
    """Streams the sensors of a rotor that `sample` is told about; what reaches its client is kept in a file."""

    def __init__(self, *, port: Path, wire: Path, rate: float, seed: int, journal: Journal) -> None:
        """Open the port."""
        self.switches = Switches()
        self.rate = rate
        self.scans = 0  # sampled since START
        self._journal, self._rng, self._dice = journal, np.random.default_rng(seed), random.Random(seed)
        self._wire = wire.open("wb", buffering=0)
        self._streaming = False
        self._sequence = self._index = 0
        self._pending: list[NDArray[np.int64]] = []
        self._waiting: deque[tuple[float, bytes]] = deque()  # frames and when they are due
        self._out = bytearray()
        self._overrun = False
        self._late_since: float | None = None
        self._line = b""
        self.cable = PtyCable(self._connect, path=port, seed=seed)

    def sample(self, angle: Volts, rpm: Volts) -> None:
        """Convert the sensors at some angles [rad] and speeds [rpm], and send what makes a frame."""
        if self._streaming:
            volts = np.column_stack([probe_volts(angle, rpm, rng=self._rng), keyphasor_volts(angle, rng=self._rng)])
            self._spoil(volts)
            counts = np.clip(np.rint(volts / VOLTS_PER_COUNT), -FULL_SCALE, FULL_SCALE - 1).astype(np.int64)
            self.scans += len(counts)
            self._pending.append(counts)
            self._make_frames()
        self._send_due()

    def restart(self) -> None:
        """Begin again at sample 0, as after a brown-out."""
        self._begin()

    def close(self) -> None:
        """Take the port away and end the file."""
        self.cable.unplug()
        self._wire.close()

    def _spoil(self, volts: Volts) -> None:
        if self.switches.keyphasor == "dead":
            volts[:, -1] = NOTCH[0]
        elif self.switches.keyphasor == "noisy":
            volts[:, -1] += np.where(self._rng.random(len(volts)) < 0.01, self._rng.uniform(-8, 8, len(volts)), 0.0)
        if self.switches.probe is not None:
            volts[:, 1] = self.switches.probe

    def _make_frames(self) -> None:
        counts = np.concatenate(self._pending)
        whole = len(counts) // SCANS * SCANS
        for part in counts[:whole].reshape(-1, SCANS, CHANNELS):
            head = struct.pack("<IQHB", self._sequence & 0xFFFFFFFF, self._index, SCANS, CHANNELS)
            self._index += SCANS
            if self._dice.random() < self.switches.lost:
                self._sequence += 1
                continue
            if len(self._out) + sum(len(data) for _, data in self._waiting) > BUFFER and not self.switches.late:
                self._overrun = True  # nobody reads: these scans are lost before they are in a frame
                continue
            data = frame(2, head + pack_int24(part), flags=int(self._overrun))
            self._overrun = False
            self._sequence += 1
            self._waiting.append((time.monotonic() + self._lateness(), data))
        self._pending = [counts[whole:]]

    def _lateness(self) -> float:
        """Seconds for which the present frame is held back."""
        if not self.switches.late:
            self._late_since = None
            return 0.0
        self._late_since = self._late_since or time.monotonic()
        return min(self.switches.late, FALLS_BEHIND * (time.monotonic() - self._late_since))

    def _send_due(self) -> None:
        now = time.monotonic()
        while self._waiting and (self._waiting[0][0] <= now or not self.switches.late):
            self._out += self._waiting.popleft()[1]
        if self.switches.silent:
            self._out.clear()
        if self._out:
            taken = self.cable.offer(bytes(self._out))
            self._wire.write(self._out[:taken])
            del self._out[:taken]

    def _connect(self, send: Send) -> Callable[[bytes], None]:
        return self._hear

    def _hear(self, data: bytes) -> None:
        *lines, self._line = (self._line + data).split(b"\n")
        for line in lines:
            if not self.switches.silent:
                self._answer(line)

    def _answer(self, line: bytes) -> None:
        if line == b"ID?":
            self._out += frame(1, json.dumps(self._info()).encode())
        elif line == b"START":
            self._begin()
            self._journal.event("stream")
        elif line == b"STOP":
            self._streaming = False
            self._waiting.clear()
            self._out += frame(3, struct.pack("<Q", self.scans))
            self._journal.event("stream ended", scans=self.scans)
        else:
            self._out += frame(0x7F, b"want ID?, START or STOP")
        self._send_due()

    def _begin(self) -> None:
        self._streaming, self._sequence, self._index, self.scans = True, 0, 0, 0
        self._pending, self._overrun = [], False
        self._waiting.clear()

    def _info(self) -> dict[str, object]:
        return {
            "protocol": 1,
            "model": "peer board",
            "serial": "P1",
            "sample_rate_hz": self.rate,
            "channels": CHANNELS,
            "volts_per_count": [VOLTS_PER_COUNT] * CHANNELS,
            "full_scale_counts": FULL_SCALE,
        }
