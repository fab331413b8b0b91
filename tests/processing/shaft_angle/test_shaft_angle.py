"""Keyphasor pulses to shaft angle, against angles known in closed form."""

import numpy as np
import pytest

from rotorrig.processing.shaft_angle.shaft_angle import TURN, fit_shaft_angle
from rotorrig.rig.errors import DataError

RPM = np.pi / 30


def chirp_edges(count: int, *, start: float, rate: float) -> np.ndarray:
    """Return when a shaft at `start` + `rate` t [rad/s] has made 0, 1, 2 ... turns: the root of a quadratic."""
    turned = TURN * np.arange(count)
    return (np.sqrt(start**2 + 2 * rate * turned) - start) / rate


def test_too_few_pulses_are_said_so() -> None:
    with pytest.raises(DataError, match="got 3 keyphasor pulses, want at least 5"):
        fit_shaft_angle(np.array([0.0, 1.0, 2.0]))


def test_angle_speed_and_time_follow_a_chirp() -> None:
    start, rate = 480 * RPM, 30 * RPM
    edges = chirp_edges(2000, start=start, rate=rate)
    shaft = fit_shaft_angle(edges)
    t = np.linspace(edges[10], edges[-10], 5001)
    np.testing.assert_allclose(shaft.theta(t), start * t + rate * t**2 / 2, atol=1e-6)
    np.testing.assert_allclose(shaft.omega(t), start + rate * t, rtol=1e-5)
    np.testing.assert_allclose(shaft.time_at(shaft.theta(t) / TURN), t, atol=1e-10)


@pytest.mark.parametrize("missing", [1, 3])
def test_angle_stays_right_across_missed_pulses(missing: int) -> None:
    start, rate = 480 * RPM, 30 * RPM
    edges = chirp_edges(400, start=start, rate=rate)
    shaft = fit_shaft_angle(np.delete(edges, range(200, 200 + missing)))
    t = np.linspace(edges[0], edges[-1], 2001)
    np.testing.assert_allclose(shaft.theta(t), start * t + rate * t**2 / 2, atol=2e-4)
    assert shaft.flaws == ()
    repaired = [(f.first_turn, f.last_turn, f.reason) for f in shaft.repairs]
    assert repaired == [(199, 200 + missing, "missed pulse bridged")]
    np.testing.assert_allclose(shaft.pulses(), edges, atol=1e-5)


@pytest.mark.parametrize("where", [0.1, 0.5, 0.9])
def test_an_extra_pulse_is_dropped_wherever_in_the_turn_it_comes(where: float) -> None:
    edges = chirp_edges(400, start=480 * RPM, rate=30 * RPM)
    extra = edges[100] + where * (edges[101] - edges[100])
    shaft = fit_shaft_angle(np.sort(np.append(edges, extra)))
    np.testing.assert_array_equal(shaft.t, edges)
    assert shaft.flaws == ()
    assert [(f.first_turn, f.reason) for f in shaft.repairs] == [(100, "extra pulse dropped")]


def test_a_start_from_rest_is_no_flaw() -> None:
    edges = np.sqrt(2 * TURN * np.arange(1, 200) / 10.0)  # 10 rad/s^2 from standstill
    assert fit_shaft_angle(edges).flaws == ()


def test_a_gap_is_bridged_by_the_turns_that_fit_into_it() -> None:
    edges = np.arange(300) * 0.1
    shaft = fit_shaft_angle(np.delete(edges, range(100, 120)), gaps=[(9.95, 11.99)])
    assert shaft.turn[-1] == 299
    assert [(f.first_turn, f.last_turn, f.reason) for f in shaft.flaws] == [(99, 120, "gap in the samples")]


def test_pulses_at_random_are_no_keyphasor(rng: np.random.Generator) -> None:
    with pytest.raises(DataError, match="want clean pulses"):
        fit_shaft_angle(np.cumsum(rng.exponential(0.1, 500)))


def test_jitter_is_the_edges_timing_error(rng: np.random.Generator) -> None:
    edges = chirp_edges(4000, start=480 * RPM, rate=30 * RPM)
    turns = np.arange(100.0, 3900.0)
    found = fit_shaft_angle(edges + 10e-6 * rng.standard_normal(len(edges))).jitter(turns, first=0, last=3999)
    assert np.sqrt(np.mean(found**2)) == pytest.approx(10e-6, rel=0.06)  # 4000 differences, correlated
    assert found.std() < 0.25 * 10e-6
    assert fit_shaft_angle(edges).jitter(turns, first=0, last=3999).max() < 1e-8


def test_a_start_from_rest_is_no_jitter(rng: np.random.Generator) -> None:
    start = np.sqrt(2 * TURN * np.arange(1, 8) / 10.0)
    edges = np.concatenate([start, start[-1] + 0.25 * np.arange(1, 60)])
    shaft = fit_shaft_angle(edges + 10e-6 * rng.standard_normal(len(edges)))
    assert (shaft.jitter(np.array([14.0, 30.0]), first=10, last=65) < 20e-6).all()


def test_the_mean_angle_of_a_row_is_as_uncertain_as_is_said(rng: np.random.Generator) -> None:
    """Rows of 8 turns under a Hann window, of a ramp that averages all its pulses and of a speed that hunts."""
    psi = (np.arange(128) + 0.5) / 16 - 4
    weight = 1 + np.cos(TURN * psi / 8)
    for swing in (0.0, 0.01):

        def theta(t: np.ndarray, swing: float = swing) -> np.ndarray:
            return 300 * t + 5 * t**2 + swing * 300 / TURN * (1 - np.cos(TURN * t))

        grid = np.linspace(0, 12, 100_001)
        z = []
        for _ in range(40):
            edges = np.interp(TURN * np.arange(1, 550), theta(grid), grid) + 20e-6 * rng.standard_normal(549)
            shaft = fit_shaft_angle(edges[rng.random(549) > 0.01])
            middle = np.arange(12.0, shaft.turn[-1] - 12, 8)
            t = shaft.time_at((middle[:, None] + psi).ravel())
            error = (theta(t) - shaft.theta(t)).reshape(len(middle), -1) @ weight / weight.sum()
            error -= TURN * np.round(error / TURN)  # the first pulse may be the one that is missing
            z.append(error / shaft.row_angle_sigma(middle, turns=8, bandwidth=1.5))
        assert np.sqrt(np.mean(np.concatenate(z) ** 2)) == pytest.approx(1.0, abs=0.2)


def test_speed_and_its_rate_come_with_their_uncertainty(rng: np.random.Generator) -> None:
    start, rate = 480 * RPM, 30 * RPM
    edges = chirp_edges(1000, start=start, rate=rate)
    z = []
    for _ in range(60):
        shaft = fit_shaft_angle(edges + 20e-6 * rng.standard_normal(len(edges)))
        t = np.linspace(edges[0], edges[-1], 50)
        z.append(
            [(shaft.omega(t) - start - rate * t) / shaft.omega_sigma(t), (shaft.alpha(t) - rate) / shaft.alpha_sigma(t)]
        )
    inside = np.mean(np.abs(z) < 1.96, axis=(0, 2))
    assert (inside > 0.9).all()
    assert (inside < 0.99).all()


def test_pulses_are_where_they_would_be_without_jitter(rng: np.random.Generator) -> None:
    edges = chirp_edges(1500, start=480 * RPM, rate=30 * RPM)
    late = 50e-6 * rng.standard_normal(len(edges))
    shaft = fit_shaft_angle(edges + late)
    assert np.sqrt(np.mean((shaft.pulses() - edges) ** 2)) < 50e-6 / 10
    too_late = (shaft.theta(shaft.t) - TURN * shaft.turn) / shaft.omega(shaft.t)
    np.testing.assert_allclose(too_late, late, atol=30e-6)
    assert (np.diff(shaft.pulses()) > 0).all()


def test_missed_pulses_are_bridged_only_as_far_as_the_angle_is_known(rng: np.random.Generator) -> None:
    """A speed that hunts by 5 % at 3 Hz swings too much within six turns at 30 a second, that of a ramp does not."""
    grid = np.linspace(0, 12, 200_001)
    swing = 0.05 * 190 / (3 * TURN) * (1 - np.cos(3 * TURN * grid))
    for theta, known in ((190 * grid, True), (190 * grid + swing, False)):
        edges = np.interp(TURN * np.arange(1, 350), theta, grid) + 5e-6 * rng.standard_normal(349)
        shaft = fit_shaft_angle(np.delete(edges, range(200, 205)))
        assert (len(shaft.repairs), len(shaft.flaws)) == ((1, 0) if known else (0, 1))
