"""Frames come out of any byte stream as docs/daq-stream.md says, whatever is between them and however it is cut."""

import itertools
import struct
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from rotorrig.rig.errors import BadFrame
from rotorrig.rig.probes.stream.frames import Complaint, Data, FrameDecoder, Info, Stopped, decode, decode_info
from tests.rig.wire_fakes import INFO, data_frame, error_frame, frame, info_frame, stopped_frame

INT24 = st.integers(-(1 << 23), (1 << 23) - 1)
COUNTS = hnp.arrays(np.int32, st.tuples(st.integers(1, 12), st.integers(1, 9)), elements=INT24)
RAMP = np.arange(40, dtype=np.int32).reshape(8, 5) * 1000 - 20_000


def fed(data: bytes, *, cuts: list[int] | None = None) -> tuple[list, FrameDecoder]:
    decoder = FrameDecoder()
    edges = [0, *sorted(c % (len(data) + 1) for c in cuts or []), len(data)]
    frames = [f for a, b in itertools.pairwise(edges) for f in decoder.feed(data[a:b])]
    return frames, decoder


def test_a_data_frame_written_by_hand_is_read() -> None:
    # sync, DATA, overrun, length 21; sequence 7, first scan 256, 1 scan, 2 channels; counts -2 and 8388607
    covered = bytes.fromhex("02 01 15 00  07 00 00 00  00 01 00 00 00 00 00 00  01 00  02  fe ff ff  ff ff 7f")
    crc = bytes.fromhex("7b 8e 45 f3")
    (got,) = fed(b"\xa5\x5a" + covered + crc)[0]
    assert (got.sequence, got.first_scan, got.overrun) == (7, 256, True)
    assert got.counts.tolist() == [[-2, 8388607]]
    assert got.counts.dtype == np.int32


@given(counts=COUNTS, sequence=st.integers(0, 2**32 - 1), first=st.integers(0, 2**64 - 1), overrun=st.booleans())
def test_what_is_encoded_is_decoded(counts: np.ndarray, sequence: int, first: int, overrun: bool) -> None:
    (got,), decoder = fed(data_frame(counts, sequence=sequence, first_scan=first, overrun=overrun))
    assert (got.sequence, got.first_scan, got.overrun) == (sequence, first, overrun)
    np.testing.assert_array_equal(got.counts, counts)
    assert (decoder.bad_frames, decoder.skipped_bytes, decoder.pending) == (0, 0, 0)


def test_the_other_frames_are_read() -> None:
    frames, _ = fed(info_frame() + stopped_frame(12345) + error_frame("no such line é"))
    assert isinstance(frames[0], Info)
    assert frames[1:] == [Stopped(12345), Complaint("no such line é")]


@given(cuts=st.lists(st.integers(0, 10_000), max_size=20))
def test_frames_do_not_depend_on_how_the_bytes_are_cut(cuts: list[int]) -> None:
    stream = b"".join(data_frame(RAMP + k, sequence=k, first_scan=8 * k) for k in range(5))
    frames, decoder = fed(stream, cuts=cuts)
    assert [f.sequence for f in frames] == [0, 1, 2, 3, 4]
    np.testing.assert_array_equal(
        np.concatenate([f.counts for f in frames]), np.concatenate([RAMP + k for k in range(5)])
    )
    assert decoder.bad_frames == decoder.skipped_bytes == 0


@given(junk=st.lists(st.binary(max_size=60), min_size=4, max_size=4), cuts=st.lists(st.integers(0, 10_000), max_size=6))
def test_garbage_between_frames_costs_no_frame_once_the_line_is_quiet(junk: list[bytes], cuts: list[int]) -> None:
    frames = [data_frame(RAMP, sequence=k, first_scan=8 * k) for k in range(3)]
    stream = b"".join(j + f for j, f in zip(junk, [*frames, b""], strict=True))
    got, decoder = fed(stream, cuts=cuts)
    while hidden := decoder.look_behind():
        got += hidden
    assert [f.sequence for f in got if isinstance(f, Data)] == [0, 1, 2]


@given(where=st.integers(0, 10_000), flip=st.integers(1, 255))
def test_one_damaged_byte_costs_its_frame_and_no_other(where: int, flip: int) -> None:
    frames = [data_frame(RAMP, sequence=k, first_scan=8 * k) for k in range(3)]
    stream = bytearray(b"".join(frames))
    hit = where % len(stream)
    stream[hit] ^= flip
    got, decoder = fed(bytes(stream))
    while hidden := decoder.look_behind():
        got += hidden
    damaged = hit // len(frames[0])
    assert [f.sequence for f in got] == [k for k in range(3) if k != damaged]


@given(cut=st.integers(1, 10_000))
def test_a_frame_whose_sender_pauses_is_waited_for(cut: int) -> None:
    whole = data_frame(RAMP, sequence=0, first_scan=0)
    at = 1 + cut % (len(whole) - 1)
    decoder = FrameDecoder()
    assert decoder.feed(whole[:at]) == decoder.look_behind() == []
    (frame,) = decoder.feed(whole[at:])
    assert isinstance(frame, Data) and frame.sequence == 0
    assert decoder.bad_frames == decoder.skipped_bytes == 0


@given(st.binary(max_size=2000))
def test_noise_is_never_taken_for_a_frame_nor_kept(noise: bytes) -> None:
    frames, decoder = fed(noise)
    assert frames == []
    assert decoder.skipped_bytes + decoder.pending == len(noise)


def test_a_false_sync_inside_counts_is_passed_over() -> None:
    counts = np.full((4, 1), int.from_bytes(b"\xa5\x5a\x02", "little", signed=True), dtype=np.int32)
    whole = data_frame(counts, sequence=0, first_scan=0)
    frames, _ = fed(whole[5:] + data_frame(counts, sequence=1, first_scan=4))  # joined in the middle of a frame
    assert [f.sequence for f in frames] == [1]


def test_a_wrong_header_does_not_hold_up_what_follows() -> None:
    bait = b"\xa5\x5a\x02\x00\xfe\xff"  # 65534 is no length a DATA frame can have: 15 + 3 n
    frames, _ = fed(bait + stopped_frame(1))
    assert frames == [Stopped(1)]


def test_a_damaged_length_does_not_hold_up_what_follows() -> None:
    longer = bytearray(data_frame(RAMP, sequence=0, first_scan=0))
    longer[5] = 0x60  # as if 24 kB of counts were to come
    frames, decoder = fed(bytes(longer) + data_frame(RAMP, sequence=1, first_scan=8))
    assert [f.sequence for f in frames] == [1]
    assert (decoder.bad_frames, decoder.skipped_bytes, decoder.pending) == (1, len(longer), 0)


def test_memory_stays_below_two_frames_whatever_comes() -> None:
    decoder = FrameDecoder()
    bait = b"\xa5\x5a\x01\x00\xff\xff"  # an INFO of 65535 bytes that never ends well
    tracemalloc.start()
    for _ in range(20):
        decoder.feed(bait * 700)  # 84 kB in all
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert decoder.pending <= 6 + 65535 + 4
    assert peak < 1e6


def test_a_frame_that_contradicts_itself_is_bad() -> None:
    two_scans_announced = struct.pack("<IQHB", 0, 0, 2, 1) + b"\0\0\0"
    with pytest.raises(BadFrame, match=r"got 3 bytes of counts, want 6 for 2 scans of 1 channels"):
        decode(frame(0x02, two_scans_announced))
    frames, decoder = fed(frame(0x02, two_scans_announced))
    assert (frames, decoder.bad_frames) == ([], 1)


def test_a_bad_crc_is_said_with_the_bytes() -> None:
    damaged = bytearray(stopped_frame(1))
    damaged[-1] ^= 1
    with pytest.raises(BadFrame, match=r"a5 5a 03 00 08 00 01 .*want it to match the contents"):
        decode(bytes(damaged))


def test_info_is_read() -> None:
    (got,), _ = fed(info_frame(volts_per_count=[1e-3, 2e-3, 3e-3, 4e-3, 5]))
    info = decode_info(got.payload)
    assert (info.model, info.serial, info.sample_rate, info.channels) == ("board", "7", 10000.0, 5)
    assert info.volts_per_count == (1e-3, 2e-3, 3e-3, 4e-3, 5.0)
    assert info.full_scale_counts == INFO["full_scale_counts"]


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"protocol": 2}, "INFO.protocol: got 2, want 1, the only one this program speaks"),
        ({"protocol": True}, "INFO.protocol: got True, want 1"),
        ({"protocol": None}, "INFO.protocol: is missing, want 1"),
        ({"model": 3}, "INFO.model: got 3, want text"),
        ({"sample_rate_hz": 0}, "INFO.sample_rate_hz: got 0, want a positive number"),
        ({"sample_rate_hz": float("nan")}, "INFO.sample_rate_hz: got nan"),
        ({"sample_rate_hz": "10 kHz"}, "INFO.sample_rate_hz: got '10 kHz'"),
        ({"channels": 0}, "INFO.channels: got 0, want 1 to 255"),
        ({"channels": 2.5}, "INFO.channels: got 2.5"),
        ({"volts_per_count": [1e-3] * 4}, "want 5 numbers"),
        ({"volts_per_count": [1e-3] * 4 + [0]}, "want 5 numbers"),
        ({"volts_per_count": [1e-3] * 4 + [None]}, "want 5 numbers"),
        ({"simulated": 1}, "INFO.simulated: got 1, want true or false"),
        ({"full_scale_counts": 1 << 24}, "INFO.full_scale_counts: got 16777216, want 1 to 8388608"),
    ],
)
def test_a_wrong_info_is_refused_in_one_sentence(changed: dict[str, object], said: str) -> None:
    (got,), _ = fed(info_frame(**changed))
    with pytest.raises(BadFrame) as error:
        decode_info(got.payload)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


@settings(max_examples=200)
@given(
    st.one_of(st.binary(max_size=80), st.recursive(st.none() | st.integers(), st.lists).map(lambda v: str(v).encode()))
)
def test_any_info_is_understood_or_refused(payload: bytes) -> None:
    with pytest.raises(BadFrame):
        decode_info(payload)


@pytest.mark.parametrize("payload", [b"[" * 100_000, b'{"protocol": 1' + b"0" * 5000 + b"}"], ids=["deep", "long"])
def test_a_hostile_info_is_refused(payload: bytes) -> None:
    with pytest.raises(BadFrame):
        decode_info(payload)
