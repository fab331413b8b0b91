"""CAN link to one CANopen node: SDO reads and writes, the master's heartbeat, emergencies; any adapter of python-can.

Safe for several threads; there is none of its own. The heartbeat goes out with the requests: a program that hangs falls
silent, and the node, told to listen, stops the rotor. A stop goes out before requests that wait or are to be repeated.
"""

import math
import os
import time
from collections.abc import Callable
from typing import Any

import can
import serial
from can.interfaces.slcan import slcanBus

from rotorrig.rig.config import CanOpen
from rotorrig.rig.errors import BadFrame, LinkLost, RigError
from rotorrig.rig.motor import sdo_frames
from rotorrig.rig.motor.sdo_frames import Aborted, Answer, Item, Segment, Value, Written
from rotorrig.rig.motor.turns import Turns
from rotorrig.rig.serial_port import diagnose_port

ANSWER_SECONDS = 0.2  # for one answer, beside the time of both frames on the bus
RETRIES = 3
WRITE_SECONDS = 0.2
FRAME_BITS = 135  # 8 bytes of data with the most stuffing
SETTLE_SECONDS = 0.0005  # without a frame, after which none is left from before; adapters deliver in bursts
SLCAN_START_SECONDS = 0.05  # python-can's 2 s are for adapters that start anew whenever their port is opened
STALE_FRAMES = 1000  # at most so many are passed over before a request; a bus busier than that never settles
MASTER, SPARE_MASTER = 127, 126  # our node number, for the heartbeat

_NMT, _EMERGENCY, _ANSWER, _REQUEST, _HEARTBEAT = 0x000, 0x080, 0x580, 0x600, 0x700  # function codes, plus the node
_NMT_START, _OPERATIONAL, _BOOT_UP = 1, 5, 0
_BUS_OFF = 0x40  # bit of an error frame's identifier, as Linux has it (linux/can/error.h)
_LONGEST_NAME = 256  # bytes


class Refused(RigError):
    """The node aborted a read or write; the message says why."""


class Overtaken(LinkLost):
    """A command that was not sent because a stop came before it."""


class CanLink:
    """The bus, and the node of `table` on it; `name` is for messages."""

    def __init__(self, table: CanOpen, *, name: str) -> None:
        """Open the bus. Raises LinkLost."""
        self.master = MASTER if table.node != MASTER else SPARE_MASTER
        self.stops = 0  # how many have gone out; a `write` may be given the number its caller has seen
        self.emergency = 0  # error code of the last emergency, 0 when the node has said that all is well
        self.restarted = False  # the node has booted since we are here: its configuration is gone
        self._node, self._name, self._place = table.node, name, f"{table.interface} {table.channel}"
        self._turns = Turns()
        self._heartbeat_period: float | None = None  # s
        self._beat_at = -math.inf
        self._patience = ANSWER_SECONDS + 2 * FRAME_BITS / table.bitrate
        self._claim = _claim(table)
        try:
            self._bus = _open_bus(table)
        except BaseException:
            self._release()
            raise

    def read(self, item: Item) -> int:
        """Return an object's value. Raises Refused, LinkLost."""
        data = self._read(item)
        try:
            return sdo_frames.integer(item, data or b"")
        except BadFrame as error:
            raise LinkLost(f"{self._name}: {error}") from error

    def read_text(self, item: Item) -> str:
        """Return an object that is a text, of any length. Raises Refused, LinkLost."""
        data = self._read(item)
        if data is None:
            data = self._read_segments(item)
        return data.decode("ascii", errors="replace").rstrip("\0 ")

    def write(self, item: Item, value: int, *, stops_before: int | None = None) -> None:
        """Set an object. Raises Refused, LinkLost; Overtaken if there have been more `stops` than `stops_before`."""
        request = sdo_frames.encode_write(item, value)
        self._exchange(request, item, lambda answer: isinstance(answer, Written), stops_before=stops_before)

    def stop(self, item: Item, value: int) -> None:
        """Set an object before whoever else waits. Raises Refused, LinkLost."""
        request = sdo_frames.encode_write(item, value)
        self._exchange(request, item, lambda answer: isinstance(answer, Written), first=True)

    def start_node(self) -> None:
        """Make the node operational (NMT). Raises LinkLost."""
        with self._turns.take():
            self._send(_NMT, bytes([_NMT_START, self._node]))

    def beat_every(self, period: float) -> None:
        """Send our heartbeat now and, with what is asked from now on, when the last is `period` [s] old."""
        with self._turns.take():
            self._heartbeat_period, self._beat_at = period, -math.inf
            self._beat()

    def close(self) -> None:
        """Leave the bus, after the exchange under way."""
        with self._turns.take(first=True):
            try:
                self._bus.shutdown()
            except (can.CanError, OSError):
                pass  # the adapter is gone, and with it what was to be closed
            finally:
                self._release()

    def _read(self, item: Item) -> bytes | None:
        """Return an object's bytes, None if they come in segments."""
        answer = self._exchange(sdo_frames.encode_read(item), item, lambda answer: isinstance(answer, Value))
        assert isinstance(answer, Value)
        return answer.data

    def _read_segments(self, item: Item) -> bytes:
        data, toggle, last = b"", False, False
        while not last and len(data) < _LONGEST_NAME:
            request = sdo_frames.encode_next_segment(toggle=toggle)
            segment = self._exchange(request, item, _is_segment(toggle))
            assert isinstance(segment, Segment)
            data, last, toggle = data + segment.data, segment.last, not toggle
        return data

    def _exchange(
        self,
        request: bytes,
        item: Item,
        fits: Callable[[Answer], bool],
        *,
        first: bool = False,
        stops_before: int | None = None,
    ) -> Answer:
        """Send a request until an answer comes that is about `item` and `fits`. Raises Refused, LinkLost, Overtaken."""
        for _ in range(1 + RETRIES):
            with self._turns.take(first=first):
                self.stops += first
                if stops_before is not None and stops_before != self.stops:
                    raise Overtaken(f"{self._name}: {item} was about to be written, but a stop came before")
                answer = self._try(request, item, fits)
            if isinstance(answer, Aborted):
                raise Refused(f"{self._name}: the node refuses access to {item}: {answer}")
            if answer:
                return answer
        raise LinkLost(f"{self._name}: asked for {item}, no answer in {1 + RETRIES} tries of {self._patience:.2g} s")

    def _try(self, request: bytes, item: Item, fits: Callable[[Answer], bool]) -> Answer | None:
        """Send a request once; return its answer, None if none comes in time."""
        self._beat()
        for _ in range(STALE_FRAMES):  # the late answer to a request before would pass for this one's
            if not self._receive(SETTLE_SECONDS):
                break
        self._send(_REQUEST + self._node, request)
        until = time.monotonic() + self._patience
        while (left := until - time.monotonic()) > 0:
            answer = self._answer(self._receive(left))
            if answer and sdo_frames.concerns(answer, item) and (isinstance(answer, Aborted) or fits(answer)):
                return answer
        return None

    def _beat(self) -> None:
        """Send the master's heartbeat when it is due."""
        now = time.monotonic()
        if self._heartbeat_period is not None and now - self._beat_at >= self._heartbeat_period:
            self._send(_HEARTBEAT + self.master, bytes([_OPERATIONAL]))
            self._beat_at = now

    def _answer(self, message: can.Message | None) -> Answer | None:
        if message is None or message.arbitration_id != _ANSWER + self._node:
            return None
        try:
            return sdo_frames.decode_answer(bytes(message.data))
        except BadFrame:
            return None

    def _send(self, can_id: int, data: bytes) -> None:
        try:
            self._bus.send(can.Message(arbitration_id=can_id, data=data, is_extended_id=False), timeout=WRITE_SECONDS)
        except (can.CanError, OSError) as error:
            raise LinkLost(
                f"{self._name}: cannot send on {self._place} ({error}); was the adapter unplugged?"
            ) from error

    def _receive(self, seconds: float) -> can.Message | None:
        """Return the next frame, None after `seconds` or if it is damaged; take note of what it says of the node."""
        try:
            message = self._bus.recv(seconds)
        except (can.CanError, OSError, ValueError, IndexError) as error:
            if isinstance(error.__cause__ or error, (ValueError, IndexError)):  # python-can, on a damaged slcan line
                if isinstance(self._bus, slcanBus):
                    self._bus.flush()  # it keeps some, and would stumble over them for ever
                return None
            raise LinkLost(
                f"{self._name}: the adapter at {self._place} is gone, was it unplugged? ({error})"
            ) from error
        if message is None:
            return None
        if message.is_error_frame:
            if message.arbitration_id & _BUS_OFF:
                raise LinkLost(f"{self._name}: the adapter at {self._place} is bus off; check bit rate and termination")
        elif message.arbitration_id == _EMERGENCY + self._node and len(message.data) >= 2:
            code = int.from_bytes(message.data[:2], "little")
            self.emergency = code if code & 0xFF00 else 0  # 00xxh: errors reset
        elif message.arbitration_id == _HEARTBEAT + self._node and bytes(message.data) == bytes([_BOOT_UP]):
            self.restarted = True
        return message

    def _release(self) -> None:
        if self._claim:
            self._claim.close()


def _is_segment(toggle: bool) -> Callable[[Answer], bool]:
    return lambda answer: isinstance(answer, Segment) and answer.toggle == toggle


def _claim(table: CanOpen) -> serial.Serial | None:
    """Lock the tty of an slcan adapter, which python-can leaves open to a second program. Raises LinkLost."""
    if table.interface != "slcan" or os.name != "posix":
        return None
    port = table.channel.partition("@")[0]
    try:
        return serial.Serial(port, exclusive=True)
    except (OSError, ValueError) as error:
        raise LinkLost(f"{port}: the CAN adapter's port cannot be opened ({diagnose_port(port)})") from error


def _open_bus(table: CanOpen) -> can.BusABC:
    options: dict[str, Any] = {}
    if table.interface == "slcan":
        options = {"sleep_after_open": SLCAN_START_SECONDS, "timeout": SETTLE_SECONDS}
    try:
        return can.Bus(
            interface=table.interface, channel=table.channel, bitrate=table.bitrate, ignore_config=True, **options
        )
    except (can.CanError, OSError, ValueError, ImportError, NotImplementedError) as error:
        raise LinkLost(f"CAN: {table.interface} {table.channel} cannot be opened ({error})") from error
