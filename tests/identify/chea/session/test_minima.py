"""The list of minima."""

import numpy as np

from rotorrig.identify.chea.session.minima import Minima, one_point


def test_ends_close_together_are_one_minimum_kept_at_its_lowest() -> None:
    minima = Minima(2, tolerance=0.01)
    for x, fun in ((0.500, 2.0), (0.505, 1.0), (0.502, 3.0)):
        minima.add(np.array([x, 0.5]), fun)
    u, fun, hits = minima.sorted()
    assert u.tolist() == [[0.505, 0.5]]
    assert fun.tolist() == [1.0]
    assert hits.tolist() == [3]
    assert len(minima) == 1


def test_an_end_between_two_minima_belongs_to_the_nearer() -> None:
    minima = Minima(1, tolerance=0.1)
    for x, fun in ((0.50, 1.0), (0.65, 1.0), (0.59, 0.5)):
        minima.add(np.array([x]), fun)
    assert minima.sorted()[0].tolist() == [[0.59], [0.50]]


def test_minima_are_apart_if_they_are_in_any_one_parameter() -> None:
    minima = Minima(8, tolerance=0.01)
    minima.add(np.full(8, 0.5), 1.0)
    minima.add(np.full(8, 0.509), 1.0)  # 0.025 away as the crow flies
    assert len(minima) == 1
    minima.add(np.array([0.5] * 7 + [0.52]), 1.0)
    assert len(minima) == 2


def test_minima_come_best_first() -> None:
    minima = Minima(1, tolerance=0.01)
    for x, fun in ((0.1, 3.0), (0.5, 1.0), (0.9, 2.0)):
        minima.add(np.array([x]), fun)
    assert minima.sorted()[0].ravel().tolist() == [0.5, 0.9, 0.1]
    assert minima.best == 1.0


def test_none_found_is_an_empty_list_of_the_right_width() -> None:
    minima = Minima(3, tolerance=0.01)
    u, fun, hits = minima.sorted()
    assert u.shape == (0, 3)
    assert fun.shape == hits.shape == (0,)
    assert minima.best == np.inf


def test_one_far_end_is_enough_to_disagree() -> None:
    same = [np.array([0.5, 0.5])] * 3
    assert one_point(same, 0.01)
    assert not one_point([*same, np.array([0.5, 0.52])], 0.01)
