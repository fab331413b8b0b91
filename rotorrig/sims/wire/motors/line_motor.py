"""A home-built motor controller on a tty: the line protocol of docs/motor-line.md in front of the emulated drive."""

import asyncio
import contextlib
import math
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from rotorrig.rig import Clock
from rotorrig.sims.wire.cables import Send, open_serial_end
from rotorrig.sims.wire.drive import Drive
from rotorrig.sims.wire.plant_port import Plant

MODEL = "RK4 bench controller, rev B"
NO_REQUEST = 1  # the fault number of the watchdog; those of a script mean what `FAULTS` says
FAULTS = {2: "over-current of the bridge", 3: "over-temperature of the bridge", 4: "supply too low"}
LONGEST_LINE = 96  # bytes, `>` and newline included

_RPM_100 = math.pi / 3000.0  # rad/s per hundredth of rpm
_TICK = 0.01  # s between looks at ramp and watchdog
_REQUEST = re.compile(rb">([0-9A-F]{2}) ([ -)+-;=?-~]*)\*([0-9A-F]{4})\r?")  # printable but for * < >
_LARGEST = (1 << 32) - 1


@asynccontextmanager
async def serve(device: "LineDevice", *, port: str) -> AsyncIterator[None]:
    """Answer for `device` on the tty `port` for the length of the block."""
    lines = _Lines(device)
    async with open_serial_end(port, received=lines.take) as send:
        lines.send = send
        ticking = asyncio.create_task(_tick(device))
        try:
            yield
        finally:
            ticking.cancel()


class LineDevice:
    """The controller: one line in, at most one line out; `drive` is what stands behind it.

    `max_speed` [rad/s] is also the speed it can lose or gain in a second: its max ramp, and that of an emergency stop.
    """

    def __init__(self, plant: Plant, *, max_speed: float, clock: Clock) -> None:
        self.drive = Drive(plant, clock=clock, silence_fault=NO_REQUEST)
        self.drive.patience = math.inf  # the watchdog is the controller's own: it brakes, which a trip does not
        self.watchdog_ms = 2000
        self._clock = clock
        self._heard = clock.now()
        self._max_speed = self._max_ramp = _hundredths(max_speed)
        self._ramp = self._max_ramp  # of the last SPEED
        self._emergency = False
        self._silent_ms = 0  # the watchdog's time when it acted
        self._last: int | None = None  # number of the last request taken; None: nobody has said ID yet
        self._last_reply = b""

    def answer(self, line: bytes) -> bytes:
        """Return the reply to a line (without its newline), empty if it gets none."""
        request = _REQUEST.fullmatch(line)
        if len(line) >= LONGEST_LINE or not request or _crc(line[: request.start(3) - 1]) != int(request[3], 16):
            return b""
        self.tick()  # a silence that this request ends has been one
        self._heard = self._clock.now()
        number, words = int(request[1], 16), request[2].decode().split(" ")
        late = self._last is None or (number - self._last) % 256 > 127
        if words[0] not in ("ID", "STOP"):
            if late:
                return b""
            if number == self._last:
                return self._last_reply
        reply = _frame(b"<%02X %s" % (number, self._obey(words).encode()))
        if not late or words[0] == "ID":
            self._last, self._last_reply = number, reply
        return reply

    def tick(self) -> None:
        """End a finished ramp-down; act on a host that has been silent for too long."""
        self.drive.tick()
        silent = self._clock.now() - self._heard
        if self.drive.running and self.watchdog_ms and silent > self.watchdog_ms / 1000:
            self._silent_ms = self.watchdog_ms
            self._stop("EMERGENCY")
            self.drive.fault = NO_REQUEST

    def _obey(self, words: list[str]) -> str:
        match words:
            case ["ID"]:
                if self.drive.fault == NO_REQUEST:
                    self.drive.fault = 0
                return f"OK 1 {self._max_speed} {self._max_ramp} output {MODEL}"
            case ["STATE"]:
                return self._state()
            case ["SPEED", speed, ramp] if _is_number(speed) and _is_number(ramp):
                return self._go(int(speed), int(ramp))
            case ["STOP", "RAMP" | "COAST" | "EMERGENCY" as kind]:
                self._stop(kind)
                return "OK"
            case ["CLEAR"]:
                self.drive.fault = 0  # a script's faults have no cause that stays
                return "OK"
            case ["WATCHDOG", time] if _is_number(time):
                self.watchdog_ms = int(time)
                return f"OK {self.watchdog_ms}"
            case ["ID" | "STATE" | "SPEED" | "STOP" | "CLEAR" | "WATCHDOG" as command, *_]:
                return f"ERR argument {command} is not used so"
            case _:
                return "ERR command no such request"

    def _state(self) -> str:
        drive = self.drive
        if not drive.active:
            phase = "off"
        elif not drive.running:
            phase = "stopping"
        else:
            phase = "ramping" if drive.remaining else "at-speed"
        setpoint = _hundredths(drive.reference) if drive.running else 0
        return f"OK {_hundredths(drive.speed)} {setpoint} {phase} {self._fault()}"

    def _fault(self) -> str:
        number = self.drive.fault
        if number == NO_REQUEST:
            return f"no request for {self._silent_ms} ms"
        return FAULTS.get(number, f"fault {number}") if number else "-"

    def _go(self, speed: int, ramp: int) -> str:
        if speed > self._max_speed:
            return f"ERR limit speed {speed}, at most {self._max_speed}"
        if not 0 < ramp <= self._max_ramp:
            return f"ERR limit ramp {ramp}, want 1 to {self._max_ramp}"
        if self.drive.fault:
            return f"ERR fault {self._fault()}"
        self._ramp, self._emergency = ramp, False
        self._set_reference(speed, ramp)
        self.drive.start()
        return "OK"

    def _stop(self, kind: str) -> None:
        if kind == "EMERGENCY":
            self._emergency = True
        elif self._emergency and kind == "RAMP":
            return  # a stop only ever gets harder
        self._set_reference(_hundredths(self.drive.reference), self._max_ramp if self._emergency else self._ramp)
        self.drive.stop(coast=kind == "COAST")

    def _set_reference(self, speed: int, ramp: int) -> None:
        slope = ramp * _RPM_100
        self.drive.set_reference(speed * _RPM_100, rising=slope, falling=slope)


class _Lines:
    """Finds lines in the bytes of the wire; one that grows too long is dropped."""

    def __init__(self, device: LineDevice) -> None:
        self.send: Send = lambda data: None
        self._device = device
        self._pending = b""

    def take(self, data: bytes) -> None:
        *lines, self._pending = (self._pending + data).split(b"\n")
        for line in lines:
            if reply := self._device.answer(line[max(line.rfind(b">"), 0) :]):
                self.send(reply)
        self._pending = self._pending[-2 * LONGEST_LINE :]


async def _tick(device: LineDevice) -> None:
    with contextlib.suppress(asyncio.CancelledError):
        while True:
            device.tick()
            await asyncio.sleep(_TICK)


def _frame(text: bytes) -> bytes:
    return b"%s*%04X\n" % (text, _crc(text))


def _crc(data: bytes) -> int:
    """CRC-16/CCITT-FALSE, bit by bit."""
    register = 0xFFFF
    for byte in data:
        register ^= byte << 8
        for _ in range(8):
            register = (register << 1 ^ 0x1021) & 0xFFFF if register & 0x8000 else register << 1
    return register


def _is_number(word: str) -> bool:
    return word.isdecimal() and word.isascii() and int(word) <= _LARGEST


def _hundredths(speed: float) -> int:
    return round(speed / _RPM_100)
