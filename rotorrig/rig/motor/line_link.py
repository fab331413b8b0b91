"""Serial link to a controller on the line protocol: one request, one reply, matched by their number.

Safe for several threads. A request whose reply does not come is repeated under its number, which the controller answers
again without doing it again; if another request has gone out meanwhile it takes a new number, the old one being late. A
stop goes out before requests that wait or are about to be repeated, and the commands among those are given up.
"""

import time

import serial

from rotorrig.rig.errors import BadFrame, LinkLost, RigError
from rotorrig.rig.motor.line_frames import LONGEST_LINE, Reply, decode_reply, encode_request
from rotorrig.rig.motor.turns import Turns
from rotorrig.rig.serial_port import open_serial

ANSWER_SECONDS = 0.2  # for one reply, beside the time of both lines on the wire
RETRIES = 3  # all tries take 0.9 s at 115200 baud of the 2 s for which the interlock does without a pulse or a reading
POLL_SECONDS = 0.02  # of one read of the port
WRITE_SECONDS = 0.2
BITS_PER_BYTE = 10  # 8N1

_COMMANDS = ("SPEED", "CLEAR", "WATCHDOG")  # what does not follow a stop it was asked for before


class Refused(RigError):
    """The controller answered ERR; `code` is its code."""

    def __init__(self, message: str, *, code: str, reason: str) -> None:
        super().__init__(message)
        self.code, self.reason = code, reason


class LineLink:
    """The port and the sequence number; `name` is for messages."""

    def __init__(self, port: str, *, baudrate: int, name: str) -> None:
        """Open `port`. Raises LinkLost."""
        self._port, self._name = port, name
        self._turns = Turns()
        self._number = -1
        self._stops = 0  # how many have gone out
        self._buffer = b""
        self._stray = 0  # bytes since the last reply that are none
        self._patience = ANSWER_SECONDS + 2 * LONGEST_LINE * BITS_PER_BYTE / baudrate
        self._serial = open_serial(port, baudrate, of="controller", timeout=POLL_SECONDS, write_timeout=WRITE_SECONDS)

    def ask(self, text: str, *, first: bool = False, seconds: float = 0.0) -> str:
        """Return what the controller says to request `text` after OK.

        Tries 1 + RETRIES times and at least for `seconds`; with `first` it goes before whoever else waits.
        Raises Refused if it answers ERR, LinkLost if it does not answer, if the port is gone, or if a stop comes before
        a command that was asked for earlier.
        """
        number, tries, until = None, 0, time.monotonic() + seconds
        stops_before = self._stops
        while tries <= RETRIES or time.monotonic() < until:
            with self._turns.take(first=first):
                self._stops += first
                if stops_before != self._stops and text.startswith(_COMMANDS):
                    raise LinkLost(
                        f"{self._name}: '{text}' was about to be sent, but a stop came before; it is given up"
                    )
                if number != self._number:  # the first try, or another request came between
                    number = self._number = (self._number + 1) % 256
                reply = self._try(number, text)
            if reply:
                return self._check_reply(reply, text)
            tries += 1
        raise LinkLost(
            f"{self._name}: asked '{text}', no valid answer in {tries} tries of {self._patience:.2g} s{self._noise()}"
        )

    def close(self) -> None:
        """Give the port back, after the request under way."""
        with self._turns.take(first=True):
            self._serial.close()

    def _try(self, number: int, text: str) -> Reply | None:
        """Send a request once; return its reply, None if none comes in time."""
        try:
            self._serial.write(encode_request(number, text))
            until = time.monotonic() + self._patience
            while time.monotonic() < until:
                for reply in self._read_replies():
                    if reply.number == number:  # another is the late answer to a request before
                        return reply
        except serial.SerialTimeoutException:
            return None
        except OSError as error:  # pyserial's own are OSErrors too
            raise LinkLost(f"{self._name}: asked '{text}', but the port is gone; was it unplugged?") from error
        return None

    def _read_replies(self) -> list[Reply]:
        """Read the port; return the whole replies, dropping damaged ones."""
        self._buffer += self._serial.read(self._serial.in_waiting or 1)
        *lines, rest = self._buffer.split(b"\n")
        self._buffer = rest[-2 * LONGEST_LINE :]
        replies = []
        for line in lines:
            try:
                replies.append(decode_reply(line[max(line.rfind(b"<"), 0) :] + b"\n"))
            except BadFrame:
                self._stray += len(line)
            else:
                self._stray = 0
        return replies

    def _check_reply(self, reply: Reply, text: str) -> str:
        if reply.refusal:
            raise Refused(
                f"{self._name}: refuses '{text}' with '{reply.refusal}': {reply.reason or 'no reason given'}",
                code=reply.refusal,
                reason=reply.reason,
            )
        return reply.text

    def _noise(self) -> str:
        stray = self._stray + len(self._buffer)
        return f" ({stray} bytes came that are no reply; is it another device or baud rate?)" if stray else ""
