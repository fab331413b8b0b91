"""Which ends of descents are one minimum."""

import numpy as np

from rotorrig.identify.chea.residuals import ABSOLUTES, SQUARES, Norm, Point
from rotorrig.identify.chea.residuals.valleys import Valleys
from rotorrig.identify.chea.session import Minima


class Ends:
    """A list of minima, and the valleys it goes by."""

    def __init__(self, norm: Norm = SQUARES) -> None:
        self._valleys = Valleys(norm, same_fit=0.01)
        self.minima = Minima(2, tolerance=0.02, distance=self._valleys.distance)

    def add(self, u: list[float], cost: float, normal: list[list[float]] | None = None, *, hits: int = 1) -> None:
        J = np.sqrt(np.eye(2) * 1e4 if normal is None else np.array(normal))  # they are diagonal
        point = Point(np.array(u), np.array([np.sqrt(cost), 0.0]), J)
        self._valleys.keep(point)
        self.minima.add(point.p, cost, hits=hits)


def test_ends_close_together_are_one_minimum_kept_at_its_lowest():
    ends = Ends()
    for u, cost in (([0.5, 0.5], 2.0), ([0.51, 0.49], 1.0), ([0.505, 0.5], 3.0)):
        ends.add(u, cost)
    u, costs, hits = ends.minima.sorted()
    assert costs.tolist() == [1.0]
    assert hits.tolist() == [3]
    assert u.tolist() == [[0.51, 0.49]]


def test_ends_far_apart_are_two_if_the_residuals_change_between_them():
    ends = Ends()
    ends.add([0.2, 0.5], 1.0)
    ends.add([0.8, 0.5], 1.0)
    assert ends.minima.sorted()[2].tolist() == [1, 1]


def test_a_direction_in_which_nothing_changes_is_one_valley():
    flat = [[0.0, 0.0], [0.0, 1e4]]
    ends = Ends()
    ends.add([0.2, 0.5], 1.0, flat)
    ends.add([0.8, 0.5], 1.001, flat)
    ends.add([0.8, 0.6], 1.0, flat)  # aside: the residuals change by 10
    assert ends.minima.sorted()[2].tolist() == [2, 1]


def test_residuals_of_absolute_values_change_by_their_sum():
    for norm, hits in ((SQUARES, [2]), (ABSOLUTES, [1, 1])):
        ends = Ends(norm)
        for u in (0.2, 0.6):
            ends.add([0.5, u], 1.0, [[0.0, 0.0], [0.0, 1e-2]])  # by 0.04, or squared by 0.0016
        assert ends.minima.sorted()[2].tolist() == hits


def test_a_point_below_a_known_minimum_is_not_held_by_it():
    ends = Ends()
    assert not ends.minima.holds(np.array([0.5, 0.5]), 1.0)
    ends.add([0.5, 0.5], 1.0)
    assert ends.minima.holds(np.array([0.505, 0.5]), 1.0)
    assert not ends.minima.holds(np.array([0.505, 0.5]), 0.9)
    assert not ends.minima.holds(np.array([0.9, 0.5]), 1.0)


def test_several_hits_may_be_taken_over():
    ends = Ends()
    ends.add([0.5, 0.5], 1.0, hits=3)
    ends.add([0.5, 0.5], 1.0, hits=4)
    assert ends.minima.sorted()[2].tolist() == [7]
    assert ends.minima.best == 1.0
    assert Ends().minima.best == np.inf
