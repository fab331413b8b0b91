"""Descents whose end is known: tilted and kinked valleys, bounds, and ground on which they must not fail."""

from collections.abc import Callable

import numpy as np
import pytest

from benchmarks.parts.identification.valley_search import descend
from rotorrig.identify.chea.session.record import Record
from tests.identify.chea.driving import drive

Fun = Callable[[np.ndarray], np.ndarray]
SEEDS = range(5)
TARGET = np.array([0.35, 0.6, 0.5, 0.45])


def run(fun: Fun, start: np.ndarray, *, seed: int = 1, **options) -> tuple[np.ndarray, float, Record]:
    """Return the end of a descent, its value, and the record of its calls."""
    record = Record(len(start), same_point=0.01)
    value = float(fun(start[None])[0])
    u, least = drive(descend(record, start, value, rng=np.random.default_rng(seed), **options), fun, record)
    return u, least, record


def calls_to(target: np.ndarray, record: Record) -> int:
    """Return after how many calls a point within 1e-4 of the target was met."""
    return int(np.flatnonzero(np.abs(record.points - target).max(axis=1) < 1e-4)[0]) + 1


def tilted(stiffest: float, *, kinked: bool = False, seed: int = 1) -> Fun:
    """Return a bowl about TARGET, oblique to the axes, with curvatures from 1 to `stiffest`.

    Kinked: the square of a sum of absolute values instead of a sum of squares.
    """
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.standard_normal((4, 4)))
    rows = rng.standard_normal((60, 4)) / np.sqrt(60) * stiffest ** (np.arange(4) / 6) @ turn

    def fun(u: np.ndarray) -> np.ndarray:
        off = (u - TARGET) @ rows.T
        return np.abs(off).sum(axis=1) ** 2 if kinked else (off**2).sum(axis=1)

    return fun


@pytest.mark.parametrize(("kinked", "calls"), [(False, 400), (True, 600)])
def test_a_valley_a_million_times_less_curved_than_its_walls_is_followed_to_its_end(kinked, calls) -> None:
    for seed in SEEDS:
        u, _, record = run(tilted(1e6, kinked=kinked, seed=seed), np.full(4, 0.3), seed=seed)
        assert u == pytest.approx(TARGET, abs=1e-6)
        assert calls_to(TARGET, record) <= calls


def test_a_bent_valley_is_followed() -> None:
    def banana(u: np.ndarray) -> np.ndarray:
        x = 4 * u - 2
        return 100 * (x[:, 1] - x[:, 0] ** 2) ** 2 + (1 - x[:, 0]) ** 2

    u, _, record = run(banana, np.array([0.2, 0.8]))
    assert u == pytest.approx(np.full(2, 0.75), abs=1e-5)
    assert calls_to(np.full(2, 0.75), record) <= 200


@pytest.mark.parametrize("factor", [1e-12, 1e12])
def test_the_unit_of_the_function_does_not_matter(factor: float) -> None:
    fun = tilted(100.0)
    u, _, _ = run(lambda u: factor * fun(u), np.full(4, 0.3))
    assert u == pytest.approx(TARGET, abs=1e-6)


def test_a_minimum_above_nothing_is_found_to_the_root_of_what_the_descent_calls_nothing() -> None:
    fun = tilted(10.0)
    u, _, _ = run(lambda u: 1 + fun(u), np.full(4, 0.3))
    assert u == pytest.approx(TARGET, abs=1e-4)


def test_a_descent_told_to_end_where_it_slows_down_ends_sooner_and_not_far_above() -> None:
    fun = tilted(1e6, kinked=True)
    _, least, whole = run(lambda u: 1 + fun(u), np.full(4, 0.3))
    _, value, short = run(lambda u: 1 + fun(u), np.full(4, 0.3), stalled=(10, 0.05))
    assert short.nfev < 0.7 * whole.nfev
    assert least <= value < 1.05


def test_a_minimum_at_bounds_is_reached_and_the_cube_not_left() -> None:
    u, _, record = run(lambda u: ((u - [-0.2, 0.5, 1.2]) ** 2).sum(axis=1), np.array([0.1, 0.4, 0.9]))
    assert u == pytest.approx([0.0, 0.5, 1.0], abs=1e-3)
    assert ((record.points >= 0) & (record.points <= 1)).all()


def test_one_parameter_is_enough() -> None:
    u, _, _ = run(lambda u: (u[:, 0] - 0.7) ** 4, np.array([0.2]))
    assert u[0] == pytest.approx(0.7, abs=1e-2)


def test_points_without_a_value_are_gone_round() -> None:
    fun = tilted(10.0)
    u, _, _ = run(lambda u: np.where(u[:, 0] > 0.36, np.nan, fun(u)), np.full(4, 0.3))
    assert u == pytest.approx(TARGET, abs=1e-5)


def test_known_points_take_the_place_of_calls() -> None:
    fun, start = tilted(1.0), TARGET + 0.01
    record = Record(4, same_point=0.01)
    known = start + 0.03 * np.random.default_rng(1).uniform(-1, 1, (40, 4))
    record.add(known, fun(known))
    part = descend(record, start, float(fun(start[None])[0]), rng=np.random.default_rng(1))
    assert next(part)[0] == pytest.approx(TARGET, abs=1e-4)


def test_it_ends_on_flat_ground_at_a_start_without_a_value_and_at_the_budget() -> None:
    start = np.full(4, 0.3)
    u, least, record = run(lambda u: np.zeros(len(u)), start)
    assert (u.tolist(), least) == (start.tolist(), 0.0)
    assert record.nfev < 50
    assert run(lambda u: np.full(len(u), np.inf), start)[2].nfev == 0
    assert run(tilted(1e6), start, max_calls=30)[2].nfev < 30 + 4
