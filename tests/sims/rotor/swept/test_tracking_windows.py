"""What rows average, of amplitudes whose average is known."""

import numpy as np
import pytest

from rotorrig.sims.rotor.model.loads import Load
from rotorrig.sims.rotor.swept.excitation import sample_excitation
from rotorrig.sims.rotor.swept.timeline import SpeedRange, Timeline
from rotorrig.sims.rotor.swept.tracking_windows import tracked_rows

OMEGA = 200.0
PULSES = 2 * np.pi / OMEGA * np.arange(101)
MIDDLE = PULSES[50] + 0.3 / OMEGA


def averaged(amplitude, rate, **layout) -> complex:
    """Return the average of a(t) around the middle of the pulses; rows of several lengths stand beside it."""
    layout = {"revolutions": [8.0, 3.0, 21.5], "window": "hann"} | layout
    rows = tracked_rows(Timeline(PULSES), t=[MIDDLE] * 3, **layout)
    a, slope = (f(PULSES).astype(complex)[:, None, None] for f in (amplitude, rate))
    return rows.averages(a, slope, powers=3)[:, 0, 0, 0]


def test_a_constant_is_its_own_average():
    np.testing.assert_allclose(averaged(lambda t: 0 * t + 2 - 1j, lambda t: 0 * t), 2 - 1j, rtol=1e-12)


#: of a Vold-Kalman window: u is 5 pi times the distance from the middle, and integral u^2 e^-u (cos u + sin u) du from
#: 0 to 5 pi / 2 = (1 + 5 pi / 2) e^(-5 pi / 2), by parts
KALMAN = (1 + 2.5 * np.pi) * np.exp(-2.5 * np.pi) / (5 * np.pi) ** 2


@pytest.mark.parametrize(
    ("window", "variance"),
    [("rectangular", 1 / 12), ("hann", 1 / 12 - 1 / (2 * np.pi**2)), ("vold-kalman", KALMAN)],
)
def test_a_parabola_averages_to_its_middle_and_the_variance_of_the_window(window, variance):
    got = averaged(lambda t: 1j * (t - MIDDLE) ** 2, lambda t: 2j * (t - MIDDLE), window=window)
    length = 2 * np.pi / OMEGA * np.array([8.0, 3.0, 21.5])
    np.testing.assert_allclose(got, 1j * length**2 * variance, rtol=1e-6)


def test_a_slow_beat_passes_a_vold_kalman_window_as_the_filter_has_it_pass():
    """The filter's response is 1 / (1 + (f / f0)^4), f0 = 2 sqrt(2) / (pi turns) orders; its window 5 pi / 4 turns."""
    beat = OMEGA / 11.9
    turns = np.array([8.0, 3.0, 21.5]) * 4 / (5 * np.pi)
    want = 1 / (1 + (turns * np.pi / (2 * np.sqrt(2)) / 11.9) ** 4)
    wave = lambda t: np.exp(1j * beat * (t - MIDDLE))  # noqa: E731
    got = averaged(wave, lambda t: 1j * beat * wave(t), window="vold-kalman")
    np.testing.assert_allclose(got, want, atol=4e-4)  # what the window leaves out of the filter, and a cubic per turn


def test_a_whole_number_of_beats_is_lost_in_a_rectangular_window():
    beat = OMEGA / 8
    got = averaged(lambda t: np.exp(1j * beat * t), lambda t: 1j * beat * np.exp(1j * beat * t), window="rectangular")
    assert abs(got[0]) < 1e-3 < abs(got[1])


def test_powers_and_forces_follow_the_speed():
    """Omega = 100 + 2 t: the averages of x and of Omega^2 - j alpha over a window around t = 10 s, evenly in angle."""
    theta = 2 * np.pi * np.arange(400)
    timeline = Timeline((np.sqrt(100**2 + 4 * theta) - 100) / 2)
    rows = tracked_rows(timeline, t=[10.0], revolutions=8, window="rectangular")
    angle = timeline.theta(10.0) + 8 * np.pi * ((np.arange(1000) + 0.5) / 500 - 1)
    omega = np.sqrt(100**2 + 4 * angle)
    ones, zeros = np.ones((400, 1, 1), dtype=complex), np.zeros((400, 1, 1), dtype=complex)
    got = rows.averages(ones, zeros, powers=2)[0, :, 0, 0]
    np.testing.assert_allclose(got, [1, np.mean((omega - rows.speeds.centre) / rows.speeds.half)], rtol=1e-5)
    unbalance, constant = sample_excitation(
        [Load(np.zeros(1), "unbalance"), Load(np.zeros(1), "constant")], rows
    ).moments[0, 0]
    np.testing.assert_allclose([unbalance, constant], [np.mean(omega**2) - 2j, 1], rtol=1e-5)


def test_a_range_of_one_speed_still_has_powers():
    speeds = SpeedRange(100.0, 100.0)
    np.testing.assert_allclose(speeds.powers(np.array([100.0, 100.05]), 3), [[1, 0, 0], [1, 0.5, 0.25]], atol=1e-9)
