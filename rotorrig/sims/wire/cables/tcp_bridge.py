"""A network cable between a client and a server on this machine, that a script can disturb, unplug and swap."""

import asyncio
import socket
import struct
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from functools import partial
from types import TracebackType
from typing import Self

from rotorrig.rig import RigError
from rotorrig.sims.wire.cables.interference import Interference, Lane

HOST = "127.0.0.1"  # the loopback alone: nobody outside has a say in a simulated rig
STRANGER = b"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n"  # a web server's answer to what is no HTTP
_NO_FAREWELL = struct.pack("ii", 1, 0)  # of SO_LINGER: a close is a reset
_CHUNK = 4096  # bytes: more than the longest Modbus TCP message, 260


class TcpBridge:
    """A port on the loopback whose connections go on to another one there, while `run` runs.

    Unplugged it refuses connections and has reset those there were, as a device that lost its power; its number stays.
    """

    def __init__(self, device_port: int) -> None:
        self.interference = Interference()
        self._device_port = device_port
        self._listening = _listener(0)
        self.client_port: int = self._listening.getsockname()[1]
        self._plugged, self._unplugged = asyncio.Event(), asyncio.Event()
        self._plugged.set()
        self._server: asyncio.Server | None = None
        self._diverted = False
        self._writers: set[asyncio.StreamWriter] = set()  # of both ends of every connection

    async def run(self) -> None:
        """Accept and carry until cancelled."""
        async with asyncio.TaskGroup() as connections:

            def accept(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
                connections.create_task(self._connect(reader, writer))

            try:
                while True:
                    await self._plugged.wait()
                    self._server = await asyncio.start_server(accept, sock=self._listening)
                    await self._unplugged.wait()
            finally:
                self._hang_up()

    def unplug(self, unplugged: bool) -> None:
        """Take the port away, or give it back with the same number. Raises RigError if somebody took it meanwhile."""
        if unplugged and self._plugged.is_set():
            self._plugged.clear()
            self._unplugged.set()
            self._hang_up()
        elif not unplugged and not self._plugged.is_set():
            self._listening = _listener(self.client_port)  # at once: who is told that it is back may connect
            self._unplugged.clear()
            self._plugged.set()

    def divert(self, diverted: bool) -> None:
        """Connect the client to another device, a web server, or back to this one."""
        self._diverted = diverted

    def close(self) -> None:
        """Close it; may be called twice."""
        self._listening.close()

    async def _connect(self, reader: asyncio.StreamReader, client: asyncio.StreamWriter) -> None:
        """Carry one client's messages to the device and back until either hangs up."""
        with suppress(OSError):
            async with self._hold_open(client):
                answers, device = await asyncio.open_connection(HOST, self._device_port)
                async with self._hold_open(device):
                    await self._carry(reader, client, answers, device)

    async def _carry(
        self,
        reader: asyncio.StreamReader,
        client: asyncio.StreamWriter,
        answers: asyncio.StreamReader,
        device: asyncio.StreamWriter,
    ) -> None:
        to_device = Lane(self.interference, "to-device", partial(_send, device))
        to_client = Lane(self.interference, "from-device", partial(_send, client))
        try:
            async with asyncio.TaskGroup() as jobs:
                jobs.create_task(self._hear(reader, to_device, client))
                jobs.create_task(self._hear(answers, to_client, None))
                jobs.create_task(to_device.run())
                jobs.create_task(to_client.run())
        except* OSError:  # one end hung up: so does the other
            pass

    @asynccontextmanager
    async def _hold_open(self, writer: asyncio.StreamWriter) -> AsyncIterator[None]:
        """Keep a connection for the length of the block; reset it then, or when the cable is unplugged."""
        self._writers.add(writer)
        try:
            yield
        finally:
            self._writers.discard(writer)
            writer.transport.abort()
            with suppress(OSError):
                await writer.wait_closed()

    async def _hear(self, source: asyncio.StreamReader, lane: Lane, client: asyncio.StreamWriter | None) -> None:
        """Put what arrives into `lane`; a diverted client is answered by the stranger instead."""
        while message := await source.read(_CHUNK):
            if not self._diverted:
                await lane.put(message)
            elif client:
                client.write(STRANGER)
        raise ConnectionResetError("hung up")

    def _hang_up(self) -> None:
        """Accept no more connections, and reset those there are."""
        if self._server:
            self._server.close()
        for writer in tuple(self._writers):
            with suppress(OSError):  # of one that has just been closed by its client
                writer.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _NO_FAREWELL)
            writer.transport.abort()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


async def _send(sink: asyncio.StreamWriter, message: bytes) -> None:
    sink.write(message)
    await sink.drain()


def _listener(port: int) -> socket.socket:
    try:
        return socket.create_server((HOST, port))
    except OSError as error:
        raise RigError(f"{HOST}, TCP port {port}: cannot be listened at ({error.strerror})") from error
