"""What a fit makes of bearings that are not plain springs and dashpots."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.base_model.forward import Forward
from rotorrig.identify.base_model.parameters import Parameters
from rotorrig.identify.base_model.structure import Structure
from rotorrig.identify.fit import identify
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import from_si
from rotorrig.rig.errors import ConfigError


def with_left_bearing(response: OrderTrackedResponse, **update: object) -> OrderTrackedResponse:
    """Return the response of the same rig with another left bearing A."""
    table = response.rig.model_dump(mode="json")
    table["bearings"][0] |= update
    return replace(response, rig=from_si(table))


def test_a_rigid_bearing_is_no_nuisance_and_holds_the_shaft_in_the_prediction(
    blind_response: OrderTrackedResponse,
) -> None:
    rows = np.arange(5)
    K, C = np.diag([33.9e3, 34.6e3])[None], np.diag([15.0, 15.0])[None]

    def predicted(response: OrderTrackedResponse) -> np.ndarray:
        others = Parameters(response.rig, response.probes).others
        values = Structure(K=K, C=C, others=(1.0,) * 2 * len(others))
        forward = Forward(response, rows, groups=[["spring"]], others=others, planes=["disk"])
        return forward(values).along[..., 0]

    rigid = with_left_bearing(blind_response, rigid=True, kxx=None, kyy=None)
    assert Parameters(rigid.rig, rigid.probes).others == ("left B",)
    hard = with_left_bearing(blind_response, kxx=1e11, kyy=1e11)
    np.testing.assert_allclose(predicted(rigid), predicted(hard), rtol=1e-3)
    assert np.abs(predicted(rigid) / predicted(blind_response) - 1).max() > 0.01


def test_a_bearing_given_over_speed_is_refused_before_any_work(blind_response: OrderTrackedResponse) -> None:
    table = {"speed": [0.0, 300.0], "value": [1e6, 2e6]}
    with pytest.raises(ConfigError, match="bearing 'left A' is given over speed, want constants to identify by"):
        identify(with_left_bearing(blind_response, kxx=table))
