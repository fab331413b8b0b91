"""The Vold-Kalman filter against its closed-form response, weights and noise; nothing here is taken from its code."""

import numpy as np
import pytest

from rotorrig.processing.rows.rows import Rows, lay_rows
from rotorrig.processing.shaft_angle.shaft_angle import ShaftAngle, fit_shaft_angle
from rotorrig.processing.tracking import vold_kalman
from rotorrig.processing.waveform import Waveforms
from tests.processing.synthetic import chirp

RATE = 4096.0
SPEED = 2 * np.pi * 40.0  # steady: 102.4 samples per turn
TURNS = 8
F0 = 2 * np.sqrt(2) / (np.pi * TURNS)  # orders
HALF = 5 * np.pi / 8 * TURNS  # turns


@pytest.fixture
def tracked(record):
    """Return z (row, order) of the first probe and the rows' middle [turns], of x(theta) at steady speed."""

    def tracked(x, *, seconds=6.0, orders=(1.0,), blocks=None, start=SPEED, rate=0.0) -> tuple[np.ndarray, np.ndarray]:
        t = np.arange(int(seconds * RATE)) / RATE
        theta = chirp(t, start=start, rate=rate, theta_0=-0.3)
        waveforms = Waveforms(record(theta, np.tile(x(theta)[:, None], 4), rate=RATE, blocks=blocks))
        shaft, rows = laid_out(seconds, start, rate)
        return vold_kalman.track(waveforms, shaft, rows, orders=orders)[:, 0], 2 * np.pi * rows.middle

    return tracked


def laid_out(seconds: float, start: float, rate: float) -> tuple[ShaftAngle, Rows]:
    """Return the true shaft angle and its rows."""
    pulses = 2 * np.pi * np.arange(int((start * seconds + rate * seconds**2 / 2 - 0.3) / (2 * np.pi)) + 1) + 0.3
    edges = pulses / start if rate == 0 else (np.sqrt(start**2 + 2 * rate * pulses) - start) / rate
    shaft = fit_shaft_angle(edges)
    return shaft, lay_rows(shaft, [(0.0, seconds)], turns=TURNS)


def known(z: np.ndarray) -> np.ndarray:
    return np.isfinite(z).all(axis=1)


def test_a_constant_vector_comes_out_as_it_is_and_the_gap_beside_it(tracked) -> None:
    z, _ = tracked(lambda theta: 3e-4 + 50e-6 * np.cos(theta - 0.5), orders=(0.0, 1.0))
    np.testing.assert_allclose(z[known(z)][:, 0], 3e-4, atol=5e-11)  # a count is 1.3e-10 m
    np.testing.assert_allclose(z[known(z)][:, 1], 50e-6 * np.exp(-0.5j), rtol=2e-5)


@pytest.mark.parametrize("beside", [0.3 * F0, F0, -1.5 * F0])
def test_what_lies_beside_the_order_passes_by_one_over_one_plus_the_fourth_power(tracked, beside: float) -> None:
    z, middle = tracked(lambda theta: 50e-6 * np.cos((1 + beside) * theta))
    want = 50e-6 * np.exp(1j * beside * middle) / (1 + (beside / F0) ** 4)
    error = np.abs(z[:, 0] - want)[known(z)]
    assert error.max() < 4e-4 * 50e-6  # e^(-5 pi / 2): the rows next to the ends lack what is beyond their support
    assert error[1:-1].max() < 4e-5 * 50e-6


def test_a_row_is_the_mean_of_the_amplitude_under_the_stated_weights_in_a_run_up(tracked) -> None:
    """An amplitude with a hump as long as a row, during a run-up; the mean by quadrature over the row's support."""

    def amplitude(theta: np.ndarray) -> np.ndarray:
        return 20e-6 + 60e-6j * np.exp(-(((theta / (2 * np.pi) - 150) / 9) ** 2))

    z, middle = tracked(lambda theta: (amplitude(theta) * np.exp(1j * theta)).real, seconds=8.0, rate=30.0)
    turns = np.linspace(-HALF, HALF, 4001)
    u = 4 * np.abs(turns) / TURNS
    w = np.exp(-u) * (np.cos(u) + np.sin(u))
    want = amplitude(middle[:, None] + 2 * np.pi * turns) @ w / w.sum()
    good = known(z)
    assert np.abs(want[good]).max() > 50e-6
    np.testing.assert_allclose(z[good, 0], want[good], atol=5e-8)


def test_orders_three_rows_lengths_apart_do_not_mix(tracked) -> None:
    near = 1 + 3 / TURNS
    z, _ = tracked(lambda theta: 50e-6 * np.cos(theta) + 20e-6 * np.sin(near * theta), orders=(1.0, near))
    np.testing.assert_allclose(z[known(z)], [[50e-6, -20e-6j]] * int(known(z).sum()), atol=2e-9)


def test_an_order_that_is_not_asked_for_leaks_as_the_response_says(tracked) -> None:
    z, _ = tracked(lambda theta: 50e-6 * np.cos(theta) + 20e-6 * np.cos(1.375 * theta))
    leak = np.abs(z[known(z), 0] - 50e-6).max()
    assert leak == pytest.approx(20e-6 / (1 + (0.375 / F0) ** 4), rel=0.02)


def test_the_backward_order_of_one_probe_is_the_conjugate_of_the_forward_one(tracked) -> None:
    z, _ = tracked(lambda theta: 50e-6 * np.cos(theta - 0.4), orders=(-1.0, 1.0, 0.5))
    assert known(z).any()
    np.testing.assert_array_equal(z[:, 0], z[:, 1].conj())


def test_rows_whose_support_reaches_into_a_gap_or_over_the_ends_have_no_vector(tracked) -> None:
    gap = (12_000, 12_100)
    z, middle = tracked(lambda theta: 50e-6 * np.cos(theta), blocks=[(0, gap[0]), (gap[1], 24_576)])
    turn = middle / (2 * np.pi)
    borders = np.array([0.0, *(s / RATE * 40 - 0.3 / (2 * np.pi) for s in gap), 239.0])  # first and last pulse: 0, 239
    clear = np.abs(turn[:, None] - borders).min(axis=1)
    np.testing.assert_array_equal(known(z), clear > HALF)
    np.testing.assert_allclose(z[known(z), 0], 50e-6, rtol=2e-4)  # e^(-5 pi / 2) of it is beyond the support


def test_white_noise_scatters_the_vectors_as_through_a_hann_window(tracked, rng: np.random.Generator) -> None:
    sigma = 1e-6
    z, _ = tracked(lambda theta: sigma * rng.standard_normal(len(theta)), seconds=60.0, orders=(0.0, 0.5, 1.0, 2.0))
    z = z[known(z)]
    expected = 1.5 * 2 * sigma**2 / (TURNS * RATE / 40)  # of re z and im z alike
    got = np.stack([z[:, 1:].real.var(axis=0), z[:, 1:].imag.var(axis=0)])
    np.testing.assert_allclose(got / expected, 1, atol=4 * np.sqrt(2 / len(z)))
    assert z[:, 0].real.var() / (expected / 2) == pytest.approx(1, abs=4 * np.sqrt(2 / len(z)))
    assert (z[:, 0].imag == 0).all()


def test_the_power_response_holds_as_much_noise_as_a_hann_window() -> None:
    x = np.linspace(-60, 60, 120_001)
    assert np.trapezoid(vold_kalman.power_response(x), x) == pytest.approx(1.5, rel=1e-6)
    assert vold_kalman.power_response(np.array(F0 * TURNS)) == pytest.approx(1 / 4)


def test_the_blocks_it_is_solved_in_leave_no_trace(tracked, monkeypatch: pytest.MonkeyPatch) -> None:
    def wave(theta: np.ndarray) -> np.ndarray:
        return 50e-6 * (1 + 0.3 * np.cos(theta / 40)) * np.cos(theta)

    whole, _ = tracked(wave)
    monkeypatch.setattr(vold_kalman, "BLOCK", 3)
    monkeypatch.setattr(vold_kalman, "CHUNK", 1001)
    pieces, _ = tracked(wave)
    np.testing.assert_allclose(pieces, whole, atol=5e-11)
