"""Samples counted by the ticks of a device's clock."""

import pytest

from rotorrig.rig.errors import LinkLost
from rotorrig.rig.probes.opendaq.tick_index import TickIndex

NOW = 1_795_274_737_147_815  # us since 1970


def index(**changed: int) -> TickIndex:
    return TickIndex(**({"delta": 20, "channels": 2} | changed), sample_rate=50_000.0)


def test_packets_in_a_row_are_a_run_of_samples() -> None:
    ticks = index()
    first = ticks.first(0, tick=NOW, samples=914)
    assert ticks.first(0, tick=NOW + 914 * 20, samples=138) == first + 914


def test_channels_share_the_clock() -> None:
    ticks = index()
    first = ticks.first(0, tick=NOW, samples=100)
    assert ticks.first(1, tick=NOW - 50 * 20, samples=100) == first - 50


def test_a_missing_packet_is_a_jump() -> None:
    ticks = index()
    first = ticks.first(0, tick=NOW, samples=100)
    assert ticks.first(0, tick=NOW + 300 * 20, samples=100) == first + 300


def test_a_tick_between_two_samples_belongs_to_the_nearer() -> None:
    ticks = index()
    first = ticks.first(0, tick=NOW, samples=100)
    assert ticks.first(0, tick=NOW + 100 * 20 + 9, samples=100) == first + 100


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(-1, "went back by 50100 samples"), (4000, "went ahead by 199999900 samples")],
)
def test_a_clock_that_was_set_is_said(seconds: int, said: str) -> None:
    ticks = index()
    ticks.first(0, tick=NOW, samples=100)
    with pytest.raises(LinkLost, match=said):
        ticks.first(0, tick=NOW + seconds * 1_000_000, samples=100)


def test_after_the_clock_went_back_no_sample_has_an_index_any_more() -> None:
    ticks = index()
    ticks.first(0, tick=NOW, samples=100)
    ticks.first(1, tick=NOW, samples=100)
    for channel, tick in ((0, NOW - 20), (0, NOW + 100 * 20), (1, NOW + 100 * 20)):
        with pytest.raises(LinkLost, match="went back by 101 samples"):
            ticks.first(channel, tick=tick, samples=100)
