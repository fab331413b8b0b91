"""A Modbus RTU slave on a tty in front of the emulated drive, served by pymodbus.

Function codes 03, 06 and 16 as the drive's manual lists them (22C-UM001J, Appendix E); others answer exception 1,
unknown registers exception 2, values out of range exception 3. Requests to other nodes are met with silence, and a
broadcast (node 0) is obeyed without an answer: Modbus over Serial Line V1.02, section 2.1.
"""

import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from pymodbus.constants import ExcCodes
from pymodbus.exceptions import NoSuchIdException
from pymodbus.server import ModbusSerialServer
from pymodbus.server.requesthandler import ServerRequestHandler
from pymodbus.simulator.simcore import SimCore

from rotorrig.sims.wire.powerflex400 import PowerFlex400

FUNCTIONS = (3, 6, 16)
_FRAME_END = 0.03  # s; the standard's 1.75 ms is below what a loaded machine's scheduler keeps


@asynccontextmanager
async def serving(drive: PowerFlex400, *, port: str, address: int) -> AsyncIterator[None]:
    """Answer for `drive` as node `address` on the tty `port` for the length of the block."""
    # no baud rate here: pacing is the cable's, and a pty takes any
    server = _Server([], port=port, ignore_missing_devices=True, broadcast_enable=True)
    server.context = _Node(drive, address)
    await server.serve_forever(background=True)
    try:
        yield
    finally:
        await server.shutdown()


class _Server(ModbusSerialServer):
    """pymodbus's server with one thing of the serial line it leaves out: silence ends a frame."""

    def callback_new_connection(self) -> ServerRequestHandler:
        return _Line(self, self.trace_packet, self.trace_pdu, self.trace_connect)


class _Line(ServerRequestHandler):
    """Drops what noise left in the buffer: without that, half a frame deafens the node to the next one."""

    _heard = -math.inf

    def data_received(self, data: bytes) -> None:
        now = self.loop.time()
        if now - self._heard > _FRAME_END:
            self.recv_buffer = b""
        self._heard = now
        super().data_received(data)


class _Node(SimCore):
    """The registers pymodbus serves: the drive's own, for one node address."""

    def __init__(self, drive: PowerFlex400, address: int) -> None:
        super().__init__([])
        self._drive, self._address = drive, address

    def device_ids(self) -> list[int]:
        return [self._address]

    async def async_getValues(  # noqa: N802 (pymodbus's name)
        self, device_id: int, func_code: int, address: int, count: int = 1
    ) -> list[int] | list[bool] | ExcCodes:
        if refusal := self._refusal(device_id, func_code):
            return refusal
        try:
            return self._drive.read(address, count)
        except KeyError:
            return ExcCodes.ILLEGAL_ADDRESS

    async def async_setValues(  # noqa: N802 (pymodbus's name)
        self, device_id: int, func_code: int, address: int, values: list[int] | list[bool]
    ) -> ExcCodes | None:
        if refusal := self._refusal(device_id, func_code):
            return refusal
        try:
            self._drive.write(address, [int(value) for value in values])
        except KeyError:
            return ExcCodes.ILLEGAL_ADDRESS
        except ValueError:
            return ExcCodes.ILLEGAL_VALUE
        return None

    def _refusal(self, device_id: int, func_code: int) -> ExcCodes | None:
        if device_id != self._address:
            raise NoSuchIdException  # pymodbus stays silent
        return None if func_code in FUNCTIONS else ExcCodes.ILLEGAL_FUNCTION
