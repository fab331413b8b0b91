"""Shared by the tests of balancing: the RK4 swept by the model itself, and its fit."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.balancing.fits import fit_from
from tests.identify.matched import sought
from tests.identify.swept import C, K, U, swept_response

TRIAL = 12e-6j


@pytest.fixture(scope="session")
def runs(rig_config: RigConfig) -> list[OrderTrackedResponse]:
    """As it is, with the trial mass, and with the correction on."""
    rng, rig = np.random.default_rng(3), sought(rig_config)
    made = [
        swept_response(rig, rng=rng, orders=(1,), trial=trial, speeds=(900, 2600), ramp=600)
        for trial in (0j, TRIAL, -U)
    ]
    return [replace(r, source=replace(r.source, source_hash=f"{i:016x}")) for i, r in enumerate(made)]


@pytest.fixture(scope="session")
def fit(runs: list[OrderTrackedResponse]) -> Identification:
    return fit_from(runs[:1], [*K, *C])
