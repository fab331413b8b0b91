"""The device's end of a serial line: a tty that is ours, in the event loop, without threads."""

import asyncio
import contextlib
import os
import tty
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

_READ = 4096  # bytes
Send = Callable[[bytes], None]


@asynccontextmanager
async def open_serial_end(port: str, *, received: Callable[[bytes], None]) -> AsyncIterator[Send]:
    """Hand what arrives on the tty `port` to `received` for the length of the block; yield what sends.

    Bytes the line has no room for are lost, as those of a UART are whose other end is not listening; so is everything
    once the line is cut. Neither is an error here: a device does not notice.
    """
    loop = asyncio.get_running_loop()
    fd = os.open(port, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)

    def read() -> None:
        try:
            data = os.read(fd, _READ)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if data:
            received(data)
        else:  # hung up: a cut line stays readable for ever
            loop.remove_reader(fd)

    def send(data: bytes) -> None:
        with contextlib.suppress(OSError):
            os.write(fd, data)

    try:
        tty.setraw(fd)
        loop.add_reader(fd, read)
        yield send
    finally:
        loop.remove_reader(fd)
        os.close(fd)
