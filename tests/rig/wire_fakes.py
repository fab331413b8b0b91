"""The far ends of two wires, at the level of bytes: a Modbus RTU drive and a framed DAQ board, each on a pty.

Written from the documents (Modbus over Serial Line V1.02; PowerFlex 400 22C-UM001J, App. E; docs/daq-stream.md), with
faults on demand. They share no code with the drivers.
"""

import json
import os
import select
import struct
import threading
import time
import tty
import zlib
from collections import deque
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

INFO = {
    "protocol": 1,
    "model": "board",
    "serial": "7",
    "sample_rate_hz": 10000.0,
    "channels": 5,
    "volts_per_count": [24 / 32768] * 5,
    "full_scale_counts": 32768,
}


# The framed DAQ


def frame(kind: int, payload: bytes, *, flags: int = 0) -> bytes:
    covered = struct.pack("<BBH", kind, flags, len(payload)) + payload
    return b"\xa5\x5a" + covered + struct.pack("<I", zlib.crc32(covered))


def info_frame(**changed: object) -> bytes:
    said = {key: value for key, value in (INFO | changed).items() if value is not None}
    return frame(0x01, json.dumps(said).encode())


def data_frame(counts: NDArray[np.int32], *, sequence: int, first_scan: int, overrun: bool = False) -> bytes:
    scans, channels = counts.shape
    body = b"".join(int(c).to_bytes(3, "little", signed=True) for c in counts.ravel())
    return frame(0x02, struct.pack("<IQHB", sequence, first_scan, scans, channels) + body, flags=int(overrun))


def stopped_frame(scans: int) -> bytes:
    return frame(0x03, struct.pack("<Q", scans))


def error_frame(text: str) -> bytes:
    return frame(0x7F, text.encode())


class Wire:
    """One end of a pty, served by a thread; `port` is the other end's path."""

    def __init__(self) -> None:
        self.master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._closing = False
        self._thread = threading.Thread(target=self._serve, daemon=True)

    def start(self) -> None:
        self._thread.start()

    def unplug(self) -> None:
        """Cut the wire; may be called twice, but a closed descriptor is closed once: its number may be another's."""
        if self._closing:
            return
        self._closing = True
        self._thread.join()
        os.close(self.master)
        os.close(self._slave)

    def received(self, data: bytes) -> None:
        raise NotImplementedError

    def idle(self) -> None:
        """Do something between requests."""

    def send(self, data: bytes) -> None:
        while data and not self._closing:
            if select.select([], [self.master], [], 0.05)[1]:
                data = data[os.write(self.master, data) :]

    def _serve(self) -> None:
        while not self._closing:
            if select.select([self.master], [], [], 0.002)[0]:
                self.received(os.read(self.master, 4096))
            self.idle()


class Board(Wire):
    """Streams `frames` once started, then nothing; answers as `info`, `deaf` and `stubborn` say."""

    def __init__(self) -> None:
        super().__init__()
        self.info = info_frame()
        self.frames: Iterator[bytes] = iter(())
        self.before_info = b""
        self.deaf = False  # answers nothing
        self.stubborn = False  # does not confirm STOP
        self.commands: list[str] = []
        self._line = b""
        self._streaming = False

    def received(self, data: bytes) -> None:
        *lines, self._line = (self._line + data).split(b"\n")
        for line in lines:
            self.commands.append(line.decode())
            if not self.deaf:
                self._obey(line)

    def idle(self) -> None:
        if self._streaming and (data := next(self.frames, None)):
            self.send(data)

    def _obey(self, line: bytes) -> None:
        match line:
            case b"ID?":
                self.send(self.before_info + self.info)
            case b"START":
                self._streaming = True
            case b"STOP" if not self.stubborn:
                self._streaming = False
                self.send(stopped_frame(0))
            case b"STOP":
                pass
            case _:
                self.send(error_frame(f"unknown command {line!r}"))


# Modbus RTU


def crc16(data: bytes) -> bytes:
    """CRC-16 of Modbus over Serial Line V1.02, section 6.2.2; low byte first on the wire."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ 0xA001 if crc & 1 else crc >> 1
    return crc.to_bytes(2, "little")


class Drive(Wire):
    """A drive at node 100 that starts, stops and trips at once; `writes` is what it was told, in order."""

    NODE = 100

    def __init__(self) -> None:
        super().__init__()
        self.registers = {8192: 0, 8193: 0, 8448: 0x000D, 8449: 0, 8450: 0, 8451: 0}
        self.registers |= {35: 7000, 37: 0, 39: 2000, 40: 2000, 105: 2, 106: 20}  # parameters
        self.writes: list[tuple[int, int]] = []
        self.requests: list[bytes] = []
        self.spoil: deque[str] = deque()  # for the next replies: "drop" or "corrupt"
        self.delays: deque[float] = deque()  # s, before the next replies
        self.exceptions: dict[int, int] = {}  # register -> exception code
        self.busy: deque[int] = deque()  # exception codes, instead of obeying the next requests
        self.obeys = True
        self._buffer = b""

    def received(self, data: bytes) -> None:
        self._buffer += data
        while len(self._buffer) >= 8:  # requests of functions 03 and 06 have 8 bytes
            request, self._buffer = self._buffer[:8], self._buffer[8:]
            self.requests.append(request)
            if request[0] == self.NODE and crc16(request[:6]) == request[6:]:
                self._answer(request)

    def _answer(self, request: bytes) -> None:
        function, register, word = struct.unpack(">xBHHxx", request)
        wanted = range(register, register + word) if function == 3 else [register]
        if self.busy:
            reply = bytes([self.NODE, function | 0x80, self.busy.popleft()])
        elif register in self.exceptions or any(r not in self.registers for r in wanted):
            reply = bytes([self.NODE, function | 0x80, self.exceptions.get(register, 2)])
        elif function == 3:
            reply = bytes([self.NODE, 3, 2 * word]) + b"".join(self.registers[r].to_bytes(2, "big") for r in wanted)
        else:
            self._write(register, word)
            reply = request[:6]
        reply += crc16(reply)
        time.sleep(self.delays.popleft() if self.delays else 0.0)
        spoil = self.spoil.popleft() if self.spoil else ""
        if spoil == "corrupt":
            reply = reply[:-1] + bytes([reply[-1] ^ 1])
        if spoil != "drop":
            self.send(reply)

    def _write(self, register: int, word: int) -> None:
        self.writes.append((register, word))
        self.registers[register] = word
        if register == 8193:
            self.registers[8450] = word
        if register != 8192 or not self.obeys:
            return
        if word & 0b0001:
            coast = self.registers[37] == 1 or not self.registers[8451]
            self.registers[8448] = 0x000D if coast else 0x002F  # down the ramp: active and decelerating
            self.registers[8451] = 0 if coast else self.registers[8451]
        elif word & 0b0010:
            self.registers[8448] = 0x010F  # ready, active, forward, at reference
            self.registers[8451] = self.registers[8193]
        elif word & 0b1000:
            self.registers[8448] &= ~0x0080
            self.registers[8449] = 0


def wait_for(condition: Callable[[], bool], seconds: float = 2.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "nothing happened"
        time.sleep(0.002)
