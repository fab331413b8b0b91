"""Pseudo-terminals as serial cables: a client opens a real tty path, the other end is ours.

`Pty` is one cable with our code at its far end. `Cable` is one that a script can disturb, unplug and plug in again.
`PtyBridge` lays a `Cable` and a `Pty` back to back, for a server that wants to open a tty itself. All are used from
one asyncio loop, so nothing here needs a thread.
"""

import asyncio
import os
import tty
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

from rotorrig.rig import RigError
from rotorrig.sims.wire.cables.interference import Deliver, Interference, Lane

BITS_PER_BYTE = 10.0  # 8N1: start bit, eight data bits, stop bit
STRANGER = b"\r\nERROR\r\n"  # what a modem answers to anything but AT commands: ITU-T V.250
_CHUNK = 256  # bytes carried at once; at most so much later does a paced byte arrive


class Unplugged(Exception):
    """The pseudo-terminal was closed while it was read or written."""


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
        self._waiting: dict[asyncio.Event, Callable[[], Any]] = {}  # who waits, and how to stop watching for it

    async def read(self, size: int = 4096) -> bytes:
        """Wait for bytes from the client, return up to `size` of them. Raises Unplugged when closed meanwhile."""
        loop = asyncio.get_running_loop()
        while self._master >= 0:
            try:
                return os.read(self._master, size)
            except BlockingIOError:
                await self._ready(loop.add_reader, loop.remove_reader)
        raise Unplugged

    async def write(self, data: bytes) -> None:
        """Send all of `data`, waiting for the client to read when the line is full (about 20 kB on Linux).

        Raises Unplugged when closed meanwhile.
        """
        loop = asyncio.get_running_loop()
        while data:
            if self._master < 0:
                raise Unplugged
            try:
                data = data[os.write(self._master, data) :]
            except BlockingIOError:
                await self._ready(loop.add_writer, loop.remove_writer)

    def close(self) -> None:
        """Close both ends, waking who waits for them; may be called twice."""
        for waiting, unwatch in self._waiting.items():
            unwatch()
            waiting.set()
        self._waiting.clear()
        for fd in (self._master, self._slave):
            if fd >= 0:
                os.close(fd)
        self._master = self._slave = -1

    async def _ready(self, watch: Callable[..., Any], unwatch: Callable[[int], Any]) -> None:
        """Wait until the loop's `watch` (add_reader or add_writer) reports the line, or it is closed."""
        ready, fd = asyncio.Event(), self._master
        watch(fd, ready.set)
        self._waiting[ready] = lambda: unwatch(fd)
        try:
            await ready.wait()
        finally:
            if stop_watching := self._waiting.pop(ready, None):
                stop_watching()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class Cable:
    """A serial cable to a client that things can happen to; messages are carried while `run` runs.

    `name` is a path under which the client always finds it, as /dev/serial/by-id is on a real machine; without one
    the port is the pseudo-terminal's own. `tap` is given what has been put on the client's line, after what befell it.
    """

    def __init__(self, *, name: Path | None = None, tap: IO[bytes] | None = None) -> None:
        self.interference = Interference()
        self._to_client = Lane(self.interference, "from-device", self._deliver)
        self._name, self._tap = name, tap
        self._plugged = asyncio.Event()
        self._diverted = False
        self._pty: Pty | None = None
        self.unplug(False)

    @property
    def port(self) -> str:
        """The path a client opens."""
        return str(self._name or (self._pty.port if self._pty else "unplugged"))

    async def write(self, message: bytes) -> None:
        """Send a message to the client; return when it is on the line. Nobody misses one sent while unplugged."""
        if not self._diverted:
            await self._to_client.put(message)

    async def run(self, received: Deliver) -> None:
        """Hand the client's messages to `received`, until cancelled."""
        to_device = Lane(self.interference, "to-device", received)
        async with asyncio.TaskGroup() as jobs:
            jobs.create_task(self._listen(to_device))
            jobs.create_task(to_device.run())
            jobs.create_task(self._to_client.run())

    def unplug(self, unplugged: bool) -> None:
        """Take the port away, as a USB adapter pulled out, or give it back under the same name."""
        if unplugged and self._pty:
            self._plugged.clear()
            if self._name:
                self._name.unlink(missing_ok=True)
            self._pty.close()
            self._pty = None
        elif not unplugged and not self._pty:
            self._pty = Pty()
            if self._name:
                self._name.symlink_to(self._pty.port)
            self._plugged.set()

    def divert(self, diverted: bool) -> None:
        """Connect the client to another device, a modem, or back to this one."""
        self._diverted = diverted

    def close(self) -> None:
        """Close it; may be called twice."""
        self.unplug(True)

    async def _listen(self, to_device: Lane) -> None:
        while True:
            await self._plugged.wait()
            try:
                assert self._pty
                message = await self._pty.read(_CHUNK)
                if self._diverted:
                    await self._pty.write(STRANGER)
                    continue
            except Unplugged:
                continue
            await to_device.put(message)

    async def _deliver(self, message: bytes) -> None:
        with suppress(Unplugged):
            if self._pty:
                await self._pty.write(message)
                if self._tap:
                    self._tap.write(message)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class PtyBridge:
    """A cable between two tty paths: bytes written to `client_port` come out of `device_port` and back.

    `baudrate` paces each direction as a UART at 8N1 would, or at `bits_per_byte`; None carries bytes at once. `name`
    is the client's path, as a `Cable`'s.
    """

    def __init__(
        self, *, baudrate: float | None = None, bits_per_byte: float = BITS_PER_BYTE, name: Path | None = None
    ) -> None:
        self.cable, self._device = Cable(name=name), Pty()
        self._byte_time = bits_per_byte / baudrate if baudrate else 0.0
        self.client_port, self.device_port = self.cable.port, self._device.port

    async def run(self) -> None:
        """Carry bytes both ways until cancelled."""
        async with asyncio.TaskGroup() as jobs:
            jobs.create_task(self.cable.run(self._to_device))
            jobs.create_task(self._from_device())

    async def _to_device(self, message: bytes) -> None:
        await self._device.write(await self._pace(message))

    async def _from_device(self) -> None:
        while True:
            await self.cable.write(await self._pace(await self._device.read(_CHUNK)))

    async def _pace(self, data: bytes) -> bytes:
        if self._byte_time:
            await asyncio.sleep(len(data) * self._byte_time)
        return data

    def close(self) -> None:
        """Close both ends; may be called twice."""
        self.cable.close()
        self._device.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
