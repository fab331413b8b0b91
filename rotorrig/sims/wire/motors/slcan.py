"""A CAN adapter on a serial port that speaks slcan, with the bus behind it: Lawicel CAN232 manual, version 3.

Commands end in a carriage return; done is answered by one, an error by a bell. Emulated: bit rates S0 to S8, open,
close, standard data and remote frames, version, serial number and status flags. An adapter set to another bit rate than
the bus carries nothing, as a real one that only sees errors.
"""

import re
from collections.abc import Callable

BITRATES = (10_000, 20_000, 50_000, 100_000, 125_000, 250_000, 500_000, 800_000, 1_000_000)  # S0 to S8
_OK, _BELL = b"\r", b"\a"
_FRAME = re.compile(rb"t([0-7][0-9A-Fa-f]{2})([0-8])((?:[0-9A-Fa-f]{2})*)")
_REMOTE = re.compile(rb"r[0-7][0-9A-Fa-f]{2}[0-8]")
_LONGEST = 64  # bytes of a command


class Adapter:
    """Bytes of the serial line on one side, frames of the bus on the other."""

    def __init__(self, *, bitrate: int, on_frame: Callable[[int, bytes], None]) -> None:
        self.send: Callable[[bytes], None] = lambda data: None  # to the serial line
        self._bus_bitrate, self._on_frame = bitrate, on_frame
        self._bitrate: int | None = None
        self._open = False
        self._pending = b""

    def take(self, data: bytes) -> None:
        """Take bytes from the serial line."""
        *commands, self._pending = (self._pending + data).split(b"\r")
        self._pending = self._pending[-_LONGEST:]
        for command in commands:
            if command:
                self._obey(command)
            else:
                self.send(_OK)

    def deliver(self, can_id: int, data: bytes) -> None:
        """Take a frame from the bus."""
        if self._on_bus:
            self.send(b"t%03X%d%s\r" % (can_id, len(data), data.hex().upper().encode()))

    @property
    def _on_bus(self) -> bool:
        return self._open and self._bitrate == self._bus_bitrate

    def _obey(self, command: bytes) -> None:
        frame = _FRAME.fullmatch(command)
        if frame or _REMOTE.fullmatch(command):
            self._transmit(frame)
            return
        answer = _OK
        match command[:1], command[1:]:
            case b"S", rate if rate in b"012345678" and len(rate) == 1 and not self._open:
                self._bitrate = BITRATES[int(rate)]
            case b"O", b"" if self._bitrate and not self._open:
                self._open = True
            case b"C", b"" if self._open:
                self._open = False
            case b"V", b"":
                answer = b"V1013\r"
            case b"N", b"":
                answer = b"NA001\r"
            case b"F", b"" if self._open:
                answer = b"F00\r"
            case _:
                answer = _BELL
        self.send(answer)

    def _transmit(self, frame: re.Match[bytes] | None) -> None:
        """Put a frame on the bus; None stands for a remote frame, which nobody here answers."""
        if not self._open or (frame and len(frame[3]) != 2 * int(frame[2])):
            self.send(_BELL)
            return
        self.send(_OK)
        if frame and self._on_bus:
            self._on_frame(int(frame[1], 16), bytes.fromhex(frame[3].decode()))
