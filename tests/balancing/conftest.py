"""Shared by the tests of balancing: the RK4 swept by the model itself, and its fit."""

import pytest

from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.balancing.fits import fit_from, three_runs


@pytest.fixture(scope="session")
def runs(rig_config: RigConfig) -> list[OrderTrackedResponse]:
    """As it is, with the trial mass, and with the correction on."""
    return three_runs(rig_config)


@pytest.fixture(scope="session")
def fit(runs: list[OrderTrackedResponse]) -> Identification:
    return fit_from(runs[:1])
