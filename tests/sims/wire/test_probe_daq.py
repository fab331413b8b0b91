"""The device side of docs/daq-stream.md, read by a decoder written here from that document."""

import json
import time
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import serial
from numpy.typing import NDArray

from rotorrig.sims.wire.probe_daq import Firmware

INFO, DATA, STOPPED, ERROR = 0x01, 0x02, 0x03, 0x7F


@dataclass(frozen=True)
class Frame:
    kind: int
    flags: int
    payload: bytes

    @property
    def sequence(self) -> int:
        return int.from_bytes(self.payload[0:4], "little")

    @property
    def index(self) -> int:
        return int.from_bytes(self.payload[4:12], "little")

    @property
    def counts(self) -> NDArray[np.int64]:
        scans, channels = int.from_bytes(self.payload[12:14], "little"), self.payload[14]
        raw = self.payload[15:]
        assert len(raw) == 3 * scans * channels
        values = [int.from_bytes(raw[i : i + 3], "little", signed=True) for i in range(0, len(raw), 3)]
        return np.array(values).reshape(scans, channels)


def decode(data: bytes) -> tuple[Frame, bytes]:
    """Return the frame at the beginning of `data` and what follows it."""
    assert data[:2] == b"\xa5\x5a"
    end = 6 + int.from_bytes(data[4:6], "little")
    assert int.from_bytes(data[end : end + 4], "little") == zlib.crc32(data[2:end])
    return Frame(data[2], data[3], data[6:end]), data[end + 4 :]


class Host:
    """A serial port and the frames that come out of it."""

    def __init__(self, port: serial.Serial) -> None:
        self.port = port

    def frame(self) -> Frame:
        head = self.port.read(6)
        assert len(head) == 6, f"got {head.hex(' ')}, then silence"
        frame, rest = decode(head + self.port.read(int.from_bytes(head[4:6], "little") + 4))
        assert not rest
        return frame

    def until(self, kind: int) -> Frame:
        while (frame := self.frame()).kind != kind:
            assert frame.kind == DATA
        return frame


@contextmanager
def host(port: str) -> Iterator[Host]:
    with serial.Serial(port, timeout=2.0) as opened:
        yield Host(opened)


def queued(firmware: Firmware) -> list[Frame]:
    frames = [decode(frame)[0] for frame in firmware.outbox]
    firmware.outbox.clear()
    return frames


def test_the_board_says_what_it_is(emulating: Any) -> None:
    with emulating(rate=20.0) as (_, port), host(port) as daq:
        daq.port.write(b"ID?\n")
        frame = daq.frame()
    assert (frame.kind, frame.flags) == (INFO, 0)
    said = json.loads(frame.payload)
    assert said.pop("model")
    assert said == {
        "protocol": 1,
        "serial": "T1",
        "sample_rate_hz": 1000.0,
        "channels": 3,
        "volts_per_count": [0.001, 0.002, 0.5],
        "full_scale_counts": 32768,
        "simulated": True,
    }


@pytest.mark.parametrize("line", [b"HELLO", b"", b"id?", b"ID?\r", b"\xff\xfe", 500 * b"x"])
def test_anything_but_the_three_commands_is_answered_by_one_error(plant: Any, line: bytes) -> None:
    firmware = Firmware(plant, serial="T1", waits=True)
    firmware.hear(line + b"\n")
    (frame,) = queued(firmware)
    assert frame.kind == ERROR
    assert "want ID?, START or STOP" in frame.payload.decode()


def test_a_line_that_never_ends_is_given_up(plant: Any) -> None:
    firmware = Firmware(plant, serial="T1", waits=True)
    for _ in range(65):
        firmware.hear(b"x")
    firmware.hear(b"ID?\n")
    assert [frame.kind for frame in queued(firmware)] == [ERROR, INFO]


def test_commands_may_come_in_pieces_or_together(plant: Any) -> None:
    firmware = Firmware(plant, serial="T1", waits=True)
    for piece in (b"I", b"D?", b"\nID?\nSTO", b"P\n"):
        firmware.hear(piece)
    assert [frame.kind for frame in queued(firmware)] == [INFO, INFO, STOPPED]


def test_counts_come_as_the_plant_gave_them_up_to_full_scale(plant: Any) -> None:
    extremes = np.array([[32767, -32768, 0], [-1, 1, 2**23 - 1]], dtype=np.int32)
    firmware = Firmware(plant, serial="T1", waits=True)
    firmware.hear(b"START\n")
    firmware.measure(np.tile(extremes, (10, 1)))
    (frame,) = queued(firmware)
    assert (frame.flags, frame.sequence, frame.index) == (0, 0, 0)
    np.testing.assert_array_equal(frame.counts, np.tile(extremes, (10, 1)))


def test_a_reader_that_pauses_loses_nothing_when_time_waits_for_it(emulating: Any) -> None:
    with emulating(rate=20.0) as (_, port), host(port) as daq:
        daq.port.write(b"START\n")
        first = daq.frame()
        time.sleep(0.5)  # far more than the line holds
        frames = [first] + [daq.frame() for _ in range(199)]
    assert [f.sequence for f in frames] == list(range(200))
    assert [f.index for f in frames] == list(range(0, 4000, 20))
    assert not any(f.flags for f in frames)
    scans = np.concatenate([f.counts for f in frames])
    np.testing.assert_array_equal(np.diff(scans[:, 0]) % 1000, 1)
    np.testing.assert_array_equal(scans[:, 1], -scans[:, 0])


def test_time_passes_no_faster_than_the_rate_allows(emulating: Any, plant: Any) -> None:
    with emulating(rate=10.0) as (_, port), host(port) as daq:
        daq.port.write(b"START\n")
        began, t = time.monotonic(), plant.t
        while time.monotonic() < began + 0.5:
            daq.frame()
        assert plant.t - t <= 10.0 * (time.monotonic() - began + 0.05)


def test_a_blocked_port_loses_samples_in_real_time_and_says_so(emulating: Any, plant: Any) -> None:
    plant.sample_rate = 20_000.0
    with emulating(rate=1.0) as (_, port), host(port) as daq:
        daq.port.write(b"START\n")
        frames = [daq.frame()]
        time.sleep(1.6)  # the board keeps 1 s, the line some 0.1 s
        while not frames[-1].flags:
            frames.append(daq.frame())
    assert [f.flags for f in frames] == [0] * (len(frames) - 1) + [1]
    assert [f.sequence for f in frames] == list(range(len(frames)))
    assert [f.index for f in frames[:-1]] == [400 * i for i in range(len(frames) - 1)]
    lost = frames[-1].index - 400 * (len(frames) - 1)
    assert 0.1 * 20_000 < lost < 1.0 * 20_000
    # the rotor did not wait: the counts after the gap are those of their index
    assert (frames[-1].counts[0, 0] - frames[0].counts[0, 0]) % 1000 == frames[-1].index % 1000


def test_a_board_keeps_exactly_one_second_for_its_reader(plant: Any) -> None:
    firmware = Firmware(plant, serial="T1", waits=False)
    firmware.hear(b"START\n")
    firmware.measure(plant.advance(2.0))
    kept = queued(firmware)
    firmware.measure(plant.advance(2.02))
    (after,) = queued(firmware)
    assert [f.index for f in kept] == list(range(0, 1000, 20))
    assert not any(f.flags for f in kept)
    assert (after.flags, after.sequence, after.index) == (1, 50, 2000)
    assert after.counts[0, 0] == 0


def test_stop_ends_the_stream_with_the_number_of_scans(emulating: Any) -> None:
    with emulating(rate=20.0) as (_, port), host(port) as daq:
        daq.port.write(b"START\n")
        seen = [daq.frame() for _ in range(10)]
        daq.port.write(b"STOP\n")
        while (frame := daq.frame()).kind == DATA:
            seen.append(frame)
        assert frame.kind == STOPPED
        produced = int.from_bytes(frame.payload, "little")
        assert produced >= seen[-1].index + 20
        time.sleep(0.1)
        assert daq.port.in_waiting == 0


def test_stop_drops_what_is_still_queued_and_counts_it(plant: Any) -> None:
    firmware = Firmware(plant, serial="T1", waits=False)
    firmware.hear(b"START\n")
    firmware.measure(plant.advance(0.5))
    firmware.hear(b"STOP\n")
    firmware.measure(plant.advance(1.0))
    (frame,) = queued(firmware)
    assert frame.kind == STOPPED
    assert int.from_bytes(frame.payload, "little") == 500


def test_start_while_streaming_begins_again_at_sample_zero(plant: Any) -> None:
    firmware = Firmware(plant, serial="T1", waits=False)
    firmware.hear(b"START\n")
    firmware.measure(plant.advance(0.130))
    firmware.hear(b"START\n")
    firmware.measure(plant.advance(0.170))
    frames = queued(firmware)
    assert [(f.sequence, f.index) for f in frames] == [(0, 0), (1, 20)]
    assert frames[0].counts[0, 0] == 130  # the first scan after the command, not one left over


def test_a_fast_board_keeps_its_frames_within_the_length_field(plant: Any) -> None:
    plant.sample_rate, plant.channels = 1e6, 16
    firmware = Firmware(plant, serial="T1", waits=True)
    firmware.hear(b"START\n")
    firmware.measure(np.zeros((3000, 16), dtype=np.int32))
    assert [f.index for f in queued(firmware)] == [0, 1365]  # (65535 - 15) // 48 scans


def test_the_motor_turns_while_nobody_streams_and_time_rests_with_the_rotor(emulating: Any, plant: Any) -> None:
    with emulating(rate=20.0):
        time.sleep(0.1)
        assert plant.t == 0.0
        plant.speed = 10.0  # coasts to rest in 1 s of its time
        time.sleep(0.5)
        assert plant.speed == pytest.approx(0.0, abs=1e-9)
        rested = plant.t
        time.sleep(0.1)
        assert 1.0 <= plant.t == rested
