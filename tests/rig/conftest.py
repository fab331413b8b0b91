"""A config, and the fakes at the far ends of its wires."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from rotorrig.rig.config.description import RigConfig, load
from rotorrig.rig.probes.base import DaqInfo
from tests.rig.wire_fakes import Board, Drive

settings.register_profile("patient", deadline=None)  # a busy machine is no defect of the code under test
settings.load_profile("patient")


@pytest.fixture(scope="session")
def rk4() -> RigConfig:
    return load(Path(__file__).parents[2] / "configs" / "rk4.toml")


@pytest.fixture(scope="session")
def info() -> DaqInfo:
    """A 16 bit DAQ of +-24 V at 10 kHz with the five channels of the RK4."""
    return DaqInfo(
        model="board",
        serial="7",
        sample_rate=10_000.0,
        channels=5,
        volts_per_count=(24 / 32768,) * 5,
        full_scale_counts=32768,
    )


@pytest.fixture
def board() -> Iterator[Board]:
    board = Board()
    board.start()
    yield board
    board.unplug()


@pytest.fixture
def drive() -> Iterator[Drive]:
    drive = Drive()
    drive.start()
    yield drive
    drive.unplug()
