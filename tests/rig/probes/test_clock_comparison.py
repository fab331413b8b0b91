"""A sample clock held against the host's: what the arrival of samples tells of their rate."""

import numpy as np
import pytest

from rotorrig.rig.probes.clock_comparison import ClockComparison

RATE = 10_000.0
BLOCK = 200  # 20 ms


def error_after(seconds: float, *, error: float, late: np.ndarray | None = None) -> float | None:
    """Return what is said after so many seconds of a clock with that error, each block late by `late` [s]."""
    comparison = ClockComparison(RATE)
    for k in range(int(seconds * RATE * (1 + error)) // BLOCK):
        at = 1000.0 + k * BLOCK / (RATE * (1 + error))
        comparison.note_arrival(k * BLOCK, at + (0.0 if late is None else late[k % len(late)]))
    return comparison.error


@pytest.mark.parametrize("error", [0.0, 1e-4, -5e-3, 0.1])
def test_the_error_of_a_punctual_clock_is_found(error: float) -> None:
    assert error_after(20, error=error) == pytest.approx(error, abs=1e-9)


def test_lateness_of_the_host_is_not_taken_for_the_clock(rng: np.random.Generator) -> None:
    late = rng.exponential(3e-3, 5000)  # 3 ms on average, 20 ms at times
    assert error_after(60, error=2e-3, late=late) == pytest.approx(2e-3, abs=5e-5)


def test_a_short_stream_says_nothing() -> None:
    assert error_after(4, error=0.01) is None


def test_arrivals_too_irregular_to_tell_say_nothing(rng: np.random.Generator) -> None:
    late = 0.2 + rng.uniform(0, 0.2, 50).repeat(60)  # held up for a second at a time
    assert error_after(10, error=0.0, late=late) is None


def test_lost_samples_make_no_difference() -> None:
    comparison = ClockComparison(RATE)
    for k in range(1000):
        if not 300 < k < 600:
            comparison.note_arrival(k * BLOCK, k * BLOCK / RATE)
    assert comparison.error == pytest.approx(0.0, abs=1e-9)
