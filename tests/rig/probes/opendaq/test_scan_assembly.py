"""Channels put together to scans: whole ones only, gaps of any channel are gaps of all."""

import numpy as np

from rotorrig.rig.probes.opendaq.scan_assembly import ScanAssembler


def segment(first: int, length: int, channel: int) -> np.ndarray:
    return np.arange(first, first + length, dtype=np.int32) * 10 + channel


def taken(scans: ScanAssembler) -> list[tuple[int, int]]:
    """Return (first, length) of all blocks; sees that every count belongs to its sample and channel."""
    found = []
    while part := scans.take():
        first, counts = part
        for channel in range(counts.shape[1]):
            np.testing.assert_array_equal(counts[:, channel], segment(first, len(counts), channel))
        found.append((first, len(counts)))
    return found


def test_nothing_comes_out_before_all_channels_have_some() -> None:
    scans = ScanAssembler(2)
    scans.add(0, 5, segment(5, 10, 0))
    assert taken(scans) == []
    scans.add(1, 5, segment(5, 10, 1))
    assert taken(scans) == [(5, 10)]


def test_counting_begins_where_all_channels_have_begun() -> None:
    scans = ScanAssembler(3)
    for channel, first in enumerate((0, 7, 3)):
        scans.add(channel, first, segment(first, 20 - first, channel))
    assert taken(scans) == [(7, 13)]


def test_packets_may_be_cut_differently() -> None:
    scans = ScanAssembler(2)
    for first, length in ((0, 4), (4, 1), (5, 5)):
        scans.add(0, first, segment(first, length, 0))
    for first, length in ((0, 7), (7, 3)):
        scans.add(1, first, segment(first, length, 1))
    blocks = taken(scans)
    assert [first for first, _ in blocks] == [0, 4, 5, 7]
    assert sum(length for _, length in blocks) == 10


def test_a_gap_of_one_channel_is_a_gap_of_all() -> None:
    scans = ScanAssembler(2)
    scans.add(0, 0, segment(0, 30, 0))
    scans.add(1, 0, segment(0, 10, 1))
    scans.add(1, 20, segment(20, 10, 1))
    assert taken(scans) == [(0, 10), (20, 10)]


def test_gaps_of_different_channels_do_not_hide_each_other() -> None:
    scans = ScanAssembler(2)
    for first in (0, 20, 30):
        scans.add(0, first, segment(first, 10, 0))
    for first in (0, 10, 30):
        scans.add(1, first, segment(first, 10, 1))
    assert taken(scans) == [(0, 10), (30, 10)]


def test_blocks_do_not_run_across_a_gap() -> None:
    scans = ScanAssembler(1)
    scans.add(0, 0, segment(0, 5, 0))
    scans.add(0, 6, segment(6, 5, 0))
    scans.add(0, 11, np.empty(0, dtype=np.int32))
    assert taken(scans) == [(0, 5), (6, 5)]
