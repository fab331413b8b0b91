"""Which files of a tree are recordings, whatever they are called."""

from pathlib import Path

from rotorrig.acquisition.files.recording_mcap import read_recording
from rotorrig.app.lab.recordings import find_recordings
from rotorrig.app.lab.storage import Lab
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.pipeline import track
from rotorrig.rig import file_hash
from rotorrig.rig.config.description import RigConfig
from tests.app.lab.conftest import write_responses


def found(folder: Path) -> list[tuple[str, str]]:
    return [(r.file, r.kind) for r in find_recordings(Lab.of(folder))]


def test_recordings_are_told_by_their_content_and_known_by_their_bytes(recordings: Path, rig_config: RigConfig) -> None:
    run = recordings / "monday/run.mcap"
    run.rename(recordings / "monday/no suffix")
    write_responses(recordings / "a table", rig_config, 1)
    (recordings / "notes.txt").write_text("shaft changed")
    assert found(recordings) == [("a table/0.mcap", "response"), ("monday/no suffix", "run")]
    assert find_recordings(Lab.of(recordings))[1].run_id == file_hash(recordings / "monday/no suffix")


def test_of_equal_files_the_first_by_name_is_taken(recordings: Path) -> None:
    (recordings / "copy.mcap").write_bytes((recordings / "monday/run.mcap").read_bytes())
    assert found(recordings) == [("copy.mcap", "run")]


def test_a_response_made_from_a_run_of_the_tree_is_left_to_the_lab(recordings: Path) -> None:
    run = recordings / "monday/run.mcap"
    write_response(recordings / "response.mcap", track(read_recording(run)))
    assert found(recordings) == [("monday/run.mcap", "run")]
    run.unlink()
    assert found(recordings) == [("response.mcap", "response")]


def test_hidden_and_unfinished_files_and_the_labs_own_are_not_looked_at(recordings: Path) -> None:
    run = (recordings / "monday/run.mcap").read_bytes()
    for name in ("monday/.hidden.mcap", ".folder/run.mcap", "lab/run.mcap", "monday/next.mcap.part"):
        (recordings / name).parent.mkdir(exist_ok=True)
        (recordings / name).write_bytes(run + name.encode())
    assert found(recordings) == [("monday/run.mcap", "run")]


def test_a_file_that_should_be_a_recording_and_is_none_is_not_missed(recordings: Path) -> None:
    (recordings / "broken.mcap").write_bytes(b"\x00" * 1000)
    assert ("broken.mcap", "run") in found(recordings)
