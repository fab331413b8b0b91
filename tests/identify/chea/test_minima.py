"""The list of minima."""

import numpy as np

from rotorrig.identify.chea.minima import Minima, one_point


def test_ends_close_together_are_one_minimum_kept_at_its_lowest() -> None:
    minima = Minima(0.01)
    minima.add(np.array([0.500, 0.5]), 2.0)
    minima.add(np.array([0.505, 0.5]), 1.0)
    minima.add(np.array([0.502, 0.5]), 3.0)
    u, fun = minima.sorted(2)
    assert u.tolist() == [[0.505, 0.5]]
    assert fun.tolist() == [1.0]


def test_minima_come_best_first() -> None:
    minima = Minima(0.01)
    for x, fun in ((0.1, 3.0), (0.5, 1.0), (0.9, 2.0)):
        minima.add(np.array([x]), fun)
    assert minima.sorted(1)[0].ravel().tolist() == [0.5, 0.9, 0.1]
    assert minima.best == 1.0


def test_none_found_is_an_empty_list_of_the_right_width() -> None:
    u, fun = Minima(0.01).sorted(3)
    assert u.shape == (0, 3)
    assert fun.shape == (0,)
    assert Minima(0.01).best == np.inf


def test_one_far_end_is_enough_to_disagree() -> None:
    same = [np.array([0.5, 0.5])] * 3
    assert one_point(same, 0.01)
    assert not one_point([*same, np.array([0.5, 0.52])], 0.01)
