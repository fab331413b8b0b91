"""The slow-roll waveform: its harmonics are the slow-roll vectors, and compensation undoes itself."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from rotorrig.acquisition.recording import RawRecording
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.settings import Spacing, SpeedWindow, Tracking
from rotorrig.processing.slow_roll.waveform import at_angles, points_per_turn, restore, subtract, turn_average
from rotorrig.rig.errors import DataError

RPM = np.pi / 30
RATE = 5_000.0
#: run-out of four probes at orders 1 to 5
RUNOUT = {1: 4e-6, 2: 1e-6j, 3: 0.5e-6, 5: 0.2e-6 * np.exp(0.4j)}
PROBES = np.array([1.0, 2.0, 0.5j, -1.0])
SETTINGS = {
    "dwell": Tracking(),
    "ramp": Tracking(slow_roll=SpeedWindow(480 * RPM, 700 * RPM)),
    "rows off the edge": Tracking(slow_roll=SpeedWindow(480 * RPM, 700 * RPM), every=Spacing(of="time", step=1.03)),
}


def runout(theta: np.ndarray) -> np.ndarray:
    """Return what the probes read of the shaft's surface at shaft angles theta (sample,), (sample, probe) m."""
    return np.real(sum(z * np.exp(1j * n * theta[:, None]) * PROBES for n, z in RUNOUT.items()))


@pytest.fixture(scope="module")
def sweep(record: Callable[..., RawRecording]) -> RawRecording:
    """Slow roll at 240 rpm for 12 s and a rise from 480 to 1280 rpm; the shaft turns in place."""
    t = np.arange(int(40 * RATE)) / RATE
    speed = np.interp(t, [0, 12, 16, 40], np.array([240, 240, 480, 1280]) * RPM)
    theta = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 / RATE)]) - 0.3
    x = 30e-6 + runout(theta) + 0.02e-6 * np.random.default_rng(0).standard_normal((len(t), 4))
    return record(theta, x, rate=RATE, marks=[(0.0, "slow roll"), (12.0, "settling"), (16.0, "up")])


@pytest.fixture(scope="module", params=SETTINGS.values(), ids=SETTINGS)
def response(sweep: RawRecording, request: pytest.FixtureRequest) -> OrderTrackedResponse:
    return track(sweep, request.param)


def test_it_is_what_the_surface_is(response: OrderTrackedResponse) -> None:
    found = response.slow_roll_waveform
    theta = 2 * np.pi * np.arange(found.shape[1]) / found.shape[1]
    np.testing.assert_allclose(found.T, runout(theta), atol=0.02e-6)
    np.testing.assert_allclose(found.mean(axis=1), 0, atol=1e-15)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_its_harmonics_are_the_slow_roll_vectors(response: OrderTrackedResponse, order: int) -> None:
    found = response.slow_roll_waveform
    theta = 2 * np.pi * np.arange(found.shape[1]) / found.shape[1]
    vectors = 2 * np.mean(found * np.exp(-1j * order * theta), axis=1)
    np.testing.assert_allclose(vectors, response.slow_roll[:, response.orders.index(order)], atol=1e-11)


def test_a_compensated_waveform_keeps_what_is_not_run_out(
    response: OrderTrackedResponse, rng: np.random.Generator
) -> None:
    theta = np.sort(rng.uniform(0, 50, 2000))  # any angles, whole turns or not
    motion = np.stack([20e-6 * np.cos(theta + p) for p in range(4)], axis=1)
    compensated = subtract(30e-6 + motion + runout(theta), theta, response.slow_roll_waveform)
    np.testing.assert_allclose(compensated, 30e-6 + motion, atol=0.02e-6)


def test_restoring_gives_the_raw_waveform_back(response: OrderTrackedResponse, rng: np.random.Generator) -> None:
    theta, x = rng.uniform(0, 50, 500), 1e-4 * rng.standard_normal((500, 4))
    before = x.copy()
    there = subtract(x, theta, response.slow_roll_waveform)
    np.testing.assert_allclose(restore(there, theta, response.slow_roll_waveform), x, rtol=0, atol=1e-19)
    np.testing.assert_array_equal(x, before)


def test_between_its_points_an_order_is_right_to_the_fourth_power_of_their_step() -> None:
    theta = np.linspace(0, 4 * np.pi, 999)
    for order in (1, 7, 20):
        points = np.cos(order * 2 * np.pi * np.arange(512) / 512)[None]
        worst = np.abs(at_angles(points, theta)[:, 0] - np.cos(order * theta)).max()
        assert worst < 1.1 * (2 * np.pi * order / 512) ** 4 / 384 + 1e-15


def test_a_window_that_begins_between_two_points_has_its_own_harmonics() -> None:
    turns, points, behind = 4, 32, 0.4 / 32
    theta = 2 * np.pi * np.arange(turns * points) / points
    x = np.cos(theta + 0.3) * (1 + 0.1 * theta)  # grows: the mean of its amplitude is that in the window's middle
    found = turn_average(x[:, None], turns=turns, behind=behind)[:, 0]
    z = 2 * np.mean(found * np.exp(-2j * np.pi * np.arange(points) / points))
    assert abs(z) == pytest.approx(1 + 0.1 * 2 * np.pi * (turns / 2 - behind), rel=2e-3)
    assert np.angle(z) == pytest.approx(0.3, abs=2e-3)


def test_there_is_none_without_a_slow_roll(sweep: RawRecording) -> None:
    marks = tuple(event for event in sweep.events if event.text != "slow roll")
    found = track(replace(sweep, events=marks))
    assert found.slow_roll_waveform.shape == (0, 0)
    with pytest.raises(DataError, match="no slow-roll waveform to compensate with"):
        subtract(np.zeros((3, 4)), np.zeros(3), found.slow_roll_waveform)


def test_points_per_turn_are_as_many_as_the_samples_fill() -> None:
    assert [points_per_turn(samples) for samples in (5.0, 40.0, 700.0, 1e5)] == [16, 32, 512, 512]
