"""A motor controller by docs/motor-line.md."""

import binascii
import re
from collections.abc import Callable

from tests.peers.cables import Receive, Send
from tests.peers.inverter import Inverter

MAX_SPEED, MAX_RAMP = 360000, 120000  # hundredths of rpm, and per second
LONGEST = 96
_LINE = re.compile(rb">([0-9A-F]{2}) ([^*<>]*)\*([0-9A-F]{4})\r?$")
WATCHDOG_FAULT = 1
TRIP_FAULT = 2
_WORDS = {0: "-", TRIP_FAULT: "over-current of the bridge"}


def crc(data: bytes) -> int:
    """CRC-16/CCITT-FALSE.

    >>> hex(crc(b"123456789"))
    '0x29b1'
    """
    return binascii.crc_hqx(data, 0xFFFF)


class LineController:
    """The controller's side: sequence numbers, requests, watchdog."""

    def __init__(self, inverter: Inverter) -> None:
        """Power up."""
        self.inverter = inverter
        self._buffer = b""
        self._send: Send = lambda data: None
        self.power_up()

    def power_up(self) -> None:
        """Forget the host; the watchdog is at 2 s."""
        self._last: int | None = None
        self._reply = b""
        inverter = self.inverter
        inverter.watchdog, inverter.watchdog_stops_by, inverter.watchdog_fault = 2.0, "quick", WATCHDOG_FAULT
        inverter.quick = MAX_RAMP / 100

    def connect(self, send: Send) -> Receive:
        """Take a host."""
        self._send, self._buffer = send, b""
        return self.hear

    def hear(self, data: bytes) -> None:
        """Take bytes of the host."""
        *lines, self._buffer = (self._buffer + data).split(b"\n")
        self._buffer = self._buffer[-LONGEST:]
        for line in lines:
            start = line.rfind(b">")
            if start >= 0 and len(line) - start < LONGEST and (match := _LINE.match(line[start:])):
                body = line[start : line.rindex(b"*")]
                if crc(body) == int(match[3], 16):
                    self._take(int(match[1], 16), match[2].decode("ascii"))

    def _take(self, number: int, text: str) -> None:
        self.inverter.heard()
        verb, *words = text.split(" ")
        ahead = None if self._last is None else (number - self._last) % 256
        if verb == "ID" or (ahead is not None and 1 <= ahead <= 127):
            self._last = number
        elif ahead == 0 and verb != "STOP":
            self._send(self._reply)
            return
        elif verb != "STOP":
            return
        self._answer(number, self._do(verb, words), remember=self._last == number)

    def _answer(self, number: int, text: str, *, remember: bool) -> None:
        body = f"<{number:02X} {text}".encode("ascii")
        line = body + b"*%04X\n" % crc(body)
        if remember:
            self._reply = line
        self._send(line)

    def _do(self, verb: str, words: list[str]) -> str:
        verbs: dict[str, Callable[[list[str]], str]] = {
            "ID": self._identify,
            "STATE": self._state,
            "SPEED": self._speed,
            "STOP": self._stop,
            "CLEAR": self._clear,
            "WATCHDOG": self._watchdog,
        }
        if verb not in verbs:
            return f"ERR command {verb}"[:60]
        try:
            return verbs[verb](words)
        except ValueError:
            return f"ERR argument {' '.join(words)}"[:60]

    def _identify(self, words: list[str]) -> str:
        () = words
        if self.inverter.fault == WATCHDOG_FAULT:
            self.inverter.clear()
        return f"OK 1 {MAX_SPEED} {MAX_RAMP} output peer controller"

    def _state(self, words: list[str]) -> str:
        () = words
        said = self.inverter.report()
        phase = "off" if not said.on else "stopping" if said.stopping else "at-speed" if said.at_target else "ramping"
        setpoint = round(said.target * 100) if said.on and not said.stopping else 0
        fault = f"no request for {self.inverter.watchdog * 1000:.0f} ms" if said.fault == WATCHDOG_FAULT else None
        return f"OK {max(0, round(said.output * 100))} {setpoint} {phase} {fault or _WORDS.get(said.fault, 'fault')}"

    def _speed(self, words: list[str]) -> str:
        speed, ramp = map(_number, words)
        if speed > MAX_SPEED:
            return f"ERR limit speed {speed}, at most {MAX_SPEED}"
        if not 0 < ramp <= MAX_RAMP:
            return f"ERR limit ramp {ramp}, at most {MAX_RAMP}"
        if self.inverter.fault:
            return "ERR fault there is one"
        self.inverter.up = self.inverter.down = ramp / 100
        self.inverter.run(speed / 100)
        return "OK"

    def _stop(self, words: list[str]) -> str:
        (kind,) = words
        kinds = {"RAMP": "ramp", "COAST": "coast", "EMERGENCY": "quick"}
        if kind not in kinds:
            raise ValueError(kind)
        self.inverter.stop(kinds[kind])
        return "OK"

    def _clear(self, words: list[str]) -> str:
        () = words
        self.inverter.clear()
        return "OK"

    def _watchdog(self, words: list[str]) -> str:
        (milliseconds,) = map(_number, words)
        self.inverter.watchdog = milliseconds / 1000
        return f"OK {milliseconds}"


def _number(word: str) -> int:
    if not word.isdecimal() or int(word) > 4294967295:
        raise ValueError(word)
    return int(word)
