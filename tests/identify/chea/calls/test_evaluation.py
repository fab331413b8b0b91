"""However the objective is called, the search is the same."""

import re
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.optimize import rosen

from rotorrig.identify.chea import StopReason, chea
from rotorrig.identify.chea.calls.evaluation import Evaluation

BOX = [(-2.0, 2.0), (-2.0, 2.0)]
FIVE = np.random.default_rng(0).uniform(-2, 2, (5, 2))
EXPECTED = [rosen(x) for x in FIVE]


def ways(fun) -> list[tuple[object, dict]]:
    """Return fun and options of `chea` for every way to call it."""
    return [
        (fun, {}),
        (lambda x: np.array([fun(one) for one in x]), {"vectorized": True}),
        (fun, {"workers": 2}),
        (fun, {"workers": map}),
    ]


@pytest.mark.parametrize("way", range(4), ids=["one by one", "vectorized", "workers", "map"])
def test_every_point_has_its_value_in_order(way: int) -> None:
    fun, options = ways(rosen)[way]
    with Evaluation(fun, **options) as evaluation:
        for n in (5, 1, 5):
            outcomes = list(evaluation(FIVE[:n]))
            assert np.concatenate([outcome.values for outcome in outcomes]).tolist() == EXPECTED[:n]
            assert not any(outcome.failure for outcome in outcomes)


@pytest.mark.parametrize("profile", ["seed", "modern"])
def test_the_search_is_the_same_however_fun_is_called(profile: str) -> None:
    results = [chea(fun, BOX, rng=2, profile=profile, max_nfev=700, **options) for fun, options in ways(rosen)]
    for name in ("x", "xl", "funl", "hits", "history", "nfev", "nit", "njev", "message"):
        assert all(np.array_equal(result[name], results[0][name]) for result in results), name


@pytest.mark.parametrize("workers", [2, map])
def test_the_target_ends_a_search_with_workers_at_the_same_call(workers: object) -> None:
    alone = chea(rosen, BOX, rng=2, f_target=0.5)
    together = chea(rosen, BOX, rng=2, f_target=0.5, workers=workers)
    assert alone.stop_reason is together.stop_reason is StopReason.TARGET
    assert together.nfev == alone.nfev
    assert together.history.tolist() == alone.history.tolist()


def test_a_map_that_needs_no_pickle_takes_any_function() -> None:
    with ThreadPoolExecutor(2) as pool, Evaluation(lambda x: x[0] / 1, workers=pool.map) as evaluation:
        assert [outcome.values.item() for outcome in evaluation(FIVE)] == FIVE[:, 0].tolist()


def test_a_map_that_loses_points_is_found_out() -> None:
    with (
        Evaluation(rosen, workers=lambda f, x: [f(one) for one in x[:-1]]) as evaluation,
        pytest.raises(ValueError, match="the map given as workers returned 4 values, expected 5"),
    ):
        list(evaluation(FIVE))


@pytest.mark.parametrize("workers", [2, -1])
def test_a_function_that_cannot_be_sent_to_workers_is_refused_in_a_sentence(workers: int) -> None:
    sentence = r"fun cannot be sent to worker processes \(.*\), expected a function that stands in a module$"
    with pytest.raises(TypeError, match=sentence):
        chea(lambda x: x[0], BOX, workers=workers)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"workers": 0}, "workers is 0, expected a number of processes, -1 for every core, or a map"),
        ({"workers": -2}, "workers is -2, expected"),
        ({"workers": 2.5}, "workers is 2.5, expected"),
        ({"workers": 2, "vectorized": True}, "workers and vectorized were both given, expected one of them"),
        ({"workers": map, "vectorized": True}, "workers and vectorized were both given, expected one of them"),
    ],
)
def test_impossible_ways_are_refused_in_a_sentence(options: dict, sentence: str) -> None:
    with pytest.raises(ValueError, match=re.escape(sentence)):
        Evaluation(rosen, **options)


def test_all_cores_are_those_this_process_may_use() -> None:
    with Evaluation(rosen, workers=-1) as evaluation:
        assert [outcome.values.item() for outcome in evaluation(FIVE)] == EXPECTED
