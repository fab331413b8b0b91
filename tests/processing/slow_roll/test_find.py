"""Where the slow roll is taken: a dwell or a window of speed in a ramp; and what becomes of its rows."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotorrig.acquisition.recording import RawRecording
from rotorrig.processing.files.response_mcap import read_response, write_response
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.settings import SpeedWindow, Tracking
from rotorrig.processing.slow_roll.find import chosen_rows
from rotorrig.rig.errors import DataError

RPM = np.pi / 30
RATE = 5_000.0
RUNOUT = np.array([3e-6, -3e-6j, 2e-6j, 1e-6])
CRITICAL = 1600 * RPM
ECCENTRICITY = 20e-6
WINDOW = SpeedWindow(300 * RPM, 420 * RPM)


@pytest.fixture(scope="module")
def run_up(record: Callable[..., RawRecording]) -> RawRecording:
    """A rise from 300 to 2400 rpm and no dwell, of a disk off its centre on a shaft critical at 1600 rpm."""
    t = np.arange(int(90 * RATE)) / RATE
    speed = (300 + 2100 / 90 * t) * RPM
    theta = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 / RATE)]) - 0.3
    r = speed / CRITICAL
    A = RUNOUT + (ECCENTRICITY * r**2 / (1 - r**2 + 0.1j * r))[:, None]
    x = np.real(A * np.exp(1j * theta[:, None])) + 0.02e-6 * np.random.default_rng(0).standard_normal((len(t), 4))
    return record(theta, x, rate=RATE, marks=[(0.0, "up")])


@pytest.fixture(scope="module")
def windowed(run_up: RawRecording) -> OrderTrackedResponse:
    return track(run_up, Tracking(slow_roll=WINDOW))


def test_a_window_of_a_run_up_is_a_slow_roll(windowed: OrderTrackedResponse) -> None:
    chosen = (windowed.omega >= WINDOW.low) & (windowed.omega <= WINDOW.high)
    assert chosen.sum() >= 3
    assert windowed.slow_roll_omega == pytest.approx(np.sqrt(np.mean(windowed.omega[chosen] ** 2)))
    n = windowed.orders.index(1.0)
    np.testing.assert_allclose(windowed.slow_roll[:, n], windowed.z[chosen, :, n].mean(axis=0), rtol=1e-12)
    r = windowed.slow_roll_omega / CRITICAL
    response = ECCENTRICITY * r**2 / (1 - r**2 + 0.1j * r)
    np.testing.assert_allclose(windowed.slow_roll[:, n], RUNOUT + response, atol=0.02e-6)


def test_its_rows_stay_rows_of_their_run_whatever_is_said_of_it(windowed: OrderTrackedResponse) -> None:
    assert windowed.usable.all() and not any(windowed.reasons)
    assert any("is response to unbalance, not run-out" in words for words in windowed.slow_roll_remarks)


def test_how_much_of_it_is_response_is_told(windowed: OrderTrackedResponse) -> None:
    words = next(words for words in windowed.slow_roll_remarks if "response" in words)
    told = float(words.split("about ")[1].split(" um")[0])
    r = windowed.slow_roll_omega / CRITICAL
    assert told == pytest.approx(ECCENTRICITY * r**2 / (1 - r**2) * 1e6, rel=0.06)


def test_without_a_window_a_run_up_has_no_slow_roll(run_up: RawRecording) -> None:
    found = track(run_up)
    assert np.isnan(found.slow_roll).all() and found.slow_roll_remarks == ()


def test_a_window_the_speed_never_was_in_is_said(run_up: RawRecording) -> None:
    with pytest.raises(
        DataError, match=r"no row is between 100 and 200 rpm, want a slow-roll window within 3\d\d to 2"
    ):
        track(run_up, Tracking(slow_roll=SpeedWindow(100 * RPM, 200 * RPM)))


def test_only_rows_with_the_same_trial_masses_make_one_slow_roll(windowed: OrderTrackedResponse) -> None:
    other = replace(windowed.runs[0], name="up 2", trial_unbalance={"disk": 1e-6 + 0j})
    run = np.where(np.arange(len(windowed.t)) < 2, 0, 1)
    mixed = replace(windowed, runs=(*windowed.runs, other), run=run)
    np.testing.assert_array_equal(np.flatnonzero(chosen_rows(mixed, window=WINDOW)), [0, 1])


def test_a_dwell_that_is_none_loses_its_rows_and_says_why(run_up: RawRecording) -> None:
    events = (replace(run_up.events[0], text="slow roll"),)
    found = track(replace(run_up, events=events))
    assert found.slow_roll_remarks[0].startswith("the speed varies by")
    assert not found.usable.any()
    assert all(found.slow_roll_remarks[0] in row for row in found.reasons)


def test_what_was_found_is_in_the_file(windowed: OrderTrackedResponse, tmp_path: Path) -> None:
    write_response(tmp_path / "response.mcap", windowed)
    back = read_response(tmp_path / "response.mcap")
    assert back.slow_roll_remarks == windowed.slow_roll_remarks and back.remarks == windowed.remarks
    np.testing.assert_array_equal(back.slow_roll_waveform, windowed.slow_roll_waveform)
