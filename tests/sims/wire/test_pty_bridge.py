import asyncio
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest
import serial

from rotorrig.rig.errors import RigError
from rotorrig.sims.wire import pty_bridge
from rotorrig.sims.wire.pty_bridge import PtyBridge

Background = Callable[..., AbstractContextManager[None]]
EVERY_BYTE = bytes(range(256))


@contextmanager
def cable(background: Background, *, baudrate: float | None = None) -> Iterator[tuple[serial.Serial, serial.Serial]]:
    """A running bridge with a serial port open at either end."""
    with PtyBridge(baudrate=baudrate) as bridge:

        async def run(end: asyncio.Event) -> None:
            async with asyncio.TaskGroup() as group:
                task = group.create_task(bridge.run())
                await end.wait()
                task.cancel()

        with (
            background(run),
            serial.Serial(bridge.client_port, timeout=5) as client,
            serial.Serial(bridge.device_port, timeout=5) as device,
        ):
            yield client, device


def test_every_byte_crosses_both_ways_unaltered(background: Background) -> None:
    with cable(background) as (client, device):
        client.write(EVERY_BYTE)
        assert device.read(256) == EVERY_BYTE
        device.write(EVERY_BYTE[::-1])
        assert client.read(256) == EVERY_BYTE[::-1]


def test_a_line_that_is_full_waits_for_its_reader(background: Background) -> None:
    data = 400 * EVERY_BYTE  # 102 kB, five times what the line holds
    with cable(background) as (client, device), ThreadPoolExecutor(1) as other:
        pouring = other.submit(device.write, data)
        time.sleep(0.2)
        assert not pouring.done()
        assert client.read(len(data)) == data


def test_a_paced_line_takes_the_time_of_its_baud_rate(background: Background) -> None:
    with cable(background, baudrate=9600) as (client, device):
        began = time.monotonic()
        client.write(96 * b"x")
        assert len(device.read(96)) == 96
        assert time.monotonic() - began >= 0.1  # 96 bytes of 10 bits


def test_a_client_may_leave_and_come_back(background: Background) -> None:
    with cable(background) as (client, device):
        for word in (b"once", b"again"):
            client.write(word)
            assert device.read(len(word)) == word
            client.close()
            client.open()


def test_a_closed_bridge_leaves_no_port() -> None:
    with PtyBridge() as bridge:
        assert Path(bridge.client_port).exists()
        assert Path(bridge.device_port).exists()
    bridge.close()  # a second time
    with pytest.raises(serial.SerialException):
        serial.Serial(bridge.client_port)


def test_a_machine_without_ptys_is_named_in_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def none_left() -> tuple[int, int]:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(pty_bridge.os, "openpty", none_left)
    with pytest.raises(RigError, match="no pseudo-terminal"):
        PtyBridge()
