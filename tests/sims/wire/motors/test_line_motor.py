"""Line by line, as docs/motor-line.md has it; its worked examples are the expected bytes."""

import asyncio
import math
import re
import time
from collections.abc import Coroutine
from pathlib import Path
from typing import Any

import pytest
import serial
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rotorrig.rig.clock import WallClock
from rotorrig.sims.wire.cables.pty_bridge import PtyBridge
from rotorrig.sims.wire.motors import line_motor
from rotorrig.sims.wire.motors.line_motor import LineDevice
from tests.manual_clock import ManualClock
from tests.sims.wire.conftest import ToyPlant

RPM = math.pi / 30
SPEC = Path(__file__).parents[4] / "docs" / "motor-line.md"


def crc(text: str) -> str:
    """CRC-16/CCITT-FALSE by long division of the message, as a polynomial, followed by 16 zeros."""
    message = int.from_bytes(text.encode("ascii") + bytes(2), "big") ^ 0xFFFF << 8 * len(text)
    for bit in reversed(range(16, message.bit_length())):
        if message >> bit & 1:
            message ^= 0x11021 << bit - 16
    return f"{message:04X}"


def test_the_checksum_is_that_of_the_specification() -> None:
    assert crc("123456789") == "29B1"
    lines = re.findall(r"^([<>][0-9A-F]{2} [^*\n]*)\*([0-9A-F]{4})", SPEC.read_text(encoding="utf-8"), re.MULTILINE)
    assert len(lines) > 20
    assert [crc(text) for text, _ in lines] == [said for _, said in lines]


class Host:
    """Asks with checksums, numbers its requests, returns the checked reply's text."""

    def __init__(self, device: LineDevice, *, begins: bool = True) -> None:
        self.device, self.number = device, -1
        if begins:
            self.ask("ID")

    def ask(self, request: str, *, number: int | None = None) -> str:
        self.number = (self.number + 1) % 256 if number is None else number
        asked = f">{self.number:02X} {request}"
        reply = self.device.answer(f"{asked}*{crc(asked)}".encode()).decode()
        if not reply:
            return ""
        text, _, said = reply.rpartition("*")
        assert said == crc(text) + "\n"
        assert text[:4] == f"<{self.number:02X} "
        return text[4:]


@pytest.fixture
def device(plant: Any, clock: ManualClock) -> LineDevice:
    return LineDevice(plant, max_speed=4200 * RPM, clock=clock)


@pytest.fixture
def host(device: LineDevice) -> Host:
    return Host(device)


def test_it_goes_to_a_speed_at_a_ramp_and_says_how_far_it_is(host: Host, plant: Any) -> None:
    assert host.ask("SPEED 6000 3000") == "OK"  # 60 rpm at 30 rpm/s
    assert plant.commands == [(pytest.approx(60 * RPM), pytest.approx(30 * RPM), True)]
    plant.advance(1.0)
    assert host.ask("STATE") == "OK 3000 6000 ramping -"
    plant.advance(3.0)
    assert host.ask("STATE") == "OK 6000 6000 at-speed -"


@pytest.mark.parametrize(("kind", "ramp"), [("RAMP", 30), ("EMERGENCY", 4200)])
def test_stops_end_off(host: Host, device: LineDevice, plant: Any, kind: str, ramp: float) -> None:
    host.ask("SPEED 120000 3000")
    plant.advance(20.0)
    assert host.ask(f"STOP {kind}") == "OK"
    assert plant.commands[-1] == (0.0, pytest.approx(ramp * RPM), True)
    assert re.fullmatch(r"OK \d+ 0 stopping -", host.ask("STATE"))
    plant.advance(60.0)
    device.tick()
    assert host.ask("STATE") == "OK 0 0 off -"


def test_a_coasting_controller_has_its_output_off(host: Host, plant: Any) -> None:
    host.ask("SPEED 120000 3000")
    plant.advance(20.0)
    assert host.ask("STOP COAST") == "OK"
    assert plant.commands[-1][2] is False
    assert host.ask("STATE") == "OK 0 0 off -"


def test_a_stop_only_gets_harder(host: Host, plant: Any) -> None:
    host.ask("SPEED 120000 3000")
    plant.advance(20.0)
    host.ask("STOP EMERGENCY")
    host.ask("STOP RAMP")
    assert plant.commands[-1][1] == pytest.approx(4200 * RPM)


@pytest.mark.parametrize(
    ("request_", "reply"),
    [
        ("FLY", "ERR command"),
        ("SPEED 100", "ERR argument"),
        ("SPEED 100 -3", "ERR argument"),
        ("SPEED 1e3 100", "ERR argument"),
        ("SPEED 4294967296 100", "ERR argument"),
        ("SPEED  100 100", "ERR argument"),
        ("STOP SLOWLY", "ERR argument"),
        ("STATE now", "ERR argument"),
        ("SPEED 420001 3000", "ERR limit"),
        ("SPEED 100 0", "ERR limit"),
        ("SPEED 100 420001", "ERR limit"),
    ],
)
def test_what_cannot_be_done_is_answered_with_its_code_and_changes_nothing(
    host: Host, plant: Any, request_: str, reply: str
) -> None:
    assert host.ask(request_).startswith(reply + " ")
    assert plant.commands == []


def test_a_repetition_is_answered_byte_for_byte_and_not_done_again(host: Host, plant: Any) -> None:
    host.ask("SPEED 6000 3000")
    state = host.ask("STATE")
    plant.advance(1.0)
    assert host.ask("STATE", number=host.number) == state
    assert host.ask("SPEED 420000 3000", number=host.number) == state  # the number alone decides
    assert len(plant.commands) == 1


def test_a_late_request_is_dropped_and_a_late_stop_obeyed(host: Host, plant: Any) -> None:
    host.ask("SPEED 6000 3000", number=7)
    assert host.ask("SPEED 120000 3000", number=6) == ""
    assert host.ask("SPEED 120000 3000", number=7 + 128) == ""
    assert len(plant.commands) == 1
    assert host.ask("STOP COAST", number=6) == "OK"
    assert plant.commands[-1][2] is False
    assert host.ask("STATE", number=7) == "OK"  # the reply to the last request taken: a late stop is not


def test_numbers_go_round(host: Host) -> None:
    assert host.ask("STATE", number=100)
    assert host.ask("STATE", number=227)  # 127 ahead
    assert host.ask("STATE", number=98)


def test_before_the_first_id_it_takes_a_stop_and_nothing_else(device: LineDevice) -> None:
    fresh = Host(device, begins=False)
    assert fresh.ask("STATE") == ""
    assert fresh.ask("STOP RAMP") == "OK"
    assert fresh.ask("STATE") == ""
    assert fresh.ask("ID", number=0).startswith("OK 1 ")
    assert fresh.ask("STATE") != ""


@pytest.mark.parametrize("hosts_return", ["CLEAR", "ID"])
def test_silence_brings_the_rotor_to_rest_and_is_remembered(
    host: Host, device: LineDevice, plant: Any, clock: ManualClock, hosts_return: str
) -> None:
    assert host.ask("WATCHDOG 1500") == "OK 1500"
    host.ask("SPEED 6000 3000")
    plant.advance(2.0)
    clock.sleep(1.49)
    host.ask("STATE")
    clock.sleep(1.49)
    device.tick()
    assert device.drive.running
    clock.sleep(0.02)
    device.tick()
    assert plant.commands[-1] == (0.0, pytest.approx(4200 * RPM), True)
    assert host.ask("STATE") == "OK 6000 0 stopping no request for 1500 ms"
    assert host.ask("SPEED 6000 3000") == "ERR fault no request for 1500 ms"
    assert host.ask(hosts_return).startswith("OK")
    assert host.ask("SPEED 6000 3000") == "OK"


def test_a_watchdog_of_zero_never_acts_and_one_at_rest_has_nothing_to_do(
    host: Host, device: LineDevice, clock: ManualClock
) -> None:
    clock.sleep(1000.0)
    assert host.ask("STATE") == "OK 0 0 off -"
    host.ask("WATCHDOG 0")
    host.ask("SPEED 6000 3000")
    clock.sleep(1000.0)
    device.tick()
    assert device.drive.running


def test_a_trip_is_told_with_its_text(host: Host, device: LineDevice, plant: Any) -> None:
    host.ask("SPEED 6000 3000")
    device.drive.trip(3)
    assert plant.commands[-1][2] is False
    assert host.ask("STATE") == "OK 0 0 off over-temperature of the bridge"
    assert host.ask("SPEED 6000 3000") == "ERR fault over-temperature of the bridge"
    host.ask("ID")
    assert host.ask("STATE") == "OK 0 0 off over-temperature of the bridge"


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.text(st.characters(min_codepoint=0x20, max_codepoint=0x7E, exclude_characters="*<>"), max_size=60))
def test_whatever_is_asked_is_answered_ok_or_err_in_one_line(host: Host, text: str) -> None:
    answer = host.ask(text)
    assert answer.startswith(("OK", "ERR command ", "ERR argument ", "ERR limit "))
    assert len(answer) < 96 - len("<00 *0000")


@given(st.binary(max_size=200))
def test_other_bytes_are_met_with_silence(noise: bytes) -> None:
    assert LineDevice(ToyPlant(), max_speed=1.0, clock=ManualClock()).answer(noise) == b""


def serve(plant: Any, ports: list[str]) -> Any:
    async def job(end: asyncio.Event) -> None:
        device = LineDevice(plant, max_speed=4200 * RPM, clock=WallClock())
        with PtyBridge() as cable:
            carrying = asyncio.create_task(cable.run())
            async with line_motor.serve(device, port=cable.device_port):
                ports.append(cable.client_port)
                await end.wait()
            carrying.cancel()
            await asyncio.wait([carrying])

    return job


def wait_for_port(ports: list[str]) -> str:
    until = time.monotonic() + 5.0
    while not ports:
        assert time.monotonic() < until, "the emulator did not start"
        time.sleep(0.005)
    return ports[0]


@pytest.mark.parametrize(
    "noise",
    [
        b"",
        b"half a line >02 SPE",
        b">02 SPEED 120000 3000*B1BE\n",
        b"<02 OK*858B\n",
        b"\n\n>\n",
        b">02 " + b"A" * 300,
        bytes(range(256)),
    ],
)
def test_over_a_real_tty_noise_is_met_with_silence_and_the_next_request_is_heard(
    plant: Any, background: Any, noise: bytes
) -> None:
    ports: list[str] = []
    job: Coroutine[Any, Any, None] = serve(plant, ports)
    with background(job), serial.Serial(wait_for_port(ports), timeout=2.0) as line:
        line.write(b">00 ID*B8EA\r\n" + noise + b">05 STOP EMERGENCY*682F\n")
        assert line.readline() == b"<00 OK 1 420000 420000 output RK4 bench controller, rev B*8E01\n"
        assert line.readline() == b"<05 OK*D4A6\n"
