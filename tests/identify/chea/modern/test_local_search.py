"""Descents whose end is known, how many calls they may take, and ground on which they must not fail."""

from collections.abc import Callable

import numpy as np
import pytest

from rotorrig.identify.chea.engine import End
from rotorrig.identify.chea.modern.local_search import descend
from rotorrig.identify.chea.session.record import Record

Fun = Callable[[np.ndarray], np.ndarray]
TARGET = np.array([0.4, 0.6])
SEEDS = range(10)


def bowl(u: np.ndarray) -> np.ndarray:
    return ((u - TARGET) ** 2 * [1.0, 10.0]).sum(axis=1)


def rosenbrock(u: np.ndarray) -> np.ndarray:
    """On [-2, 2]^dim shifted so that the minimum, 0, is at 0.65."""
    x = 1 + 4 * (u - 0.65)
    return (100 * (x[:, 1:] - x[:, :-1] ** 2) ** 2 + (1 - x[:, :-1]) ** 2).sum(axis=1)


def rastrigin(u: np.ndarray) -> np.ndarray:
    """On a box of width 10 with the minimum, 0, at TARGET and basins a tenth wide."""
    x = 10 * (u - TARGET)
    return (x**2 + 10 - 10 * np.cos(2 * np.pi * x)).sum(axis=1)


def run(fun: Fun, start: np.ndarray, *, known: np.ndarray | None = None, **options) -> tuple[End, np.ndarray]:
    """Return the end of a descent and the points it asked for (n, dim)."""
    record = Record(len(start), same_point=0.01)
    first = start[None] if known is None else np.vstack([known, start])
    record.add(first, fun(first))
    descent = descend(record, start, float(fun(start[None])[0]), **options)
    answer = None
    try:
        while True:
            points = next(descent) if answer is None else descent.send(answer)
            values = fun(points)
            answer = np.where(np.isfinite(values), values, np.inf)
            record.add(points, values)
    except StopIteration as stop:
        return stop.value, record.points[len(first) :]


def beside(target: np.ndarray, distance: float, seed: int) -> np.ndarray:
    way = np.random.default_rng(seed).standard_normal(len(target))
    return np.clip(target + distance * way / np.linalg.norm(way), 0, 1)


def mean_calls(fun: Fun, target: np.ndarray, *, distance: float, known: int = 0, **options) -> float:
    """Return the mean number of calls, every descent having reached the target."""
    calls = []
    for seed in SEEDS:
        points = np.random.default_rng(seed).random((known, len(target)))
        end, asked = run(fun, beside(target, distance, seed), known=points, **options)
        assert end.u == pytest.approx(target, abs=2e-5)
        calls.append(len(asked))
    return float(np.mean(calls))


def test_a_bowl_takes_the_points_a_quadratic_has_coefficients_and_a_step() -> None:
    assert mean_calls(bowl, TARGET, distance=0.3) <= 12


def test_known_points_spare_most_of_the_calls() -> None:
    assert mean_calls(bowl, TARGET, distance=0.3, known=20) <= 8


def test_a_curved_valley_takes_few_calls_among_known_points() -> None:
    assert mean_calls(rosenbrock, np.full(2, 0.65), distance=0.3, known=48) <= 25
    assert mean_calls(rosenbrock, np.full(5, 0.65), distance=0.2) <= 150


def test_a_basin_among_many_takes_a_dozen_calls() -> None:
    assert mean_calls(rastrigin, TARGET, distance=0.03, known=48, radius=0.02) <= 15


@pytest.mark.parametrize("dim", [5, 10])
def test_an_ill_conditioned_quadratic_takes_about_twice_the_calls_it_has_coefficients(dim: int) -> None:
    axes, _ = np.linalg.qr(np.random.default_rng(0).standard_normal((dim, dim)))
    hessian = axes * np.logspace(0, 4, dim) @ axes.T
    target = np.full(dim, 0.5)
    calls = mean_calls(lambda u: (((u - target) @ hessian) * (u - target)).sum(axis=1), target, distance=0.3)
    assert calls <= 1.2 * (dim + 1) * (dim + 2)


def test_one_parameter_is_enough() -> None:
    end, asked = run(lambda u: np.exp(u[:, 0]) - 2 * u[:, 0], np.array([0.1]))
    assert end.u == pytest.approx([np.log(2)], abs=1e-5)
    assert len(asked) <= 10


def test_a_minimum_outside_is_found_on_the_bound_and_no_point_beyond_is_asked_for() -> None:
    end, asked = run(lambda u: (u[:, 0] - 2) ** 2 + (u[:, 1] + 1) ** 2 + u[:, 0] * u[:, 1], np.array([0.5, 0.5]))
    assert end.u.tolist() == [1.0, 0.0]
    assert end.kind == "minimum"
    assert asked.min() >= 0.0
    assert asked.max() <= 1.0


def test_a_descent_from_a_corner_and_from_a_saddle_works() -> None:
    assert run(bowl, np.ones(2))[0].u == pytest.approx(TARGET, abs=1e-5)
    end, _ = run(lambda u: (u[:, 1] - 0.5) ** 2 - (u[:, 0] - 0.5) ** 2, np.array([0.5, 0.2]))
    assert end.u[0] in (0.0, 1.0)
    assert end.u[1] == pytest.approx(0.5, abs=1e-5)


@pytest.mark.parametrize(("factor", "constant"), [(1e-14, 0.0), (1e12, 0.0), (1.0, 100.0), (1e-6, -1e-3)])
def test_neither_unit_nor_offset_of_the_function_matters(factor: float, constant: float) -> None:
    end, asked = run(lambda u: factor * bowl(u) + constant, np.array([0.8, 0.1]))
    assert end.u == pytest.approx(TARGET, abs=1e-4)
    assert len(asked) <= 20


@pytest.mark.parametrize(
    "fun",
    [
        lambda u: np.abs((u - TARGET) @ [[1.0, 0.8], [-0.5, 1.0]]).sum(axis=1),
        lambda u: np.sqrt(bowl(u)),
        lambda u: np.abs(u - TARGET).max(axis=1),
    ],
    ids=["sum of kinks", "cone", "maximum"],
)
def test_a_kink_at_the_minimum_is_reached(fun: Fun) -> None:
    for seed in SEEDS:
        end, asked = run(fun, beside(TARGET, 0.3, seed))
        assert end.u == pytest.approx(TARGET, abs=1e-4)
        assert len(asked) <= 90


def test_small_ripples_do_not_catch_a_descent_of_large_radius() -> None:
    def rippled(u: np.ndarray) -> np.ndarray:
        return bowl(u) + 1e-3 * (1 - np.cos(2 * np.pi * (u - TARGET) / 0.04)).sum(axis=1)

    known = np.random.default_rng(0).random((48, 2))
    for seed in SEEDS:
        assert run(rippled, beside(TARGET, 0.3, seed), known=known, radius=0.3)[0].u == pytest.approx(TARGET, abs=1e-3)


@pytest.mark.parametrize(("noise", "error"), [(1e-6, 1e-3), (1e-4, 2e-2)])
def test_noise_ends_a_descent_about_where_it_hides_the_slope(noise: float, error: float) -> None:
    rng = np.random.default_rng(0)
    for seed in SEEDS:
        end, asked = run(lambda u: bowl(u) + noise * rng.standard_normal(len(u)), beside(TARGET, 0.3, seed))
        assert end.u == pytest.approx(TARGET, abs=error)
        assert len(asked) <= 60


@pytest.mark.parametrize(
    "fun",
    [
        lambda u: np.ones(len(u)),
        lambda u: np.floor(200 * bowl(u)) / 200,
        lambda u: bowl(u) + (u[:, 0] > 0.5),
        lambda u: bowl(u) + np.exp(500 * (u[:, 0] - 0.45)),
        lambda u: np.sqrt(np.abs(u - TARGET)).sum(axis=1),
    ],
    ids=["flat", "steps", "jump", "wall", "infinite slopes"],
)
def test_on_any_ground_a_descent_ends_no_higher_than_it_began(fun: Fun) -> None:
    for seed in SEEDS:
        start = beside(TARGET, 0.3, seed)
        end, asked = run(fun, start)
        assert end.fun <= fun(start[None])[0]
        assert len(asked) <= 250


@pytest.mark.parametrize("edge", [0.38, 0.4])
def test_a_descent_along_failing_calls_still_reaches_the_minimum(edge: float) -> None:
    def walled(u: np.ndarray) -> np.ndarray:
        return np.where(u[:, 0] < edge, np.nan, bowl(u))

    end, _ = run(walled, np.array([0.7, 0.4]))
    assert end.u == pytest.approx(TARGET, abs=1e-4)


@pytest.mark.parametrize("height", [1e30, 1.7e308])
def test_a_cliff_of_any_height_is_kept_away_from(height: float) -> None:
    def cliff(u: np.ndarray) -> np.ndarray:
        return np.where(u[:, 0] > 0.5, height, bowl(u))

    end, _ = run(cliff, np.array([0.45, 0.3]), known=np.random.default_rng(0).random((48, 2)))
    assert end.u == pytest.approx(TARGET, abs=1e-4)


def test_a_start_without_a_value_goes_nowhere() -> None:
    end, asked = run(lambda u: np.full(len(u), np.inf), np.array([0.5, 0.5]))
    assert (end.kind, end.fun, len(asked)) == ("no value", np.inf, 0)


def test_where_every_call_but_the_first_fails_the_start_is_kept() -> None:
    start = np.array([0.5, 0.5])
    end, asked = run(lambda u: np.where((u == start).all(axis=1), 1.0, np.inf), start)
    assert end.u.tolist() == start.tolist()
    assert len(asked) <= 60


def test_the_budget_ends_a_descent() -> None:
    end, asked = run(rosenbrock, np.array([0.1, 0.9]), max_calls=10)
    assert end.kind == "stuck"
    assert 10 <= len(asked) <= 11  # the last batch is not cut


def test_the_caller_sees_where_a_descent_is_bound_for_and_can_abandon_it() -> None:
    shown = []

    def watch(u: np.ndarray, fun: float, goal: np.ndarray, goal_fun: float) -> bool:
        shown.append((fun, goal, goal_fun))
        return fun < 1e-3

    end, _ = run(bowl, np.array([0.7, 0.3]), stop_if=watch)
    assert end.kind == "abandoned"
    assert shown[-1][1] == pytest.approx(TARGET, abs=1e-2)
    assert all(goal_fun <= fun + 1e-6 for fun, _, goal_fun in shown)


def test_the_hessian_at_the_end_is_the_functions() -> None:
    end, _ = run(bowl, np.array([0.7, 0.3]))
    assert end.hessian == pytest.approx(np.diag([2.0, 20.0]), rel=1e-3, abs=1e-2)


def test_the_same_record_gives_the_same_descent() -> None:
    first, second = (run(rosenbrock, np.array([0.1, 0.9]))[1] for _ in range(2))
    assert first.tolist() == second.tolist()
