"""The parts of the tracking's benchmark: its signal, its arithmetic, a short live measurement, its page."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.parts.tracking import page as tracking_page
from benchmarks.parts.tracking.accuracy import Coverage, Score
from benchmarks.parts.tracking.figures import Figures
from benchmarks.parts.tracking.live import latencies, live_run, measure_latency, row_ends
from benchmarks.parts.tracking.page import METHODS
from benchmarks.parts.tracking.signal import RATE, RPM, blocks, resonant, rig_of, standard
from benchmarks.tracking import COVERED, cases
from docs import tracking_drawing


def test_the_run_up_turns_as_it_says() -> None:
    run = standard()
    t = np.linspace(0, 30, 50_001)
    speed = np.gradient(run.theta(t), t)
    np.testing.assert_allclose(speed[1:-1], (600 + 180 * t[1:-1]) * RPM, rtol=1e-6)
    np.testing.assert_allclose(run.omega(run.theta(t)), (600 + 180 * t) * RPM, rtol=1e-9)


def test_a_pulse_passes_its_threshold_when_the_shaft_is_at_zero_and_late_by_its_jitter() -> None:
    run = standard(jitter=50e-6, missed=0.1)
    turn = np.arange(1, 1600)
    edge = (run.omega(2 * np.pi * turn) - run.start) / run.acceleration
    late = run.pulses[turn]
    np.testing.assert_allclose(run.keyphasor(edge + np.nan_to_num(late)), np.where(np.isnan(late), -2, -6), atol=1e-6)
    assert np.nanstd(late) == pytest.approx(50e-6, rel=0.1)
    assert np.isnan(late).mean() == pytest.approx(0.1, abs=0.03)


def test_the_probes_see_what_the_truth_says_and_nothing_else() -> None:
    run = replace(standard(2), noise=0.0)
    t = np.linspace(20, 21, 20_001)
    theta = run.theta(t)
    fitted = np.column_stack([np.exp(1j * order * theta) for order in (0, 0.47, 1, 2, 3, 4, 5)])
    columns = np.column_stack([fitted.real, -fitted.imag[:, 1:]])
    x = run.displacement(t, np.random.default_rng(0))
    found, *_ = np.linalg.lstsq(columns, x, rcond=None)
    np.testing.assert_allclose(columns @ found, x, atol=1e-12)
    np.testing.assert_allclose(found[2] + 1j * found[8], run.truth(1.0), rtol=1e-9)
    np.testing.assert_allclose(found[0], 30e-6, rtol=1e-9)


def test_the_resonance_is_100_um_high_at_its_speed() -> None:
    run = resonant()
    assert run.resonance
    omega = np.linspace(600, 6000, 20_001) * RPM
    height = np.abs(run.resonance.at(omega)[:, 0])
    assert height.max() == pytest.approx(100e-6, rel=1e-3)
    assert omega[height.argmax()] == pytest.approx(2400 * RPM, rel=2e-3)


def test_the_counts_do_not_depend_on_how_long_the_blocks_are_but_for_the_noise() -> None:
    run = replace(standard(2, seconds=0.5), noise=0.0)
    rig = rig_of(2)
    whole, parts = (np.concatenate([b.counts for b in blocks(run, rig, scans)]) for scans in (30_000, 777))
    assert whole.shape == (RATE / 2, 3)
    np.testing.assert_array_equal(whole, parts)


def test_the_parts_of_the_error_are_taken_from_one_run_up() -> None:
    for name, run in cases().items():
        assert (run.noise > 0) == (name in ("ideal", "jitter", "noise alone"))
        assert (np.abs(run.truth(0.47)).max() > 0) == (name in ("ideal", "jitter", "0.47X alone"))


def test_a_score_is_of_usable_rows_and_parts_amplitude_from_phase() -> None:
    truth = np.array([2.0, 2j])
    z = np.array([[2.02, 2j], [2.0, 2j * np.exp(0.01j)], [7.0, 7.0]])
    found = Score.of(z, truth, np.array([[True, True], [True, True], [False, False]]))
    assert found.amplitude_percent == pytest.approx(0.5)
    assert found.phase_deg == pytest.approx(np.degrees(0.005))
    assert found.worst_percent == pytest.approx(1.0, rel=1e-4)
    assert found.vector_percent == pytest.approx(100 * np.sqrt(2 * 0.01**2 / 4), rel=1e-4)
    assert found.usable == pytest.approx(2 / 3)


def test_a_row_is_shown_by_the_first_picture_that_goes_beyond_its_end() -> None:
    handed = np.array([10.02, 10.04, 10.06, 10.08])
    shown, arrived = np.array([0.02, 0.06]), np.array([10.05, 10.2])
    got = latencies(np.array([0.015, 0.03, 0.079]), handed, shown, arrived)
    np.testing.assert_allclose(got, [10.05 - 10.02, 10.2 - 10.04])  # the third is in no picture


def test_rows_end_at_every_eighth_edge() -> None:
    run = live_run(10.0)
    np.testing.assert_allclose(run.theta(row_ends(run)) / (2 * np.pi), 8 * np.arange(1, len(row_ends(run)) + 1))


def test_a_live_view_shows_its_vectors_at_a_viewer_of_its_own() -> None:
    found = measure_latency(3.0)
    assert len(found) > 5
    assert (found > 0).all()
    assert found.max() < 30  # it came at all; how soon is the benchmark's to say


def test_the_pictures_curves_are_one_at_the_order_itself_and_nothing_at_the_others() -> None:
    for method, passed in tracking_drawing.passing(np.array([0.5, 1.0, 2.0, 3.0])).items():
        np.testing.assert_allclose(passed, [0, 1, 0, 0], atol=1e-6, err_msg=method)
    assert tracking_drawing.windows().text().startswith("<svg")


def test_the_page_and_the_summary_say_what_was_measured() -> None:
    score = Score(vector_percent=0.0321, amplitude_percent=0.02, phase_deg=0.011, worst_percent=0.4, usable=1.0)
    counted = Coverage(
        asked={(order, "re"): 200 for order in COVERED}, held={(order, "re"): 190 - int(order) for order in COVERED}
    )
    peers = ("ours", "rota-order", "plain scipy")
    figures = Figures(
        first={(case, method): score for case in cases() for method in METHODS},
        second={("ideal", method): score for method in METHODS},
        smear=dict.fromkeys(METHODS, score),
        coverage={(case, method): counted for case in ("ideal", "jitter") for method in METHODS},
        peers={peer + suffix: score for peer in peers for suffix in ("", ", jitter")},
        seconds={"ours": 0.2, "rota-order": 0.9, "plain scipy": 0.5},
        realtime={(method, probes): 150.0 * probes for method in METHODS for probes in (1, 8)},
        memory={(method, seconds): round(7e5 * seconds) for method in METHODS for seconds in (30.0, 300.0)},
        latency=np.array([0.2, 0.3]),
    )
    page = tracking_page.page(figures, draws=7, rounds=3)
    assert "Over 7 recordings" in page and "The best of 3" in page
    assert "| vold-kalman                         |   21 |   210 |" in page
    assert "2 rows of 8 turns:\n250 ms in the median" in page
    assert figures.summary() == {
        "realtime_factor": 150.0,
        "rms_percent": 0.0321,
        "phase_deg_rms": 0.011,
        "rms_percent_jitter": 0.0321,
        "coverage95": 0.9425,
        "live_latency_s": 0.299,
        "vs_rota_order": {"speed": 4.5, "error": 1.0, "error_jitter": 1.0},
        "vs_scipy": {"speed": 2.5, "error": 1.0, "error_jitter": 1.0},
    }
