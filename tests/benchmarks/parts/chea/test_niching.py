"""The functions with many global minima have them where they say, and the other method finds some."""

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.parts.chea import niching_runs
from benchmarks.parts.chea.counting import Counted
from benchmarks.parts.chea.functions import Array
from benchmarks.parts.chea.nearest_better import clusters, nea2
from benchmarks.parts.chea.niching import niching_cases

CASES = {case.name: case for case, _ in niching_cases()}


def minima_of(name: str) -> Array:
    """Return the global minima (n, dim) that a dense sample is nearest to."""
    case = CASES[name]
    sample = np.random.default_rng(0).uniform(*case.bounds.T, (20_000, case.dim))
    return np.unique(case.minima.nearest(sample).round(9), axis=0)


@pytest.mark.parametrize("name", [name for name in CASES if not name.startswith(("Shubert 3", "Vincent 3"))])
def test_every_minimum_is_one_and_all_are_as_low(name: str) -> None:
    case = CASES[name]
    places = minima_of(name)
    assert len(places) == case.minima.count or case.dim == 10, "there, some are nearest to no point of the sample"
    values = case.fun(places)
    sample = case.fun(np.random.default_rng(1).uniform(*case.bounds.T, (20_000, case.dim)))
    np.testing.assert_allclose(values, values[0], atol=1e-6 * np.ptp(sample))
    assert sample.min() > values.max() - 1e-6 * np.ptp(sample), "none lower"
    step = 1e-4 * np.ptp(case.bounds, axis=1)
    for place, value in zip(places, values, strict=True):
        around = np.clip(place + step * np.random.default_rng(2).normal(size=(200, case.dim)), *case.bounds.T)
        assert case.fun(around).min() >= value - 1e-9 * np.ptp(sample)


def test_a_long_tie_between_two_groups_is_cut() -> None:
    two = np.array([[0.1, 0.1], [0.12, 0.1], [0.1, 0.12], [0.9, 0.9], [0.92, 0.9], [0.9, 0.92]])
    found = clusters(two, np.array([0.0, 1.0, 1.0, 0.5, 2.0, 2.0]))
    assert [place.tolist() for place, _ in found] == [[0.1, 0.1], [0.9, 0.9]]
    assert all(reach == 0.5 for _, reach in found), "half way, and no more than half the box"


def test_the_other_method_lists_the_minima_of_an_easy_function_within_its_calls() -> None:
    pytest.importorskip("cma")
    problem = CASES["Himmelblau 2"].problem(0)
    fun = Counted(problem.fun, budget=8000)
    found = nea2(fun, problem.bounds, np.random.default_rng(0))
    near = problem.minima.nearest(found.listed)
    hit = (np.abs(near - found.listed) <= problem.tolerance).all(axis=1)
    assert len(np.unique(near[hit].round(6), axis=0)) == 4
    assert 7000 < fun.calls <= 8000


def test_runs_are_summed_up_by_function_and_method_of_one_version(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def line(method: str, seed: int, listed: int, version: str = "a") -> str:
        about = {"version": version, "design": method, "name": f"Vincent 2 {seed}", "function": "Vincent 2"}
        return json.dumps({**about, "seed": seed, "listed": listed, "count": 36, "calls": 100 + seed, "own_ms": 0.5})

    kept = tmp_path / "kept.jsonl"
    kept.write_text("\n".join([line("chea all", 0, 36), line("chea all", 1, 18), line("NEA2", 0, 9, "b")]) + "\n")
    monkeypatch.setattr(niching_runs, "KEPT", kept)
    found = niching_runs.summarise(niching_runs.read_runs("a", any_version=False))["Vincent 2"]
    assert found["peak_ratio"] == 0.75
    assert found["chea all"]["all_listed"] == 0.5
    assert found["chea all"]["calls_median"] == 100.5
    assert "NEA2" not in found
    assert niching_runs.read_runs("none", any_version=False) == []
    assert len(niching_runs.read_runs("none", any_version=True)) == 1, "the newest there is"
