import asyncio
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

import numpy as np
import psutil
import pytest

from rotorrig.rig.errors import RigError
from rotorrig.sims.wire.background import run_jobs
from rotorrig.sims.wire.cables import tcp_bridge
from rotorrig.sims.wire.cables.tcp_bridge import TcpBridge
from rotorrig.sims.wire.fault_script import Drop

Background = Callable[..., AbstractContextManager[None]]


@contextmanager
def bridged(background: Background) -> Iterator[tuple[TcpBridge, asyncio.AbstractEventLoop]]:
    """A running bridge to a server that says everything back, in capitals, and the loop it runs in."""
    bridges: list[tuple[TcpBridge, asyncio.AbstractEventLoop]] = []

    async def shout(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while data := await reader.read(4096):
            writer.write(data.upper())
        writer.close()
        await writer.wait_closed()

    async def run(end: asyncio.Event) -> None:
        server = await asyncio.start_server(shout, "127.0.0.1", 0)
        async with server:
            with TcpBridge(server.sockets[0].getsockname()[1]) as bridge:
                async with run_jobs(bridge.run()):
                    bridges.append((bridge, asyncio.get_running_loop()))
                    await end.wait()

    with background(run):
        until = time.monotonic() + 5
        while not bridges:
            assert time.monotonic() < until
            time.sleep(0.005)
        yield bridges[0]


def client(bridge: TcpBridge) -> socket.socket:
    return socket.create_connection(("127.0.0.1", bridge.client_port), timeout=5)


def test_messages_cross_both_ways_for_several_clients(background: Background) -> None:
    with bridged(background) as (bridge, _), client(bridge) as first, client(bridge) as second:
        first.sendall(b"one")
        second.sendall(b"two")
        assert second.recv(100) == b"TWO"
        assert first.recv(100) == b"ONE"


def test_an_unplugged_device_resets_its_connections_and_refuses_new_ones_until_it_is_back(
    background: Background,
) -> None:
    with bridged(background) as (bridge, loop):
        for _ in range(2):
            with client(bridge) as opened:
                opened.sendall(b"there")
                assert opened.recv(100) == b"THERE"
                loop.call_soon_threadsafe(bridge.unplug, True)
                with pytest.raises(ConnectionResetError):
                    opened.recv(100)
            with pytest.raises(ConnectionRefusedError):
                client(bridge)
            loop.call_soon_threadsafe(bridge.unplug, False)
            time.sleep(0.1)


def established() -> set[object]:
    return {(c.laddr, c.raddr) for c in psutil.Process().net_connections("tcp") if c.status == "ESTABLISHED"}


def test_a_client_that_hangs_up_ends_the_connection_to_the_device(background: Background) -> None:
    others = established()  # of tests before this one, in the same process
    with bridged(background) as (bridge, _):
        with client(bridge) as opened:
            opened.sendall(b"x")
            assert opened.recv(1) == b"X"
            assert established() - others
        until = time.monotonic() + 5
        while connections := established() - others:
            assert time.monotonic() < until, connections
            time.sleep(0.01)


def test_a_diverted_client_hears_another_device(background: Background) -> None:
    with bridged(background) as (bridge, _), client(bridge) as opened:
        bridge.divert(True)
        opened.sendall(b"\x00\x01\x00\x00\x00\x06\x01\x03\x00\x00\x00\x01")
        assert opened.recv(100).startswith(b"HTTP/1.1 400 ")
        bridge.divert(False)
        opened.sendall(b"x")
        assert opened.recv(100) == b"X"


def test_interference_befalls_what_crosses(background: Background) -> None:
    fault = Drop(kind="drop", on="motor", direction="to-device", count=1)
    with bridged(background) as (bridge, _), client(bridge) as opened:
        bridge.interference.begin(fault, np.random.default_rng(1))
        opened.sendall(b"lost")
        time.sleep(0.1)
        opened.sendall(b"found")
        assert opened.recv(100) == b"FOUND"
        assert bridge.interference.end(fault) == 1


def test_it_listens_on_the_loopback_alone(background: Background) -> None:
    with bridged(background) as (bridge, _):
        listening = [c.laddr for c in psutil.Process().net_connections("inet") if c.status == psutil.CONN_LISTEN]
        assert ("127.0.0.1", bridge.client_port) in listening
        assert {address.ip for address in listening} == {"127.0.0.1"}


def test_a_port_that_was_taken_meanwhile_is_named() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(RigError, match=rf"127\.0\.0\.1, TCP port {port}: cannot be listened at"):
            tcp_bridge._listener(port)
