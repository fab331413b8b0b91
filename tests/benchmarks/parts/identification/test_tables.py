"""Tables 8 and 10: the chapter's figures, the searches beside ours, what the summaries make of known runs."""

import numpy as np
import pytest

from benchmarks.parts.identification import table8, table10
from benchmarks.parts.identification.chapter import (
    NAMES,
    OBJECTIVES,
    TABLE8,
    TABLE8_REFERENCE,
    TABLE10,
    TABLE10_REFERENCE,
    errors,
)
from benchmarks.parts.identification.page import page
from benchmarks.parts.identification.searches import black_box, box, least_of_many
from benchmarks.parts.identification.table7 import oracle_response, steady
from rotorrig.identify.base_model.global_search import search_amplitudes
from rotorrig.identify.base_model.objectives import Amplitudes
from rotorrig.processing.response import OrderTrackedResponse


@pytest.fixture(scope="module")
def exact() -> Amplitudes:
    """Table 7's amplitudes, without noise."""
    return Amplitudes(steady(), np.abs(oracle_response()))


def test_the_printed_errors_follow_from_the_printed_values() -> None:
    ours, rk4 = errors(TABLE8, TABLE8_REFERENCE), errors(TABLE10, TABLE10_REFERENCE)
    assert [round(abs(x), 1) for x in ours["f1"].values()] == [8.1, 2.4, 414.0, 99.8, 5.2]
    assert [round(abs(rk4[f][name]), 1) for f in OBJECTIVES for name in ("kxx", "kyy", "u")] == pytest.approx(
        [8.9, 1.1, 7.8, 9.1, 1.7, 14.3, 1.2, 5.2, 7.5], abs=0.11
    )
    assert np.isnan(rk4["f1"]["cxx"])


@pytest.fixture(scope="module")
def response() -> OrderTrackedResponse:
    """The first rig of Table 10."""
    return table10.simulated(table10.FIRST_SEED)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_brute_force_from_the_true_values_stays_there(monkeypatch, objective, exact: Amplitudes) -> None:
    monkeypatch.setattr("benchmarks.parts.identification.searches._SCATTERED", 1)
    truth = np.array(TABLE8_REFERENCE)
    least = least_of_many(exact, objective=objective, starts=1, near=truth, rng=np.random.default_rng(1))
    assert least <= exact.cost(truth[None], objective=objective)[0] * (1 + 1e-9)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_brute_force_from_a_few_starts_meets_what_the_search_finds(monkeypatch, objective) -> None:
    monkeypatch.setattr("benchmarks.parts.identification.searches._SCATTERED", 1)
    monkeypatch.setattr("benchmarks.parts.identification.searches._CARRIED", 1)
    amplitudes, rng = table8.noisy(1), np.random.default_rng(2)
    optima, *_ = search_amplitudes(amplitudes, objective=objective, rng=rng)
    least = least_of_many(amplitudes, objective=objective, starts=2, near=table8.TRUTH, rng=rng)
    assert least == pytest.approx(optima[0].cost, rel=1e-6)


def test_a_black_box_keeps_to_the_budget_and_the_bounds(monkeypatch, exact: Amplitudes) -> None:
    monkeypatch.setattr("benchmarks.parts.identification.searches.BUDGET", 60)
    theta, cost, calls = black_box(exact, objective="f2", seed=1)
    assert calls <= 60
    assert ((box(exact)[:, 0] <= theta) & (theta <= box(exact)[:, 1])).all()
    assert cost == pytest.approx(float(exact.cost(theta[None], objective="f2")[0]))


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_a_black_box_finds_the_true_values_in_as_many_calls_as_the_chapter(objective, exact: Amplitudes) -> None:
    theta, _, calls = black_box(exact, objective=objective, seed=1)
    assert theta == pytest.approx(TABLE8_REFERENCE, rel=1e-3)
    assert calls <= 3000


def test_a_black_box_on_noise_ends_where_rounds_agree_and_at_the_end_of_a_descent(monkeypatch) -> None:
    monkeypatch.setattr("benchmarks.parts.identification.searches._ENOUGH", 2)
    amplitudes = table8.noisy(2)
    optima, *_ = search_amplitudes(amplitudes, objective="f2", rng=np.random.default_rng(1))
    theta, cost, calls = black_box(amplitudes, objective="f2", seed=2)
    assert cost == pytest.approx(optima[0].cost, rel=1e-3)
    assert theta == pytest.approx(optima[0].theta, rel=0.1)
    assert calls < 2500


def test_the_bound_of_table_8_is_that_of_differences_of_the_response() -> None:
    def logarithms(factors: np.ndarray) -> np.ndarray:
        return np.log(np.abs(steady().receptance.response(*(np.array(TABLE8_REFERENCE) * factors)))).ravel()

    step = 1e-5
    columns = [(logarithms(1 + step * e) - logarithms(1 - step * e)) / (2 * step) for e in np.eye(5)]
    J = np.stack(columns, axis=1)
    expected = np.sqrt(np.diag(np.linalg.inv(J.T @ J))) * 0.1 / np.sqrt(1.02)
    assert table8.bound() == pytest.approx(expected, rel=1e-4)


def run_of(error: float, *, cost: float = 2.0, least: float = 2.0) -> table8.Run:
    search = table8.Search(error=np.full(5, error), cost=cost, calls=100)
    return table8.Run(vector=search, scalar=None, least=least, at_truth=3.0, at_chapter=9.0)


def test_table_8_counts_the_draws_that_reached_the_least_and_those_as_wrong_as_the_chapter() -> None:
    runs = [run_of(-0.5), run_of(10.0), run_of(20.0, cost=2.1), run_of(20.0)]
    row = table8.summarise({name: runs for name in OBJECTIVES})["f3"]
    assert row["reached"] == 0.75
    assert row["kxx"] == 15.0
    assert row["quartiles"]["u"] == pytest.approx([7.625, 20.0])
    assert row["as_wrong"] == {"kxx": 0.0, "kyy": 0.5, "cxx": 0.0, "cyy": 0.5, "u": 0.0}
    assert (row["chapter_worse_than_truth"], row["chapter_over_least"]) == (1.0, 4.5)


def test_table_8_says_whose_error_it_was_and_has_no_row_for_black_boxes_not_run() -> None:
    text = table8.text({name: [run_of(-0.5), run_of(20.0)] for name in OBJECTIVES})
    (f3,) = (line for line in text.splitlines() if line.startswith("- f3."))
    assert "in no draw as wrong as the chapter's kxx (124 %), cxx (70.4 %), u (42.1 %): its optimiser's" in f3
    assert "kyy (14.8 %) in 50%" in f3
    assert "black box" not in text


def test_one_rig_of_table_10_end_to_end(response: OrderTrackedResponse) -> None:
    case = table10.identified(response, table10.FIRST_SEED)
    assert case.outcomes.keys() == {*OBJECTIVES, *(f"{name} uncompensated" for name in OBJECTIVES), "residual"}
    for name, limits in case.bounds.items():
        assert np.isfinite(limits).all() and (limits > 0).all(), name
    assert (case.bounds["vectors exact"] < case.bounds["vectors"]).all()
    assert (case.bounds["vectors"] <= case.bounds["amplitudes"]).all()
    assert (case.bounds["vectors exact"] <= case.bounds["amplitudes exact"]).all()
    assert (np.abs(case.outcomes["residual"].error) < 4 * case.bounds["vectors"]).all()
    summary = table10.summarise([case])
    assert summary.keys() >= {*OBJECTIVES, "residual", "crb"}
    assert set(NAMES) <= summary["residual"].keys()
    others = ("### Table 7\n\nx", "### Table 8\n\nx")
    written = page(*others, table10.text([case]), more=["### Time\n\nx"], seeds=3, starts=50)
    assert "3 runs of every search" in written and "(50 starts)" in written
    assert written.count("\n## ") == 4
    assert max(len(line) for line in written.splitlines() if not line.startswith("|")) <= 120


def test_the_rows_of_table_10_are_those_of_the_chapters_speeds(response: OrderTrackedResponse) -> None:
    assert len(response.omega) == len(table10.SPEEDS) == 84
    assert np.abs(response.omega - table10.SPEEDS).max() < 10 * np.pi / 30
    assert response.slow_roll_omega == pytest.approx(table10.SLOW_ROLL, rel=0.002)
    above = response.omega > 1200 * np.pi / 30
    amplitude = np.abs(response.compensated()[above])
    scatter = np.sqrt(np.diagonal(response.covariance[above, 0], axis1=1, axis2=2)[:, ::2])
    assert np.median(scatter / amplitude) == pytest.approx(0.05, rel=0.2)
