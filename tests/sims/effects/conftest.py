"""The RK4 and its reduced rotor."""

import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.rotor.model.assembly import RotorModel, assemble
from rotorrig.sims.rotor.model.reduction import reduce


@pytest.fixture(scope="session")
def rk4(rig_config: RigConfig) -> RigConfig:
    return rig_config


@pytest.fixture(scope="session")
def full(rk4: RigConfig) -> RotorModel:
    return assemble(rk4)


@pytest.fixture(scope="session")
def small(full: RotorModel) -> RotorModel:
    return reduce(full, modes=6)
