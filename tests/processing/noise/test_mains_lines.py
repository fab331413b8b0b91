"""Lines at fixed frequencies: found with the amplitude they were given, and told from resonances and noise."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from rotorrig.acquisition.recording import RawRecording
from rotorrig.processing.noise.covariance import NoiseSpectrum
from rotorrig.processing.noise.mains_lines import Line, line_remarks, line_transmission
from rotorrig.processing.pipeline import noise_between_orders, track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.rows.rows import Rows, lay_rows
from rotorrig.processing.shaft_angle.read_keyphasor import read_keyphasor
from rotorrig.processing.waveform import Waveforms
from tests.processing.synthetic import chirp

RPM = np.pi / 30
RATE = 2_000.0
SECONDS = 40.0
HUM = np.array([0.4e-6, 0.2e-6, 0.0, 0.05e-6])
FREQUENCY = 50.03
NOISE = 2e-8
T = np.arange(int(SECONDS * RATE)) / RATE


def theta(rate: float = 15 * RPM) -> np.ndarray:
    """Return the shaft angle of a rise from 600 rpm."""
    return chirp(T, start=600 * RPM, rate=rate, theta_0=-0.3)


def vibration(rng: np.random.Generator, angle: np.ndarray) -> np.ndarray:
    return 20e-6 * np.cos(angle)[:, None] + NOISE * rng.standard_normal((len(T), 4))


def hum(amplitude: np.ndarray = HUM) -> np.ndarray:
    return np.cos(2 * np.pi * FREQUENCY * T + 0.7)[:, None] * amplitude


@pytest.fixture(scope="module")
def pair(record: Callable[..., RawRecording]) -> tuple[RawRecording, RawRecording]:
    """The same recording without hum and with it."""
    x = vibration(np.random.default_rng(8), theta())
    clean, humming = (record(theta(), x + more, rate=RATE, marks=[(0.0, "up")]) for more in (0.0, hum()))
    return clean, humming


@pytest.fixture(scope="module")
def responses(pair: tuple[RawRecording, RawRecording]) -> tuple[OrderTrackedResponse, OrderTrackedResponse]:
    return track(pair[0]), track(pair[1])


def spectrum(recording: RawRecording) -> tuple[NoiseSpectrum, Rows]:
    waveforms = Waveforms(recording)
    shaft = read_keyphasor(waveforms)
    rows = lay_rows(shaft, [(0.0, SECONDS)], turns=8)
    return noise_between_orders(waveforms, shaft, rows, orders=(0.0, 1.0, 2.0, 3.0)), rows


def test_hum_is_found_with_its_frequency_and_amplitude(pair: tuple[RawRecording, RawRecording]) -> None:
    (line,) = spectrum(pair[1])[0].lines
    assert line.frequency == pytest.approx(FREQUENCY, abs=2e-3)
    np.testing.assert_allclose(line.amplitude, HUM, rtol=0.01, atol=1e-12)
    assert line.name == "mains hum at 50.0 Hz"


def test_no_line_is_found_in_noise(record: Callable[..., RawRecording]) -> None:
    for seed in range(10):
        x = vibration(np.random.default_rng(seed), theta())
        assert spectrum(record(theta(), x, rate=RATE, marks=[(0.0, "up")]))[0].lines == ()


@pytest.mark.parametrize("damping", [0.01, 0.005])
def test_a_natural_frequency_that_noise_excites_is_no_line(record: Callable[..., RawRecording], damping: float) -> None:
    for seed in range(5):
        rng = np.random.default_rng(seed)
        w = 2 * np.pi * 43.0 / RATE
        poles = np.exp(-damping * w), np.cos(w * np.sqrt(1 - damping**2))
        mode = lfilter([1], [1, -2 * poles[0] * poles[1], poles[0] ** 2], rng.standard_normal(len(T)))
        x = vibration(rng, theta()) + 1e-6 * (mode / mode.std())[:, None]
        assert spectrum(record(theta(), x, rate=RATE, marks=[(0.0, "up")]))[0].lines == ()


def test_nothing_is_told_at_one_speed_where_a_line_may_follow_the_shaft(record: Callable[..., RawRecording]) -> None:
    angle = theta(rate=0.0)
    x = vibration(np.random.default_rng(1), angle) + hum() + 1e-6 * np.cos(0.47 * angle)[:, None]
    assert spectrum(record(angle, x, rate=RATE, marks=[(0.0, "dwell")]))[0].lines == ()


def test_what_moves_with_the_speed_is_no_line(record: Callable[..., RawRecording]) -> None:
    x = vibration(np.random.default_rng(1), theta()) + 5e-6 * np.cos(0.47 * theta())[:, None]
    assert spectrum(record(theta(), x, rate=RATE, marks=[(0.0, "up")]))[0].lines == ()


@pytest.mark.parametrize("order", [1.0, 2.0, 3.0])
def test_what_a_line_is_said_to_add_is_what_it_adds(
    pair: tuple[RawRecording, RawRecording],
    responses: tuple[OrderTrackedResponse, OrderTrackedResponse],
    order: float,
) -> None:
    _, rows = spectrum(pair[1])
    without, humming = responses
    added = np.abs(humming.order(order) - without.order(order))[:, 0]
    said = HUM[0] * line_transmission(rows, order=order, frequency=FREQUENCY)
    np.testing.assert_allclose(added, said, atol=0.01 * HUM[0])  # side lobes three bins off are not told


def test_a_vold_kalman_window_lets_in_what_its_filter_does(
    pair: tuple[RawRecording, RawRecording],
) -> None:
    _, rows = spectrum(pair[1])
    slow = replace(rows, alpha=np.zeros_like(rows.alpha))
    passed = line_transmission(slow, order=3.0, frequency=FREQUENCY, window="vold-kalman")
    f0 = 2 * np.sqrt(2) / (8 * np.pi)  # orders, for 8 turns
    beside = (2 * np.pi * FREQUENCY / rows.omega - 3.0) / f0
    near = passed > 0
    assert near.any()
    np.testing.assert_allclose(passed[near], 1 / (1 + beside[near] ** 4), atol=2e-3)


def test_rows_that_a_line_falls_into_say_so_and_stay_usable(
    responses: tuple[OrderTrackedResponse, OrderTrackedResponse],
) -> None:
    clean, humming = responses
    assert not any(clean.remarks) and len(clean.remarks) == len(clean.t)
    assert humming.usable.all() and not any(humming.reasons)
    detected = np.array([any("falls into 3X" in word for word in row) for row in humming.remarks])
    bin_rpm = 2 * humming.omega / RPM / 8 / 3  # where the window of 8 turns ends
    apart = np.abs(humming.omega / RPM - 20 * FREQUENCY)
    assert detected[apart < 0.8 * bin_rpm].all()
    assert not detected[apart > bin_rpm + 30].any()
    crossing = int(apart.argmin())
    words = "mains hum at 50.0 Hz, 0.4 um at 1x, falls into 3X: adds up to 0.4 um"
    assert humming.remarks[crossing] == (words,)  # 3X itself is nothing but the hum: no share of it is told


def test_a_share_is_told_where_there_is_a_vector_and_nothing_below_a_fifth_of_a_percent(
    responses: tuple[OrderTrackedResponse, OrderTrackedResponse], pair: tuple[RawRecording, RawRecording]
) -> None:
    _, rows = spectrum(pair[1])
    row = int(np.abs(rows.omega / RPM - 20 * 50.0).argmin())
    response = responses[0]
    n = response.orders.index(3.0)
    for size, words in ((10e-6, "adds up to 0.4 um, 4.0% of it"), (1e-3, "")):
        z = response.z.copy()
        z[row, :, n] = size
        said = line_remarks((Line(frequency=50.0, amplitude=HUM),), replace(response, z=z), rows)[row]
        assert "".join(said).endswith(words) and bool(said) == bool(words)


def test_a_line_off_the_mains_is_called_fixed() -> None:
    names = [Line(frequency=f, amplitude=HUM).name for f in (37.2, 59.9, 120.0, 149.9, 52.0)]
    assert names == [
        "a fixed line at 37.2 Hz",
        "mains hum at 59.9 Hz",
        "mains hum at 120.0 Hz",
        "mains hum at 149.9 Hz",
        "a fixed line at 52.0 Hz",
    ]
