"""The covariance of order vectors against noise of known spectrum."""

import numpy as np
import pytest
from scipy.signal import lfilter

from rotorrig.processing.noise.covariance import NoiseSpectrum, row_covariance
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.rows.rows import Rows
from tests.processing.synthetic import chirp, falling_notch

RPM = np.pi / 30
RATE = 5_000.0
NATURAL, DAMPING = 2226 * RPM, 0.015
MODE = np.array([1.0, 0.3, 0.8, -0.2])  # of the resonance at the four probes


def rows_at(frequency: list[float], *, turns: int = 8) -> Rows:
    f = np.array(frequency)
    nothing = np.zeros(len(f))
    return Rows(
        turns=turns,
        run=nothing.astype(np.intp),
        first_turn=nothing,
        begin=nothing,
        end=turns / f,
        t=nothing,
        omega=2 * np.pi * f,
        alpha=nothing,
    )


def resonance(rng: np.random.Generator, samples: int, *, rms: float) -> np.ndarray:
    """Return noise of a lightly damped natural frequency: white noise through two poles."""
    r, w = np.exp(-DAMPING * NATURAL / RATE), NATURAL * np.sqrt(1 - DAMPING**2) / RATE
    x = lfilter([1.0], [1.0, -2 * r * np.cos(w), r**2], rng.standard_normal(samples + 20_000))[20_000:]
    return rms * x / x.std()


def whitened(response: OrderTrackedResponse, error: np.ndarray, order: float) -> np.ndarray:
    """Return the errors (row, probe) in standard deviations, (row, 2 probe), correlations taken out."""
    pairs = np.stack([error.real, error.imag], axis=-1).reshape(len(error), -1)
    root = np.linalg.cholesky(response.covariance[:, response.orders.index(order)])
    return np.linalg.solve(root, pairs[..., None])[..., 0]


def test_white_noise_has_the_variance_of_a_mean_weighted_by_blackmans_window() -> None:
    sigma, rate, turns, speed = 2.0, 1000.0, 8, 40.0
    spectrum = NoiseSpectrum(
        frequency=np.arange(0, 500, 0.5),
        density=np.full((1000, 1, 1), sigma**2 / rate, dtype=complex),  # two-sided
    )
    covariance = row_covariance(spectrum, rows_at([speed], turns=turns), orders=(0.0, 1.0, 2.0))[0]
    n, broad = rate * turns / speed, 1523 / 882  # noise bandwidth of 0.42, 0.50, 0.08: Harris, table 1
    np.testing.assert_allclose(covariance[1], broad * 2 * sigma**2 / n * np.eye(2), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(covariance[2], covariance[1])
    assert covariance[0, 0, 0] == pytest.approx(broad * sigma**2 / n)  # the mean, not twice it


def test_a_quarter_turn_between_probes_correlates_real_with_imaginary_parts() -> None:
    # y lags x by 90 degrees at positive frequencies: z_y = -j z_x, so re y = im x and im y = -re x
    one = np.array([[1.0, 1.0j], [-1.0j, 1.0]])
    spectrum = NoiseSpectrum(frequency=np.arange(0, 200, 0.5), density=np.tile(one, (400, 1, 1)))
    c = row_covariance(spectrum, rows_at([50.0]), orders=(1.0,))[0, 0]
    np.testing.assert_allclose(c / c[0, 0], [[1, 0, 0, -1], [0, 1, 1, 0], [0, 1, 1, 0], [-1, 0, 0, 1]], atol=1e-6)


@pytest.fixture(scope="module")
def noisy(record) -> tuple[OrderTrackedResponse, np.ndarray]:
    """A run-up through a natural frequency that random forces excite; with the vectors that are there in truth."""
    rng = np.random.default_rng(3)
    t = np.arange(int(140 * RATE)) / RATE
    theta = chirp(t, start=480 * RPM, rate=20 * RPM, theta_0=-0.3)
    A = np.array([20e-6, 10e-6j, 5e-6, 15e-6 * np.exp(2j)])
    B = np.array([4e-6, 0, 1e-6j, 0])
    x = np.real(A * np.exp(1j * theta[:, None]) + B * np.exp(2j * theta[:, None]))
    x += 0.2e-6 * rng.standard_normal(x.shape) + np.outer(resonance(rng, len(t), rms=0.5e-6), MODE)
    return track(record(theta, x, rate=RATE, marks=[(0.0, "up")])), A, B


def test_intervals_of_95_percent_cover_the_truth_93_to_97_times_in_100(noisy) -> None:
    response, *truth = noisy
    for order, vectors in zip((1.0, 2.0), truth, strict=True):
        inside = np.abs(whitened(response, response.order(order) - vectors, order)) < 1.96
        assert inside.size > 4000
        assert 0.93 < inside.mean() < 0.97
        assert (inside.mean(axis=0) > 0.91).all()


def test_sigma_is_right_where_1x_crosses_the_noisy_natural_frequency_and_elsewhere(noisy) -> None:
    response, A, _ = noisy
    sigmas = whitened(response, response.order(1.0) - A, 1.0)
    off = response.omega / NATURAL - 1
    for region in (off < -0.2, (off > -0.2) & (off < -0.05), np.abs(off) < 0.05, (off > 0.05) & (off < 0.2), off > 0.2):
        power = np.mean(sigmas[region] ** 2)
        assert power == pytest.approx(1.0, abs=5 * np.sqrt(2 / sigmas[region].size) + 0.08)  # chi square + spectrum
    sigma = np.sqrt(response.covariance[:, response.orders.index(1.0), 0, 0])
    assert np.median(sigma[np.abs(off) < 0.01]) > 10 * np.median(sigma[off < -0.5])


def test_noise_of_one_mode_correlates_the_probes_as_the_mode_shape(noisy) -> None:
    response, *_ = noisy
    row = int(np.argmin(np.abs(response.omega - NATURAL)))
    c = response.covariance[row, response.orders.index(1.0)]
    assert c[0, 4] / c[0, 0] == pytest.approx(MODE[2], abs=0.05)
    assert c[0, 6] / c[0, 0] == pytest.approx(MODE[3], abs=0.05)


def test_a_large_resonance_does_not_leak_into_the_noise(record, rng: np.random.Generator) -> None:
    t = np.arange(int(60 * RATE)) / RATE
    theta = chirp(t, start=1200 * RPM, rate=30 * RPM, theta_0=-0.3)
    w = 1200 * RPM + 30 * RPM * t
    A = 15e-6 * w**2 / (NATURAL**2 - w**2 + 2j * DAMPING * NATURAL * w)  # 500 um at its peak
    x = np.real(A * np.exp(1j * theta))[:, None] + 0.1e-6 * rng.standard_normal((len(t), 4))
    response = track(record(theta, x, rate=RATE, marks=[(0.0, "up")]))
    slow = response.omega < 1500 * RPM
    samples = RATE * 8 * 2 * np.pi / response.omega
    want = 0.1e-6 * np.sqrt(1.5 * 2 / samples)
    twice = response.covariance[:, response.orders.index(2.0), 0, 0]
    np.testing.assert_allclose(np.sqrt(twice)[slow], want[slow], rtol=0.15)


def test_keyphasor_jitter_raises_the_covariance_across_the_vector_only(record, rng: np.random.Generator) -> None:
    t = np.arange(int(60 * RATE)) / RATE
    swing = 0.05 * np.sin(2 * np.pi * t)  # rad; without it hundreds of turns would average the jitter away
    theta = chirp(t, start=1200 * RPM, rate=20 * RPM, theta_0=-0.3) + swing
    x = np.tile(100e-6 * np.cos(theta)[:, None], 4) + 0.01e-6 * rng.standard_normal((len(t), 4))
    notch = falling_notch(theta, slope=np.radians(10)) + 0.3 * rng.standard_normal(len(t))
    response = track(record(theta, x, rate=RATE, marks=[(0.0, "up")], notch=notch))
    error = response.order(1.0) - 100e-6
    assert error.imag.std() > 10 * error.real.std()  # the vector is real: jitter turns it
    sigma = np.sqrt(response.covariance[:, response.orders.index(1.0), 1, 1])
    assert np.sqrt(np.mean((error.imag[:, 0] / sigma) ** 2)) == pytest.approx(1.0, abs=0.2)


def test_noise_that_grows_with_speed_is_told_so_row_by_row(record, rng: np.random.Generator) -> None:
    """White noise of e^{b Omega / 2}: the variance of a row, which has the same turns, goes as Omega e^{b Omega}."""
    t = np.arange(int(60 * RATE)) / RATE
    theta, growth = chirp(t, start=600 * RPM, rate=40 * RPM), 0.006
    omega = (600 + 40 * t) * RPM
    noise = 1e-7 * np.exp(growth * omega / 2)[:, None] * rng.standard_normal((len(t), 4))
    response = track(record(theta, 20e-6 * np.cos(theta)[:, None] + noise, rate=RATE, marks=[(0.0, "up")]))
    variance = response.covariance[:, response.orders.index(1.0), 0, 0]
    slope = np.polyfit(response.omega, np.log(variance / response.omega), 1)[0]
    assert slope == pytest.approx(growth, rel=0.1)
    error = response.order(1.0) - 20e-6
    for rows in np.array_split(np.arange(len(error)), 3):
        sigmas = whitened(response, error, 1.0)[rows]
        assert np.mean(sigmas**2) == pytest.approx(1.0, abs=4 * np.sqrt(2 / sigmas.size))


def test_mains_hum_is_not_in_the_covariance_and_its_phase_is_told(record, rng: np.random.Generator) -> None:
    t = np.arange(int(60 * RATE)) / RATE
    theta = chirp(t, start=600 * RPM, rate=40 * RPM)
    x = 20e-6 * np.cos(theta)[:, None] + 2e-8 * rng.standard_normal((len(t), 4))
    hum = 1e-6 * np.cos(2 * np.pi * 49.99 * t + 0.5)[:, None]
    clean, humming = (track(record(theta, x + more, rate=RATE, marks=[(0.0, "up")])) for more in (0.0, hum))
    assert clean.mains == ()
    (followed,) = humming.mains
    phase = np.interp(humming.t, followed.t, followed.sigma)
    variances = [np.diagonal(r.covariance[:, 1:], axis1=2, axis2=3) for r in (humming, clean)]
    assert (variances[0] < 1.5 * variances[1] + 1.1 * ((1e-6 * phase) ** 2)[:, None, None]).all()
    assert (variances[0] > 0.6 * variances[1]).all()
    crossing = np.abs(humming.omega / np.pi - 50).argmin()  # by 2X
    assert variances[0][crossing, 1] == pytest.approx((1e-6 * phase[crossing]) ** 2 / 2, rel=0.2)
    assert followed.frequency == 50.0
    ahead = 0.5 - 2 * np.pi * 0.01 * followed.t
    assert np.abs(np.angle(np.exp(1j * (followed.stray - ahead)))).max() < 0.1


def test_probes_that_read_alike_to_the_last_count_leave_the_covariance_invertible(record) -> None:
    t = np.arange(int(20 * RATE)) / RATE
    theta = chirp(t, start=600 * RPM, rate=20 * RPM, theta_0=-0.3)
    response = track(record(theta, np.zeros((len(t), 4)), rate=RATE, marks=[(0.0, "up")]))
    np.linalg.cholesky(response.covariance)
