"""A recording whose folder vanishes goes on elsewhere, with all that was recorded; leftovers and names taken."""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

from rotorrig.acquisition.files import fallback_folder, part_file
from rotorrig.acquisition.files.recording_mcap import RecordingWriter, read_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig import DataError
from tests.acquisition.files.file_parts import same_blocks


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path / "state" / "rotorrig"


@pytest.fixture
def out(tmp_path: Path) -> Path:
    (tmp_path / "out").mkdir()
    return tmp_path / "out" / "run.mcap"


def write_through(
    recording: RawRecording, out: Path, slip: Callable[[], object], *, at: int
) -> tuple[Path, list[Path]]:
    """Write a recording while `slip` happens before block `at`; return where it went, and what was told."""
    told: list[Path] = []
    with RecordingWriter(out, recording.rig, recording.daq, recording.source, on_move=told.append) as writer:
        for number, block in enumerate(recording.blocks):
            if number == at:
                slip()
            writer.write_block(block)
        if at == len(recording.blocks):
            slip()
    return writer.path, told


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("slip", ["deleted", "renamed"])
def test_a_recording_whose_folder_vanishes_goes_on_elsewhere(
    recording: RawRecording, out: Path, state: Path, share: float, slip: str
) -> None:
    def vanish() -> None:
        if slip == "deleted":
            shutil.rmtree(out.parent)
        else:
            out.parent.rename(out.parent.with_name("archive"))

    path, told = write_through(recording, out, vanish, at=round(share * len(recording.blocks)))
    assert told == [path]
    assert path.name == "run.mcap"
    assert path.parent.parent == state
    saved = read_recording(path)
    assert saved.complete
    assert same_blocks(saved.blocks, recording.blocks)
    assert f"vanished; it goes on as {path}" in [event.text.partition("folder ")[2] for event in saved.events][-1]
    assert not out.parent.exists()


def test_a_recording_whose_name_is_taken_away_keeps_its_folder(recording: RawRecording, out: Path, state: Path) -> None:
    path, told = write_through(recording, out, lambda: out.with_name("run.mcap.part").unlink(), at=12)
    assert (path, told) == (out, [out])
    assert same_blocks(read_recording(out).blocks, recording.blocks)
    assert not state.exists()


def test_without_a_home_it_goes_where_temporary_files_are(
    recording: RawRecording, out: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "no-folder").touch()
    (tmp_path / "temporary").mkdir()
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "no-folder"))
    monkeypatch.setattr(tempfile, "gettempdir", lambda: str(tmp_path / "temporary"))
    path, _ = write_through(recording, out, lambda: shutil.rmtree(out.parent), at=12)
    assert path.parent.parent == tmp_path / "temporary"
    assert same_blocks(read_recording(path).blocks, recording.blocks)


def test_a_disk_that_is_full_is_passed_over(
    recording: RawRecording, out: Path, state: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copy, tried = part_file._copy, []

    def full(source: int, target: int) -> None:
        tried.append(target)
        if len(tried) == 1:
            raise OSError(28, "No space left on device")
        copy(source, target)

    monkeypatch.setattr(part_file, "_copy", full)
    path, _ = write_through(recording, out, lambda: shutil.rmtree(out.parent), at=12)
    assert state not in path.parents
    assert same_blocks(read_recording(path).blocks, recording.blocks)
    shutil.rmtree(path.parent)


def test_a_folder_that_comes_back_takes_the_recording_that_had_nowhere_to_go(
    recording: RawRecording, out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fallback_folder.tempfile, "mkdtemp", refuse)
    with RecordingWriter(out, recording.rig, recording.daq, recording.source) as writer:
        for number, block in enumerate(recording.blocks):
            if number == 8:
                shutil.rmtree(out.parent)
            if number == 20:
                out.parent.mkdir()
            writer.write_block(block)
    assert same_blocks(read_recording(out).blocks, recording.blocks)


def test_nowhere_to_go_is_said_in_a_sentence(
    recording: RawRecording, out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fallback_folder.tempfile, "mkdtemp", refuse)
    with pytest.raises(DataError, match=r"run\.mcap: cannot be given its name"):
        write_through(recording, out, lambda: shutil.rmtree(out.parent), at=12)


def refuse(*_: object, **__: object) -> str:
    raise OSError(28, "No space left on device")


def test_a_file_that_took_the_name_meanwhile_is_kept(recording: RawRecording, out: Path) -> None:
    with pytest.raises(DataError, match=r"cannot be given its name \(File exists\); look for run\.mcap\.part"):
        write_through(recording, out, lambda: out.write_text("another"), at=12)
    assert out.read_text() == "another"
    assert same_blocks(read_recording(out.with_name("run.mcap.part")).blocks, recording.blocks)


def test_an_empty_part_does_not_block_the_next_run(recording: RawRecording, out: Path) -> None:
    out.with_name("run.mcap.part").touch()
    assert write_through(recording, out, lambda: None, at=0) == (out, [])
    assert same_blocks(read_recording(out).blocks, recording.blocks)


def test_a_part_that_another_program_writes_is_left_alone(recording: RawRecording, out: Path) -> None:
    held = part_file.PartFile(out, overwrite=False, salvageable=True)
    for overwrite in (False, True):
        with pytest.raises(DataError, match=r"run\.mcap\.part: is being written by another program"):
            RecordingWriter(out, recording.rig, recording.daq, recording.source, overwrite=overwrite)
    held.discard()
    assert list(out.parent.iterdir()) == []
