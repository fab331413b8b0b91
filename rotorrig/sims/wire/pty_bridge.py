"""Pseudo-terminals as serial cables: a client opens a real tty path, the other end is ours.

`Pty` is one cable with our code at its far end. `PtyBridge` lays two back to back, for a server that wants to open a
tty itself. Both are used from one asyncio loop, so nothing here needs a thread.
"""

import asyncio
import os
import tty
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

from rotorrig.rig.errors import RigError

BITS_PER_BYTE = 10  # 8N1: start bit, eight data bits, stop bit
_CHUNK = 256  # bytes carried at once; at most so much later does a paced byte arrive


class Pty:
    """A raw pseudo-terminal; clients open `port`. A context manager closes both ends.

    The client's end is held open here too: a client may come and go, and meanwhile the line is idle, not hung up.
    """

    def __init__(self) -> None:
        try:
            self._master, self._slave = os.openpty()
        except OSError as error:
            raise RigError(f"no pseudo-terminal to be had ({error.strerror}), want one per emulated port") from error
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.port = os.ttyname(self._slave)

    async def read(self, size: int = 4096) -> bytes:
        """Wait for bytes from the client, return up to `size` of them."""
        loop = asyncio.get_running_loop()
        while True:
            try:
                return os.read(self._master, size)
            except BlockingIOError:
                await _ready(self._master, loop.add_reader, loop.remove_reader)

    async def write(self, data: bytes) -> None:
        """Send all of `data`, waiting for the client to read when the line is full (about 20 kB on Linux)."""
        loop = asyncio.get_running_loop()
        while data:
            try:
                data = data[os.write(self._master, data) :]
            except BlockingIOError:
                await _ready(self._master, loop.add_writer, loop.remove_writer)

    def close(self) -> None:
        """Close both ends; may be called twice."""
        for fd in (self._master, self._slave):
            if fd >= 0:
                os.close(fd)
        self._master = self._slave = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class PtyBridge:
    """A cable between two tty paths: bytes written to `client_port` come out of `device_port` and back.

    `baudrate` paces each direction as a UART at 8N1 would; None carries bytes at once.
    """

    def __init__(self, *, baudrate: float | None = None) -> None:
        self._client, self._device = Pty(), Pty()
        self._byte_time = BITS_PER_BYTE / baudrate if baudrate else 0.0
        self.client_port, self.device_port = self._client.port, self._device.port

    async def run(self) -> None:
        """Carry bytes both ways until cancelled."""
        async with asyncio.TaskGroup() as directions:
            directions.create_task(self._carry(self._client, self._device))
            directions.create_task(self._carry(self._device, self._client))

    async def _carry(self, source: Pty, sink: Pty) -> None:
        while True:
            data = await source.read(_CHUNK)
            if self._byte_time:
                await asyncio.sleep(len(data) * self._byte_time)
            await sink.write(data)

    def close(self) -> None:
        """Close both cables; may be called twice."""
        self._client.close()
        self._device.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


async def _ready(fd: int, watch: Callable[..., Any], unwatch: Callable[[int], Any]) -> None:
    """Wait until the loop's `watch` (add_reader or add_writer) reports `fd`."""
    ready = asyncio.Event()
    watch(fd, ready.set)
    try:
        await ready.wait()
    finally:
        unwatch(fd)
