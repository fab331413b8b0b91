"""The slcan adapter, command by command as the Lawicel CAN232 manual lists them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotorrig.sims.wire.motors.slcan import Adapter


class Line:
    """Both sides of an adapter on a bus of 500 kbit/s."""

    def __init__(self) -> None:
        self.frames: list[tuple[int, bytes]] = []
        self.said = b""
        self.adapter = Adapter(bitrate=500_000, on_frame=lambda can_id, data: self.frames.append((can_id, data)))
        self.adapter.send = self._hear

    def ask(self, *commands: bytes) -> bytes:
        self.said = b""
        self.adapter.take(b"".join(commands))
        return self.said

    def _hear(self, data: bytes) -> None:
        self.said += data


@pytest.fixture
def line() -> Line:
    return Line()


def test_a_frame_goes_each_way_once_it_is_open(line: Line) -> None:
    assert line.ask(b"S6\r", b"O\r") == b"\r\r"
    assert line.ask(b"t60582b4060000f000000\r") == b"\r"
    assert line.frames == [(0x605, bytes.fromhex("2b4060000f000000"))]
    assert line.ask(b"t0002", b"0105\r") == b"\r"  # in two pieces
    assert line.frames[1] == (0, bytes.fromhex("0105"))
    line.said = b""
    line.adapter.deliver(0x77F, b"\x05")
    line.adapter.deliver(0x585, bytes.fromhex("6040600000000000"))
    assert line.said == b"t77F105\rt58586040600000000000\r"


@pytest.mark.parametrize(
    "command",
    [b"t60582b40\r", b"tXYZ0\r", b"t8000\r", b"t0009\r", b"S9\r", b"O\r", b"Q\r", b"t6051zz\r", b"\xff\xfe\r"],
)
def test_what_it_does_not_know_rings_the_bell(line: Line, command: bytes) -> None:
    line.ask(b"S6\r", b"O\r")
    assert line.ask(command) == b"\a"
    assert line.frames == []


def test_closed_it_carries_nothing(line: Line) -> None:
    assert line.ask(b"t0000\r") == b"\a"
    line.ask(b"S6\r", b"O\r", b"C\r")
    line.adapter.deliver(0x701, b"\x00")
    assert line.ask(b"t0000\r") == b"\a"
    assert line.frames == []


def test_at_another_bit_rate_it_carries_nothing(line: Line) -> None:
    line.ask(b"S4\r", b"O\r")
    line.ask(b"t0000\r")
    line.adapter.deliver(0x701, b"\x00")
    assert (line.frames, line.said) == ([], b"\r")


def test_it_says_what_it_is(line: Line) -> None:
    line.ask(b"S6\r", b"O\r")
    assert line.ask(b"V\r", b"N\r", b"F\r", b"\r") == b"V1013\rNA001\rF00\r\r"


def test_noise_before_a_command_costs_that_command_alone(line: Line) -> None:
    line.ask(b"S6\r", b"O\r")
    assert line.ask(b"x" * 1000 + b"t0000\r", b"t0000\r") == b"\a\r"


@given(st.lists(st.binary(max_size=40), max_size=5))
def test_no_bytes_upset_it(pieces: list[bytes]) -> None:
    line = Line()
    line.ask(b"S6\r", b"O\r")
    for piece in pieces:
        line.adapter.take(piece)
    assert all(0 <= can_id < 0x800 and len(data) <= 8 for can_id, data in line.frames)
    assert line.ask(b"\r", b"V\r")[-6:] == b"V1013\r"
