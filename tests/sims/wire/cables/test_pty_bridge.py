import asyncio
import time
from collections.abc import Callable, Coroutine, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import pytest
import serial

from rotorrig.rig.errors import RigError
from rotorrig.sims.wire.background import run_jobs
from rotorrig.sims.wire.cables import pty_bridge
from rotorrig.sims.wire.cables.pty_bridge import PtyBridge

Background = Callable[..., AbstractContextManager[None]]
EVERY_BYTE = bytes(range(256))


@contextmanager
def cable(
    background: Background, *, baudrate: float | None = None
) -> Iterator[tuple[serial.Serial, serial.Serial, PtyBridge]]:
    """A running bridge with a serial port open at either end."""
    with (
        PtyBridge(baudrate=baudrate) as bridge,
        background(carrying(bridge)),
        serial.Serial(bridge.client_port, timeout=5) as client,
        serial.Serial(bridge.device_port, timeout=5) as device,
    ):
        yield client, device, bridge


def carrying(
    bridge: PtyBridge, loops: list[asyncio.AbstractEventLoop] | None = None
) -> Callable[[asyncio.Event], Coroutine[Any, Any, None]]:
    """Return what carries; the loop it does so in is appended to `loops`."""

    async def run(end: asyncio.Event) -> None:
        if loops is not None:
            loops.append(asyncio.get_running_loop())
        async with run_jobs(bridge.run()):
            await end.wait()

    return run


def test_every_byte_crosses_both_ways_unaltered(background: Background) -> None:
    with cable(background) as (client, device, _):
        client.write(EVERY_BYTE)
        assert device.read(256) == EVERY_BYTE
        device.write(EVERY_BYTE[::-1])
        assert client.read(256) == EVERY_BYTE[::-1]


def test_a_line_that_is_full_waits_for_its_reader(background: Background) -> None:
    data = 400 * EVERY_BYTE  # 102 kB, five times what the line holds
    with cable(background) as (client, device, _), ThreadPoolExecutor(1) as other:
        pouring = other.submit(device.write, data)
        time.sleep(0.2)
        assert not pouring.done()
        assert client.read(len(data)) == data


def test_a_paced_line_takes_the_time_of_its_baud_rate(background: Background) -> None:
    with cable(background, baudrate=9600) as (client, device, _):
        began = time.monotonic()
        client.write(96 * b"x")
        assert len(device.read(96)) == 96
        assert time.monotonic() - began >= 0.1  # 96 bytes of 10 bits


def test_a_client_may_leave_and_come_back(background: Background) -> None:
    with cable(background) as (client, device, _):
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


def test_a_port_that_was_plugged_in_again_has_the_same_name(background: Background, tmp_path: Path) -> None:
    name = tmp_path / "drive"
    loops: list[asyncio.AbstractEventLoop] = []
    with (
        PtyBridge(name=name) as bridge,
        background(carrying(bridge, loops)),
        serial.Serial(bridge.device_port, timeout=5) as device,
    ):
        assert bridge.client_port == str(name)
        for _ in range(2):
            with serial.Serial(str(name), timeout=5) as client:
                client.write(b"there")
                assert device.read(5) == b"there"
                device.write(b"here")
                assert client.read(4) == b"here"
                loops[0].call_soon_threadsafe(bridge.cable.unplug, True)
                with pytest.raises(serial.SerialException):
                    client.read(1)
            assert not name.exists()
            device.write(b"nobody listens")
            time.sleep(0.05)
            loops[0].call_soon_threadsafe(bridge.cable.unplug, False)
            until = time.monotonic() + 5
            while not name.exists() and time.monotonic() < until:
                time.sleep(0.005)
    assert not name.exists()


def test_a_diverted_client_hears_another_device_and_the_device_nothing(background: Background) -> None:
    with cable(background) as (client, device, bridge):
        bridge.cable.divert(True)
        client.write(b"ID?\n")
        assert client.read(9) == b"\r\nERROR\r\n"  # a modem's
        bridge.cable.divert(False)
        client.write(b"x")
        assert device.read(1) == b"x"


def test_a_machine_without_ptys_is_named_in_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def none_left() -> tuple[int, int]:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(pty_bridge.os, "openpty", none_left)
    with pytest.raises(RigError, match="no pseudo-terminal"):
        PtyBridge()
