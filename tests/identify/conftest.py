"""The RK4 without bands, recordings of it by the model itself, and the unknowns they were made of."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.identify.matched import sought
from tests.identify.problems import problem_of
from tests.identify.swept import C, K, swept_response


@pytest.fixture(scope="session")
def rig(rig_config: RigConfig) -> RigConfig:
    return sought(rig_config)


@pytest.fixture(scope="session")
def one_plane(rig: RigConfig) -> RigConfig:
    return rig.model_copy(update={"probes": rig.probes[:2]})


@pytest.fixture(scope="session")
def short(rig: RigConfig) -> OrderTrackedResponse:
    """Twenty rows through the critical speeds, three orders, a trial mass, no noise."""
    return swept_response(rig, trial=4e-6 + 3e-6j, orders=(1, 2, 3), speeds=(900, 2600), ramp=600)


@pytest.fixture(scope="session")
def healthy(rig: RigConfig) -> OrderTrackedResponse:
    return swept_response(rig, rng=np.random.default_rng(1))


@pytest.fixture(scope="session")
def hidden(short: OrderTrackedResponse) -> NDArray[np.float64]:
    """The base's unknowns of every recording here, but for what a fit settles by itself: (parameter,)."""
    problem = problem_of(short)
    return problem.begin(np.array([*K, *C]))[: len(problem.parameters.base)]


@pytest.fixture
def bare(short: OrderTrackedResponse) -> Recording:
    """The short recording at 1X alone."""
    return Recording(
        replace(
            short,
            orders=(1.0,),
            z=short.z[..., :1],
            covariance=short.covariance[:, :1],
            slow_roll=short.slow_roll[:, :1],
            slow_roll_covariance=short.slow_roll_covariance[:1],
        )
    )
