import dataclasses
from pathlib import Path

import numpy as np
import pytest

from rotorrig.acquisition.files.recording_mcap import write_recording
from rotorrig.acquisition.recording import Event, MotorSample, RawRecording
from rotorrig.acquisition.replay import ReplayDaq, trim_before
from rotorrig.rig.errors import ConfigError, LinkLost
from tests.manual_clock import ManualClock


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


def test_events_and_readings_come_in_their_places_between_the_blocks(recording: RawRecording) -> None:
    played: list[object] = []
    with ReplayDaq(recording) as daq:
        daq.start()
        assert daq.notes() == ()
        while not daq.ended:
            played.append(daq.read())
            played += daq.notes()
    places = {note: played.index(note) for note in (*recording.events, *recording.motor)}
    assert [played[places[note] - 1] for note in recording.events] == [recording.blocks[0], recording.blocks[9]]
    assert played[places[recording.motor[0]] - 1] is recording.blocks[4]  # ends at 100 ms
    assert [x for x in played if not isinstance(x, Event | MotorSample)] == list(recording.blocks)


def test_what_was_noted_after_the_last_block_is_not_lost(recording: RawRecording) -> None:
    late = Event(t_ns=9_000_000_000, kind="stop", text="plan finished")
    daq = ReplayDaq(dataclasses.replace(recording, events=(*recording.events, late)))
    daq.start()
    notes = [note for _ in recording.blocks if daq.read() for note in daq.notes()]
    assert notes[-1] is late
    assert daq.notes() == ()


def test_a_cut_keeps_indices_and_times_and_the_run_under_way(recording: RawRecording) -> None:
    trial = Event(t_ns=0, kind="trial", text="disk: 12 g mm at 90 deg")
    events = (trial, *recording.events, Event(t_ns=300_000_000, kind="mark", text="down"))
    cut = trim_before(dataclasses.replace(recording, events=events), 0.1234)
    assert (cut.blocks[0].first_sample, cut.blocks[0].t_ns) == (1234, 123_400_000)
    assert np.array_equal(cut.blocks[0].counts, recording.blocks[6].counts[34:])
    assert cut.blocks[1:] == recording.blocks[7:]
    assert [(event.t_ns, event.text) for event in cut.events] == [
        (123_400_000, "disk: 12 g mm at 90 deg"),
        (123_400_000, "up"),
        (200_000_000, "100 samples are missing"),
        (300_000_000, "down"),
    ]
    assert cut.motor == ()


def test_a_cut_behind_the_end_of_a_run_does_not_take_it_up_again(recording: RawRecording) -> None:
    stop = Event(t_ns=100_000_000, kind="stop", text="plan finished")
    cut = trim_before(dataclasses.replace(recording, events=(recording.events[0], stop)), 0.2)
    assert [event.kind for event in cut.events] == ["stop"]


@pytest.mark.parametrize("seconds", [-1.0, 0.51, float("nan"), float("inf")])
def test_a_cut_that_leaves_nothing_is_refused(recording: RawRecording, seconds: float) -> None:
    with pytest.raises(ConfigError, match="from: got"):
        trim_before(recording, seconds)
