import os
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from rotorrig.acquisition.files import fsync
from rotorrig.acquisition.files.fsync import Syncer
from rotorrig.acquisition.files.recording_mcap import RecordingWriter, read_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig.errors import DataError
from tests.acquisition.files.file_parts import same_blocks


class SlowMedium:
    """Stands in for os.fsync: takes until told to go on, then may fail."""

    def __init__(self) -> None:
        self.begun, self.go_on = threading.Event(), threading.Event()
        self.threads: set[str] = set()
        self.error: OSError | None = None

    def __call__(self, fd: int) -> None:
        os.fstat(fd)  # raises if the descriptor is not open any more
        name = threading.current_thread().name
        if not self.go_on.is_set():
            self.threads.add(name)
        self.begun.set()
        self.go_on.wait(10)
        if self.error and name == "file sync":
            raise self.error


@pytest.fixture
def medium(monkeypatch: pytest.MonkeyPatch) -> Iterator[SlowMedium]:
    slow = SlowMedium()
    monkeypatch.setattr(fsync.Syncer.__init__, "__kwdefaults__", {"every": 0.01})
    yield slow
    slow.go_on.set()


def test_a_medium_that_takes_its_time_holds_up_no_block(
    recording: RawRecording, medium: SlowMedium, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "run.mcap"
    writer = RecordingWriter(path, recording.rig, recording.daq, recording.source)
    monkeypatch.setattr(os, "fsync", medium)
    assert medium.begun.wait(10)
    for block in recording.blocks:  # while the first sync is still under way
        writer.write_block(block)
    writer.flush()
    assert path.with_name("run.mcap.part").stat().st_size > 50_000
    medium.go_on.set()
    writer.close()
    assert same_blocks(read_recording(path).blocks, recording.blocks)
    assert medium.threads == {"file sync"}


def test_a_medium_that_takes_back_what_it_had_accepted_ends_the_recording(
    recording: RawRecording, medium: SlowMedium, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    medium.error = OSError(28, "No space left on device")
    path = tmp_path / "run.mcap"
    writer = RecordingWriter(path, recording.rig, recording.daq, recording.source)
    monkeypatch.setattr(os, "fsync", medium)
    for block in recording.blocks[:20]:
        writer.write_block(block)
    medium.go_on.set()
    with pytest.raises(DataError, match=r"No space left on device.*it ends early and keeps"):
        while True:
            writer.write_block(recording.blocks[20])
    assert len(read_recording(path).blocks) >= 12


def test_the_last_sync_is_over_when_closed(tmp_path: Path) -> None:
    with (tmp_path / "x").open("wb") as file:
        syncer = Syncer(file.fileno(), every=0.001)
        syncer.close()
        syncer.close()
    assert syncer.fault is None
