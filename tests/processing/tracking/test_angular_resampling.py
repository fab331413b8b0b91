"""Order vectors against signals whose order content is known in closed form."""

import numpy as np
import pytest

from rotorrig.processing.pipeline import track
from rotorrig.processing.tracking.angular_resampling import order_vectors
from rotorrig.processing.windows import blackman
from tests.processing.synthetic import chirp

RPM = np.pi / 30
START, RATE = 600 * RPM, 5400 * RPM / 30  # 600 to 6000 rpm in 30 s


def one_row(x: np.ndarray, psi: np.ndarray, *, turns: int = 8, orders: tuple[float, ...] = (1.0,)) -> np.ndarray:
    return order_vectors(x[:, None], psi, np.ones(len(psi)), orders=orders, turns=turns)[0]


def turned(turns: int, per_turn: float) -> np.ndarray:
    return np.arange(-np.pi * turns, np.pi * turns, 2 * np.pi / per_turn)


def test_a_heavy_spot_seen_30_degrees_after_the_keyphasor_has_a_phase_lag_of_30_degrees() -> None:
    theta = turned(8, 256)
    z = one_row(np.cos(theta - np.radians(30)), theta)[0]
    assert abs(z) == pytest.approx(1.0, abs=1e-9)  # 0-peak
    assert np.degrees(np.angle(z)) == pytest.approx(-30.0, abs=1e-9)
    assert np.degrees(-np.angle(z)) == pytest.approx(30.0, abs=1e-9)


def test_orders_do_not_leak_into_each_other() -> None:
    theta = turned(8, 100.3)  # no whole number of samples per turn
    x = 1e-3 + 5e-6 * np.cos(2 * theta + 1) + 2e-6 * np.cos(theta / 2) + 3e-6 * np.cos(3 * theta)
    z = one_row(x, theta, orders=(0.0, 0.5, 1.0, 2.0, 3.0))
    np.testing.assert_allclose(z, [1e-3, 2e-6, 0, 5e-6 * np.exp(1j), 3e-6], atol=3e-11)


def test_twenty_samples_per_turn_are_enough() -> None:
    for start in np.linspace(0, 1, 7):
        theta = turned(8, 20.3) + start * 2 * np.pi / 20.3
        theta = theta[theta < 8 * np.pi]
        assert abs(one_row(np.cos(theta), theta)[0] - 1) < 1e-5


def test_a_row_is_the_mean_of_the_amplitude_under_blackmans_window() -> None:
    # A = A0 + A1 psi + A2 psi^2: the odd part drops out; the mean of psi^2 is T^2 (pi^2 / 3 - 16 / 7)
    turns, theta = 8, turned(8, 200)
    A = (1 + 2j) + (0.01 - 0.02j) * theta + (0.001 + 0.002j) * theta**2
    z = one_row(np.real(A * np.exp(1j * theta)), theta, turns=turns)[0]
    want = (1 + 2j) + (0.001 + 0.002j) * turns**2 * (np.pi**2 / 3 - 16 / 7)
    assert z == pytest.approx(want, rel=2e-3)  # A is no band-limited modulation: its kink at the ends leaks a little
    weight = blackman(theta, turns=turns)
    assert z == pytest.approx(weight @ A / weight.sum(), rel=2e-3)


def test_a_fast_run_up_is_tracked_to_a_twentieth_of_a_percent(record) -> None:
    rate = 25_600.0
    t = np.arange(int(30 * rate)) / rate
    theta = chirp(t, start=START, rate=RATE, theta_0=-0.3)
    A = np.array([100e-6 * np.exp(-0.5j), 50e-6, 20e-6j, 5e-6])
    B = np.array([10e-6, 0, 3e-6j, 1e-6])
    x = np.real(A * np.exp(1j * theta[:, None]) + B * np.exp(2j * theta[:, None])) + 3e-6 * np.cos(3 * theta[:, None])
    response = track(record(theta, x, rate=rate, marks=[(0.0, "up")]))
    error = np.abs(response.order(1) - A) / np.abs(A)
    assert np.sqrt(np.mean(error**2)) < 1e-4  # measured 4.5e-5; asked for 5e-4
    assert error.max() < 5e-4
    assert np.abs(response.order(2) - B).max() < 2e-8
    np.testing.assert_allclose(response.omega, START + RATE * response.t, rtol=1e-4)
    slow = response.omega < 3000 * RPM  # an edge takes several samples there, so that its time is exact
    np.testing.assert_allclose(response.alpha[slow], RATE, rtol=1e-4)
    np.testing.assert_allclose(response.alpha, RATE, rtol=0.06)
    assert response.usable.all()


def test_shifting_the_keyphasor_turns_every_order_by_its_share(record) -> None:
    rate, shift = 10_000.0, np.radians(40)
    t = np.arange(int(12 * rate)) / rate
    theta = chirp(t, start=100.0, rate=5.0, theta_0=-0.3)
    x = np.tile((10e-6 * np.cos(theta + 0.2) + 4e-6 * np.cos(2 * theta - 0.7))[:, None], 4)
    here, there = (track(record(angle, x, rate=rate, marks=[(0.0, "up")])) for angle in (theta, theta - shift))
    for order, size in ((1, 10e-6), (2, 4e-6)):
        np.testing.assert_allclose(
            here.order(order)[5:-5, 0] * np.exp(1j * order * shift) / size,
            np.interp(here.t[5:-5], there.t, there.order(order)[:, 0]) / size,
            atol=1e-3,
        )
