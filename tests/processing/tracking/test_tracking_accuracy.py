"""How exact the tracking is on run-ups from 600 to 6000 rpm whose truth is known in closed form.

Short versions of benchmarks/tracking.py, through a file as a user's recording goes: 50 um of 1X, 10 um of 2X, 5 um of
0.47X, 8 um of run-out, 0.5 um rms of noise.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.parts.tracking.accuracy import Coverage, Score, instant_truth, windowed_truth
from benchmarks.parts.tracking.signal import RunUp, resonant, standard, without, write_run
from rotorrig.acquisition.files.recording_mcap import read_recording
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import Method, OrderTrackedResponse
from rotorrig.processing.settings import Tracking
from tests.parameters import defer_rest

METHODS: tuple[Method, ...] = ("resampling", "least-squares", "vold-kalman")
FITTED: tuple[Method, ...] = ("least-squares", "vold-kalman")

Track = Callable[..., OrderTrackedResponse]


@pytest.fixture(scope="module")
def tracked(tmp_path_factory: pytest.TempPathFactory) -> Track:
    """Return what writes a run-up to a file and tracks it."""
    folder = tmp_path_factory.mktemp("run-ups")

    def tracked(run: RunUp, **settings: object) -> OrderTrackedResponse:
        return track(read_recording(write_run(folder / "run.mcap", run)), Tracking(**settings))

    return tracked


def score(response: OrderTrackedResponse, run: RunUp, order: float = 1.0) -> Score:
    return Score.of(response.order(order), run.truth(order), response.usable)


@pytest.mark.parametrize("method", defer_rest(METHODS))
def test_a_run_up_of_constant_vectors_is_tracked_to_a_twentieth_of_a_percent(tracked: Track, method: Method) -> None:
    run = without(standard(2), orders=(0.47,))
    found = score(tracked(run, method=method), run)
    assert found.vector_percent < 0.05  # 0.043 of it the noise's
    assert found.phase_deg < 0.05
    assert found.usable > 0.97


@pytest.mark.parametrize("method", FITTED)
def test_a_line_between_the_orders_that_nobody_asked_for_does_no_harm_to_a_fit(tracked: Track, method: Method) -> None:
    run = standard(2)
    found = score(tracked(run, method=method), run)
    assert found.vector_percent < 0.05
    assert found.phase_deg < 0.05


def test_a_line_between_the_orders_leaks_through_blackmans_window_as_its_transform_says(tracked: Track) -> None:
    """5 um at 0.53 orders from the 1X and 1.47 from its mirror image, x = orders times turns.

    Blackman's transform: sinc(x) (4 - 3 x^2 / 7) / ((1 - x^2) (4 - x^2)).
    """
    run = without(replace(standard(2), noise=0.0), orders=(4.0, 5.0))
    near, far = (np.sinc(x) * (4 - 3 * x**2 / 7) / ((1 - x**2) * (4 - x**2)) for x in (8 * 0.53, 8 * 1.47))
    expected = 100 * 5e-6 * np.hypot(near, far) / np.sqrt(np.mean(np.abs(run.truth(1.0)) ** 2))
    assert score(tracked(run), run).vector_percent == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("method", defer_rest(METHODS))
def test_jitter_of_50_us_and_missed_pulses_cost_a_fifth_of_a_percent_at_most(tracked: Track, method: Method) -> None:
    run = standard(2, jitter=50e-6, missed=0.01)
    found = score(tracked(run, method=method), run)
    assert found.vector_percent < 0.2
    assert found.usable > 0.95


@pytest.mark.parametrize("method", defer_rest(METHODS))
def test_a_row_at_a_resonance_is_the_mean_under_the_window_that_the_record_names(
    tracked: Track, method: Method
) -> None:
    run = resonant(2)
    response = tracked(run, method=method)
    truth = windowed_truth(run, response)
    at_peak = np.abs(truth) > 0.5 * np.abs(truth).max()
    usable = response.usable & at_peak
    error = Score.of(response.order(1.0), truth, usable)
    smear = Score.of(instant_truth(run, response), truth, usable)
    assert error.worst_percent < 0.05
    assert smear.worst_percent > 5 * error.worst_percent


@pytest.mark.campaign
@pytest.mark.parametrize("faults", [{}, {"jitter": 50e-6, "missed": 0.01}], ids=["ideal", "jitter"])
def test_95_percent_intervals_hold_the_truth_in_93_to_97_percent(tracked: Track, faults: dict[str, float]) -> None:
    counted = Coverage()
    for seed in range(4):
        run = without(standard(2, seed=seed, **faults), orders=(0.47,))
        counted.add(tracked(run), run, (0.0, 1.0, 2.0, 3.0))
    assert 0.93 <= counted.share() <= 0.97
