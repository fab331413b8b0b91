"""Blocks in their place in time, and the count of what came and what did not."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.probes.base import DaqCounters, DaqInfo
from rotorrig.rig.probes.tally import Tally

INFO = DaqInfo(
    model="m", serial="", sample_rate=10_240 / 3, channels=2, volts_per_count=(1e-3, 1e-3), full_scale_counts=100
)


def counts(*rows: tuple[int, int]) -> np.ndarray:
    return np.array(rows, dtype=np.int32)


def test_a_block_is_placed_by_its_first_sample() -> None:
    block = Tally(INFO).block(counts((1, 2)), first_sample=200)
    assert (block.first_sample, block.t_ns, block.overrun) == (200, 58_593_750, False)  # 200 * 3 / 10240 s


def test_gaps_and_overruns_are_counted() -> None:
    tally = Tally(replace(INFO, simulated=True))
    tally.block(counts((1, 2), (3, 4)), first_sample=0)
    tally.block(counts((1, 2)), first_sample=7, overrun=True)
    tally.block(counts((1, 2)), first_sample=8)
    assert tally.counters == DaqCounters(
        blocks=3, samples=4, gaps=1, lost_samples=5, overruns=1, saturated=(0, 0), clock_error=None
    )


def test_both_ends_of_the_range_saturate() -> None:
    tally = Tally(INFO)
    tally.block(counts((99, -100), (98, -99), (150, 0)), first_sample=0)
    assert tally.counters.saturated == (2, 1)


def test_inputs_may_have_ranges_of_their_own() -> None:
    tally = Tally(INFO, lowest=np.array([0, -100]), highest=np.array([99, 50]))
    tally.block(counts((0, 50), (1, 49), (-3, -100)), first_sample=0)
    assert tally.counters.saturated == (2, 2)


def test_an_empty_block_counts_nothing() -> None:
    tally = Tally(INFO)
    assert tally.block(np.empty((0, 2), dtype=np.int32), first_sample=0).counts.shape == (0, 2)
    assert tally.counters == DaqCounters(blocks=1, saturated=(0, 0))


@pytest.mark.parametrize(("error", "simulated"), [(0.01, False), (None, True)])
def test_the_clock_of_a_simulated_daq_is_not_compared(error: float | None, simulated: bool) -> None:
    tally = Tally(replace(INFO, sample_rate=1000.0, simulated=simulated))
    for k in range(100):
        tally.block(np.zeros((100, 2), dtype=np.int32), first_sample=100 * k, arrived=0.1 * k / 1.01)
    found = tally.counters.clock_error
    assert found == (None if error is None else pytest.approx(error))


def test_a_sound_stream_has_nothing_to_remark() -> None:
    assert DaqCounters(blocks=9, samples=900, saturated=(0, 0), clock_error=9e-4).remarks({0: "A"}) == ()


def test_everything_that_went_wrong_has_its_sentence() -> None:
    counters = DaqCounters(
        blocks=9,
        samples=900,
        gaps=1,
        lost_samples=5,
        overruns=2,
        lost_frames=3,
        damaged_frames=1,
        repeated_frames=4,
        late_frames=6,
        stray_bytes=7,
        saturated=(8, 9, 1),
        clock_error=-0.0123,
    )
    assert counters.remarks({0: "A", 2: "keyphasor"}) == (
        "5 samples are missing in 1 gap",
        "the DAQ said 2 times that it had lost samples",
        "3 frames of the DAQ did not arrive",
        "1 frame of the DAQ arrived damaged",
        "4 frames of the DAQ came twice",
        "6 frames of the DAQ came out of order, too late for their place",
        "7 bytes from the DAQ were part of no sound frame",
        "A (channel 0): 8 samples at the end of the DAQ's range",
        "keyphasor (channel 2): 1 sample at the end of the DAQ's range",
        "the DAQ's sample clock runs 1.23% slow by this computer's clock, want within 0.10%: speeds are off by as much",
    )
