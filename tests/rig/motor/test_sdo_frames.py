"""SDO frames as CiA 301 V4.2, section 7.2.4.3, draws them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotorrig.rig.errors import BadFrame
from rotorrig.rig.motor import sdo_frames
from rotorrig.rig.motor.sdo_frames import Aborted, Item, Segment, Value, Written

ITEM = Item(0x6042, 0, 2, "vl target velocity", signed=True)


def test_reads_are_initiate_upload_requests() -> None:
    assert sdo_frames.encode_read(Item(0x1018, 1, 4, "vendor-ID")) == bytes.fromhex("40 18 10 01 00 00 00 00")


@pytest.mark.parametrize(
    ("size", "value", "frame"),
    [  # expedited, size indicated: 2F, 2B, 27, 23 for 1 to 4 bytes, little endian
        (1, 2, "2f 42 60 00 02 00 00 00"),
        (2, -300, "2b 42 60 00 d4 fe 00 00"),
        (3, 0x123456, "27 42 60 00 56 34 12 00"),
        (4, 0x12345678, "23 42 60 00 78 56 34 12"),
    ],
)
def test_writes_are_expedited_downloads(size: int, value: int, frame: str) -> None:
    assert sdo_frames.encode_write(Item(0x6042, 0, size, "", signed=True), value) == bytes.fromhex(frame)


def test_a_value_that_does_not_fit_is_no_frame() -> None:
    with pytest.raises(OverflowError):
        sdo_frames.encode_write(ITEM, 1 << 15)


@pytest.mark.parametrize(
    ("frame", "answer"),
    [
        ("4b 42 60 00 d4 fe 00 00", Value((0x6042, 0), b"\xd4\xfe")),
        ("4f 61 60 00 02 00 00 00", Value((0x6061, 0), b"\x02")),
        ("43 00 10 00 92 01 01 00", Value((0x1000, 0), b"\x92\x01\x01\x00")),
        ("42 00 10 00 92 01 01 00", Value((0x1000, 0), b"\x92\x01\x01\x00")),  # size not indicated
        ("41 08 10 00 1a 00 00 00", Value((0x1008, 0), None)),  # 26 bytes to come
        ("00 43 69 41 20 34 30 32", Segment(False, b"CiA 402", False)),
        ("1b 76 65 00 00 00 00 00", Segment(True, b"ve", True)),  # toggled, 5 bytes unused, last
        ("60 40 60 00 00 00 00 00", Written((0x6040, 0))),
        ("80 42 60 00 32 00 09 06", Aborted((0x6042, 0), 0x06090032)),
    ],
)
def test_answers_are_told_apart(frame: str, answer: object) -> None:
    assert sdo_frames.decode_answer(bytes.fromhex(frame)) == answer


@pytest.mark.parametrize("frame", ["", "4b 42 60 00", "c0 42 60 00 00 00 00 00", "ff" * 8])
def test_other_frames_are_bad(frame: str) -> None:
    with pytest.raises(BadFrame):
        sdo_frames.decode_answer(bytes.fromhex(frame))


@given(st.binary(max_size=8))
def test_any_frame_is_an_answer_or_bad(frame: bytes) -> None:
    try:
        sdo_frames.concerns(sdo_frames.decode_answer(frame), ITEM)
    except BadFrame as error:
        assert "SDO: got" in str(error)


def test_integers_have_their_sign_and_may_come_longer_than_they_are() -> None:
    assert sdo_frames.integer(ITEM, b"\xd4\xfe") == -300
    assert sdo_frames.integer(ITEM, b"\xd4\xfe\xff\xff") == -300
    assert sdo_frames.integer(Item(0x6041, 0, 2, ""), b"\xd4\xfe") == 0xFED4
    with pytest.raises(BadFrame, match=r"vl target velocity \(6042h:00\): got 1 bytes, want 2"):
        sdo_frames.integer(ITEM, b"\xd4")


def test_the_next_segment_is_asked_for_with_the_toggle_bit() -> None:
    assert sdo_frames.encode_next_segment(toggle=False) == bytes.fromhex("60 00 00 00 00 00 00 00")
    assert sdo_frames.encode_next_segment(toggle=True) == bytes.fromhex("70 00 00 00 00 00 00 00")


def test_an_abort_says_why() -> None:
    assert str(Aborted((0x6042, 0), 0x06090032)) == "value too low (abort code 06090032h)"
