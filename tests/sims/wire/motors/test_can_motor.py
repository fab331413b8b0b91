"""The drive as a CANopen node: frames of CiA 301 on an slcan line over a real tty."""

import asyncio
import math
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any

import can
import canopen
import pytest
import serial
from canopen.profiles.p402 import BaseNode402

from rotorrig.rig.clock import WallClock
from rotorrig.sims.wire.cables.pty_bridge import PtyBridge
from rotorrig.sims.wire.motors.can_motor import Node, serve_slcan
from rotorrig.sims.wire.motors.cia402 import Cia402

RPM = math.pi / 30
NODE = 5


@pytest.fixture
def device(plant: Any) -> Cia402:
    return Cia402(plant, max_speed=4200 * RPM, rpm_per_unit=1.0, clock=WallClock())


Serving = Callable[[], AbstractContextManager[serial.Serial]]


@pytest.fixture
def slcan(device: Cia402, background: Any) -> Serving:
    """An open adapter on a tty."""

    @contextmanager
    def start() -> Iterator[serial.Serial]:
        with serving(device, background) as port, serial.Serial(port, timeout=2.0) as line:
            line.write(b"S6\rO\r")
            assert line.read(2) == b"\r\r"
            yield line

    return start


@contextmanager
def serving(device: Cia402, background: Any) -> Iterator[str]:
    """Serve the drive on a tty; yields the other end."""
    ports: list[str] = []

    async def job(end: asyncio.Event) -> None:
        with PtyBridge() as cable:
            carrying = asyncio.create_task(cable.run())
            async with serve_slcan(device, port=cable.device_port, node=NODE):
                ports.append(cable.client_port)
                await end.wait()
            carrying.cancel()
            await asyncio.wait([carrying])

    with background(job):
        _wait(lambda: ports)
        yield ports[0]


def ask(line: serial.Serial, request: str) -> str:
    """Send an SDO request's hex, return the answer's; the adapter's own carriage return comes before it."""
    line.write(b"t6058" + request.replace(" ", "").encode() + b"\r")
    assert line.read(1) == b"\r"
    answer = line.read_until(b"\r")
    assert answer[:5] == b"t5858"
    return bytes.fromhex(answer[5:-1].decode()).hex(" ")


def test_objects_are_read_and_written_by_sdo(slcan: Serving, plant: Any) -> None:
    with slcan() as line:
        assert ask(line, "40 00 10 00 00 00 00 00") == "43 00 10 00 92 01 01 00"  # device type 402
        assert ask(line, "40 41 60 00 00 00 00 00") == "4b 41 60 00 50 02 00 00"  # switch on disabled
        assert ask(line, "2f 60 60 00 02 00 00 00") == "60 60 60 00 00 00 00 00"
        for word in ("06", "07", "7f"):
            assert ask(line, f"2b 40 60 00 {word} 00 00 00") == "60 40 60 00 00 00 00 00"
        assert ask(line, "2b 42 60 00 58 02 00 00") == "60 42 60 00 00 00 00 00"  # 600 rpm
        assert ask(line, "40 41 60 00 00 00 00 00") == "4b 41 60 00 37 02 00 00"  # enabled, on its way
    assert plant.commands[-1][0] == pytest.approx(600 * RPM)


@pytest.mark.parametrize(
    ("request_", "code"),
    [
        ("40 00 20 00 00 00 00 00", "00 00 02 06"),  # no such object
        ("40 46 60 09 00 00 00 00", "11 00 09 06"),  # no such subindex
        ("2b 41 60 00 00 00 00 00", "02 00 01 06"),  # read-only
        ("2b 42 60 00 ff ff 00 00", "32 00 09 06"),  # too low: reverse
        ("2f 42 60 00 01 00 00 00", "10 00 07 06"),  # one byte for two
    ],
)
def test_what_it_cannot_do_is_aborted_with_the_code_of_the_standard(slcan: Serving, request_: str, code: str) -> None:
    with slcan() as line:
        assert ask(line, request_) == f"80 {request_[3:11]} {code}"


def test_frames_for_others_and_cut_ones_are_met_with_silence(slcan: Serving) -> None:
    with slcan() as line:
        for frame in (b"t60684041600000000000", b"t605440416000", b"t0000", b"t7010", b"t08580000000000000000"):
            line.write(frame + b"\r")
            assert line.read(1) == b"\r"
        assert ask(line, "40 41 60 00 00 00 00 00") == "4b 41 60 00 50 02 00 00"


def test_a_trip_is_an_emergency_message(slcan: Serving, device: Cia402) -> None:
    with slcan() as line:
        device.drive.trip(0x3210)
        assert line.read_until(b"\r") == b"t08581032010000000000\r"  # code, error register, five bytes of its own


def test_a_lost_heartbeat_is_an_emergency_and_leaves_operational(slcan: Serving, device: Cia402) -> None:
    with slcan() as line:
        line.write(b"t00020105\r")  # NMT: start node 5
        assert line.read(1) == b"\r"
        ask(line, "2b 07 60 00 02 00 00 00")
        assert ask(line, "23 16 10 01 64 00 7f 00") == "60 16 10 01 00 00 00 00"  # node 127, 100 ms
        line.write(b"t77F105\r")
        assert line.read(1) == b"\r"
        assert line.read_until(b"\r") == b"t08583081110000000000\r"
        line.write(b"t77F105\r")
        assert line.read(1) == b"\r"
        assert line.read_until(b"\r") == b"t08580000000000000000\r"  # no error


def test_it_says_that_it_has_booted(device: Cia402) -> None:
    node = Node(device, NODE)
    sent: list[tuple[int, bytes]] = []
    node.transmit = lambda can_id, data: sent.append((can_id, bytes(data)))

    async def boot() -> None:
        async with node.alive():
            pass

    asyncio.run(boot())
    assert sent[0] == (0x700 + NODE, b"\x00")


def test_a_master_of_another_make_drives_it(device: Cia402, plant: Any, background: Any) -> None:
    with (
        serving(device, background) as port,
        can.Bus(interface="slcan", channel=port, bitrate=500_000, sleep_after_open=0) as bus,
    ):
        network = canopen.Network(bus)
        network.NOTIFIER_CYCLE = 0.1
        network.connect()
        try:
            node = BaseNode402(NODE, canopen.ObjectDictionary())
            network.add_node(node)
            assert node.sdo.upload(0x1008, 0) == b"CiA 402 bench inverter"
            node.sdo.download(0x6060, 0, b"\x02")
            for word in (0x06, 0x07, 0x7F):
                node.sdo.download(0x6040, 0, word.to_bytes(2, "little"))
            node.sdo.download(0x6042, 0, (900).to_bytes(2, "little"))
            with pytest.raises(canopen.SdoAbortedError, match="0x06090031"):
                node.sdo.download(0x6046, 2, (9999).to_bytes(4, "little"))
        finally:
            network.notifier.stop()
    assert plant.commands[-1] == (pytest.approx(900 * RPM), pytest.approx(420 * RPM), True)


def _wait(condition: Callable[[], Any], seconds: float = 5.0) -> None:
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until, "nothing happened"
        time.sleep(0.005)
