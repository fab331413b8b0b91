"""`profile="modern"` on functions whose minima are known; all calls are counted, and the search ends by itself."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.chea import MODERN, CheaResult, StopReason, chea
from tests.parameters import defer_rest

PEAKS = np.array([[a * 0.43880, b * 0.30585] for a in (1, -1) for b in (1, -1)])  # chapter, Table 3


def banana(x: np.ndarray) -> np.ndarray:
    return 100 * (x[:, 1] - x[:, 0] ** 2) ** 2 + (1 - x[:, 0]) ** 2


def multimodal(x: np.ndarray) -> np.ndarray:
    u, v = np.pi * x.T
    return (np.cos(2 * u) + np.cos(2.5 * u) - 2.1) * (2.1 - np.cos(3 * v) - np.cos(3.5 * v))


def rastrigin(x: np.ndarray) -> np.ndarray:
    return 10 * x.shape[1] + (x**2 - 10 * np.cos(2 * np.pi * x)).sum(axis=1)


def bowl(x: np.ndarray) -> np.ndarray:
    return ((x - 0.3) ** 2).sum(axis=1)


def shifted(fun, half: float, fraction: float, seeds: int) -> list[CheaResult]:
    found = []
    for seed in range(seeds):
        rng = np.random.default_rng([2, seed])
        middle = rng.uniform(-fraction, fraction, 2) * half
        found.append(chea(fun, np.column_stack([middle - half, middle + half]), rng=rng, vectorized=True))
    assert all(result.stop_reason is StopReason.CONVERGED for result in found)
    return found


def lists(result: CheaResult, points: np.ndarray) -> bool:
    return bool((np.abs(result.xl[:, None] - points).max(axis=2).min(axis=0) < 1e-3).all())


def calls(results: list[CheaResult]) -> float:
    return float(np.mean([result.nfev for result in results]))


def test_the_curved_valley_is_solved_every_time_and_has_one_minimum() -> None:
    results = shifted(banana, 2.0, 0.4, 8)
    assert all(lists(result, np.ones((1, 2))) and len(result.xl) == 1 for result in results)
    assert calls(results) < 250  # chapter 1120


def test_all_four_global_minima_are_listed_every_time() -> None:
    results = shifted(multimodal, 1.0, 0.4, 8)
    assert all(lists(result, PEAKS) for result in results)
    assert calls(results) < 260  # chapter 1131


@pytest.mark.parametrize("angle", defer_rest([0.6, 0.0]))
def test_rastrigin_is_solved_every_time_however_it_is_turned(angle: float) -> None:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    results = shifted(lambda x: rastrigin(x @ turn), 5.0, 0.6, 6)
    assert all(lists(result, np.zeros((1, 2))) for result in results)
    assert all(len(result.xl) >= 5 for result in results)
    assert calls(results) < 600  # chapter 2100


def test_rastrigin_of_five_parameters_is_solved() -> None:
    result = chea(rastrigin, [(-4.0, 6.0)] * 5, rng=np.random.default_rng(0), vectorized=True)
    assert result.x == pytest.approx(np.zeros(5), abs=1e-3)
    assert result.nfev < 4000


@pytest.mark.parametrize(("dim", "most"), [(1, 80), (2, 120), (20, 1200)])
def test_a_bowl_of_any_dimension_ends_early(dim: int, most: int) -> None:
    result = chea(bowl, [(0.0, 1.0)] * dim, rng=np.random.default_rng(0), vectorized=True)
    assert result.x == pytest.approx(np.full(dim, 0.3), abs=1e-4)
    assert result.stop_reason is StopReason.CONVERGED
    assert len(result.xl) == 1
    assert result.nfev < most


def test_ripples_finer_than_the_sample_are_noticed() -> None:
    def rippled(x: np.ndarray) -> np.ndarray:
        return 40 * ((x - [0.3, 0.4]) ** 2).sum(axis=1) - 0.1 * np.cos(300 * (x - [0.3, 0.4])).sum(axis=1)

    for seed in range(4):
        result = chea(rippled, [(0, 1)] * 2, rng=np.random.default_rng(seed), vectorized=True)
        assert result.x == pytest.approx([0.3, 0.4], abs=1e-3)


def test_a_kink_at_the_minimum_is_reached() -> None:
    result = chea(
        lambda x: np.abs(x - [0.2, 0.7, 0.5]).sum(axis=1), [(0, 1)] * 3, rng=np.random.default_rng(0), vectorized=True
    )
    assert result.x == pytest.approx([0.2, 0.7, 0.5], abs=1e-4)


def test_failing_calls_are_survived() -> None:
    def half_failing(x: np.ndarray) -> np.ndarray:
        return np.where(x[:, 0] > 0.6, np.nan, bowl(x))

    result = chea(half_failing, [(0, 1)] * 2, rng=np.random.default_rng(0), vectorized=True)
    assert result.x == pytest.approx([0.3, 0.3], abs=1e-4)
    assert result.nfail > 0


def test_a_function_that_always_fails_ends_after_the_first_sample() -> None:
    result = chea(lambda x: np.full(len(x), np.nan), [(0, 1)] * 2, rng=np.random.default_rng(0), vectorized=True)
    assert result.stop_reason is StopReason.NO_FINITE_VALUE
    assert result.nfev == 3 * MODERN.sample


def test_a_flat_function_ends() -> None:
    result = chea(lambda x: np.ones(len(x)), [(0, 1)] * 2, rng=np.random.default_rng(0), vectorized=True)
    assert result.stop_reason is StopReason.CONVERGED
    assert result.nfev < 200


def test_steps_end() -> None:
    result = chea(lambda x: np.floor(5 * x).sum(axis=1), [(0, 1)] * 2, rng=np.random.default_rng(0), vectorized=True)
    assert result.stop_reason is StopReason.CONVERGED
    assert result.fun == 0.0


def test_the_same_generator_makes_the_same_search() -> None:
    one, other = (chea(multimodal, [(-1, 1)] * 2, rng=np.random.default_rng(5), vectorized=True) for _ in range(2))
    assert one.nfev == other.nfev
    assert np.array_equal(one.xl, other.xl)


def test_unit_and_offset_of_the_function_do_not_matter() -> None:
    one, other = (
        chea(lambda x, a=a, b=b: a * multimodal(x) + b, [(-1, 1)] * 2, rng=np.random.default_rng(5), vectorized=True)
        for a, b in ((1.0, 0.0), (1e-6, 1e-5))
    )
    assert lists(one, PEAKS)
    assert lists(other, PEAKS)
    assert abs(one.nfev - other.nfev) < 60  # rounding turns a few steps


def test_more_patience_looks_longer() -> None:
    short, long = (
        chea(
            rastrigin,
            [(-5, 4)] * 2,
            rng=np.random.default_rng(1),
            vectorized=True,
            settings=replace(MODERN, patience=p),
        )
        for p in (0.5, 3.0)
    )
    assert long.nfev > short.nfev
    assert len(long.xl) >= len(short.xl)
