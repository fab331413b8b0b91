"""The peers' side of the protocols, byte for byte against the documents' examples."""

import re
from pathlib import Path

import numpy as np
import pytest

from tests.peers.can_drive import CanDrive
from tests.peers.daq_board import frame, pack_int24
from tests.peers.drives import Acs355
from tests.peers.inverter import Inverter
from tests.peers.journal import Journal
from tests.peers.line_controller import LineController, crc

DOCS = Path(__file__).parents[2] / "docs"


def examples(page: str) -> list[bytes]:
    """The frames of docs/daq-stream.md."""
    blocks = re.findall(r"```\n([0-9a-f \n]+)```", (DOCS / page).read_text(encoding="utf-8"))
    return [bytes.fromhex(block.replace("\n", " ")) for block in blocks]


def test_daq_frames_are_those_of_the_document() -> None:
    two_scans, first, stopped, error, info = examples("daq-stream.md")
    counts = np.array([[1, -2], [8388607, -8388608]])
    head = (7).to_bytes(4, "little") + (1400).to_bytes(8, "little") + b"\x02\x00\x02"
    assert frame(2, head + pack_int24(counts), flags=1) == two_scans
    assert frame(2, bytes(12) + b"\x01\x00\x03" + pack_int24(np.array([[0, -1, 100]]))) == first
    assert frame(3, (1402).to_bytes(8, "little")) == stopped
    assert frame(0x7F, b"want ID?, START or STOP") == error
    assert frame(1, b'{"protocol": 1}') == info


def line(text: str) -> bytes:
    """A request with its CRC."""
    body = text.encode("ascii")
    return body + b"*%04X\n" % crc(body)


def test_the_line_protocol_of_the_document_is_spoken(inverter: Inverter) -> None:
    said: list[bytes] = []
    controller = LineController(inverter)
    hear = controller.connect(said.append)
    hear(line(">09 STATE"))
    assert said == []  # after power-up, every request but ID and STOP is late
    hear(line(">00 ID"))
    hear(line(">01 WATCHDOG 2000"))
    assert said[1] == b"<01 OK 2000*D0B2\n"
    hear(line(">02 SPEED 120000 3000"))
    hear(line(">02 SPEED 120000 3000"))
    assert said[2:] == [b"<02 OK*858B\n"] * 2
    assert inverter.target == 1200.0
    assert inverter.up == 30.0
    hear(line(">01 STATE"))
    hear(b">03 STATE*0000\n")
    assert len(said) == 4  # late, damaged
    hear(b"noise" + line(">03 STOP EMERGENCY") + line(">04 SPEED 500000 3000"))
    assert said[4] == line("<03 OK")
    assert said[5].startswith(b"<04 ERR limit speed 500000")


def test_an_acs355_is_enabled_as_its_manual_says(inverter: Inverter) -> None:
    drive = Acs355(inverter)
    values = dict(drive.initial)

    def write(address: int, value: int) -> int:
        assert drive.write(address, value, values) is None
        values[address] = value
        drive.refresh(values)
        return values[3]

    write(1, 10000)  # half of 1105, 60 Hz
    assert write(0, 0x47F) & 0x47 == 0x40  # switching on is inhibited
    assert not inverter.on
    assert write(0, 0x476) & 0x47 == 0x01  # ready to switch on
    assert write(0, 0x477) & 0x07 == 0x03  # ready to operate
    assert write(0, 0x47F) & 0x07 == 0x07
    assert inverter.target == pytest.approx(1800.0)
    write(0, 0x47D)  # OFF2: coasts, and switching on is inhibited
    assert not inverter.on
    assert values[3] & 0x50 == 0x40


def test_a_cia_402_drive_goes_through_its_states(inverter: Inverter, journal: Journal) -> None:
    said: list[bytes] = []
    drive = CanDrive(inverter, journal)
    hear = drive.connect(said.append)

    def exchange(data: str) -> bytes:
        said.clear()
        hear(b"t6018" + data.encode() + b"\r")
        return bytes.fromhex(said[-1].strip()[5:].decode())

    def status() -> int:
        return int.from_bytes(exchange("4041600000000000")[4:6], "little") & 0x6F

    assert status() == 0x40
    for controlword, wanted in ((0x06, 0x21), (0x07, 0x23), (0x7F, 0x27)):
        assert exchange(f"2B406000{controlword:02X}000000")[0] == 0x60
        assert status() == wanted
    exchange("2B4260002C010000")
    assert inverter.target == 300.0
    inverter.advance(1.0)
    assert inverter.output > 0
    for backward, sign in ((False, 1), (True, -1)):
        inverter.switches.backward = backward
        actual = int.from_bytes(exchange("4044600000000000")[4:6], "little", signed=True)
        assert actual == sign * round(inverter.output)
    exchange("2B40600000000000")  # disable voltage
    assert status() == 0x40
    assert not inverter.on
    assert exchange("4000200000000000")[0] == 0x80  # no such object
    drive.bus.shutdown()
