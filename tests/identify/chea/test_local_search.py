"""Descents whose end is known."""

import numpy as np
import pytest

from rotorrig.identify.chea.local_search import descend

TARGET = np.array([0.3, 0.6])
START = np.array([0.8, 0.1])


def bowl(u: np.ndarray) -> np.ndarray:
    return ((u - TARGET) ** 2 * [1.0, 30.0]).sum(axis=1)


def run(fun, start=START):
    return descend(fun, start, float(fun(start[None])[0]))


def test_a_bowl_is_descended_to_its_bottom() -> None:
    u, value = run(bowl)
    assert u == pytest.approx(TARGET, abs=1e-5)
    assert value == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("factor", "constant"), [(1e-14, 0.0), (1e12, 0.0), (1.0, 100.0), (1e-6, -1e-3)])
def test_neither_unit_nor_offset_of_the_function_matters(factor: float, constant: float) -> None:
    u, _ = run(lambda u: factor * bowl(u) + constant)
    assert u == pytest.approx(TARGET, abs=1e-4)


def test_a_minimum_outside_is_found_on_the_bound_and_no_point_beyond_is_asked_for() -> None:
    asked = []

    def slope(u: np.ndarray) -> np.ndarray:
        asked.extend(u)
        return (u[:, 0] - 2) ** 2 + (u[:, 1] + 1) ** 2

    u, _ = run(slope)
    assert u == pytest.approx([1.0, 0.0], abs=1e-12)
    assert np.min(asked) >= 0.0
    assert np.max(asked) <= 1.0


def test_a_descent_from_the_upper_corner_works() -> None:
    assert run(bowl, np.ones(2))[0] == pytest.approx(TARGET, abs=1e-5)


def test_the_gradient_is_one_batch_of_as_many_points_as_parameters() -> None:
    sizes = []

    def counting(u: np.ndarray) -> np.ndarray:
        sizes.append(len(u))
        return bowl(u)

    run(counting)
    assert set(sizes) == {1, 2}


def test_an_infinite_start_goes_nowhere() -> None:
    u, value = descend(lambda u: pytest.fail("evaluated"), START, np.inf)
    assert u is START
    assert value == np.inf


def test_a_flat_function_ends_after_one_gradient() -> None:
    calls = []

    def flat(u: np.ndarray) -> np.ndarray:
        calls.append(len(u))
        return np.ones(len(u))

    assert descend(flat, START, 1.0)[1] == 1.0
    assert calls == [2]


def test_a_wall_of_infinity_on_the_way_is_survived() -> None:
    def walled(u: np.ndarray) -> np.ndarray:
        return np.where(u[:, 0] < 0.5, np.inf, bowl(u))

    u, value = run(walled)
    assert u[0] >= 0.5
    assert np.isfinite(value)
    assert value < bowl(START[None])[0]
