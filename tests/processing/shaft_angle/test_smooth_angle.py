"""The smooth angle through pulses whose timing errors are known, of motions known in closed form."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.processing.shaft_angle.smooth_angle import TURN, SmoothAngle, fit_angle

RPM = np.pi / 30
START, RATE = 600 * RPM, 180 * RPM  # 600 to 6000 rpm in 30 s
Angle = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def ramp_pulses() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return when the ramp has made 0, 1, 2 ... turns: the root of a quadratic."""
    turned = TURN * np.arange(1650)
    return (np.sqrt(START**2 + 2 * RATE * turned) - START) / RATE, turned


def pulses_of(theta: Angle, seconds: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return when an increasing angle passes whole turns, by inverse interpolation and Newton's steps."""
    grid = np.linspace(0, seconds, 100_001)
    turned = TURN * np.arange(1, int(theta(grid[-1:])[0] / TURN))
    t = np.interp(turned, theta(grid), grid)
    for _ in range(4):
        slope = (theta(t + 1e-6) - theta(t - 1e-6)) / 2e-6
        t = t - (theta(t) - turned) / slope
    return t, turned


def with_errors(
    t: NDArray[np.float64], turned: NDArray[np.float64], error: NDArray[np.float64], rng: np.random.Generator
) -> SmoothAngle:
    """Return the fit through pulses of which one in a hundred is missing."""
    kept = rng.random(len(t)) > 0.01
    return fit_angle((t + error)[kept], turned[kept])


def hunting(frequency: float) -> Angle:
    """Return the angle of a shaft at 3000 rpm whose speed swings by 1 % at `frequency` [Hz]."""
    omega, p = 3000 * RPM, TURN * frequency
    return lambda t: omega * t + 0.01 * omega / p * (1 - np.cos(p * t))


def tripped(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angle of a shaft that rises by 60 rpm/s and from 10 s on falls by 240 rpm/s."""
    return 3000 * RPM * t + 30 * RPM * t**2 - 150 * RPM * np.maximum(t - 10, 0) ** 2


def test_pulses_in_time_give_the_angle_of_a_ramp_exactly() -> None:
    pulses, turned = ramp_pulses()
    fit = fit_angle(pulses, turned)
    t = np.linspace(pulses[0], pulses[-1], 5001)
    np.testing.assert_allclose(fit.curve(t), START * t + RATE * t**2 / 2, atol=1e-9)
    np.testing.assert_allclose(fit.curve(t, 1), START + RATE * t, atol=1e-9)
    np.testing.assert_allclose(fit.curve(t, 2), RATE, atol=1e-8)


@pytest.mark.parametrize("frequency", [0.5, 2.0])
def test_pulses_in_time_give_the_angle_of_a_speed_that_hunts(frequency: float) -> None:
    theta = hunting(frequency)
    pulses, turned = pulses_of(theta, 10.0)
    t = np.linspace(pulses[0], pulses[-1], 5001)
    np.testing.assert_allclose(fit_angle(pulses, turned).curve(t), theta(t), atol=1e-4)


def test_a_ramp_averages_jitter_over_all_its_turns(rng: np.random.Generator) -> None:
    """50 us make single pulses err by 18 mrad; 1.5 mrad are what 0.2 % of a vector leave for the angle."""
    pulses, turned = ramp_pulses()
    t = np.interp(np.linspace(0, turned[-1], 300), turned, pulses)  # evenly over the turns, as rows are
    error = [
        with_errors(pulses, turned, 50e-6 * rng.standard_normal(len(pulses)), rng).curve(t)
        - START * t
        - RATE * t**2 / 2
        for _ in range(30)
    ]
    assert np.sqrt(np.mean(np.square(error))) < 1.2e-3


@pytest.mark.parametrize("shape", ["normal", "uniform"])
def test_95_percent_of_the_angles_speeds_and_rates_of_a_ramp_lie_in_their_intervals(
    shape: str, rng: np.random.Generator
) -> None:
    pulses, turned = (values[:300] for values in ramp_pulses())
    t = np.linspace(pulses[0], pulses[-1], 100)
    truth = np.stack([START * t + RATE * t**2 / 2, START + RATE * t, np.full(len(t), RATE)], axis=1)
    inside = []
    for _ in range(200):
        unit = rng.standard_normal(len(pulses)) if shape == "normal" else rng.uniform(-1, 1, len(pulses)) * np.sqrt(3)
        fit = with_errors(pulses, turned, 20e-6 * unit, rng)
        wrong = np.stack([fit.curve(t), fit.curve(t, 1), fit.curve(t, 2)], axis=1) - truth
        inside.append(np.abs(wrong) < 1.96 * np.sqrt(fit.variance(t)))
    covered = np.mean(inside, axis=(0, 1))
    assert (covered > 0.92).all()  # 400 draws gave 93.3 to 96.0 %
    assert (covered < 0.98).all()


@pytest.mark.parametrize("frequency", [0.5, 2.0])
def test_a_speed_that_hunts_is_followed_within_the_stated_sigma(frequency: float, rng: np.random.Generator) -> None:
    theta = hunting(frequency)
    pulses, turned = pulses_of(theta, 10.0)
    t = np.linspace(pulses[0], pulses[-1], 1000)
    z = []
    for _ in range(30):
        fit = with_errors(pulses, turned, 5e-6 * rng.standard_normal(len(pulses)), rng)
        z.append((fit.curve(t) - theta(t)) / np.sqrt(fit.variance(t)[:, 0]))
    assert 0.93 < np.mean(np.abs(z) < 1.96) < 0.98
    bias = np.mean(z, axis=0)  # (time,) sigma; by chance 0.18
    assert np.sqrt(np.mean(bias**2)) < 0.4


def test_a_trip_is_followed_and_not_smoothed_away(rng: np.random.Generator) -> None:
    pulses, turned = pulses_of(tripped, 20.0)
    about, before = np.linspace(9.5, 10.5, 500), np.linspace(3.0, 7.0, 500)
    z, early = [], []
    for _ in range(30):
        fit = with_errors(pulses, turned, 20e-6 * rng.standard_normal(len(pulses)), rng)
        z.append((fit.curve(about) - tripped(about)) / np.sqrt(fit.variance(about)[:, 0]))
        early.append(fit.curve(before) - tripped(before))
    assert np.mean(np.abs(z) < 1.96) > 0.93
    assert np.sqrt(np.mean(np.square(early))) < 20e-6 * 3200 * RPM / 3  # away from it dozens of turns are averaged


@pytest.mark.parametrize("frequency", [4.0, 7.0, 12.3])
def test_a_torsional_swing_larger_than_the_jitter_is_followed(frequency: float, rng: np.random.Generator) -> None:
    def theta(t: NDArray[np.float64]) -> NDArray[np.float64]:
        return 3000 * RPM * t + 0.01 * np.sin(TURN * frequency * t)

    pulses, turned = pulses_of(theta, 10.0)
    t = np.linspace(pulses[0], pulses[-1], 1000)
    fits = [with_errors(pulses, turned, 5e-6 * rng.standard_normal(len(pulses)), rng) for _ in range(5)]
    wrong = np.array([fit.curve(t) - theta(t) for fit in fits])
    stated = np.sqrt([fit.variance(t)[:, 0] for fit in fits])
    assert np.sqrt(np.mean(wrong**2)) < 0.003  # of a swing of 0.007 rms that shows in fewer than five pulses
    assert np.mean(np.abs(wrong) < 1.96 * stated) > 0.93
    assert np.median(np.concatenate([fit.sigma for fit in fits])) == pytest.approx(5e-6, rel=0.4)


def test_the_timing_error_is_told_and_where_it_changes(rng: np.random.Generator) -> None:
    pulses, turned = ramp_pulses()
    sigma = np.where(np.arange(len(pulses)) < 800, 10e-6, 40e-6)
    found = fit_angle(pulses + sigma * rng.standard_normal(len(pulses)), turned).sigma
    assert found[:700].mean() == pytest.approx(10e-6, rel=0.1)
    assert found[900:].mean() == pytest.approx(40e-6, rel=0.1)


def test_a_coast_down_to_a_few_rpm_is_followed(rng: np.random.Generator) -> None:
    def theta(t: NDArray[np.float64]) -> NDArray[np.float64]:
        return 3600.0 * (1 - np.exp(-t / 6))  # from 5730 rpm

    pulses, turned = pulses_of(theta, 35.0)
    t = np.linspace(pulses[0], pulses[-1], 2000)
    fit = with_errors(pulses, turned, 20e-6 * rng.standard_normal(len(pulses)), rng)
    wrong = fit.curve(t) - theta(t)
    assert np.sqrt(np.mean(wrong**2)) < 5e-3
    assert np.mean(np.abs(wrong) < 1.96 * np.sqrt(fit.variance(t)[:, 0])) > 0.9


def test_nothing_is_carried_across_a_cut() -> None:
    """A quarter of a turn is lost in the cut, as after a gap: either side keeps its speed and is right by itself."""
    omega = 50.0
    pulses = TURN * np.arange(200) / omega
    later = pulses[100:] + 0.25 * TURN / omega
    t = np.concatenate([pulses[:100], later])
    fit = fit_angle(t, TURN * np.arange(200), cut=np.arange(199) == 99)
    np.testing.assert_allclose(fit.curve(pulses[:99], 1), omega, rtol=1e-6)
    np.testing.assert_allclose(fit.curve(later[1:], 1), omega, rtol=1e-6)
    middle = np.array([(pulses[99] + later[0]) / 2])
    assert np.sqrt(fit.variance(middle)[0, 0]) > 0.05


def test_the_uncertainty_grows_beyond_the_last_pulse_and_between_pulses(rng: np.random.Generator) -> None:
    theta = hunting(2.0)
    pulses, turned = pulses_of(theta, 5.0)
    fit = fit_angle(pulses + 5e-6 * rng.standard_normal(len(pulses)), turned)
    at = np.sqrt(fit.variance(pulses[[100]])[0, 0])
    between = np.sqrt(fit.variance((pulses[[100]] + pulses[[101]]) / 2)[0, 0])
    beyond = np.sqrt(fit.variance(np.array([pulses[0] - 0.02, pulses[-1] + 0.02]))[:, 0])
    assert at < between
    assert (beyond > 2 * at).all()
    np.testing.assert_allclose(np.sqrt(fit.variance(pulses[[100]])[0, 0]), np.sqrt(fit.smoothed[100, 0, 0]), rtol=1e-6)
