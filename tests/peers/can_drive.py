"""A CiA 402 drive in velocity mode (IEC 61800-7-201): a `canopen` LocalNode behind an slcan adapter."""

import time
from collections.abc import Callable
from typing import Any

import can
import canopen
from canopen.objectdictionary import (
    INTEGER8,
    INTEGER16,
    UNSIGNED8,
    UNSIGNED16,
    UNSIGNED32,
    VISIBLE_STRING,
    ObjectDictionary,
    ODArray,
    ODVariable,
)
from canopen.sdo.exceptions import SdoAbortedError

from tests.peers.cables import Receive, Send
from tests.peers.inverter import Inverter
from tests.peers.journal import Journal

NODE = 1
TIMED_OUT = 0x05040000  # SDO abort: protocol timed out, which is transient
HEARTBEAT_LOST = 0x8130  # emergency error code of CiA 301
TRIPPED = 0x2310  # continuous over-current

#: index -> (name, type, initial value, access); those with subindices as lists
OBJECTS: dict[int, Any] = {
    0x1000: ("device type", UNSIGNED32, 0x00010192, "ro"),
    0x1001: ("error register", UNSIGNED8, 0, "ro"),
    0x1008: ("device name", VISIBLE_STRING, "peer drive", "ro"),
    0x1016: ("consumer heartbeat time", [("1", UNSIGNED32, 0, "rw")]),
    0x1017: ("producer heartbeat time", UNSIGNED16, 0, "rw"),
    0x1018: ("identity", [("vendor", UNSIGNED32, 0x1234, "ro"), ("product", UNSIGNED32, 1, "ro")]),
    0x6007: ("abort connection option code", INTEGER16, 0, "rw"),
    0x603F: ("error code", UNSIGNED16, 0, "ro"),
    0x6040: ("controlword", UNSIGNED16, 0, "rw"),
    0x6041: ("statusword", UNSIGNED16, 0, "ro"),
    0x6042: ("vl target velocity", INTEGER16, 0, "rw"),
    0x6043: ("vl velocity demand", INTEGER16, 0, "ro"),
    0x6044: ("vl velocity actual value", INTEGER16, 0, "ro"),
    0x6046: ("vl velocity min max amount", [("min", UNSIGNED32, 0, "rw"), ("max", UNSIGNED32, 3600, "rw")]),
    0x6048: ("vl velocity acceleration", [("speed", UNSIGNED32, 300, "rw"), ("time", UNSIGNED16, 1, "rw")]),
    0x6049: ("vl velocity deceleration", [("speed", UNSIGNED32, 300, "rw"), ("time", UNSIGNED16, 1, "rw")]),
    0x604A: ("vl velocity quick stop", [("speed", UNSIGNED32, 1200, "rw"), ("time", UNSIGNED16, 1, "rw")]),
    0x605A: ("quick stop option code", INTEGER16, 2, "rw"),
    0x605B: ("shutdown option code", INTEGER16, 0, "rw"),
    0x605E: ("fault reaction option code", INTEGER16, 0, "rw"),
    0x6060: ("modes of operation", INTEGER8, 0, "rw"),
    0x6061: ("modes of operation display", INTEGER8, 0, "ro"),
    0x6502: ("supported drive modes", UNSIGNED32, 0b10, "ro"),
}


def dictionary() -> ObjectDictionary:
    """The drive's object dictionary."""
    od = ObjectDictionary()
    od.node_id = NODE
    for index, (name, *rest) in OBJECTS.items():
        if len(rest) == 3:
            od.add_object(_variable(name, index, 0, *rest))
            continue
        array = ODArray(name, index)
        array.add_member(_variable("number", index, 0, UNSIGNED8, len(rest[0]), "ro"))
        for sub, (member, *facts) in enumerate(rest[0], start=1):
            array.add_member(_variable(member, index, sub, *facts))
        od.add_object(array)
    return od


def _variable(name: str, index: int, sub: int, kind: int, value: Any, access: str) -> ODVariable:
    variable = ODVariable(name, index, sub)
    variable.data_type, variable.default, variable.access_type = kind, value, access
    return variable


class SlcanBus(can.BusABC):
    """A bus behind a LAWICEL adapter on a serial port; frames of the client are handed to `heard`."""

    def __init__(self, heard: Callable[[int, bytes], None]) -> None:
        """Wait for a client."""
        super().__init__(channel="slcan")
        self._heard = heard
        self._buffer = b""
        self._send: Send = lambda data: None

    def connect(self, send: Send) -> Receive:
        """Take a client."""
        self._send, self._buffer = send, b""
        return self._take

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send a frame to the client."""
        self._send(b"t%03X%d%s\r" % (msg.arbitration_id, msg.dlc, bytes(msg.data).hex().upper().encode()))

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        return None, False  # nobody reads: frames come by `heard`

    def _take(self, data: bytes) -> None:
        *lines, self._buffer = (self._buffer + data).split(b"\r")
        for line in lines:
            if not line.startswith(b"t"):
                self._send(b"\r")
                continue
            try:
                identifier, length = int(line[1:4], 16), int(line[4:5])
                payload = bytes.fromhex(line[5 : 5 + 2 * length].decode("ascii"))
            except ValueError:
                self._send(b"\a")
                continue
            if len(payload) == length:
                self._heard(identifier, payload)


class CanDrive:
    """The drive: state machine of CiA 402, velocity mode, heartbeat consumer."""

    def __init__(self, inverter: Inverter, journal: Journal) -> None:
        """Boot."""
        self.inverter, self._journal = inverter, journal
        self.busy_every, self.busy_times = 0.0, 2
        self._busy_left, self._busy_next = 0, 0.0
        self.bus = SlcanBus(self._heard)
        self.network = canopen.Network(self.bus)
        self.node = canopen.LocalNode(NODE, dictionary())
        self.node.associate_network(self.network)
        self.node.add_read_callback(self._read)
        self.node.add_write_callback(self._write)
        self._state = "switch on disabled"
        self._heartbeat_seen = False

    @property
    def connect(self) -> Callable[[Send], Receive]:
        """Takes a client of the adapter."""
        return self.bus.connect

    def busy(self, *, every: float, times: int) -> None:
        """Abort bursts of transfers with a transient code."""
        self.busy_every, self.busy_times, self._busy_next = every, times, time.monotonic()

    def power_up(self) -> None:
        """Forget everything that was set, and say that it booted."""
        self.node.data_store.clear()
        self._state, self._heartbeat_seen = "switch on disabled", False
        self.network.send_message(0x700 + NODE, b"\x00")

    def emergency(self) -> None:
        """Tell of a fault that has just come."""
        self.node.emcy.send(self.inverter.fault, 1)

    def _heard(self, identifier: int, data: bytes) -> None:
        consumer = self._get(0x1016, 1)
        if identifier == 0x700 + (consumer >> 16 & 0x7F) and consumer & 0xFFFF:
            self._heartbeat_seen = True
            self.inverter.heard()
            self._set_watchdog()
        self.network.notify(identifier, bytearray(data), time.time())

    def _get(self, index: int, sub: int = 0) -> int:
        stored = self.node.data_store.get(index, {}).get(sub)
        variable = self.node.object_dictionary[index]
        if isinstance(variable, ODArray):
            variable = variable[sub]
        return int(variable.default if stored is None else variable.decode_raw(stored))

    def _set_watchdog(self) -> None:
        reaction = {1: "trip", 2: "coast", 3: "quick"}.get(self._get(0x6007), "")
        armed = reaction and self._heartbeat_seen
        self.inverter.watchdog = (self._get(0x1016, 1) & 0xFFFF) / 1000 if armed else 0.0
        self.inverter.watchdog_stops_by = reaction
        self.inverter.watchdog_fault = HEARTBEAT_LOST if reaction == "trip" else 0

    def _settle(self) -> None:
        """Follow the inverter: a fault, a stop that has ended."""
        if self.inverter.fault:
            self._state = "fault"
        elif not self.inverter.on:
            if self._state in ("quick stop active", "shutting down"):
                self._state = "switch on disabled" if self._state == "quick stop active" else "ready to switch on"
            elif self._state == "operation enabled" and self.inverter.target:
                self._state = "switch on disabled"

    def _read(self, *, index: int, subindex: int, od: Any) -> int | None:
        if index != 0x6041 and self._is_busy():
            self._journal.event("busy", address=index)
            raise SdoAbortedError(TIMED_OUT)
        self._settle()
        said = self.inverter.report()
        if index == 0x6041:
            word = {
                "switch on disabled": 0x40,
                "ready to switch on": 0x31,
                "switched on": 0x33,
                "operation enabled": 0x37,
                "shutting down": 0x37,
                "quick stop active": 0x17,
                "fault": 0x08,
            }[self._state]
            return word | 0x200 | (0x400 if said.at_target else 0)
        if index in (0x6043, 0x6044):
            return round(-said.output if said.backward else said.output)
        return {0x603F: said.fault, 0x6061: self._get(0x6060), 0x1001: int(bool(said.fault))}.get(index)

    def _write(self, *, index: int, subindex: int, od: Any, data: bytes) -> None:
        if self._is_busy():
            self._journal.event("busy", address=index)
            raise SdoAbortedError(TIMED_OUT)
        self._settle()
        self.node.data_store.setdefault(index, {})[subindex] = bytes(data)
        if index in (0x1016, 0x6007):
            self._set_watchdog()
        elif index == 0x6040:
            self._control(int.from_bytes(data, "little"))
        elif index == 0x6042 and self._state == "operation enabled":
            self._go()

    def _control(self, word: int) -> None:
        inverter = self.inverter
        if word & 0x80 and self._state == "fault":
            inverter.clear()
            self._state = "switch on disabled"
        elif self._state == "fault":
            return
        elif not word & 2:
            inverter.stop("coast")
            self._state = "switch on disabled"
        elif not word & 4:
            self._quick_stop()
        elif word & 0xF == 0xF and self._state in ("switched on", "operation enabled", "ready to switch on"):
            self._state = "operation enabled"
            self._go()
        elif word & 7 == 7 and self._state == "ready to switch on":
            self._state = "switched on"
        elif word & 7 == 6:
            self._shut_down()

    def _quick_stop(self) -> None:
        if self._state not in ("operation enabled", "shutting down"):
            if self._state != "quick stop active":
                self._state = "switch on disabled"
            return
        kind = {0: "coast", 1: "ramp"}.get(self._get(0x605A), "quick")
        self._take_ramps()
        self.inverter.stop(kind)
        self._state = "quick stop active" if self.inverter.on else "switch on disabled"

    def _shut_down(self) -> None:
        if self._state == "operation enabled":
            self.inverter.stop("ramp" if self._get(0x605B) == 1 else "coast")
            self._state = "shutting down" if self.inverter.on else "ready to switch on"
        elif self._state in ("switch on disabled", "switched on"):
            self._state = "ready to switch on"

    def _go(self) -> None:
        self._take_ramps()
        if self._get(0x6040) & 0x70 == 0x70:
            limit = self._get(0x6046, 2)
            self.inverter.run(float(max(-limit, min(limit, self._get(0x6042)))))

    def _take_ramps(self) -> None:
        ramps = (self._get(index, 1) / max(1, self._get(index, 2)) for index in (0x6048, 0x6049, 0x604A))
        self.inverter.up, self.inverter.down, self.inverter.quick = ramps

    def _is_busy(self) -> bool:
        now = time.monotonic()
        if self.busy_every and not self._busy_left and now >= self._busy_next:
            self._busy_left, self._busy_next = self.busy_times, now + self.busy_every
        if self._busy_left:
            self._busy_left -= 1
            return True
        return False
