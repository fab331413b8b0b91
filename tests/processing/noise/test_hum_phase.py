"""The mains' phase is followed through a recording, also while an order of the shaft is in the way."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal.windows import kaiser

from rotorrig.processing.noise.hum_phase import HumPhase
from rotorrig.processing.response import MainsHum

RATE, SIZE = 1_000.0, 2_000
SECONDS = 180
T = np.arange(SECONDS * int(RATE)) / RATE


def followed(
    phase: NDArray[np.float64],
    *,
    rng: np.random.Generator,
    noise: float = 0.3,
    blocked: tuple[float, float] = (0, 0),
    of_second: float = 1.0,
) -> MainsHum:
    """What is found of a tone of that phase in two probes; an order is in the way while `blocked`."""
    x = np.cos(phase)[:, None] * [1.0, of_second] + noise * rng.standard_normal((len(T), 2))
    taper, frequency = kaiser(SIZE, 16.0), np.arange(SIZE // 2 + 1) * RATE / SIZE
    hum = HumPhase(frequency, taper=taper, rate=RATE)
    for begin in range(0, len(T) - SIZE, SIZE // 2):
        middle = T[begin + SIZE // 2]
        clear = np.full(len(frequency), not blocked[0] < middle < blocked[1])
        hum.add_segment(begin, np.fft.rfft(x[begin : begin + SIZE] * taper[:, None], axis=0), clear)
    found = hum.follow(50.1)
    assert found.frequency == 50.0
    return found


def off(found: NDArray[np.float64], truth: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.angle(np.exp(1j * (found - truth)))


def test_a_straying_of_20_mhz_is_followed_through_noise_and_a_crossing_of_12_s(rng: np.random.Generator) -> None:
    def stray(t: NDArray[np.float64]) -> NDArray[np.float64]:
        return 1.2 * np.sin(2 * np.pi * t / 60 + 0.4) + 0.9

    found = followed(2 * np.pi * 50 * T + stray(T), rng=rng, blocked=(80.0, 92.0))
    error = off(found.stray, stray(found.t))
    assert np.abs(error).max() < 0.15
    assert np.sqrt(np.mean(error**2)) < 0.06
    assert found.sigma[np.abs(found.t - 86.0).argmin()] > 5 * np.median(found.sigma), "where nobody could see it"
    assert np.sqrt(np.mean((error / found.sigma) ** 2)) < 1.5


def test_the_probes_may_pick_it_up_each_with_another_phase(rng: np.random.Generator) -> None:
    found = followed(2 * np.pi * 50 * T + 0.3, rng=rng, of_second=-1.0)
    assert np.ptp(found.stray) < 0.1


@pytest.mark.parametrize("frequency", [49.99, 50.004])
def test_a_steady_offset_from_nominal_is_a_phase_that_runs_ahead(frequency: float, rng: np.random.Generator) -> None:
    found = followed(2 * np.pi * frequency * T - 0.8, rng=rng)
    assert np.abs(off(found.stray, 2 * np.pi * (frequency - 50) * found.t - 0.8)).max() < 0.1
    assert np.abs(np.diff(found.stray)).max() < 0.2, "it is unwrapped"


def test_between_bins_the_phase_is_that_of_the_nominal_frequency(rng: np.random.Generator) -> None:
    """Where segments are no whole number of its periods long."""
    taper, rate = kaiser(1_990, 16.0), 1_003.0
    t = np.arange(40_000) / rate
    frequency = np.arange(996) * rate / 1_990
    hum = HumPhase(frequency, taper=taper, rate=rate)
    x = np.cos(2 * np.pi * 60.0 * t + 1.1)[:, None]
    for begin in range(0, len(t) - 1_990, 995):
        spectrum = np.fft.rfft(x[begin : begin + 1_990] * taper[:, None], axis=0)
        hum.add_segment(begin, spectrum, np.ones(len(frequency), dtype=bool))
    assert hum.follow(60.0).stray == pytest.approx(1.1, abs=0.01)
