"""A drive on Modbus: registers served by pymodbus, whose meaning one of the drive's manuals gives."""

import asyncio
import os
import pty
import tty
from collections.abc import Callable
from contextlib import suppress
from typing import Protocol

from pymodbus.constants import ExcCodes
from pymodbus.framer import FramerType
from pymodbus.server import ModbusSerialServer, ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

from tests.peers.cables import Receive, Send
from tests.peers.inverter import Inverter
from tests.peers.journal import Journal


class RegisterMap(Protocol):
    """A drive family as its manual describes it; addresses as on the wire."""

    address: int  # the node's, as delivered
    initial: dict[int, int]  # every register there is
    read_only: frozenset[int]

    def refresh(self, registers: dict[int, int]) -> None:
        """Bring the registers that report up to date."""

    def write(self, address: int, value: int, registers: dict[int, int]) -> ExcCodes | None:
        """Act on a write; an exception code refuses it."""

    def power_up(self) -> None:
        """Forget what is lost at power-off."""


class ModbusDrive:
    """A pymodbus server of one drive."""

    def __init__(self, registers: RegisterMap, inverter: Inverter, journal: Journal) -> None:
        """Prepare the device; `listen_rtu` or `listen_tcp` serves it."""
        self.map, self.inverter = registers, inverter
        self.values = dict(registers.initial)
        self.busy_every = 0.0  # s between bursts of exceptions 6; 0: none
        self.busy_times = 2  # exceptions in a burst
        self._busy_left = 0
        self._busy_next = 0.0
        self._journal = journal
        self._refused: set[int] = set()
        self._device = SimDevice(
            id=registers.address,
            simdata=[
                SimData(address, values=value, datatype=DataType.REGISTERS) for address, value in self.values.items()
            ],
            action=self._act,
        )
        self._server: ModbusSerialServer | ModbusTcpServer | None = None

    async def listen_tcp(self) -> Callable[[Send], Receive]:
        """Serve on a port of its own; return what connects a client to it."""
        self._server = ModbusTcpServer(self._device, address=("127.0.0.1", 0))
        await self._server.serve_forever(background=True)
        transport = self._server.transport
        assert isinstance(transport, asyncio.Server)
        port = transport.sockets[0].getsockname()[1]
        return lambda send: _Tunnel(port, send).pass_on

    async def listen_rtu(self) -> Callable[[Send], Receive]:
        """Serve on a pseudo-terminal of its own; return what connects a client to it."""
        master, slave = pty.openpty()
        tty.setraw(slave)
        os.set_blocking(master, False)
        self._server = ModbusSerialServer(self._device, framer=FramerType.RTU, port=os.ttyname(slave), baudrate=115200)
        await self._server.serve_forever(background=True)
        answer: list[Send] = []

        def read() -> None:
            with suppress(OSError):
                answer[-1](os.read(master, 4096))

        def pass_on(data: bytes) -> None:
            with suppress(OSError):
                os.write(master, data)

        def connect(send: Send) -> Receive:
            answer.append(send)
            return pass_on

        asyncio.get_running_loop().add_reader(master, read)
        return connect

    def busy(self, *, every: float, times: int) -> None:
        """Answer bursts of requests with exception 6, server busy."""
        self.busy_every, self.busy_times, self._busy_next = every, times, asyncio.get_running_loop().time()

    async def _act(
        self,
        function: int,
        start: int,
        address: int,
        count: int,
        registers: list[int],
        written: list[int] | list[bool] | None,
    ) -> ExcCodes | None:
        self.inverter.heard()
        if self._is_busy():
            self._journal.event("busy", function=function, address=address)
            return ExcCodes.DEVICE_BUSY
        if any(at not in self.values for at in range(address, address + count)):
            return self._refuse(address, ExcCodes.ILLEGAL_ADDRESS)
        if written is not None:
            for at, value in enumerate(written, start=address):
                refused = ExcCodes.ILLEGAL_ADDRESS if at in self.map.read_only else None
                if refused := refused or self.map.write(at, int(value), self.values):
                    return self._refuse(at, refused)
                self.values[at] = int(value)
        self.map.refresh(self.values)
        for at, value in self.values.items():
            registers[at - start] = value & 0xFFFF
        return None

    def _is_busy(self) -> bool:
        now = asyncio.get_running_loop().time()
        if not self.busy_every:
            return False
        if not self._busy_left and now >= self._busy_next:
            self._busy_left, self._busy_next = self.busy_times, now + self.busy_every
        if self._busy_left:
            self._busy_left -= 1
            return True
        return False

    def _refuse(self, address: int, code: ExcCodes) -> ExcCodes:
        if address not in self._refused:
            self._refused.add(address)
            self._journal.event("refused", address=address, exception=int(code))
        return code


class _Tunnel:
    """A client's connection, led on to the server's own port."""

    def __init__(self, port: int, send: Send) -> None:
        self._send, self._waiting = send, bytearray()
        self._writer: asyncio.StreamWriter | None = None
        self._task = asyncio.ensure_future(self._run(port))

    def pass_on(self, data: bytes) -> None:
        """Lead a request on."""
        if self._writer is None:
            self._waiting += data
        else:
            self._writer.write(data)

    async def _run(self, port: int) -> None:
        reader, self._writer = await asyncio.open_connection("127.0.0.1", port)
        self._writer.write(bytes(self._waiting))
        with suppress(OSError):
            while data := await reader.read(4096):
                self._send(data)
        self._writer.close()
