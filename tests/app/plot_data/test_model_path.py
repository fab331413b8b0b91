"""The path of a model's vectors: the closed form of tests/app/conftest.py, a circle but for a few percent."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.app.plot_data.curves import Curve, curves
from rotorrig.app.plot_data.model_path import model_path
from rotorrig.processing.response import OrderTrackedResponse
from tests.app.conftest import make_response, prediction_of


@pytest.fixture
def sparse(response: OrderTrackedResponse) -> Curve:
    few = make_response(response.rig, rows=120)  # 26 rpm apart, at a half-power width of 180
    return dataclasses.replace(curves(few, 0, prediction=prediction_of(few))[0])


def test_between_rows_the_path_is_the_models(
    sparse: Curve, closed_form: Callable[[NDArray[np.float64]], NDArray[np.complex128]]
) -> None:
    rpm, z = model_path(sparse)
    true = closed_form(rpm * np.pi / 30) - closed_form(np.array([240 * np.pi / 30]))  # less its slow roll
    assert np.abs(z - 1e6 * true).max() < 0.02 * 187.5


def test_no_step_of_the_path_is_seen_as_a_corner(sparse: Curve) -> None:
    _, z = model_path(sparse)
    assert np.abs(np.diff(z)).max() < 0.05 * 187.5
    assert len(z) < 500


def test_a_run_of_two_rows_is_left_as_it_is(sparse: Curve) -> None:
    rpm, z = model_path(sparse.at(np.array([3, 4])))
    assert rpm == pytest.approx(sparse.rpm[3:5])
    assert np.abs(z) == pytest.approx(sparse.model_amplitude[3:5])  # type: ignore[index]
