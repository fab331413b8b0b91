"""The genetic algorithm: coding, what is evaluated, what survives."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.chea.genetic import Colony, gray_to_integer
from rotorrig.identify.chea.settings import SEED

CUBE = np.array([[0.0, 0.0], [1.0, 1.0]])


def gray(number: int, bits: int) -> list[int]:
    return [(number ^ number >> 1) >> k & 1 for k in reversed(range(bits))]


def test_all_4096_gray_codes_are_read() -> None:
    codes = np.array([gray(n, 12) for n in range(4096)], dtype=np.uint8)
    assert gray_to_integer(codes).tolist() == list(range(4096))


class Bowl:
    """(u - target)^2, remembering what it was asked."""

    def __init__(self) -> None:
        self.asked: list[np.ndarray] = []

    def __call__(self, u: np.ndarray) -> np.ndarray:
        self.asked += list(u)
        return ((u - [0.7, 0.2]) ** 2).sum(axis=1)


def test_points_stay_in_the_box_and_reach_for_its_corners() -> None:
    box = np.array([[0.25, 0.5], [0.5, 0.625]])
    bowl = Bowl()
    colony = Colony(bowl, box, rng=np.random.default_rng(0), settings=SEED)
    for _ in range(8):
        colony.advance()
    asked = np.array(bowl.asked)
    assert (asked >= box[0]).all()
    assert (asked <= box[1]).all()
    assert colony.points[colony.fun.argmin()] == pytest.approx([0.5, 0.5], abs=0.01)  # nearest the target outside


def test_no_point_is_evaluated_twice() -> None:
    bowl = Bowl()
    colony = Colony(bowl, CUBE, rng=np.random.default_rng(1), settings=SEED)
    for _ in range(10):
        colony.advance()
    assert len({point.tobytes() for point in bowl.asked}) == len(bowl.asked)


def test_values_belong_to_their_points() -> None:
    colony = Colony(Bowl(), CUBE, rng=np.random.default_rng(2), settings=SEED)
    for _ in range(4):
        colony.advance()
        assert colony.fun == pytest.approx(Bowl()(colony.points))


def test_the_best_individual_is_never_lost() -> None:
    wild = replace(SEED, mutation=1.0, crossover=1.0)
    for seed in range(20):
        colony = Colony(Bowl(), CUBE, rng=np.random.default_rng(seed), settings=wild)
        best = [colony.fun.min()]
        for _ in range(5):
            colony.advance()
            best.append(colony.fun.min())
        assert best == sorted(best, reverse=True)


def test_first_generation_costs_the_calls_the_probabilities_imply() -> None:
    # A child is new if its pair is crossed or a bit flips: 1 - 0.6 (1 - 0.8 exp(-1/2)) = 0.691 of 200, a few of them
    # unchanged by a crossing of equal parents or tails. 138 + 200 at most, binomial sd 6.5 per run and 1.5 over 20.
    calls = []
    for seed in range(20):
        bowl = Bowl()
        Colony(bowl, CUBE, rng=np.random.default_rng(seed), settings=SEED).advance()
        calls.append(len(bowl.asked))
    assert 320 < np.mean(calls) < 343


def test_without_crossover_and_mutation_nothing_new_appears() -> None:
    bowl = Bowl()
    still = replace(SEED, mutation=0.0, crossover=0.0)
    colony = Colony(bowl, CUBE, rng=np.random.default_rng(3), settings=still)
    for _ in range(5):
        colony.advance()
    assert len(bowl.asked) == 200


def test_an_odd_population_is_bred_whole() -> None:
    colony = Colony(Bowl(), CUBE, rng=np.random.default_rng(4), settings=replace(SEED, population=7))
    colony.advance()
    assert colony.points.shape == (7, 2)
