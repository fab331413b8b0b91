"""What a fit makes of bearings that are not plain springs and dashpots."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.base_fit.fit import identify
from rotorrig.identify.base_model.parameters import Parameters
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import from_si
from rotorrig.rig.errors import ConfigError
from tests.identify.problems import problem_of


def with_left_bearing(response: OrderTrackedResponse, **update: object) -> OrderTrackedResponse:
    """Return the response of the same rig with another left bearing A."""
    table = response.rig.model_dump(mode="json")
    table["bearings"][0] |= update
    return replace(response, rig=from_si(table))


def test_a_rigid_bearing_is_no_nuisance_and_holds_the_shaft_in_the_prediction(
    blind_response: OrderTrackedResponse,
) -> None:
    def predicted(response: OrderTrackedResponse) -> np.ndarray:
        problem = problem_of(response)
        p = problem.begin(np.array([33.9e3, 34.6e3, 15.0, 15.0]))
        names = problem.parameters.base
        p[names.unbalance], p[names.runout] = (1.0, 0.0), 0.0
        return problem.model.predict(p)[0][1][:5]

    rigid = with_left_bearing(blind_response, rigid=True, kxx=None, kyy=None)
    assert Parameters(rigid.rig, rigid.probes).others == ("left B",)
    hard = with_left_bearing(blind_response, kxx=1e11, kyy=1e11)
    np.testing.assert_allclose(predicted(rigid), predicted(hard), rtol=1e-3)
    assert np.abs(predicted(rigid) / predicted(blind_response) - 1).max() > 0.01


def test_a_bearing_given_over_speed_is_refused_before_any_work(blind_response: OrderTrackedResponse) -> None:
    table = {"speed": [0.0, 300.0], "value": [1e6, 2e6]}
    with pytest.raises(ConfigError, match="bearing 'left A' is given over speed, want constants to identify by"):
        identify([with_left_bearing(blind_response, kxx=table)])
