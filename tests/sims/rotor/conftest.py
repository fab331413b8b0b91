"""The RK4's rotor, whole and reduced."""

from pathlib import Path

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig, load
from rotorrig.sims.rotor.model.assembly import RotorModel, assemble
from rotorrig.sims.rotor.model.component_modes import condense_spans
from rotorrig.sims.rotor.model.reduction import reduce


@pytest.fixture(scope="session")
def rk4() -> RigConfig:
    return load(Path(__file__).parents[3] / "configs" / "rk4.toml")


@pytest.fixture(scope="session")
def full(rk4) -> RotorModel:
    return assemble(rk4)


@pytest.fixture(scope="session")
def small(full) -> RotorModel:
    return reduce(full)


@pytest.fixture(scope="session")
def adjustable(rk4) -> RotorModel:
    """The RK4, reduced so that its geometry may be changed."""
    return condense_spans(assemble(rk4, hubs=True), modes=4)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(2)
