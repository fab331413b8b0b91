"""Which ends of descents are one minimum."""

import numpy as np

from rotorrig.identify.chea.residuals.levenberg_marquardt import Point
from rotorrig.identify.chea.residuals.valleys import Valleys


def end(u, cost, normal=None):
    normal = np.eye(len(u)) * 1e4 if normal is None else np.array(normal, dtype=float)
    J = np.sqrt(normal)  # they are diagonal
    r = np.zeros(len(u))
    r[0] = np.sqrt(cost)
    return Point(np.array(u, dtype=float), r, J)


def none():
    return Valleys(2, same_point=0.02, same_fit=0.01)


def test_ends_close_together_are_one_minimum_kept_at_its_lowest():
    valleys = none()
    for u, cost in (([0.5, 0.5], 2.0), ([0.51, 0.49], 1.0), ([0.505, 0.5], 3.0)):
        valleys.add(end(u, cost))
    assert valleys.cost.tolist() == [1.0]
    assert valleys.hits.tolist() == [3]
    assert valleys.points[0].p.tolist() == [0.51, 0.49]


def test_ends_far_apart_are_two_if_the_residuals_change_between_them():
    valleys = none()
    valleys.add(end([0.2, 0.5], 1.0))
    valleys.add(end([0.8, 0.5], 1.0))
    assert valleys.hits.tolist() == [1, 1]


def test_a_direction_in_which_nothing_changes_is_one_valley():
    flat = [[0.0, 0.0], [0.0, 1e4]]
    valleys = none()
    valleys.add(end([0.2, 0.5], 1.0, flat))
    valleys.add(end([0.8, 0.5], 1.001, flat))
    valleys.add(end([0.8, 0.6], 1.0, flat))  # aside: the residuals change by 10
    assert valleys.hits.tolist() == [2, 1]


def test_a_point_below_a_known_minimum_is_not_held_by_it():
    valleys = none()
    assert not valleys.holds(end([0.5, 0.5], 1.0))
    valleys.add(end([0.5, 0.5], 1.0))
    assert valleys.holds(end([0.505, 0.5], 1.0))
    assert not valleys.holds(end([0.505, 0.5], 0.9))
    assert not valleys.holds(end([0.9, 0.5], 1.0))


def test_several_hits_may_be_taken_over():
    valleys = none()
    valleys.add(end([0.5, 0.5], 1.0), hits=3)
    valleys.add(end([0.5, 0.5], 1.0), hits=4)
    assert valleys.hits.tolist() == [7]
    assert valleys.best == 1.0
    assert none().best == np.inf
