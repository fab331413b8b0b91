"""The genetic algorithm: coding, what is evaluated, what survives."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.chea.chapter.genetic import Colony, gray_to_integer
from rotorrig.identify.chea.chapter.settings import SEED, SeedSettings
from rotorrig.identify.chea.session.record import Record
from tests.identify.chea.driving import drive

CUBE = np.array([[0.0, 0.0], [1.0, 1.0]])


def gray(number: int, bits: int) -> list[int]:
    return [(number ^ number >> 1) >> k & 1 for k in reversed(range(bits))]


def test_all_4096_gray_codes_are_read() -> None:
    codes = np.array([gray(n, 12) for n in range(4096)], dtype=np.uint8)
    assert gray_to_integer(codes).tolist() == list(range(4096))


def bowl(u: np.ndarray) -> np.ndarray:
    return ((u - [0.7, 0.2]) ** 2).sum(axis=1)


class Bred:
    """A colony on the bowl, and the record of what it asked for."""

    def __init__(
        self, seed: int, *, box: np.ndarray = CUBE, settings: SeedSettings = SEED, generations: int = 0
    ) -> None:
        self.record = Record(2, same_point=0.01)
        self.colony = Colony(box, rng=np.random.default_rng(seed), settings=settings)
        drive(self.colony.create_founders(), bowl, self.record)
        for _ in range(generations):
            self.advance()

    def advance(self, elites: np.ndarray | None = None) -> None:
        drive(self.colony.advance(elites), bowl, self.record)


def test_points_stay_in_the_box_and_reach_for_its_corners() -> None:
    box = np.array([[0.25, 0.5], [0.5, 0.625]])
    bred = Bred(0, box=box, generations=8)
    assert (bred.record.points >= box[0]).all()
    assert (bred.record.points <= box[1]).all()
    best = bred.colony.points[bred.colony.fun.argmin()]
    assert best == pytest.approx([0.5, 0.5], abs=0.02)  # nearest the target outside; the grid is 0.004 and 0.002


def test_no_point_is_evaluated_twice() -> None:
    points = Bred(1, generations=10).record.points
    assert len(np.unique(points, axis=0)) == len(points)


def test_values_belong_to_their_points() -> None:
    bred = Bred(2)
    for _ in range(4):
        bred.advance()
        assert bred.colony.fun == pytest.approx(bowl(bred.colony.points))


def test_the_best_individual_is_never_lost() -> None:
    wild = replace(SEED, mutation=1.0, crossover=1.0)
    for seed in range(20):
        bred = Bred(seed, settings=wild)
        best = [bred.colony.fun.min()]
        for _ in range(5):
            bred.advance()
            best.append(bred.colony.fun.min())
        assert best == sorted(best, reverse=True)


def test_the_elites_named_survive_though_they_are_the_worst() -> None:
    for seed in range(5):
        bred = Bred(seed)
        worst = np.argsort(bred.colony.fun)[-3:]
        kept = {tuple(point) for point in bred.colony.points[worst]}
        bred.advance(worst)
        assert kept <= {tuple(point) for point in bred.colony.points}


def test_every_individual_wins_no_more_often_than_it_enters() -> None:
    still = replace(SEED, mutation=0.0, crossover=0.0)
    bred = Bred(6, settings=still)
    copies = np.unique(bred.colony.points, axis=0, return_counts=True)[1].max()
    bred.advance()
    assert np.unique(bred.colony.points, axis=0, return_counts=True)[1].max() <= 3 * copies + 1  # and the elite


def test_first_children_cost_the_calls_the_probabilities_imply() -> None:
    # A child is new if its pair is crossed or a bit flips: 1 - 0.6 (1 - 0.8 exp(-1)) = 0.577 of 200, some of them
    # unchanged by a crossing of equal parents or tails, or met before: 200 and 115 at most, and not many fewer. Of 4096
    # points 200 founders repeat 5; binomial sd 7 per run, 1.6 over 20.
    calls = [Bred(seed, generations=1).record.nfev for seed in range(20)]
    assert 285 < np.mean(calls) < 315


def test_without_crossover_and_mutation_nothing_new_appears() -> None:
    bred = Bred(3, settings=replace(SEED, mutation=0.0, crossover=0.0))
    founders = bred.record.nfev
    for _ in range(5):
        bred.advance()
    assert bred.record.nfev == founders


def test_an_odd_population_is_bred_whole() -> None:
    assert Bred(4, settings=replace(SEED, population=7), generations=1).colony.points.shape == (7, 2)
