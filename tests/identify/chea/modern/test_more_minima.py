"""Minima that the natural end leaves unlisted: all that are as low as the best, or as many as the calls allow."""

import pickle

import numpy as np
import pytest

from benchmarks.parts.chea.niching import niching_cases
from rotorrig.identify.chea import CheaResult, Search, StopReason, chea

CASES = {case.name: case for case, _ in niching_cases()}


def listed(name: str, result: CheaResult, seed: int) -> int:
    """Return how many of the global minima are in the list."""
    problem = CASES[name].problem(seed)
    near = problem.minima.nearest(result.xl)
    there = (np.abs(near - result.xl) <= problem.tolerance).all(axis=1)
    return len(np.unique(near[there].round(6), axis=0))


def search(name: str, *, seed: int = 0, budget: int = 200_000, **how: object) -> CheaResult:
    problem = CASES[name].problem(seed)
    return chea(problem.fun, problem.bounds, rng=seed, vectorized=True, max_nfev=budget, **how)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("Himmelblau 2", 4),
        ("modified Rastrigin 2", 12),
        pytest.param("Shubert 2", 18, marks=pytest.mark.campaign),
        pytest.param("Vincent 2", 36, marks=pytest.mark.campaign),
        pytest.param("rugged 2", 8, marks=pytest.mark.campaign),
    ],
)
def test_all_global_minima_are_listed_and_it_ends_by_itself(name: str, count: int) -> None:
    found = search(name, stop="all")
    assert (listed(name, found, 0), CASES[name].minima.count) == (count, count)
    assert found.stop_reason is StopReason.CONVERGED
    assert found.nfev < 200_000


def test_the_natural_end_lists_fewer_in_fewer_calls() -> None:
    natural, everything = search("Shubert 2"), search("Shubert 2", stop="budget", budget=8000)
    assert listed("Shubert 2", natural, 0) < 18
    assert natural.nfev < 2000
    assert everything.nfev == 8000
    assert everything.stop_reason is StopReason.BUDGET
    assert listed("Shubert 2", everything, 0) == 18


def test_until_the_natural_end_it_is_the_same_search() -> None:
    natural, longer = search("Himmelblau 2"), search("Himmelblau 2", stop="budget", budget=3000)
    np.testing.assert_array_equal(longer.state.values[: natural.nfev], natural.state.values)


def test_a_search_for_more_goes_on_where_it_was_cut_off() -> None:
    problem = CASES["Himmelblau 2"].problem(0)
    whole = search("Himmelblau 2", stop="budget", budget=2500)
    part = search("Himmelblau 2", stop="budget", budget=1000)
    state = pickle.loads(pickle.dumps(part.state))
    gone_on = chea(problem.fun, resume=state, vectorized=True, max_nfev=2500)
    np.testing.assert_array_equal(gone_on.state.values, whole.state.values)


def test_the_chapters_search_has_a_natural_end_alone() -> None:
    with pytest.raises(ValueError, match="stop is 'all', expected 'natural' for profile='seed'"):
        search("Himmelblau 2", profile="seed", stop="all")
    with pytest.raises(ValueError, match="stop is 'never', expected 'natural' or 'budget' or 'all'"):
        Search([(0, 1)], stop="never")  # type: ignore[arg-type]


def test_a_lone_minimum_is_all_there_is() -> None:
    found = chea(lambda x: float((x**2).sum()), [(-1, 2), (-1, 2)], rng=0, stop="all")
    assert found.stop_reason is StopReason.CONVERGED
    assert len(found.xl) == 1
