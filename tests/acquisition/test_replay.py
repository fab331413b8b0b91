import dataclasses
from pathlib import Path

import numpy as np
import pytest

from rotorrig.acquisition.mcap_file import write_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.acquisition.replay import ReplayDaq
from rotorrig.rig.clock import ManualClock
from rotorrig.rig.errors import ConfigError, LinkLost


def test_a_replay_hands_out_the_blocks_gaps_and_all(recording: RawRecording) -> None:
    with ReplayDaq(recording) as daq:
        assert daq.open() == recording.daq
        daq.start()
        for block in recording.blocks:
            assert daq.read() is block
        assert daq.ended
        with pytest.raises(LinkLost, match=r"recording of 0\.5 s has come to its end"):
            daq.read()


def test_a_replay_reads_a_file(recording: RawRecording, tmp_path: Path) -> None:
    write_recording(tmp_path / "run.mcap", recording)
    daq = ReplayDaq(tmp_path / "run.mcap")
    daq.start()
    assert np.array_equal(daq.read().counts, recording.blocks[0].counts)


def test_started_again_it_begins_again(recording: RawRecording) -> None:
    daq = ReplayDaq(recording)
    daq.start()
    daq.read()
    daq.start()
    assert daq.read() is recording.blocks[0]


@pytest.mark.parametrize(("rate", "seconds"), [(1.0, 0.51), (0.5, 1.02), (20.0, 0.0255), ("max", 0.0)])
def test_a_replay_keeps_the_recordings_pace(recording: RawRecording, rate: float, seconds: float) -> None:
    clock = ManualClock(start=100.0)
    daq = ReplayDaq(recording, rate=rate, clock=clock)
    daq.start()
    for _ in recording.blocks:
        daq.read()
    assert clock.now() - 100.0 == pytest.approx(seconds)  # 5000 scans and 100 missing at 10 kHz


def test_a_long_gap_is_silence_and_then_goes_on(recording: RawRecording) -> None:
    late = dataclasses.replace(recording.blocks[1], first_sample=50_000, t_ns=5_000_000_000)
    daq = ReplayDaq(dataclasses.replace(recording, blocks=(recording.blocks[0], late)), rate=1.0, clock=ManualClock())
    daq.start()
    daq.read()
    with pytest.raises(LinkLost, match="silent for 1 s"):
        daq.read(timeout=1.0)
    assert daq.read(timeout=4.5) is late


def test_a_replay_that_was_not_started_says_so(recording: RawRecording) -> None:
    daq = ReplayDaq(recording)
    with pytest.raises(LinkLost, match="not started"):
        daq.read()
    daq.start()
    daq.close()
    daq.close()
    with pytest.raises(LinkLost, match="not started"):
        daq.read()


@pytest.mark.parametrize("rate", [0.0, -1.0, float("nan")])
def test_a_rate_that_leads_nowhere_is_refused(recording: RawRecording, rate: float) -> None:
    with pytest.raises(ConfigError, match="rate: got"):
        ReplayDaq(recording, rate=rate)
