"""The order of DATA frames: what is repeated, late, lost; and when it can only be a device that restarted."""

import numpy as np
import pytest

from rotorrig.rig.errors import LinkLost
from rotorrig.rig.probes.stream.frames import Data
from rotorrig.rig.probes.stream.sequence import BEHIND, SEQUENCES, STALE_IN_A_ROW, FrameSequence, Place


def frame(sequence: int, first_scan: int | None = None) -> Data:
    scan = 10 * sequence if first_scan is None else first_scan
    return Data(sequence, scan, False, np.full((10, 2), sequence % 1000, dtype=np.int32))


def places(*sequences: int) -> list[tuple[Place, int]]:
    order = FrameSequence(sample_rate=1000.0)
    return [order.place(frame(s)) for s in sequences]


def test_frames_in_order_miss_nothing() -> None:
    assert places(0, 1, 2) == [(Place.NEXT, 0)] * 3


def test_missing_frames_are_counted_at_the_next() -> None:
    assert places(0, 4) == [(Place.NEXT, 0), (Place.NEXT, 3)]


def test_the_first_frames_may_be_missing() -> None:
    assert places(2) == [(Place.NEXT, 2)]


def test_a_missing_frame_that_comes_after_all_is_late_once_then_repeated() -> None:
    assert [p for p, _ in places(0, 2, 1, 1)] == [Place.NEXT, Place.NEXT, Place.LATE, Place.REPEATED]


def test_the_very_first_frame_may_be_late_or_repeated() -> None:
    assert [p for p, _ in places(1, 0)] == [Place.NEXT, Place.LATE]
    assert [p for p, _ in places(0, 0)] == [Place.NEXT, Place.REPEATED]


def test_a_new_first_frame_is_a_restart() -> None:
    order = FrameSequence(sample_rate=1000.0)
    order.place(frame(0))
    again = Data(0, 0, False, np.full((10, 2), 99, dtype=np.int32))
    with pytest.raises(LinkLost, match="went back to scan 0 after 10; has it restarted"):
        order.place(again)


def test_a_frame_from_far_back_is_a_restart() -> None:
    order = FrameSequence(sample_rate=1000.0)
    for s in range(BEHIND + 3):
        order.place(frame(s))
    with pytest.raises(LinkLost, match="went back to scan 10"):
        order.place(frame(1))


def test_nothing_but_old_frames_is_a_restart() -> None:
    order = FrameSequence(sample_rate=1000.0)
    for s in range(20):
        order.place(frame(s))
    for s in range(1, 1 + STALE_IN_A_ROW):  # its frame 0 was lost
        assert order.place(frame(s))[0] is Place.REPEATED
    with pytest.raises(LinkLost, match="has it restarted"):
        order.place(frame(1 + STALE_IN_A_ROW))


@pytest.mark.parametrize("come", [1, 5, 9, 20, BEHIND + 3])
def test_after_a_restart_no_frame_has_a_place_any_more(come: int) -> None:
    order = FrameSequence(sample_rate=1000.0)
    for s in range(come):
        order.place(frame(s))
    for s in range(2 * come):
        with pytest.raises(LinkLost, match=f"went back to scan 0 after {10 * come}"):
            order.place(Data(s, 10 * s, False, np.full((10, 2), -1, dtype=np.int32)))


def test_a_restart_whose_first_frame_is_lost_shows_by_other_samples_under_an_old_number() -> None:
    order = FrameSequence(sample_rate=1000.0)
    for s in range(5):
        order.place(frame(s))
    for s in range(1, 8):
        with pytest.raises(LinkLost, match="went back to scan 10 after 50"):
            order.place(Data(s, 10 * s, False, np.full((10, 2), -1, dtype=np.int32)))


def test_sequence_numbers_wrap() -> None:
    order = FrameSequence(sample_rate=1000.0)
    order._next_sequence = SEQUENCES - 1
    assert order.place(frame(SEQUENCES - 1, 0)) == (Place.NEXT, 0)
    assert order.place(frame(1, 20)) == (Place.NEXT, 1)
    assert order.place(frame(0, 10)) == (Place.LATE, 0)


@pytest.mark.parametrize("then", [frame(5, 10_000_000), frame(SEQUENCES - 4, 100)])
def test_counters_no_stream_can_have_are_refused(then: Data) -> None:
    order = FrameSequence(sample_rate=1000.0)
    for s in range(5):
        order.place(frame(s))
    with pytest.raises(LinkLost, match="counters are broken"):
        order.place(then)
