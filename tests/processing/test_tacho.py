"""Keyphasor pulses to shaft angle, against angles known in closed form."""

import numpy as np
import pytest

from rotorrig.processing.tacho import TURN, find_edges, levels, shaft_angle
from rotorrig.rig.errors import DataError
from tests.processing.synthetic import chirp, falling_notch

RPM = np.pi / 30


def chirp_edges(count: int, *, start: float, rate: float) -> np.ndarray:
    """Return when a shaft at `start` + `rate` t [rad/s] has made 0, 1, 2 ... turns: the root of a quadratic."""
    turned = TURN * np.arange(count)
    return (np.sqrt(start**2 + 2 * rate * turned) - start) / rate


def test_the_falling_edge_of_a_notch_is_angle_zero() -> None:
    t = np.arange(20_000) / 10_000
    edges = find_edges(falling_notch(chirp(t, start=60.0, rate=0.0) - 1.0), edge="falling", threshold=-6, band=4)
    np.testing.assert_allclose(edges / 10_000, (1.0 + TURN * np.arange(len(edges))) / 60.0, atol=1e-7)


def test_the_rising_edge_comes_a_notch_later() -> None:
    t = np.arange(20_000) / 10_000
    edges = find_edges(falling_notch(60.0 * t - 1.0), edge="rising", threshold=-6, band=4)
    np.testing.assert_allclose(edges / 10_000, (1.0 + np.radians(20) + TURN * np.arange(len(edges))) / 60.0, atol=1e-7)


def test_noise_smaller_than_the_band_makes_no_extra_edges(rng: np.random.Generator) -> None:
    t = np.arange(100_000) / 10_000
    volts = falling_notch(50.0 * t - 1.0, slope=np.radians(10)) + 0.4 * rng.standard_normal(len(t))
    assert len(find_edges(volts, edge="falling", threshold=-6, band=4)) == 1 + int((50.0 * t[-1] - 1.0) // TURN)


def test_levels_are_those_of_the_pulse_whatever_its_duty() -> None:
    volts = np.full(10_000, -2.0)
    volts[::100] = -10.0  # 1 % of the turn
    assert levels(volts) == (-10.0, -2.0)


def test_wide_flanks_do_not_shift_the_levels(rng: np.random.Generator) -> None:
    # a notch of 20 degrees whose flanks take 10 each: half of what is below the middle is flank
    volts = falling_notch(np.linspace(0, 200, 100_000), slope=np.radians(10)) + 0.05 * rng.standard_normal(100_000)
    np.testing.assert_allclose(levels(volts), (-10.0, -2.0), atol=0.03)


def test_a_channel_without_pulses_is_said_so(rng: np.random.Generator) -> None:
    with pytest.raises(DataError, match="no pulse found, the voltage wanders between"):
        levels(-10 + 0.01 * rng.standard_normal(10_000))
    with pytest.raises(DataError, match="no pulse found, the voltage stays at -10 V"):
        levels(np.full(100, -10.0))
    with pytest.raises(DataError, match="got 3 keyphasor pulses, want at least 5"):
        shaft_angle(np.array([0.0, 1.0, 2.0]))


def test_angle_speed_and_time_follow_a_chirp() -> None:
    start, rate = 480 * RPM, 30 * RPM
    edges = chirp_edges(2000, start=start, rate=rate)
    shaft = shaft_angle(edges)
    t = np.linspace(edges[10], edges[-10], 5001)
    np.testing.assert_allclose(shaft.theta(t), start * t + rate * t**2 / 2, atol=1e-6)
    np.testing.assert_allclose(shaft.omega(t), start + rate * t, rtol=1e-5)
    np.testing.assert_allclose(shaft.time_at(shaft.theta(t) / TURN), t, atol=1e-10)


@pytest.mark.parametrize("missing", [1, 3])
def test_angle_stays_right_across_missed_pulses(missing: int) -> None:
    start, rate = 480 * RPM, 30 * RPM
    edges = chirp_edges(400, start=start, rate=rate)
    shaft = shaft_angle(np.delete(edges, range(200, 200 + missing)))
    t = np.linspace(edges[0], edges[-1], 2001)
    np.testing.assert_allclose(shaft.theta(t), start * t + rate * t**2 / 2, atol=2e-4)
    assert [(f.first_turn, f.last_turn, f.reason) for f in shaft.flaws] == [(199, 200 + missing, "missed pulse")]
    np.testing.assert_allclose(shaft.pulses(), edges, atol=1e-5)


@pytest.mark.parametrize("where", [0.1, 0.5, 0.9])
def test_an_extra_pulse_is_dropped_wherever_in_the_turn_it_comes(where: float) -> None:
    edges = chirp_edges(400, start=480 * RPM, rate=30 * RPM)
    extra = edges[100] + where * (edges[101] - edges[100])
    shaft = shaft_angle(np.sort(np.append(edges, extra)))
    np.testing.assert_array_equal(shaft.t, edges)
    assert [(f.first_turn, f.reason) for f in shaft.flaws] == [(100, "extra pulse")]


def test_a_start_from_rest_is_no_flaw() -> None:
    edges = np.sqrt(2 * TURN * np.arange(1, 200) / 10.0)  # 10 rad/s^2 from standstill
    assert shaft_angle(edges).flaws == ()


def test_a_gap_is_bridged_by_the_turns_that_fit_into_it() -> None:
    edges = np.arange(300) * 0.1
    shaft = shaft_angle(np.delete(edges, range(100, 120)), gaps=[(9.95, 11.99)])
    assert shaft.turn[-1] == 299
    assert [(f.first_turn, f.last_turn, f.reason) for f in shaft.flaws] == [(99, 120, "gap in the samples")]


def test_pulses_at_random_are_no_keyphasor(rng: np.random.Generator) -> None:
    with pytest.raises(DataError, match="want one clean pulse per turn"):
        shaft_angle(np.cumsum(rng.exponential(0.1, 500)))


def test_jitter_is_the_edges_timing_error(rng: np.random.Generator) -> None:
    edges = chirp_edges(4000, start=480 * RPM, rate=30 * RPM)
    turns = np.arange(100.0, 3900.0)
    found = shaft_angle(edges + 10e-6 * rng.standard_normal(len(edges))).jitter(turns, first=0, last=3999)
    assert np.sqrt(np.mean(found**2)) == pytest.approx(10e-6, rel=0.06)  # 4000 differences, correlated
    assert found.std() < 0.25 * 10e-6
    assert shaft_angle(edges).jitter(turns, first=0, last=3999).max() < 1e-8


def test_a_start_from_rest_before_the_range_is_no_jitter(rng: np.random.Generator) -> None:
    start = np.sqrt(2 * TURN * np.arange(1, 8) / 10.0)
    edges = np.concatenate([start, start[-1] + 0.25 * np.arange(1, 60)])
    shaft = shaft_angle(edges + 10e-6 * rng.standard_normal(len(edges)))
    assert (shaft.jitter(np.array([14.0, 30.0]), first=10, last=65) < 20e-6).all()
    assert (shaft.jitter(np.array([14.0, 30.0]), first=0, last=65) > 100e-6).all()
