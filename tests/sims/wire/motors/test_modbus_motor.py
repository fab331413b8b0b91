"""Byte by byte: Modbus Application Protocol V1.1b3, Modbus over Serial Line V1.02, registers as in the manuals."""

import contextlib
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
import serial
from pymodbus.client import ModbusSerialClient

from tests.sims.wire.served_inverter import served


def crc(frame: bytes) -> bytes:
    """Modbus over Serial Line V1.02, section 6.2.2, bit by bit; low byte first."""
    register = 0xFFFF
    for byte in frame:
        register ^= byte
        for _ in range(8):
            register = (register >> 1) ^ 0xA001 if register & 1 else register >> 1
    return register.to_bytes(2, "little")


@contextmanager
def line(port: str) -> Iterator[serial.Serial]:
    with serial.Serial(port, 19200, timeout=2.0) as opened:
        yield opened


def ask(opened: serial.Serial, request: str, size: int) -> str:
    """Send the hex of a request less its CRC, return the hex of the answer less its checked CRC."""
    frame = bytes.fromhex(request)
    opened.write(frame + crc(frame))
    answer = opened.read(size)
    assert len(answer) == size, f"got {answer.hex(' ')}"
    assert crc(answer[:-2]) == answer[-2:]
    return answer[:-2].hex(" ")


def test_the_checksum_is_that_of_the_specification() -> None:
    assert crc(bytes.fromhex("02 07")).hex(" ") == "41 12"  # its worked example


def test_a_drive_at_rest_is_ready_forward_and_controlled_by_the_network(emulating: Any) -> None:
    with emulating(rate=20.0) as (port, _), line(port) as opened:
        # read 4 registers from 8448: bits 0, 2, 3, 9, 10; no fault; no frequency
        assert ask(opened, "64 03 21 00 00 04", 13) == "64 03 08 06 0d 00 00 00 00 00 00"


@pytest.mark.parametrize(
    ("request_", "answer"),
    [
        ("64 03 00 07 00 01", "64 83 02"),  # read of a register the drive has not
        ("64 03 21 00 00 05", "64 83 02"),  # of one too many
        ("64 06 21 00 00 01", "64 86 02"),  # write to the status, read-only
        ("64 06 20 01 1b 59", "64 86 03"),  # reference 70.01 Hz, above P035 of 70.00
        ("64 06 00 25 00 02", "64 86 03"),  # P037 DC brake
        ("64 06 20 00 00 22", "64 86 03"),  # start in reverse
        ("64 04 21 00 00 01", "64 84 01"),  # function 04
        ("64 01 00 00 00 01", "64 81 01"),  # function 01
        ("64 10 20 00 00 02 04 00 12 ff ff", "64 90 03"),  # start and reference together, the latter too high
    ],
)
def test_what_the_drive_cannot_do_is_answered_by_the_exception_of_the_specification(
    emulating: Any, plant: Any, request_: str, answer: str
) -> None:
    with emulating(rate=20.0) as (port, _), line(port) as opened:
        assert ask(opened, request_, 5) == answer
    assert plant.commands == []


def test_writes_are_echoed_and_reach_the_plant(emulating: Any, plant: Any) -> None:
    with emulating(rate=20.0) as (port, _), line(port) as opened:
        assert ask(opened, "64 06 00 27 03 e8", 8) == "64 06 00 27 03 e8"  # P039 = 10.00 s to 70 Hz
        assert ask(opened, "64 06 20 01 07 d0", 8) == "64 06 20 01 07 d0"  # 20.00 Hz
        assert ask(opened, "64 06 20 00 00 12", 8) == "64 06 20 00 00 12"  # start, forward
    setpoint, ramp, powered = plant.commands[0]
    # 20 Hz of a two-pole motor are 1200 rpm; 70 Hz in 10 s are 420 rpm/s
    assert (setpoint, ramp, powered) == (pytest.approx(125.66370614), pytest.approx(43.98229715), True)


def test_start_and_reference_may_come_in_one_frame(emulating: Any, plant: Any) -> None:
    with emulating(rate=20.0) as (port, _), line(port) as opened:
        assert ask(opened, "64 10 20 00 00 02 04 00 12 07 d0", 8) == "64 10 20 00 00 02"
    assert plant.commands[-1][0] == pytest.approx(125.66370614)


def test_a_broadcast_is_obeyed_and_not_answered(emulating: Any) -> None:
    with emulating(rate=20.0) as (port, _), line(port) as opened:
        frame = bytes.fromhex("00 06 20 01 07 d0")
        opened.write(frame + crc(frame))
        time.sleep(0.1)
        assert opened.in_waiting == 0
        assert ask(opened, "64 03 20 01 00 01", 7) == "64 03 02 07 d0"


@pytest.mark.parametrize(
    "noise",
    [
        "65 03 21 00 00 01",  # a request to another node, whole
        "64 03 21 00 00 01 00 00",  # a wrong checksum
        "00 ff 64 7e",  # no frame
        "64 10 20 00",  # a frame that was cut
    ],
)
def test_the_drive_is_silent_to_what_is_not_for_it_and_hears_the_next_request(emulating: Any, noise: str) -> None:
    frame = bytes.fromhex(noise)
    with emulating(rate=20.0) as (port, _), line(port) as opened:
        opened.write(frame + (crc(frame) if frame[0] == 0x65 else b""))
        time.sleep(0.1)
        assert opened.in_waiting == 0
        assert ask(opened, "64 03 21 00 00 01", 7) == "64 03 02 06 0d"


def test_a_client_of_another_make_drives_the_rotor_up_and_lets_it_coast(emulating: Any, plant: Any) -> None:
    with emulating(rate=20.0) as (port, _):
        client = ModbusSerialClient(port, baudrate=19200, timeout=1.0)
        assert client.connect()
        with contextlib.closing(client):
            client.write_registers(39, [350], device_id=100)  # 3.50 s to 70 Hz: 20 Hz/s
            client.write_registers(8192, [0x12, 1000], device_id=100)
            assert _wait(lambda: client.read_holding_registers(8448, device_id=100).registers[0] & 1 << 8)
            assert client.read_holding_registers(8451, device_id=100).registers == [1000]
            assert plant.speed == pytest.approx(62.8318530718)
            client.write_register(37, 1, device_id=100)
            client.write_register(8192, 1, device_id=100)
            assert client.read_holding_registers(8451, device_id=100).registers == [0]
            assert plant.speed > 30.0
            assert _wait(lambda: plant.speed == 0.0)


def _wait(condition: Any, seconds: float = 5.0) -> bool:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        if condition():
            return True
        time.sleep(0.01)
    return False


@pytest.mark.parametrize(
    ("profile", "request_", "answer"),
    [
        # Eaton MN04020003E, page 135: an ID that is not there, 2051, sent as 2050
        ("m-max", "01 06 08 02 00 01 eb aa", "01 86 02 c3 a1"),
        # Delta VFD-VL manual, page 4-90: the two frequencies, here of a drive at rest that was asked for 60.00 Hz
        ("vfd-ed", "01 03 21 02 00 02 6f f7", "01 03 04 17 70 00 00 fe 5c"),
    ],
)
def test_a_frame_printed_in_a_manual_is_answered_as_printed(profile: Any, request_: str, answer: str) -> None:
    with served(profile) as drive, line(drive.table.port) as opened:
        if profile == "vfd-ed":
            assert ask(opened, "01 06 20 01 17 70", 8) == "01 06 20 01 17 70"
        opened.write(bytes.fromhex(request_))
        assert opened.read(len(bytes.fromhex(answer))).hex(" ") == answer


def test_a_request_for_more_than_the_drive_sends_is_not_answered() -> None:
    # Eaton MN04020003E, page 135: "with an invalid data length (for example, reading of 12 registers)" no reply, F08
    with served("m-max") as drive, line(drive.table.port) as opened:
        frame = bytes.fromhex("01 03 08 34 00 0c")
        opened.write(frame + crc(frame))
        time.sleep(0.1)
        assert opened.in_waiting == 0
        assert ask(opened, "01 03 08 3e 00 01", 7) == "01 03 02 00 08"  # ID 2111, sent as 2110


def test_a_drive_in_disguise_answers_as_another() -> None:
    with served("powerflex400", address=100) as drive, line(drive.table.port) as opened:
        drive.disguise.answers_as = 7
        assert ask(opened, "64 03 20 01 00 01", 7) == "07 03 02 00 00"
        drive.disguise.answers_as = None
        assert ask(opened, "64 03 20 01 00 01", 7) == "64 03 02 00 00"


@contextmanager
def connected(port: int, host: str = "127.0.0.1") -> Iterator[socket.socket]:
    with socket.create_connection((host, port), timeout=2.0) as opened:
        yield opened


def ask_tcp(opened: socket.socket, request: str, size: int) -> str:
    opened.sendall(bytes.fromhex(request))
    answer = b""
    while len(answer) < size:
        part = opened.recv(size - len(answer))
        assert part, f"got {answer.hex(' ')}"
        answer += part
    return answer.hex(" ")


def test_a_drive_on_tcp_answers_with_the_transactions_number() -> None:
    # header: transaction, protocol 0, bytes that follow, unit
    with served("powerflex400", wire="tcp") as drive, connected(drive.table.tcp_port) as opened:
        assert ask_tcp(opened, "12 34 00 00 00 06 01 06 20 01 07 d0", 12) == "12 34 00 00 00 06 01 06 20 01 07 d0"
        assert ask_tcp(opened, "12 35 00 00 00 06 01 03 20 01 00 01", 11) == "12 35 00 00 00 05 01 03 02 07 d0"


def test_another_unit_is_behind_no_such_gateway() -> None:
    with served("powerflex400", wire="tcp") as drive, connected(drive.table.tcp_port) as opened:
        assert ask_tcp(opened, "00 01 00 00 00 06 05 03 20 01 00 01", 9) == "00 01 00 00 00 03 05 83 0b"


def test_a_frame_in_pieces_is_a_frame_on_tcp() -> None:
    with served("powerflex400", wire="tcp") as drive, connected(drive.table.tcp_port) as opened:
        opened.sendall(bytes.fromhex("00 01 00 00 00 06 01"))
        time.sleep(0.1)
        assert ask_tcp(opened, "03 20 01 00 01", 11) == "00 01 00 00 00 05 01 03 02 00 00"


def test_a_drive_on_tcp_cannot_be_reached_from_another_host() -> None:
    with served("powerflex400", wire="tcp") as drive:
        for other in ("127.0.0.2", *_own_addresses()):  # as a packet from elsewhere would be addressed
            with pytest.raises(OSError), connected(drive.table.tcp_port, other):
                pass


def _own_addresses() -> set[str]:
    infos = socket.getaddrinfo(socket.gethostname(), None, family=socket.AF_INET)
    return {str(info[4][0]) for info in infos} - {"127.0.0.1"}
