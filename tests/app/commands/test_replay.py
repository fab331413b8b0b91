"""`rotor replay --track`: the same bytes give the same response, at any rate, in any process."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.parts.blind.run import record
from rotorrig.acquisition.files.recording_mcap import read_recording, write_recording
from rotorrig.acquisition.recording import Event
from rotorrig.acquisition.replay import trim_before
from rotorrig.app.commands import replay
from rotorrig.processing.files.response_mcap import read_response, write_response
from rotorrig.processing.pipeline import track
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import ConfigError


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, brief_rig: RigConfig) -> Path:
    """A folder with a sweep's run.mcap, a gap of half a block in it, and what `track` makes of it."""
    folder = tmp_path_factory.mktemp("replay")
    recording = record(brief_rig, seed=7)
    blocks = list(recording.blocks)
    at = len(blocks) // 2
    whole = blocks[at]
    half = len(whole.counts) // 2
    blocks[at] = type(whole)(
        counts=whole.counts[half:],
        first_sample=whole.first_sample + half,
        t_ns=whole.t_ns + half * 100_000,
        overrun=True,
    )
    gap = Event(t_ns=whole.t_ns, kind="gap", text=f"{half} samples are missing")
    events = tuple(sorted((*recording.events, gap), key=lambda event: event.t_ns))
    fields = {name: getattr(recording, name) for name in ("rig", "daq", "motor", "source", "complete")}
    write_recording(folder / "run.mcap", type(recording)(blocks=tuple(blocks), events=events, **fields))
    write_response(folder / "tracked.mcap", track(read_recording(folder / "run.mcap")))
    return folder


@pytest.mark.parametrize("rate", ["max", "200"])
def test_a_replay_is_tracked_as_the_recording_is(folder: Path, tmp_path: Path, rate: str) -> None:
    replay.play(folder / "run.mcap", rate=rate, view=False, track=tmp_path / "replayed.mcap")
    assert (tmp_path / "replayed.mcap").read_bytes() == (folder / "tracked.mcap").read_bytes()


@pytest.mark.campaign
def test_another_process_writes_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    words = ["-m", "rotorrig.app.cli", "replay", str(folder / "run.mcap"), "--track", str(tmp_path / "replayed.mcap")]
    subprocess.run(
        [sys.executable, *words], check=True, env={**os.environ, "PYTHONHASHSEED": "77"}, capture_output=True
    )
    assert (tmp_path / "replayed.mcap").read_bytes() == (folder / "tracked.mcap").read_bytes()


def test_from_a_time_on_it_is_the_recording_cut_there(folder: Path, tmp_path: Path) -> None:
    for rate in ("max", "200"):
        out = tmp_path / f"{rate}.mcap"
        assert replay.play(folder / "run.mcap", rate=rate, view=False, track=out, begin=9.00005) > 5
    write_response(tmp_path / "cut.mcap", track(trim_before(read_recording(folder / "run.mcap"), 9.00005)))
    assert (tmp_path / "max.mcap").read_bytes() == (tmp_path / "200.mcap").read_bytes()
    assert (tmp_path / "max.mcap").read_bytes() == (tmp_path / "cut.mcap").read_bytes()


@pytest.mark.campaign
def test_a_cut_recording_read_from_its_own_file_gives_the_same_vectors(folder: Path, tmp_path: Path) -> None:
    replay.play(folder / "run.mcap", rate="max", view=False, track=tmp_path / "replayed.mcap", begin=9.0)
    write_recording(tmp_path / "cut.mcap", trim_before(read_recording(folder / "run.mcap"), 9.0))
    ours, theirs = read_response(tmp_path / "replayed.mcap"), track(read_recording(tmp_path / "cut.mcap"))
    assert ours.runs == theirs.runs
    assert np.array_equal(ours.z, theirs.z, equal_nan=True)  # the row with the gap
    assert np.array_equal(ours.covariance, theirs.covariance, equal_nan=True)


def test_a_beginning_behind_the_end_is_refused(folder: Path) -> None:
    with pytest.raises(ConfigError, match=r"from: got 1e\+06 s, want less than the recording's"):
        replay.play(folder / "run.mcap", rate="max", view=False, begin=1e6)
