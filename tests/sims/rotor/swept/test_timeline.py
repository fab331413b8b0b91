"""Angle, speed and acceleration from pulses whose law is known."""

import numpy as np
import pytest

from rotorrig.rig.errors import DataError
from rotorrig.sims.rotor.swept.timeline import Timeline


def run_up(omega0: float, alpha: float, turns: int) -> np.ndarray:
    """Return the pulse times of theta = omega0 t + alpha t^2 / 2, the first at t = 0."""
    theta = 2 * np.pi * np.arange(turns)
    return (np.sqrt(omega0**2 + 2 * alpha * theta) - omega0) / alpha


def test_a_run_up_is_recovered_from_its_pulses():
    timeline = Timeline(run_up(50.0, 3.0, 400))
    t = np.linspace(0.5, timeline.t[-1] - 0.5, 50)
    np.testing.assert_allclose(timeline.theta(t), 50 * t + 1.5 * t**2, rtol=1e-8)
    np.testing.assert_allclose(timeline.omega(t), 50 + 3 * t, rtol=1e-6)
    np.testing.assert_allclose(timeline.alpha(t), 3.0, rtol=1e-3)


def test_the_angle_is_a_whole_number_of_turns_at_every_pulse():
    pulses = run_up(50.0, 3.0, 100)
    np.testing.assert_allclose(Timeline(pulses).theta(pulses), 2 * np.pi * np.arange(100), atol=1e-9)


@pytest.mark.parametrize("missing", [[40], [40, 41], [20, 60, 61]])
def test_missed_pulses_are_counted(missing):
    pulses = run_up(50.0, 3.0, 100)
    timeline = Timeline(np.delete(pulses, missing))
    np.testing.assert_allclose(timeline.t, pulses, atol=2e-6)


def test_turns_hold_the_speed_halfway_in_time():
    turns = Timeline(run_up(50.0, 3.0, 100)).turns()
    mid = (turns.t[1:] + turns.t[:-1]) / 2
    np.testing.assert_allclose(turns.omega_mid, 50 + 3 * mid, rtol=1e-4)
    assert np.all(np.abs(turns.theta_mid - np.pi) < 0.2)


@pytest.mark.parametrize(
    ("pulses", "message"),
    [
        ([0.0, 0.1, 0.2], r"pulse times of shape \(3,\), want four or more"),
        ([[0.0, 0.1], [0.2, 0.3]], r"pulse times of shape \(2, 2\)"),
        ([0.0, 0.1, 0.1, 0.2], "pulse 2 at 0.1 s is not later than the one before"),
        ([0.0, 0.1, np.nan, 0.2], "pulse 2 at nan s is not later"),
    ],
)
def test_pulses_that_make_no_timeline_are_refused(pulses, message):
    with pytest.raises(DataError, match=message):
        Timeline(pulses)


def test_a_phase_of_order_three_turns_three_times_as_often():
    timeline = Timeline(run_up(50.0, 3.0, 100))
    once, thrice = timeline.turns(), timeline.turns(3)
    np.testing.assert_allclose(thrice.t[::3], once.t, rtol=1e-9)
    np.testing.assert_allclose(thrice.omega[::3], 3 * once.omega, rtol=1e-9)
    np.testing.assert_allclose(thrice.omega_mid[1::3], 3 * once.omega_mid, rtol=1e-4)
    assert np.all(np.abs(thrice.theta_mid - np.pi) < 0.2)
