"""The flow chart of Fig. 1: what decides that a cluster holds one minimum, and what each part of a search adds."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.chea import StopReason
from rotorrig.identify.chea.chapter.chapter import method
from rotorrig.identify.chea.chapter.settings import SEED, SeedSettings
from rotorrig.identify.chea.engine import Engine
from rotorrig.identify.chea.session.record import Record
from tests.identify.chea.driving import drive

NO_FAR = replace(SEED, far_iterations=0)


def bowl(u: np.ndarray) -> np.ndarray:
    return ((u - [0.7, 0.2]) ** 2).sum(axis=1)


def two_pits(u: np.ndarray) -> np.ndarray:
    """A wide bowl with two equal pits at its bottom, (0.45, 0.5) and (0.55, 0.5), nearer than a cluster is wide."""
    pits = [np.exp(-((u - [x, 0.5]) ** 2).sum(axis=1) / 0.02**2) for x in (0.45, 0.55)]
    return ((u - 0.5) ** 2).sum(axis=1) - pits[0] - pits[1]


def egg_box(u: np.ndarray) -> np.ndarray:
    """Nine equal minima at 1/6, 3/6 and 5/6 in both parameters."""
    return np.cos(6 * np.pi * u).sum(axis=1)


def run(fun, seed: int = 0, settings: SeedSettings = SEED) -> tuple[StopReason, Record]:
    record = Record(2, same_point=settings.same_point)
    return drive(Engine(record, np.random.default_rng(seed), method(2, settings)).run(), fun, record), record


@pytest.mark.parametrize("seed", range(5))
def test_a_bowl_has_one_minimum(seed: int) -> None:
    reason, record = run(bowl, seed)
    points, values, _ = record.minima.sorted()
    assert reason is StopReason.CONVERGED
    assert len(points) == 1
    assert points[0] == pytest.approx([0.7, 0.2], abs=1e-6)
    assert values[0] < 1e-12


def test_two_minima_within_one_cluster_are_told_apart() -> None:
    found = [run(two_pits, seed, NO_FAR)[1].minima.sorted()[0] for seed in range(5)]
    both = [all(np.abs(points - [x, 0.5]).max(axis=1).min() < 0.005 for x in (0.45, 0.55)) for points in found]
    assert sum(both) >= 4


def test_every_listed_minimum_is_a_converged_point() -> None:
    for seed in range(3):
        points, values, _ = run(egg_box, seed)[1].minima.sorted()
        nearest = (np.clip(np.floor(3 * points), 0, 2) * 2 + 1) / 6
        assert points == pytest.approx(nearest, abs=1e-5)
        assert values == pytest.approx(-2.0, abs=1e-9)


def test_of_nine_equal_minima_most_are_listed_though_copies_crowd_at_some() -> None:
    assert np.mean([len(run(egg_box, seed)[1].minima) for seed in range(5)]) > 5


def test_the_far_search_adds_as_many_points_as_it_is_given_where_none_is_lower() -> None:
    calls = [run(bowl, settings=replace(SEED, far_iterations=n))[1].nfev for n in (0, 50)]
    assert calls[1] - calls[0] == 50


def test_a_function_without_a_value_ends_after_its_first_generation() -> None:
    reason, record = run(lambda u: np.full(len(u), np.nan))
    assert reason is StopReason.NO_FINITE_VALUE
    assert record.nfev <= SEED.population


def test_a_function_without_a_value_on_half_the_box_is_searched_on_the_other() -> None:
    reason, record = run(lambda u: np.where(u[:, 0] < 0.5, np.nan, bowl(u)))
    assert reason is StopReason.CONVERGED
    assert record.best[0] == pytest.approx([0.7, 0.2], abs=1e-5)


def test_clusters_left_with_several_minima_at_the_last_level_are_owned_up_to() -> None:
    reason, _ = run(lambda u: np.cos(80 * np.pi * u).sum(axis=1), settings=replace(NO_FAR, max_levels=1))
    assert reason is StopReason.STALLED
