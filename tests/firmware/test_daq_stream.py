"""The reference encoder of docs/daq-stream.md in C: its bytes are the document's, and the driver understands them."""

import ctypes
import itertools
import re
import shutil
import subprocess
import time
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import serial
from numpy.typing import NDArray

from rotorrig.rig.probes.stream.daq import StreamDaq
from rotorrig.rig.probes.stream.frames import Complaint, Data, Frame, FrameDecoder, Info, Stopped

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "firmware" / "daq_stream"
COMPILER = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-O2"]


class Stream(ctypes.Structure):
    _fields_ = [
        ("sequence", ctypes.c_uint32),
        ("scan", ctypes.c_uint64),
        ("channels", ctypes.c_uint8),
        ("lost", ctypes.c_bool),
    ]


class Encoder:
    """The compiled daq_stream.c."""

    def __init__(self, library: Path) -> None:
        self.c = ctypes.CDLL(str(library))
        for name in ("data", "info", "stopped", "error"):
            getattr(self.c, f"daq_stream_{name}").restype = ctypes.c_size_t
        self.c.daq_crc32.restype = ctypes.c_uint32
        self.stream = Stream()

    def begin(self, channels: int) -> None:
        self.c.daq_stream_begin(ctypes.byref(self.stream), ctypes.c_uint8(channels))

    def data(self, counts: NDArray[np.int32], *, room: int = 70_000) -> bytes:
        out = ctypes.create_string_buffer(room)
        length = self.c.daq_stream_data(
            ctypes.byref(self.stream),
            np.ascontiguousarray(counts, dtype=np.int32).ctypes.data_as(ctypes.c_void_p),
            ctypes.c_uint16(len(counts)),
            out,
            ctypes.c_size_t(room),
        )
        return out.raw[:length]

    def lose(self, scans: int) -> None:
        self.c.daq_stream_lose(ctypes.byref(self.stream), ctypes.c_uint64(scans))

    def stopped(self) -> bytes:
        out = ctypes.create_string_buffer(64)
        length = self.c.daq_stream_stopped(ctypes.byref(self.stream), out, ctypes.c_size_t(64))
        return out.raw[:length]

    def text(self, kind: str, text: str, *, room: int = 70_000) -> bytes:
        out = ctypes.create_string_buffer(room)
        length = getattr(self.c, f"daq_stream_{kind}")(text.encode(), out, ctypes.c_size_t(room))
        return out.raw[:length]


def compiled(*arguments: str | Path) -> None:
    if COMPILER is None:
        pytest.skip("no C compiler here (cc, gcc or clang) to build the encoder with")
    done = subprocess.run([COMPILER, *STRICT, *map(str, arguments)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("firmware") / "daq_stream.so"
    compiled("-shared", "-fPIC", "-o", path, SOURCES / "daq_stream.c")
    return path


@pytest.fixture
def encoder(library: Path) -> Encoder:
    return Encoder(library)


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("firmware") / "example"
    compiled("-o", path, SOURCES / "daq_stream.c", SOURCES / "example.c")
    return path


@pytest.fixture(scope="module")
def printed() -> list[bytes]:
    """The example frames of the document, in its order."""
    text = (ROOT / "docs" / "daq-stream.md").read_text()
    return [bytes.fromhex(block) for block in re.findall(r"```\n(a5 5a [0-9a-f\s]+)```", text)]


def fed(data: bytes) -> list[Frame]:
    decoder = FrameDecoder()
    frames = decoder.feed(data)
    assert (decoder.bad_frames, decoder.skipped_bytes, decoder.pending) == (0, 0, 0)
    return frames


def test_every_frame_of_the_document_comes_out_byte_for_byte(encoder: Encoder, printed: list[bytes]) -> None:
    after_overrun, first, stopped, error, info = printed
    encoder.begin(3)
    assert encoder.data(np.array([[0, -1, 100]])) == first
    encoder.begin(2)
    for _ in range(7):
        encoder.data(np.zeros((100, 2)))
    encoder.lose(700)
    assert encoder.data(np.array([[1, -2], [8388607, -8388608]])) == after_overrun
    assert encoder.stopped() == stopped
    assert encoder.text("error", "want ID?, START or STOP") == error
    assert encoder.text("info", '{"protocol": 1}') == info


def test_the_driver_reads_every_frame_of_the_document(printed: list[bytes]) -> None:
    after_overrun, first, *others = fed(b"".join(printed))
    assert isinstance(after_overrun, Data)
    assert isinstance(first, Data)
    assert (after_overrun.sequence, after_overrun.first_scan, after_overrun.overrun) == (7, 1400, True)
    assert after_overrun.counts.tolist() == [[1, -2], [8388607, -8388608]]
    assert (first.sequence, first.first_scan, first.overrun, first.counts.tolist()) == (0, 0, False, [[0, -1, 100]])
    assert others == [Stopped(1402), Complaint("want ID?, START or STOP"), Info(b'{"protocol": 1}')]


def test_the_crc_is_zlibs_in_one_piece_or_several(encoder: Encoder, rng: np.random.Generator) -> None:
    data = rng.bytes(1000)
    assert encoder.c.daq_crc32(0, data, ctypes.c_size_t(1000)) == zlib.crc32(data)
    half = encoder.c.daq_crc32(0, data[:300], ctypes.c_size_t(300))
    assert encoder.c.daq_crc32(ctypes.c_uint32(half), data[300:], ctypes.c_size_t(700)) == zlib.crc32(data)


def test_the_driver_reads_the_counts_that_went_in(encoder: Encoder, rng: np.random.Generator) -> None:
    counts = rng.integers(-(2**23), 2**23, (500, 8)).astype(np.int32)
    encoder.begin(8)
    (frame,) = fed(encoder.data(counts))
    assert isinstance(frame, Data)
    np.testing.assert_array_equal(frame.counts, counts)


def test_counts_beyond_24_bits_are_cut_to_them(encoder: Encoder) -> None:
    encoder.begin(2)
    (frame,) = fed(encoder.data(np.array([[2**31 - 1, -(2**31)]])))
    assert isinstance(frame, Data)
    assert frame.counts.tolist() == [[2**23 - 1, -(2**23)]]


def test_lost_samples_are_flagged_once_and_indexed(encoder: Encoder) -> None:
    encoder.begin(1)
    sent = [encoder.data(np.zeros((10, 1)))]
    encoder.lose(5)
    encoder.lose(5)
    sent += [encoder.data(np.zeros((10, 1))) for _ in range(2)]
    frames = [f for f in fed(b"".join(sent)) if isinstance(f, Data)]
    assert [(f.sequence, f.first_scan, f.overrun) for f in frames] == [(0, 0, False), (1, 20, True), (2, 30, False)]


def test_the_sequence_number_wraps(encoder: Encoder) -> None:
    encoder.begin(1)
    encoder.stream.sequence = 2**32 - 1
    frames = fed(encoder.data(np.zeros((1, 1))) + encoder.data(np.zeros((1, 1))))
    assert [f.sequence for f in frames if isinstance(f, Data)] == [2**32 - 1, 0]


def test_what_does_not_fit_is_refused_and_changes_nothing(encoder: Encoder) -> None:
    encoder.begin(8)
    assert encoder.data(np.zeros((10, 8)), room=10 + 15 + 240 - 1) == b""
    assert encoder.data(np.zeros((2731, 8)), room=70_000) == b""  # 65559 bytes of payload
    assert len(encoder.data(np.zeros((2730, 8)), room=70_000)) == 10 + 65535
    assert (encoder.stream.sequence, encoder.stream.scan) == (1, 2730)
    assert encoder.text("error", "x" * 54, room=63) == b""


def test_commands_are_heard_line_by_line(encoder: Encoder) -> None:
    line = ctypes.create_string_buffer(64)  # a zeroed daq_line, with room to spare
    text = b"ID?\nSTART\nSTOP\nSTOP\r\n" + b"S" * 40 + b"\nid?\n\nID?\n"
    heard = [encoder.c.daq_hear(line, ctypes.c_char(bytes([b]))) for b in text]
    none, ask, start, stop, unknown = range(5)
    assert [h for h in heard if h != none] == [ask, start, stop, unknown, unknown, unknown, unknown, ask]


def test_the_example_writes_a_whole_stream(example: Path) -> None:
    arguments = ["--seconds", "1", "--rate", "5000", "--channels", "3", "--lose", "1000", "250"]
    *data, stopped = fed(subprocess.run([example, *arguments], capture_output=True, timeout=20, check=True).stdout)
    frames = [f for f in data if isinstance(f, Data)]
    assert stopped == Stopped(frames[-1].first_scan + 50)
    (overrun,) = (f for f in frames if f.overrun)
    assert overrun.first_scan == 1250
    assert sum(len(f.counts) for f in frames) == stopped.scans - 250


@contextmanager
def served(example: Path, *arguments: str) -> Iterator[str]:
    with subprocess.Popen([example, "--pty", *arguments], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout
        yield process.stdout.readline().strip()
        process.terminate()


def test_the_driver_and_the_example_talk_over_a_pty(example: Path) -> None:
    with (
        served(example, "--rate", "10000", "--channels", "3", "--seconds", "20") as port,
        StreamDaq(port, sample_rate=10_000.0, channels=3) as daq,
    ):
        assert daq.open().model == "reference encoder"
        for _ in range(2):
            daq.start()
            blocks = list(itertools.islice(iter(daq.read, None), 50))
            daq.stop()
            scans = np.concatenate([b.counts for b in blocks])
            np.testing.assert_array_equal(scans[:, 2], np.arange(len(scans)) + 2 - 0x400000)
            assert (daq.counters.samples, daq.counters.gaps) == (len(scans), 0)


def test_the_example_drops_what_is_not_sent_when_it_is_stopped(example: Path) -> None:
    with served(example, "--seconds", "20") as path, serial.Serial(path, timeout=1.0) as port:
        port.write(b"START\n")
        time.sleep(0.3)  # its queue fills
        port.write(b"ID?\nSTOP\n")
        time.sleep(0.1)
        *data, info, stopped = fed(port.read(1 << 20))
        assert len(data) < 10
    assert isinstance(info, Info)
    assert isinstance(stopped, Stopped)
    assert stopped.scans > 0.25 * 50_000


def test_a_host_that_does_not_read_is_told_what_it_missed(example: Path) -> None:
    with (
        served(example, "--rate", "50000", "--channels", "8", "--seconds", "20", "--ram", "128") as port,
        StreamDaq(port, sample_rate=50_000.0, channels=8) as daq,
    ):
        daq.open()
        daq.start()
        first = daq.read()
        time.sleep(1.5)  # the queue holds half a second of these frames, the board a tenth
        blocks = [first]
        while not blocks[-1].overrun:
            blocks.append(daq.read())
        counters = daq.counters
    assert (counters.gaps, counters.overruns, counters.lost_frames) == (1, 1, 0)
    assert counters.lost_samples == blocks[-1].first_sample - blocks[-2].first_sample - len(blocks[-2].counts) > 0
    expected = ((blocks[-1].first_sample + 1) & 0x7FFFFF) - 0x400000
    assert blocks[-1].counts[0, 1] == expected  # the samples after the gap are those of their index
