"""A small recording whose every count is known."""

from pathlib import Path

import numpy as np
import pytest

from rotorrig.acquisition.files.recording_mcap import write_recording
from rotorrig.acquisition.recording import Event, MotorSample, RawRecording
from rotorrig.rig.config.description import RigConfig, load
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance
from tests.acquisition.sweep.scripted_bench import Bench, MakeBench
from tests.acquisition.sweep.scripted_rig import Shaft

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def rig() -> RigConfig:
    return load(ROOT / "configs/rk4.toml")


@pytest.fixture(scope="session")
def daq_info() -> DaqInfo:
    return DaqInfo(
        model="stream DAQ",
        serial="7",
        sample_rate=1e4,
        channels=5,
        volts_per_count=(6e-4, 6e-4, 6e-4, 6e-4, 1e-3),
        full_scale_counts=32768,
    )


@pytest.fixture
def source(rig: RigConfig) -> Provenance:
    return Provenance(config_hash=rig.hash, code_version="0.1.0", source="bench")


@pytest.fixture
def recording(rig: RigConfig, daq_info: DaqInfo, source: Provenance) -> RawRecording:
    """Half a second in 25 blocks; 100 samples are missing before the eleventh."""
    rng = np.random.default_rng(5)
    blocks = tuple(
        Block(
            counts=rng.integers(-32768, 32768, (200, 5), dtype=np.int32),
            first_sample=200 * i + 100 * (i >= 10),
            t_ns=20_000_000 * i + 10_000_000 * (i >= 10),
            overrun=i == 10,
        )
        for i in range(25)
    )
    return RawRecording(
        rig=rig,
        daq=daq_info,
        blocks=blocks,
        events=(
            Event(t_ns=0, kind="mark", text="up"),
            Event(t_ns=200_000_000, kind="gap", text="100 samples are missing"),
        ),
        motor=(MotorSample(t_ns=100_000_000, speed=50.0, setpoint=50.5, running=True, fault=""),),
        source=source,
        complete=True,
    )


@pytest.fixture
def whole(recording: RawRecording, tmp_path: Path) -> Path:
    """Return the recording's file."""
    path = tmp_path / "run.mcap"
    write_recording(path, recording)
    return path


@pytest.fixture
def bench(rig: RigConfig, daq_info: DaqInfo, source: Provenance, tmp_path: Path) -> MakeBench:
    """Return what makes a scripted rig with a shaft of these ways, see scripted_rig.Shaft."""

    def make(**shaft: float) -> Bench:
        return Bench(rig, daq_info, source, tmp_path / "run.mcap", Shaft(**shaft))

    return make
