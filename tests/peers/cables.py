"""Cables between a peer and its client: pseudo-terminals and TCP ports, and what befalls them."""

import asyncio
import os
import pty
import random
import socket
import struct
import tty
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

Send = Callable[[bytes], None]
Receive = Callable[[bytes], None]
Connect = Callable[[Send], Receive]  # a client has connected: given how to answer it, returns who listens to it


@dataclass(slots=True)
class Faults:
    """What is wrong with a cable; all off in a sound one."""

    silent: bool = False  # nothing passes, the port stays
    delay: float = 0.0  # s, of every message
    lost: float = 0.0  # share of the messages
    garbled: float = 0.0  # share of the messages


class Cable:
    """Passes messages both ways through its faults."""

    def __init__(self, connect: Connect, *, seed: int) -> None:
        """Plug nothing in yet; `connect` is called for every client."""
        self.faults = Faults()
        self._connect, self._rng = connect, random.Random(seed)

    def pass_on(self, data: bytes, to: Receive) -> None:
        """Pass a message on, late, damaged or not at all."""
        faults = self.faults
        if faults.silent or self._rng.random() < faults.lost:
            return
        if self._rng.random() < faults.garbled:
            spoiled = bytearray(data)
            spoiled[self._rng.randrange(len(spoiled))] ^= 1 << self._rng.randrange(8)
            data = bytes(self._rng.randbytes(self._rng.randint(0, 6))) + bytes(spoiled)
        if faults.delay:
            asyncio.get_running_loop().call_later(faults.delay, to, data)
        else:
            to(data)

    def unplug(self) -> None:
        """Take the port away."""
        raise NotImplementedError

    def plug(self) -> None:
        """Give it back under the same name."""
        raise NotImplementedError


class PtyCable(Cable):
    """A serial cable: a pseudo-terminal that keeps its name when it is plugged in again."""

    def __init__(self, connect: Connect, *, path: Path, seed: int) -> None:
        """Plug it in at `path`."""
        super().__init__(connect, seed=seed)
        self.path = path
        self._ends: tuple[int, int] | None = None
        self._receive: Receive = lambda data: None
        self.plug()

    def plug(self) -> None:
        """Make the port; its own end of the slave stays open, so that a client may come and go."""
        if self._ends is not None:
            return
        master, slave = pty.openpty()
        tty.setraw(slave)
        os.set_blocking(master, False)
        self._ends = (master, slave)
        self.path.unlink(missing_ok=True)
        self.path.symlink_to(os.ttyname(slave))
        self._receive = self._connect(lambda data: self.pass_on(data, self.write))
        asyncio.get_running_loop().add_reader(master, self._read, master)

    def unplug(self) -> None:
        """Close the port: its client reads an error, as after a pulled USB adapter."""
        if self._ends is None:
            return
        asyncio.get_running_loop().remove_reader(self._ends[0])
        for end in self._ends:
            os.close(end)
        self._ends = None
        self.path.unlink(missing_ok=True)

    def write(self, data: bytes) -> None:
        """Write to the client what fits; the rest is lost, as on a UART."""
        self.offer(data)

    def offer(self, data: bytes) -> int:
        """Write to the client what fits; return the number of bytes."""
        if self._ends is None:
            return 0
        with suppress(OSError):
            return os.write(self._ends[0], data)
        return 0

    def _read(self, master: int) -> None:
        with suppress(OSError):
            if data := os.read(master, 4096):
                self.pass_on(data, self._receive)


class TcpCable(Cable):
    """A network cable: a port on 127.0.0.1 that keeps its number."""

    def __init__(self, connect: Connect, *, seed: int) -> None:
        """Find a free port; `plug` opens it."""
        super().__init__(connect, seed=seed)
        with socket.create_server(("127.0.0.1", 0)) as found:
            self.port: int = found.getsockname()[1]
        self._server: asyncio.AbstractServer | None = None
        self._clients: set[_Client] = set()
        self._plugged = False

    async def open(self) -> None:
        """Listen."""
        self._plugged = True
        loop = asyncio.get_running_loop()
        server = await loop.create_server(lambda: _Client(self), "127.0.0.1", self.port, reuse_address=True)
        if not self._plugged:
            server.close()
            return
        self._server = server

    def plug(self) -> None:
        """Listen again, soon."""
        self._task = asyncio.ensure_future(self.open())

    def unplug(self) -> None:
        """Reset every connection and refuse new ones."""
        self._plugged = False
        if self._server is not None:
            self._server.close()
            self._server = None
        for client in tuple(self._clients):
            client.reset()

    def serve(self, client: "_Client") -> Receive:
        """Connect a client to the device."""
        self._clients.add(client)
        return self._connect(lambda data: self.pass_on(data, client.write))

    def leave(self, client: "_Client") -> None:
        """Forget a client that is gone."""
        self._clients.discard(client)


class _Client(asyncio.Protocol):
    """One connection of a client."""

    def __init__(self, cable: TcpCable) -> None:
        self._cable = cable
        self._transport: asyncio.Transport | None = None
        self._receive: Receive = lambda data: None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        self._receive = self._cable.serve(self)

    def data_received(self, data: bytes) -> None:
        self._cable.pass_on(data, self._receive)

    def connection_lost(self, exc: Exception | None) -> None:
        self._cable.leave(self)
        self._transport = None

    def write(self, data: bytes) -> None:
        """Send to the client, if it is still there."""
        if self._transport is not None:
            self._transport.write(data)

    def reset(self) -> None:
        """End with a reset instead of a farewell."""
        if self._transport is not None:
            self._transport.get_extra_info("socket").setsockopt(
                socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0)
            )
            self._transport.abort()
