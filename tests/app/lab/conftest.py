"""A small lab: a run-up in closed form as run.mcap, and two processes to work on."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from distributed import Client

from rotorrig.acquisition.files.recording_mcap import write_recording
from rotorrig.app import cli
from rotorrig.app.lab.cluster import connect
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.units import RPM
from tests.identify.matched import matched_response, sought
from tests.processing.synthetic import chirp, recording_of

RATE = 2_000.0
KXX = 36e3  # N/m
Rotor = Callable[..., tuple[int, str, str]]


def write_run_up(path: Path, rig: RigConfig, *, amplitude: float = 20e-6) -> None:
    """Write a run-up from 300 to 1500 rpm in 30 s, with that amplitude at every probe [m]."""
    t = np.arange(int(30 * RATE)) / RATE
    theta = chirp(t, start=300 / RPM, rate=40 / RPM)
    x = np.tile(amplitude * np.cos(theta)[:, None], 4) + 1e-8 * np.random.default_rng(1).standard_normal((len(t), 4))
    write_recording(path, recording_of(rig, theta, x, rate=RATE))


def write_responses(folder: Path, rig: RigConfig, number: int) -> None:
    """Write responses of a rotor with another spring bearing than the nameplate's, each with another noise."""
    folder.mkdir(parents=True, exist_ok=True)
    hidden = {"spring": (np.diag([KXX, 35e3]), np.diag([15.0, 16.0]))}
    for i in range(number):
        response = matched_response(
            sought(rig), bearings=hidden, unbalance={"disk": 15e-6 + 0j}, rng=np.random.default_rng(i)
        )
        write_response(folder / f"{i}.mcap", response)


@pytest.fixture(scope="session")
def processes() -> Iterator[str]:
    """The address of a scheduler with two workers."""
    with connect(workers=2) as client:
        yield client.cluster.scheduler_address


@pytest.fixture
def client(processes: str) -> Iterator[Client]:
    with Client(processes) as client:
        yield client


@pytest.fixture(scope="session")
def run_up(rig_config: RigConfig, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("run-up") / "run.mcap"
    write_run_up(path, rig_config)
    return path.read_bytes()


@pytest.fixture
def recordings(tmp_path: Path, run_up: bytes) -> Path:
    """A folder with one recording in it."""
    path = tmp_path / "recordings" / "monday" / "run.mcap"
    path.parent.mkdir(parents=True)
    path.write_bytes(run_up)
    return tmp_path / "recordings"


@pytest.fixture
def rotor(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Rotor:
    """Run `rotor` with these words; return its status and what it printed."""

    def run(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["rotor", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        printed = capsys.readouterr()
        assert isinstance(ended.value.code, int) or ended.value.code is None
        return ended.value.code or 0, printed.out, " ".join(printed.err.split())

    return run
