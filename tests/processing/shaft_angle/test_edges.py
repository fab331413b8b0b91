"""Edges and levels of pulse trains whose crossings are known in closed form."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from rotorrig.processing.shaft_angle.edges import EdgeFinder, LevelFinder, levels
from rotorrig.processing.shaft_angle.smooth_angle import TURN
from rotorrig.rig.errors import DataError
from tests.processing.synthetic import chirp, falling_notch

RATE = 10_000.0
T = np.arange(20_000) / RATE


def in_pieces(volts: NDArray[np.float64], cuts: list[int]) -> list[tuple[int, NDArray[np.float64]]]:
    """Return (first sample, volts) of the stretches between the cuts."""
    return [(int(part[0]), volts[part]) for part in np.split(np.arange(len(volts)), cuts) if len(part)]


def levels_of(volts: NDArray[np.float64], cuts: list[int]) -> tuple[float, float]:
    finder = LevelFinder(RATE)
    for first, part in in_pieces(volts, cuts):
        finder.take(first, part)
    found = finder.levels()
    return found.highest_low, found.lowest_high


def edges_of(volts: NDArray[np.float64], *, edge: str, threshold: float) -> NDArray[np.float64]:
    return EdgeFinder(edge=edge, band=4.0).take(0, volts, threshold=threshold)


def test_the_falling_edge_of_a_notch_is_angle_zero() -> None:
    edges = edges_of(falling_notch(chirp(T, start=60.0, rate=0.0) - 1.0), edge="falling", threshold=-6)
    np.testing.assert_allclose(edges / RATE, (1.0 + TURN * np.arange(len(edges))) / 60.0, atol=1e-7)


def test_the_rising_edge_comes_a_notch_later() -> None:
    edges = edges_of(falling_notch(60.0 * T - 1.0), edge="rising", threshold=-6)
    np.testing.assert_allclose(edges / RATE, (1.0 + np.radians(20) + TURN * np.arange(len(edges))) / 60.0, atol=1e-7)


def test_noise_smaller_than_the_band_makes_no_extra_edges(rng: np.random.Generator) -> None:
    t = np.arange(100_000) / RATE
    volts = falling_notch(50.0 * t - 1.0, slope=np.radians(10)) + 0.4 * rng.standard_normal(len(t))
    assert len(edges_of(volts, edge="falling", threshold=-6)) == 1 + int((50.0 * t[-1] - 1.0) // TURN)


@given(cuts=st.lists(st.integers(1, 19_999), max_size=15, unique=True))
def test_edges_and_levels_do_not_depend_on_the_cuts(cuts: list[int]) -> None:
    noise = 0.6 * np.random.default_rng(8).standard_normal(len(T))  # several crossings per flank
    volts = falling_notch(40.0 * T - 1.0, slope=np.radians(10)) + noise
    finder = EdgeFinder(edge="falling", band=4.0)
    pieces = in_pieces(volts, sorted(cuts))
    found = np.concatenate([finder.take(first, part, threshold=-6.0) for first, part in pieces])
    np.testing.assert_array_equal(found, edges_of(volts, edge="falling", threshold=-6.0))
    assert levels_of(volts, sorted(cuts)) == levels_of(volts, [])


def test_an_edge_begun_before_a_gap_is_none_after_it() -> None:
    finder = EdgeFinder(edge="falling", band=2.0)
    assert len(finder.take(0, np.array([0.0, 0.0, -4.9]), threshold=-5.0)) == 0
    assert len(finder.take(10, np.array([-8.0, -8.0, 0.0]), threshold=-5.0)) == 0
    np.testing.assert_allclose(finder.take(13, np.array([0.0, -10.0]), threshold=-5.0), [13.5])


def test_levels_are_those_of_the_pulse_whatever_its_duty() -> None:
    volts = np.full(10_000, -2.0)
    volts[::100] = -10.0  # 1 % of the turn
    assert levels(volts) == (-10.0, -2.0)


def test_wide_flanks_do_not_shift_the_levels(rng: np.random.Generator) -> None:
    # a notch of 20 degrees whose flanks take 10 each: half of what is below the middle is flank
    volts = falling_notch(np.linspace(0, 200, 100_000), slope=np.radians(10)) + 0.05 * rng.standard_normal(100_000)
    np.testing.assert_allclose(levels(volts), (-10.0, -2.0), atol=0.03)


def test_spikes_beyond_the_pulse_do_not_shift_the_levels() -> None:
    volts = falling_notch(np.linspace(0, 200, 100_000))
    volts[5_000::10_000] = 20.0
    volts[7_000::10_000] = -24.0
    np.testing.assert_allclose(levels(volts), (-10.0, -2.0), atol=1e-6)


def test_a_runout_under_the_keyphasor_probe_shifts_no_pulse_from_turn_to_turn() -> None:
    angle = 50.0 * np.arange(100_000) / RATE
    volts = falling_notch(angle) + 0.8 * np.cos(angle + 1.0)  # as much as a tenth of the pulse
    low, high = levels(volts)
    period = np.diff(edges_of(volts, edge="falling", threshold=(low + high) / 2))
    np.testing.assert_allclose(period, RATE * TURN / 50.0, atol=0.05)  # interpolation on a flank of four samples


def test_levels_that_drift_take_the_threshold_along() -> None:
    """The probe's driver warms up: all volts fall by 5 V in 60 s. A fixed threshold would be passed 30 us sooner."""
    t = np.arange(int(60 * RATE)) / RATE
    drift = -5.0 * t / 60
    volts = falling_notch(50.0 * t - 1.0) + drift
    finder = LevelFinder(RATE)
    finder.take(0, volts)
    found = finder.levels()
    middle = found.middle(0, len(t))
    np.testing.assert_allclose(middle, -6.0 + drift, atol=0.8)  # found in stretches of 4 s, 0.33 V each
    edges = EdgeFinder(edge="falling", band=2.0).take(0, volts, threshold=middle)
    np.testing.assert_allclose(edges / RATE, (1.0 + TURN * np.arange(len(edges))) / 50.0, atol=np.radians(0.2) / 50.0)


def test_a_rotor_at_rest_for_most_of_the_recording_has_the_levels_of_its_turns(rng: np.random.Generator) -> None:
    t = np.arange(int(40 * RATE)) / RATE
    turning = np.maximum(t - 30.0, 0.0)  # at rest over the idle surface for 30 s, with some hum
    volts = falling_notch(60.0 * turning - 1.0) + 0.05 * np.sin(TURN * 50 * t) + 0.01 * rng.standard_normal(len(t))
    finder = LevelFinder(RATE)
    finder.take(0, volts)
    found = finder.levels()
    np.testing.assert_allclose([found.highest_low, found.lowest_high], [-10.0, -2.0], atol=0.06)


def test_a_channel_without_pulses_is_said_so(rng: np.random.Generator) -> None:
    with pytest.raises(DataError, match="no pulse found, the voltage wanders between"):
        levels(-10 + 0.01 * rng.standard_normal(10_000))
    with pytest.raises(DataError, match="no pulse found, the voltage stays at -10 V"):
        levels_of(np.full(100_000, -10.0), [])
