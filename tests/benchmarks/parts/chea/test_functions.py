"""The test functions against their published minima; sources in benchmarks/parts/chea/functions.py."""

import itertools

import numpy as np
import pytest

from benchmarks.parts.chea.functions import (
    SHUBERT_HIGHS,
    SHUBERT_LOWS,
    Case,
    Listed,
    ShubertMinima,
    Turned,
    cases_beyond,
    chapter_cases,
    cube,
)

CASES = {case.name: case for case in (*chapter_cases(), *cases_beyond())}
LEAST = {  # published, to the digits printed
    "f1": 0.0,
    "f2": -16.09172,
    "f3": 0.0,
    "Ackley": 0.0,
    "Griewank": 0.0,
    "Levy": 0.0,
    "Rastrigin": 0.0,
    "Schwefel": 0.0,
    "camel": -1.0316,
    "Branin": 0.397887,
    "Hartmann 3": -3.86278,
    "Hartmann 6": -3.32237,
    "Shubert 2": -186.7309,
    "Vincent": -1.0,
}
COUNT = {"f2": 4, "camel 2": 2, "Branin 2": 3, "Shubert 2": 18, "Vincent 2": 36}  # published; of all others 1
SHUBERT_3 = 81


def some_minima(case: Case, seed: int) -> np.ndarray:
    problem = case.problem(seed)
    anywhere = np.random.default_rng(seed).uniform(*problem.bounds.T, (20, case.dim))
    return problem.minima.nearest(anywhere)


@pytest.mark.parametrize("name", CASES)
def test_the_value_at_the_minima_is_the_published_one(name: str) -> None:
    published = [least for start, least in LEAST.items() if name.startswith(start)]
    assert len(published) == 1 or name in ("Shubert 5", "Shubert 10")
    for seed in range(3):
        values = CASES[name].problem(seed).fun(some_minima(CASES[name], seed))
        assert np.ptp(values) <= 1e-9 * (1 + abs(values[0]))
        if published:
            assert values == pytest.approx(published[0], abs=6e-5)


@pytest.mark.parametrize("name", CASES)
def test_the_minima_are_in_the_box_of_every_seed(name: str) -> None:
    for seed in range(50):
        problem, minima = CASES[name].problem(seed), some_minima(CASES[name], seed)
        assert ((minima > problem.bounds[:, 0]) & (minima < problem.bounds[:, 1])).all()


@pytest.mark.parametrize("name", CASES)
def test_nothing_nearby_or_anywhere_in_the_box_is_lower(name: str) -> None:
    rng = np.random.default_rng(0)
    for seed in range(5):
        problem, minima = CASES[name].problem(seed), some_minima(CASES[name], seed)
        least = problem.fun(minima[:1])[0]
        near = minima[0] + rng.uniform(-1, 1, (2000, problem.dim)) * problem.tolerance
        anywhere = rng.uniform(*problem.bounds.T, (20_000, problem.dim))
        assert problem.fun(np.vstack([near, anywhere])).min() >= least - 1e-5 * max(1.0, abs(least))


@pytest.mark.parametrize("name", [name for name in CASES if not name.startswith("Ackley")])  # a cusp
def test_the_gradient_vanishes_at_the_minima(name: str) -> None:
    problem, x = CASES[name].problem(1), some_minima(CASES[name], 1)[0]
    step = 1e-3 * problem.tolerance
    ahead, behind = problem.fun(x + np.diag(step)), problem.fun(x - np.diag(step))
    curvature = (ahead + behind - 2 * problem.fun(x[None])[0]) / step**2
    newton = np.abs((ahead - behind) / (2 * step) / curvature)
    assert (newton < 0.1 * problem.tolerance).all()


@pytest.mark.parametrize("name", [name for name in CASES if CASES[name].dim == 2])
def test_a_fine_grid_has_as_many_lowest_minima_as_are_published(name: str) -> None:
    problem = CASES[name].problem(0)
    axes = [np.linspace(low, high, 751) for low, high in problem.bounds]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    low = problem.fun(grid.reshape(-1, 2)).reshape(751, 751)
    inner = low[1:-1, 1:-1]
    lower = [inner <= low[1 + i : 750 + i, 1 + j : 750 + j] for i, j in itertools.product((-1, 0, 1), repeat=2)]
    at = grid[1:-1, 1:-1][np.logical_and.reduce(lower)]
    to_nearest = np.abs(at - problem.minima.nearest(at)) / np.ptp(problem.bounds, axis=1)
    reached = problem.minima.nearest(at[(to_nearest < 2 / 750).all(axis=1)])
    published = COUNT.get(name.rstrip("s"), COUNT.get(name, 1))
    assert len(np.unique(reached.round(6), axis=0)) == problem.minima.count == published


def test_shubert_in_three_dimensions_has_its_minima_where_one_parameter_is_low_and_the_others_high() -> None:
    listed = [
        np.insert([a, b], at, low)
        for at in range(3)
        for low in SHUBERT_LOWS
        for a, b in itertools.product(SHUBERT_HIGHS, repeat=2)
    ]
    anywhere = np.random.default_rng(0).uniform(-10, 10, (500, 3))
    found = ShubertMinima(3).nearest(anywhere)
    assert len(listed) == ShubertMinima(3).count == SHUBERT_3
    away = np.abs(anywhere - found).max(axis=1)
    assert away == pytest.approx(np.abs(anywhere - Listed(np.array(listed)).nearest(anywhere)).max(axis=1))


def test_rastrigin_has_121_minima_on_the_chapters_box() -> None:
    integers = np.array(list(itertools.product(range(-5, 6), repeat=2)), dtype=float)
    step = np.array([[0.1, 0], [-0.1, 0], [0, 0.1], [0, -0.1]])
    fun = CASES["f3"].fun
    lower_next_to = [(fun(integers) < fun(np.clip(integers + s, -5, 5)) + 1e-12).sum() for s in step]
    assert lower_next_to == [121] * 4


def test_a_turn_moves_the_minima_with_the_function() -> None:
    case = CASES["Schwefel 2"]
    signs = {tuple(np.sign(some_minima(case, seed)[0])) for seed in range(30)}
    assert signs == set(itertools.product((-1.0, 1.0), repeat=2))
    quarter = Turned(Listed(np.array([[1.0, 0.0]])), np.array([[0.0, 1.0], [-1.0, 0.0]]))  # fun'(x, y) = fun(y, -x)
    assert quarter.nearest(np.zeros((1, 2))).tolist() == [[0.0, 1.0]]


def test_a_seed_gives_the_same_box_again_and_another_seed_another() -> None:
    boxes = [CASES["f3r"].problem(seed).bounds for seed in (3, 3, 4)]
    assert (boxes[0] == boxes[1]).all() and (boxes[0] != boxes[2]).all()
    assert np.ptp(boxes[0], axis=1) == pytest.approx([10.0, 10.0])
    assert (CASES["f3"].problem(3).bounds == cube(5.0, 2)).all()
