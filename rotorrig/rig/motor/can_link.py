"""CAN link to one CANopen node: SDO reads and writes, the master's heartbeat, emergencies; any adapter of python-can.

The transfers are those of the canopen package; each request of one is an exchange here, with a turn of its own. A stop
goes out before requests that wait or are to be repeated. Safe for several threads; the heartbeat goes out with the
requests: a program that hangs falls silent, and the node, told to listen, stops the rotor.

There is no thread of its own, nor canopen's, which keeps a stop's time as well (99 % on the wire within 4 ms beside two
readers; 7 ms here) but takes the late answer to another command for this one's and ends at a damaged slcan line.
"""

import logging
import math
import os
import time
from collections.abc import Callable
from typing import Any

import can
import serial
from can.interfaces.slcan import slcanBus
from canopen import Network, ObjectDictionary
from canopen.sdo import SdoAbortedError, SdoClient, SdoCommunicationError, constants

from rotorrig.rig.config import CanOpen
from rotorrig.rig.errors import BadFrame, LinkLost, RigError
from rotorrig.rig.motor.cia402_frames import Item
from rotorrig.rig.motor.turns import Turns
from rotorrig.rig.serial_port import open_serial

ANSWER_SECONDS = 0.2  # for one answer, beside the time of both frames on the bus
RETRIES = 3  # all tries take 0.8 s of the 2 s for which the interlock does without a pulse or a reading
WRITE_SECONDS = 0.2
FRAME_BITS = 135  # 8 bytes of data with the most stuffing
SETTLE_SECONDS = 0.0005  # without a frame, after which none is left from before; adapters deliver in bursts
SLCAN_START_SECONDS = 0.05  # python-can's 2 s are for adapters that start anew whenever their port is opened
STALE_FRAMES = 1000  # at most so many are passed over before a request; a bus busier than that never settles
MASTER, SPARE_MASTER = 127, 126  # our node number, for the heartbeat

_NMT, _EMERGENCY, _ANSWER, _REQUEST, _HEARTBEAT = 0x000, 0x080, 0x580, 0x600, 0x700  # function codes, plus the node
_NMT_START, _OPERATIONAL, _BOOT_UP = 1, 5, 0
_BUS_OFF = 0x40  # bit of an error frame's identifier, as Linux has it (linux/can/error.h)
_SPECIFIER = 0xE0  # of the first byte of an SDO frame: its kind
_FITTING = {  # kind of request: that of its answer
    constants.REQUEST_UPLOAD: constants.RESPONSE_UPLOAD,
    constants.REQUEST_DOWNLOAD: constants.RESPONSE_DOWNLOAD,
    constants.REQUEST_SEGMENT_UPLOAD: constants.RESPONSE_SEGMENT_UPLOAD,
}
_TRANSIENT = (  # aborts after which a transfer is repeated
    constants.ABORT_TOGGLE_NOT_ALTERNATED,
    constants.ABORT_TIMED_OUT,
    constants.ABORT_INVALID_COMMAND_SPECIFIER,  # to a segment asked for after a stop came in between
)
_LONGEST = 256  # bytes of a text; a node may go on for ever

# without a handler, Python prints canopen's own account of every repetition to stderr; errors are raised as LinkLost
logging.getLogger("canopen").addHandler(logging.NullHandler())


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
        try:
            return item.decode(self._transfer(_reader(item), item))
        except BadFrame as error:
            raise LinkLost(f"{self._name}: {error}") from error

    def read_text(self, item: Item) -> str:
        """Return an object that is a text, of any length. Raises Refused, LinkLost."""
        return self._transfer(_reader(item), item).decode("ascii", errors="replace").rstrip("\0 ")

    def write(self, item: Item, value: int, *, stops_before: int | None = None) -> None:
        """Set an object. Raises Refused, LinkLost; Overtaken if there have been more `stops` than `stops_before`."""
        self._transfer(_writer(item, value), item, stops_before=stops_before)

    def stop(self, item: Item, value: int) -> None:
        """Set an object before whoever else waits. Raises Refused, LinkLost."""
        self._transfer(_writer(item, value), item, first=True)

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

    def _transfer(
        self, run: Callable[[SdoClient], bytes], item: Item, *, first: bool = False, stops_before: int | None = None
    ) -> bytes:
        """Run a transfer about `item`, again if it fails for now. Raises Refused, LinkLost, Overtaken."""
        abort: SdoAbortedError | None = None

        def exchange(request: bytes) -> bytes | None:
            with self._turns.take(first=first):
                self.stops += first
                if stops_before is not None and stops_before != self.stops:
                    raise Overtaken(f"{self._name}: {item} was about to be written, but a stop came before")
                return self._exchange(request)

        for _ in range(1 + RETRIES):
            try:
                return run(_make_client(exchange))
            except SdoAbortedError as error:
                abort = error
                if abort.code not in _TRANSIENT:
                    break
            except SdoCommunicationError:
                abort = None
        if abort:
            reason = abort.CODES.get(abort.code, "not said why")
            raise Refused(f"{self._name}: the node refuses access to {item}: {reason} (abort code {abort.code:08X}h)")
        raise LinkLost(f"{self._name}: asked for {item}, no answer in {1 + RETRIES} tries of {self._patience:.2g} s")

    def _exchange(self, request: bytes) -> bytes | None:
        """Send a request once; return its answer, None if none comes in time."""
        self._beat()
        for _ in range(STALE_FRAMES):  # the late answer to a request before would pass for this one's
            if not self._receive(SETTLE_SECONDS):
                break
        self._send(_REQUEST + self._node, request)
        until = time.monotonic() + self._patience
        while (left := until - time.monotonic()) > 0:
            message = self._receive(left)
            if message and message.arbitration_id == _ANSWER + self._node and _is_answer(message.data, request):
                return bytes(message.data)
        return None

    def _beat(self) -> None:
        """Send the master's heartbeat when it is due."""
        now = time.monotonic()
        if self._heartbeat_period is not None and now - self._beat_at >= self._heartbeat_period:
            self._send(_HEARTBEAT + self.master, bytes([_OPERATIONAL]))
            self._beat_at = now

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


def _reader(item: Item) -> Callable[[SdoClient], bytes]:
    """Return the transfer that reads an object."""

    def read(sdo: SdoClient) -> bytes:
        data = b""
        with sdo.open(item.index, item.subindex, buffering=0) as stream:
            while len(data) < _LONGEST and (segment := stream.read(7)):
                data += segment
        return data

    return read


def _writer(item: Item, value: int) -> Callable[[SdoClient], bytes]:
    """Return the transfer that sets an object. Raises OverflowError if it does not hold `value`."""
    data = item.encode(value)

    def write(sdo: SdoClient) -> bytes:
        sdo.download(item.index, item.subindex, data)
        return data

    return write


class _Wire(Network):
    """Network of one canopen client: an exchange where it sends a request.

    A transfer's aborts are left out: nobody answers them, and the next request ends what was under way as well.
    """

    def __init__(self, exchange: Callable[[bytes], bytes | None]) -> None:
        super().__init__()
        self._exchange = exchange

    def send_message(self, can_id: int, data: bytes, remote: bool = False) -> None:
        """Send a request, and pass its answer on if there is one."""
        if data[0] & _SPECIFIER in _FITTING and (answer := self._exchange(bytes(data))):
            self.notify(_ANSWER, bytearray(answer), 0.0)


def _make_client(exchange: Callable[[bytes], bytes | None]) -> SdoClient:
    """Return a client for one transfer. It neither waits nor repeats: an answer is there once its request is sent."""
    client = SdoClient(_REQUEST, _ANSWER, ObjectDictionary())
    client.RESPONSE_TIMEOUT, client.MAX_RETRIES = 0.0, 1
    client.network = _Wire(exchange)
    client.network.subscribe(_ANSWER, client.on_response)
    return client


def _is_answer(frame: bytes | bytearray, request: bytes) -> bool:
    """Return whether a frame answers a request: those before may be answered late, or twice."""
    if len(frame) != len(request):
        return False
    kind, asked = frame[0] & _SPECIFIER, request[0] & _SPECIFIER
    if asked == constants.REQUEST_SEGMENT_UPLOAD:  # a segment does not say what it is about
        same = (frame[0] ^ request[0]) & constants.TOGGLE_BIT == 0
        return kind == constants.RESPONSE_ABORTED or (kind == _FITTING[asked] and same)
    return kind in (_FITTING[asked], constants.RESPONSE_ABORTED) and frame[1:4] == request[1:4]


def _claim(table: CanOpen) -> serial.Serial | None:
    """Lock the tty of an slcan adapter, which python-can leaves open to a second program. Raises LinkLost.

    What `open_serial` sets holds for python-can's opening of it too.
    """
    if table.interface != "slcan" or os.name != "posix":
        return None
    port, _, baudrate = table.channel.partition("@")
    return open_serial(port, int(baudrate) if baudrate.isdecimal() else 9600, of="CAN adapter")


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
