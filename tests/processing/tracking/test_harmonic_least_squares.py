"""Least squares on the known angle, against sums of orders known in closed form."""

import numpy as np
import pytest

from rotorrig.processing.noise.covariance import NoiseSpectrum, row_covariance
from rotorrig.processing.rows.rows import Rows
from rotorrig.processing.tracking import angular_resampling, harmonic_least_squares

TURNS = 8
PSI = np.arange(-np.pi * TURNS, np.pi * TURNS, 2 * np.pi / 61.3)  # no whole number of samples per turn
EVEN = np.ones(len(PSI))


def fitted(x: np.ndarray, orders: tuple[float, ...]) -> np.ndarray:
    return harmonic_least_squares.order_vectors(x[:, None], PSI, EVEN, orders=orders, turns=TURNS)[0]


def summed(x: np.ndarray, orders: tuple[float, ...]) -> np.ndarray:
    return angular_resampling.order_vectors(x[:, None], PSI, EVEN, orders=orders, turns=TURNS)[0]


def test_every_order_of_a_steady_sum_is_found_to_rounding() -> None:
    x = 1e-3 + 5e-6 * np.cos(2 * PSI + 1) + 2e-6 * np.cos(PSI / 2) + 3e-6 * np.cos(3 * PSI - 2)
    want = [1e-3, 2e-6, 0, 5e-6 * np.exp(1j), 3e-6 * np.exp(-2j)]
    np.testing.assert_allclose(fitted(x, (0.0, 0.5, 1.0, 2.0, 3.0)), want, rtol=0, atol=1e-16)


def test_orders_one_bin_apart_are_told_apart_where_a_dft_mixes_them() -> None:
    close = 1 + 1 / TURNS
    x = 10e-6 * np.cos(PSI - 0.5) + 4e-6 * np.cos(close * PSI + 1)
    want = np.array([10e-6 * np.exp(-0.5j), 4e-6 * np.exp(1j)])
    np.testing.assert_allclose(fitted(x, (1.0, close)), want, rtol=0, atol=1e-16)
    assert np.abs(summed(x, (1.0, close)) - want).max() > 1e-6


def test_an_amplitude_that_changes_through_the_row_does_not_leak_into_its_neighbours() -> None:
    x = 10e-6 * (1 + 0.03 * PSI) * np.cos(PSI)
    assert np.abs(fitted(x, (0.0, 0.5, 1.0, 2.0)) - [0, 0, 10e-6, 0]).max() < 1e-16
    assert np.abs(summed(x, (0.0, 0.5, 1.0, 2.0)) - [0, 0, 10e-6, 0]).max() > 1e-9


def test_a_parabola_is_seen_as_under_the_hann_window() -> None:
    # mean of psi^2 under 1 + cos(psi / T) is T^2 (pi^2 / 3 - 2)
    A = (1 + 2j) + (0.01 - 0.02j) * PSI + (0.001 + 0.002j) * PSI**2
    want = (1 + 2j) + (0.001 + 0.002j) * TURNS**2 * (np.pi**2 / 3 - 2)
    assert fitted(np.real(A * np.exp(1j * PSI)), (1.0,))[0] == pytest.approx(want, rel=1e-4)


def test_a_backward_order_of_one_probe_is_the_conjugate() -> None:
    x = 10e-6 * np.cos(PSI - 0.5)
    forward, backward = fitted(x, (1.0, -1.0))
    assert backward == pytest.approx(np.conj(forward))


def test_too_few_samples_to_tell_the_orders_apart_give_finite_vectors() -> None:
    few = np.arange(-np.pi * TURNS, np.pi * TURNS, 2 * np.pi / 4)  # order 4 looks like order 0, order 3 like order 1
    z = harmonic_least_squares.order_vectors(
        np.cos(few)[:, None], few, np.ones(len(few)), orders=(1.0, 3.0), turns=TURNS
    )
    assert np.abs(z.sum() - 1) < 1e-6
    assert np.abs(z).max() < 1


@pytest.mark.parametrize(("order", "orders"), [(1.0, (0.0, 0.5, 1.0, 2.0)), (0.5, (0.5, 0.625)), (0.0, (0.0, 1.0))])
def test_the_noise_response_is_what_a_tone_beside_the_order_leaves(order: float, orders: tuple[float, ...]) -> None:
    beside = np.array([-9.3, -4.0, -1.7, -0.5, 0.0, 0.4, 1.0, 2.2, 6.1])
    tones = order + beside / TURNS
    of_cosine = np.array([fitted(np.cos(tone * PSI), orders)[orders.index(order)] for tone in tones])
    of_sine = np.array([fitted(np.sin(tone * PSI), orders)[orders.index(order)] for tone in tones])
    power = np.abs(of_cosine + 1j * of_sine) ** 2 / (4 if order else 1)
    found = harmonic_least_squares.noise_response(beside, order=order, orders=orders, turns=TURNS)
    np.testing.assert_allclose(found, power, rtol=1e-6, atol=1e-7)
    assert found[4] == pytest.approx(1.0)


def test_the_stated_variance_is_that_of_many_draws_for_close_orders_too(rng: np.random.Generator) -> None:
    orders, draws = (1.0, 1 + 1 / TURNS, 2.0), 4000
    noise = rng.standard_normal((len(PSI), draws))
    z = harmonic_least_squares.order_vectors(noise, PSI, EVEN, orders=orders, turns=TURNS)
    found = (z.real.var(axis=0) + z.imag.var(axis=0)) / 2
    rate, speed = 61.3 * 10.0, 2 * np.pi * 10.0  # samples per second at ten turns a second
    spectrum = NoiseSpectrum(frequency=np.arange(0, 300, 0.25), density=np.full((1200, 1, 1), 1 / rate, dtype=complex))
    nothing = np.zeros(1)
    rows = Rows(
        turns=TURNS,
        run=nothing.astype(np.intp),
        first_turn=nothing,
        begin=nothing,
        end=nothing + TURNS / 10,
        t=nothing,
        omega=nothing + speed,
        alpha=nothing,
    )
    stated = row_covariance(spectrum, rows, orders=orders, response=harmonic_least_squares.noise_response)
    np.testing.assert_allclose(stated[0, :, 0, 0], found, rtol=0.06)
    assert stated[0, 0, 0, 0] > 1.2 * stated[0, 2, 0, 0]  # what telling close orders apart costs
