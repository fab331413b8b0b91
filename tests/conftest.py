"""Shared by all tests: the RK4, a hurried version of its sweep, and what the blind plant answers to it."""

import os
import signal
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: threads only fight over matrices this small

import numpy as np
import pytest
from hypothesis import settings

from benchmarks.parts.blind.run import record
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig, load, parse
from tests import compile_once

CONFIGS = Path(__file__).parents[1] / "configs"

settings.register_profile("patient", deadline=None)  # a busy machine is no defect of the code under test
settings.load_profile("patient")
compile_once.install()


if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # so a shell starts what it puts in the background
    signal.signal(signal.SIGINT, signal.default_int_handler)  # else the programs under test never hear of a Ctrl-C


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--rig", metavar="CONFIG", help="run tests/contracts on the devices of this config")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--rig"):
        for item in items:
            if "contracts" in item.path.parts:
                item.add_marker(pytest.mark.hardware)


@pytest.fixture(scope="session")
def rig_config() -> RigConfig:
    return load(CONFIGS / "rk4.toml")


@pytest.fixture(scope="session")
def hurried_rig() -> RigConfig:
    """The RK4 with a ramp of 90 rpm/s and a short slow roll: a third of the samples, three times the sweep lag."""
    text = (CONFIGS / "rk4.toml").read_text()
    for old, new in (('ramp = "30 rpm/s"', 'ramp = "90 rpm/s"'), ('time = "10 s"', 'time = "6 s"')):
        assert old in text
        text = text.replace(old, new)
    return parse(text, where="hurried rk4.toml")


@pytest.fixture(scope="session")
def blind_response(hurried_rig: RigConfig) -> OrderTrackedResponse:
    """A healthy blind plant, swept and tracked; its truth is `draw(hurried_rig, seed=BLIND_SEED)`."""
    return track(record(hurried_rig, seed=BLIND_SEED))


BLIND_SEED = 7


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20240229)
