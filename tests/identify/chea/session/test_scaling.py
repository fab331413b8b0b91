"""Parameters and the unit cube."""

import re

import numpy as np
import pytest
from scipy.optimize import Bounds

from rotorrig.identify.chea.session.scaling import from_bounds


def test_linear_and_logarithmic_middles_are_the_two_means() -> None:
    scaling = from_bounds([(2.0, 8.0), (2.0, 8.0)], ["linear", "log"])
    assert scaling.to_parameters(np.array([0.5, 0.5])) == pytest.approx([5.0, 4.0])


def test_the_ends_are_the_bounds_to_the_last_bit() -> None:
    bounds = [(0.1, 0.7), (1e-7, 1e-3), (-3.3, 1e9)]
    scaling = from_bounds(bounds, ["linear", "log", "linear"])
    assert scaling.to_parameters(np.array([np.zeros(3), np.ones(3)])).T.tolist() == [list(pair) for pair in bounds]


def test_the_ends_of_any_logarithmic_box_are_met_to_the_last_bit() -> None:
    ends = np.sort(np.random.default_rng(0).uniform(-20, 20, (500, 2)), axis=1)
    scaling = from_bounds(10.0**ends, "log")
    corners = scaling.to_parameters(np.array([np.zeros(500), np.ones(500)]))
    assert corners.T.tolist() == (10.0**ends).tolist()


def test_no_point_of_the_cube_leaves_the_bounds() -> None:
    scaling = from_bounds([(0.1, 0.3), (1e2, 1e6)], ["linear", "log"])
    u = np.concatenate([np.random.default_rng(0).random((5000, 2)), np.array([[1 - 1e-16] * 2, [1e-17] * 2])])
    x = scaling.to_parameters(u)
    assert (x >= scaling.lower).all()
    assert (x <= scaling.upper).all()


def test_scipy_bounds_serve_too() -> None:
    assert from_bounds(Bounds([0, 1], [2, 3]), "linear").upper.tolist() == [2.0, 3.0]


@pytest.mark.parametrize(
    ("bounds", "x_scale", "sentence"),
    [
        ([(0, 1, 2)], "linear", "bounds has shape (1, 3), expected (dim, 2)"),
        ([], "linear", "expected (dim, 2)"),
        ([(0, 1), (3, 2)], "linear", "bounds[1] is (3, 2), expected finite ends"),
        ([(0, np.inf)], "linear", "bounds[0] is (0, inf), expected finite ends"),
        ([(np.nan, 1)], "linear", "bounds[0] is (nan, 1), expected finite ends"),
        ([(-1e308, 1e308)], "linear", "bounds[0] is (-1e+308, 1e+308), expected ends whose difference is finite"),
        ([("low", 1)], "linear", "bounds are no numbers: could not convert string to float: 'low'"),
        ([(0, 1), (0,)], "linear", "bounds are no numbers"),
        ([(0, 1)], "log", "bounds[0] starts at 0, expected a positive end"),
        ([(1, 2)], "cubic", "x_scale is 'cubic', expected 'linear' or 'log'"),
        ([(1, 2)], ["log", "log"], "one of them for each of 1"),
    ],
)
def test_unusable_bounds_are_refused_in_a_sentence(bounds, x_scale, sentence: str) -> None:
    with pytest.raises(ValueError, match=re.escape(sentence)):
        from_bounds(bounds, x_scale)
