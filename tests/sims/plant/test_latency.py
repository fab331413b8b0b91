"""A fraction of a sample late, in one block or in many."""

import numpy as np
import pytest

from rotorrig.sims.plant.latency import Latency

RATE = 10_000.0


@pytest.mark.parametrize("delay", [2e-5, 1e-4, 1.5e-4, 3.3e-4, 2.05e-3])
def test_a_slow_sine_comes_out_that_much_later_and_as_large(delay: float) -> None:
    t = np.arange(4000) / RATE
    for hertz, error in ((60.0, 1e-6), (500.0, 2e-3)):
        wave = np.sin(2 * np.pi * hertz * t)[:, None]
        late = Latency(np.array([delay]), sample_rate=RATE).delay(wave)[100:, 0]
        assert np.abs(late - np.sin(2 * np.pi * hertz * (t[100:] - delay))).max() < error


def test_whole_samples_are_exact_and_each_column_has_its_own(rng_blocks: list[np.ndarray]) -> None:
    whole = np.concatenate(rng_blocks)
    late = Latency(np.array([0.0, 3e-4]), sample_rate=RATE).delay(whole)
    assert late[:, 0] == pytest.approx(whole[:, 0], abs=1e-12)
    assert late[3:, 1] == pytest.approx(whole[:-3, 1], abs=1e-12)
    assert late[:3, 1] == pytest.approx(whole[0, 1])


def test_blocks_of_any_size_give_what_one_gives(rng_blocks: list[np.ndarray]) -> None:
    delay = np.array([1.7e-4, 9e-4])
    whole = Latency(delay, sample_rate=RATE).delay(np.concatenate(rng_blocks))
    pieces = Latency(delay, sample_rate=RATE)
    assert np.array_equal(np.concatenate([pieces.delay(block) for block in rng_blocks]), whole)


@pytest.fixture
def rng_blocks() -> list[np.ndarray]:
    rng = np.random.default_rng(1)
    return [rng.standard_normal((size, 2)) for size in (1, 0, 2, 500, 7, 1)]
