"""Fixtures of the processing tests; what they are made of stands in synthetic.py."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig, load
from tests.processing.synthetic import recording_of


@pytest.fixture(scope="session")
def rk4() -> RigConfig:
    return load(Path(__file__).parents[2] / "configs" / "rk4.toml")


@pytest.fixture(scope="session")
def record(rk4: RigConfig) -> partial:
    return partial(recording_of, rk4)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20_26)
