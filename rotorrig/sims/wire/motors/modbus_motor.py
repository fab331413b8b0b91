"""A Modbus server in front of an emulated drive, on a tty (RTU) or on 127.0.0.1 (TCP), served by pymodbus.

Function codes are those of the drive's manual; others answer exception 1, unknown registers exception 2, values out of
range exception 3. On a line, requests to other nodes are met with silence and a broadcast (node 0) is obeyed without
an answer: Modbus over Serial Line V1.02, section 2.1. Over TCP, another unit identifier answers exception 11, as a
gateway does for a device it cannot reach: Modbus Application Protocol V1.1b3, section 7.
"""

import asyncio
import logging
import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Protocol

from pymodbus.constants import ExcCodes
from pymodbus.exceptions import NoSuchIdException
from pymodbus.pdu import ModbusPDU
from pymodbus.server import ModbusSerialServer, ModbusTcpServer
from pymodbus.server.requesthandler import ServerRequestHandler
from pymodbus.simulator.simcore import SimCore

from rotorrig.sims.wire.drive import Drive

LOOPBACK = "127.0.0.1"  # the only address served: an emulator takes no orders from other hosts
_FRAME_END = 0.03  # s; the standard's 1.75 ms is below what a loaded machine's scheduler keeps

# without a handler, Python prints pymodbus' account of every refused request to stderr
logging.getLogger("pymodbus").addHandler(logging.NullHandler())


class Unanswered(Exception):
    """Raised by registers that a request leaves silent."""


class Registers(Protocol):
    """An emulated controller as its Modbus master sees it; one class per family, see `inverters`."""

    @property
    def drive(self) -> Drive:
        """The drive behind the registers."""
        ...

    @property
    def functions(self) -> frozenset[int]:
        """The function codes its manual lists."""
        ...

    def read(self, address: int, count: int) -> list[int]:
        """Return `count` registers from `address`.

        Raises KeyError for one the drive does not have, Unanswered for a request it does not reply to.
        """
        ...

    def write(self, address: int, values: list[int]) -> None:
        """Write consecutive registers. Raises KeyError for one that is unknown or read-only, ValueError for a value."""
        ...


@dataclass(slots=True)
class Disguise:
    """A fault script's: the address put into replies while it is set, as if another device answered."""

    answers_as: int | None = None


@asynccontextmanager
async def serve_rtu(
    registers: Registers, *, port: str, address: int, disguise: Disguise | None = None
) -> AsyncIterator[None]:
    """Answer for `registers` as node `address` on the tty `port` for the length of the block."""
    # no baud rate here: pacing is the cable's, and a pty takes any
    server = _RtuServer([], port=port, ignore_missing_devices=True, broadcast_enable=True)
    server.disguise = disguise or Disguise()
    server.context = _Node(registers, address)
    await server.serve_forever(background=True)
    try:
        yield
    finally:
        await server.shutdown()


@asynccontextmanager
async def serve_tcp(registers: Registers, *, address: int, disguise: Disguise | None = None) -> AsyncIterator[int]:
    """Answer for `registers` as unit `address` on 127.0.0.1 for the length of the block; give the port, a free one."""
    server = _TcpServer([], address=(LOOPBACK, 0))
    server.disguise = disguise or Disguise()
    server.context = _Node(registers, address)
    await server.serve_forever(background=True)
    assert isinstance(server.transport, asyncio.Server)
    try:
        yield server.transport.sockets[0].getsockname()[1]
    finally:
        await server.shutdown()


class _RtuServer(ModbusSerialServer):
    """pymodbus's server with one thing of the serial line it leaves out: silence ends a frame."""

    disguise: Disguise

    def callback_new_connection(self) -> ServerRequestHandler:
        return _Line(self, self.trace_packet, self.trace_pdu, self.trace_connect)


class _TcpServer(ModbusTcpServer):
    disguise: Disguise

    def callback_new_connection(self) -> ServerRequestHandler:
        return _Connection(self, self.trace_packet, self.trace_pdu, self.trace_connect)


class _Connection(ServerRequestHandler):
    """Signs its replies with the address of the disguise."""

    server: _RtuServer | _TcpServer

    def server_send(self, pdu: ModbusPDU, addr: tuple[str, int] | None) -> None:
        if pdu and (worn := self.server.disguise.answers_as) is not None:
            pdu.dev_id = worn
        super().server_send(pdu, addr)


class _Line(_Connection):
    """Drops what noise left in the buffer: without that, half a frame deafens the node to the next one."""

    _heard = -math.inf

    def data_received(self, data: bytes) -> None:
        now = self.loop.time()
        if now - self._heard > _FRAME_END:
            self.recv_buffer = b""
        self._heard = now
        super().data_received(data)


class _Node(SimCore):
    """The registers pymodbus serves: the drive's own, for one address."""

    def __init__(self, registers: Registers, address: int) -> None:
        super().__init__([])
        self._registers, self._address = registers, address

    def device_ids(self) -> list[int]:
        return [self._address]

    async def async_getValues(  # noqa: N802 (pymodbus's name)
        self, device_id: int, func_code: int, address: int, count: int = 1
    ) -> list[int] | list[bool] | ExcCodes:
        if refusal := self._refusal(device_id, func_code):
            return refusal
        try:
            return self._registers.read(address, count)
        except Unanswered:
            raise NoSuchIdException from None  # pymodbus stays silent
        except KeyError:
            return ExcCodes.ILLEGAL_ADDRESS

    async def async_setValues(  # noqa: N802 (pymodbus's name)
        self, device_id: int, func_code: int, address: int, values: list[int] | list[bool]
    ) -> ExcCodes | None:
        if refusal := self._refusal(device_id, func_code):
            return refusal
        try:
            self._registers.write(address, [int(value) for value in values])
        except KeyError:
            return ExcCodes.ILLEGAL_ADDRESS
        except ValueError:
            return ExcCodes.ILLEGAL_VALUE
        return None

    def _refusal(self, device_id: int, func_code: int) -> ExcCodes | None:
        if device_id != self._address:
            raise NoSuchIdException  # silence on a line, exception 11 over TCP
        return None if func_code in self._registers.functions else ExcCodes.ILLEGAL_FUNCTION
