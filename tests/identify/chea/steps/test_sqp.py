"""Descents whose end is known."""

from collections.abc import Callable

import numpy as np
import pytest

from rotorrig.identify.chea.session.record import Record
from rotorrig.identify.chea.steps.sqp import descend
from tests.identify.chea.driving import drive

Fun = Callable[[np.ndarray], np.ndarray]
TARGET = np.array([0.3, 0.6])
START = np.array([0.8, 0.1])


def bowl(u: np.ndarray) -> np.ndarray:
    return ((u - TARGET) ** 2 * [1.0, 30.0]).sum(axis=1)


def run(
    fun: Fun, start: np.ndarray = START, *, known: np.ndarray | None = None, **options
) -> tuple[np.ndarray, float, Record]:
    """Return the end of a descent, its value, and the record of its calls; `known` is a minimum found before."""
    record = Record(len(start), same_point=0.01)
    if known is not None:
        record.minima.add(known, float(fun(known[None])[0]))
    u, value = drive(descend(record, start, float(fun(start[None])[0]), **options), fun, record)
    return u, value, record


def test_a_bowl_is_descended_to_its_bottom() -> None:
    u, value, record = run(bowl)
    assert u == pytest.approx(TARGET, abs=1e-5)
    assert value == pytest.approx(0.0, abs=1e-10)
    assert record.nfev < 40


@pytest.mark.parametrize(("factor", "constant"), [(1e-14, 0.0), (1e12, 0.0), (1.0, 100.0), (1e-6, -1e-3)])
def test_neither_unit_nor_offset_of_the_function_matters(factor: float, constant: float) -> None:
    u, _, _ = run(lambda u: factor * bowl(u) + constant)
    assert u == pytest.approx(TARGET, abs=1e-4)


def test_a_minimum_outside_is_found_on_the_bound_and_no_point_beyond_is_asked_for() -> None:
    u, _, record = run(lambda u: (u[:, 0] - 2) ** 2 + (u[:, 1] + 1) ** 2)
    assert u == pytest.approx([1.0, 0.0], abs=1e-12)
    assert np.min(record.points) >= 0.0
    assert np.max(record.points) <= 1.0


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
    u, value, record = run(lambda u: np.full(len(u), np.inf))
    assert u is START
    assert value == np.inf
    assert record.nfev == 0


def test_a_flat_function_ends_after_one_gradient() -> None:
    _, value, record = run(lambda u: np.ones(len(u)))
    assert value == 1.0
    assert record.nfev == 2


def test_a_bowl_of_condition_ten_thousand_and_any_orientation_is_descended_in_five_dimensions() -> None:
    for seed in range(5):
        rng = np.random.default_rng(seed)
        axes, target = np.linalg.qr(rng.normal(size=(5, 5)))[0], rng.uniform(0.2, 0.8, 5)

        def fun(u: np.ndarray, axes: np.ndarray = axes, target: np.ndarray = target) -> np.ndarray:
            return (((u - target) @ axes) ** 2 * np.logspace(0, 4, 5)).sum(axis=1)

        u, _, record = run(fun, rng.random(5))
        assert u == pytest.approx(target, abs=0.01)
        assert record.nfev < 300


def test_a_descent_stops_on_arrival_at_a_known_minimum() -> None:
    alone = run(bowl)[2]
    u, _, record = run(bowl, known=TARGET, near=0.02)
    assert u == pytest.approx(TARGET, abs=0.02)
    assert record.nfev <= alone.nfev - 3  # a gradient and a step at least


def test_a_start_beside_a_known_minimum_costs_no_call() -> None:
    assert run(bowl, TARGET + 0.005, known=TARGET, near=0.01)[2].nfev == 0


def test_a_descent_passes_a_known_minimum_that_lies_higher() -> None:
    beside = TARGET + np.array([0.02, 0.0])  # lower ground around it: no minimum, though listed as one
    u, _, _ = run(bowl, known=beside, near=0.025)
    assert u == pytest.approx(TARGET, abs=0.025)
    assert bowl(u[None])[0] < bowl(beside[None])[0]


def test_a_wall_of_infinity_on_the_way_is_survived() -> None:
    def walled(u: np.ndarray) -> np.ndarray:
        return np.where(u[:, 0] < 0.5, np.inf, bowl(u))

    u, value, _ = run(walled)
    assert u[0] >= 0.5
    assert np.isfinite(value)
    assert value < bowl(START[None])[0]


def test_a_sum_of_absolute_values_is_descended_along_its_kinks_to_where_all_are_nothing() -> None:
    for seed in range(5):
        rng = np.random.default_rng(seed)
        slopes, target = rng.normal(size=(60, 4)) * np.logspace(0, -4, 4), rng.uniform(0.2, 0.8, 4)

        def fun(u: np.ndarray, slopes: np.ndarray = slopes, target: np.ndarray = target) -> np.ndarray:
            return np.abs((u - target) @ slopes.T).sum(axis=1)

        u, _, record = run(fun, rng.random(4))
        assert u == pytest.approx(target, abs=1e-4)
        assert record.nfev < 2000
