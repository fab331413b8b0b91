"""The smear: what a method makes of a vector that changes through its window is what the rotor model is told it makes.

A run-up passes a resonance whose 1X vector is known in closed form; the model's average of it over the window that
stands in the response has to be the vector tracked.
"""

from collections.abc import Callable

import numpy as np
import pytest

from rotorrig.acquisition.recording import RawRecording
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.settings import Tracking
from rotorrig.sims.rotor.swept.timeline import Timeline
from rotorrig.sims.rotor.swept.tracking_windows import tracked_rows
from tests.processing.synthetic import chirp

RPM = np.pi / 30
RATE, SECONDS = 10_000.0, 40.0
START, RISE = 900 * RPM, 45 * RPM
NATURAL, DAMPING = 1800 * RPM, 0.02  # a row of 8 turns takes 12 rpm, the peak is 72 rpm wide


def vector(omega: np.ndarray) -> np.ndarray:
    """Return 10 um of unbalance through a lightly damped natural frequency."""
    return 10e-6 * omega**2 / (NATURAL**2 - omega**2 + 2j * DAMPING * NATURAL * omega)


def its_rate(omega: np.ndarray) -> np.ndarray:
    """Return the same's derivative by time at a constant rise of speed."""
    below = NATURAL**2 - omega**2 + 2j * DAMPING * NATURAL * omega
    return 10e-6 * (2 * omega * below - omega**2 * (2j * DAMPING * NATURAL - 2 * omega)) / below**2 * RISE


@pytest.fixture(scope="module")
def passage(record: Callable[..., RawRecording]) -> RawRecording:
    t = np.arange(int(SECONDS * RATE)) / RATE
    theta = chirp(t, start=START, rate=RISE, theta_0=-0.3)
    x = np.real(vector(START + RISE * t) * np.exp(1j * theta))
    x = x[:, None] + 1e-9 * np.random.default_rng(4).standard_normal((len(t), 4))
    return record(theta, x, rate=RATE, marks=[(0.0, "up")])


def by_the_model(response: OrderTrackedResponse, rows: np.ndarray) -> np.ndarray:
    """Return the averages of the vector over the windows of `rows`, as identify takes them of its rotor."""
    timeline = Timeline(response.keyphasor_t)
    tracked = tracked_rows(timeline, t=response.t[rows], revolutions=response.revolutions[rows], window=response.window)
    omega = timeline.omega(response.keyphasor_t)
    return tracked.averages(vector(omega), its_rate(omega), powers=1)[:, 0]


@pytest.mark.parametrize("method", ["resampling", "least-squares", "vold-kalman"])
@pytest.mark.parametrize("turns", [8, 16])
def test_the_model_applies_the_smear_of_the_method(passage: RawRecording, method: str, turns: int) -> None:
    response = track(passage, Tracking(turns=turns, orders=(0.0, 1.0, 2.0), method=method))
    rows = np.flatnonzero(response.usable.all(axis=1))
    assert len(rows) > 0.9 * len(response.t)
    z, predicted = response.order(1.0)[rows, 0], by_the_model(response, rows)
    peak = np.abs(predicted).max()
    assert np.abs(z - predicted).max() < 5e-4 * peak
    smeared = np.abs(z - vector(response.omega[rows])).max()
    assert smeared > 4 * np.abs(z - predicted).max()  # without it the model would be off by more


def test_a_longer_window_smears_more(passage: RawRecording) -> None:
    top = [np.abs(track(passage, Tracking(turns=turns, orders=(1.0,))).order(1.0)).max() for turns in (4, 16, 64)]
    assert top[0] > top[1] > top[2]
    assert top[2] < 0.8 * top[0]
