"""Offspring of minima that lie in a pattern."""

import numpy as np
import pytest

from rotorrig.identify.chea.modern.recombination import offspring, spacing

NOWHERE = np.empty((0, 2))


def test_crossover_completes_a_grid() -> None:
    minima = np.array([[0.2, 0.3], [0.7, 0.9]])
    children = offspring(minima, NOWHERE, number=10, apart=0.01, rng=np.random.default_rng(0))
    for corner in ([0.2, 0.9], [0.7, 0.3]):
        assert np.abs(children - corner).max(axis=1).min() < 1e-12


def test_a_parallelogram_continues_a_turned_lattice() -> None:
    a, b = np.array([0.1, 0.04]), np.array([-0.04, 0.1])
    middle = np.array([0.5, 0.5])
    minima = np.array([middle, middle + a, middle + b])
    children = offspring(minima, NOWHERE, number=40, apart=0.005, rng=np.random.default_rng(0))
    for neighbour in (middle - a, middle - b, middle + a - b, middle + b - a, middle + a + b):
        assert np.abs(children - neighbour).max(axis=1).min() < 1e-12


def test_children_keep_away_from_what_is_known_and_from_one_another_and_stay_inside() -> None:
    rng = np.random.default_rng(0)
    minima, known = rng.random((8, 2)), rng.random((30, 2))
    children = offspring(minima, known, number=20, apart=0.03, rng=rng)
    everything = np.vstack([minima, known, children])
    apart = np.abs(children[:, None] - everything).max(axis=2)
    assert (apart > 0.03).sum() == len(children) * (len(everything) - 1)  # each but itself
    assert children.min() >= 0.0
    assert children.max() <= 1.0


def test_twins_have_no_new_children() -> None:
    minima = np.full((2, 2), 0.5)
    assert offspring(minima, NOWHERE, number=5, apart=0.01, rng=np.random.default_rng(0)).shape == (0, 2)


def test_the_spacing_of_a_lattice_is_its_edge() -> None:
    grid = np.array([[x, y] for x in np.arange(5) for y in np.arange(4)]) * 0.07
    assert spacing(grid) == pytest.approx(0.07)
    assert spacing(grid[:1]) == np.inf
