"""`rotor lab run`: each recording once, whatever happens on the way."""

import json
import os
import shutil
import signal
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from distributed import Client

from rotorrig.app.lab import cluster
from rotorrig.app.lab import run as run_module
from rotorrig.app.lab.catalogue import query_table
from rotorrig.app.lab.page import write_lab_page
from rotorrig.app.lab.settings import LabSettings
from rotorrig.app.lab.steps import Job, find_jobs
from rotorrig.app.lab.storage import Lab
from rotorrig.app.lab.task import work_through
from rotorrig.processing.files.response_mcap import read_response
from rotorrig.rig import ConfigError, code_version
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.extended_config import extend
from rotorrig.rig.config.extension import Extension
from tests.app.lab.conftest import KXX, Rotor, write_responses, write_run_up

TIMES = {"made_at", "seconds_track", "seconds_identify", "seconds_diagnose", "recorded_at"}


def rows(folder: Path, table: str) -> list[dict[str, Any]]:
    return query_table(folder, f"select * from {table} order by all").to_pylist()


def part_files(folder: Path) -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in folder.glob("lab/**/*") if path.is_file()}


def jobs_of(folder: Path, settings: LabSettings, *, version: str = "") -> list[Job]:
    return [replace(job, code_version=version or job.code_version) for job in find_jobs(folder, settings)]


def test_a_recording_is_tracked_and_its_row_says_what_it_is(recordings: Path, rotor: Rotor, processes: str) -> None:
    code, out, _ = rotor("lab", "run", recordings, "--steps", "track", "--scheduler", processes)
    assert (code, out.startswith("1 recording: 1 done in ")) == (0, True)
    (row,) = rows(recordings, "runs")
    expected = {"file": "monday/run.mcap", "kind": "run", "status": "done", "step": "track", "duration_s": 30.0}
    assert expected.items() <= row.items()
    assert row["lowest_speed_rpm"] == pytest.approx(300, abs=50)
    assert row["highest_speed_rpm"] == pytest.approx(1500, abs=50)
    assert row["noise_um"] < 0.01  # the run-up has 0.01 um in a sample
    response = read_response(recordings / row["response_file"])
    np.testing.assert_allclose(np.abs(response.order(1.0)[response.usable]), 20e-6, atol=2e-8)
    assert (len(response.omega), len(response.probes)) == (row["rows"], row["probes"])


def test_what_is_done_is_not_done_again(recordings: Path, rotor: Rotor, processes: str) -> None:
    rotor("lab", "run", recordings, "--steps", "track", "--scheduler", processes)
    before = part_files(recordings)
    code, out, _ = rotor(
        "lab", "run", recordings, "--steps", "track", "--json"
    )  # without the processes: there is no work
    facts = json.loads(out)
    assert (code, facts["done"], facts["before"], facts["left"]) == (0, 0, 1, 0)
    assert part_files(recordings) == before


def test_another_config_or_version_makes_rows_beside_the_old_ones(
    recordings: Path, rig_config: RigConfig, rotor: Rotor, processes: str, tmp_path: Path
) -> None:
    bowed = tmp_path / "bowed.toml"
    bow = Extension(name="bow", parameters={"bow re": 10e-6, "bow im": 0.0})
    bowed.write_text(extend(rig_config, (bow,)).text, encoding="utf-8")
    rotor("lab", "run", recordings, "--steps", "track", "--scheduler", processes)
    code, _, err = rotor("lab", "run", recordings, "--steps", "track", "--scheduler", processes, "--config", bowed)
    assert (code, err) == (0, "")
    (old_job,) = jobs_of(recordings, LabSettings(steps=("track",)), version="0.0.1")
    run_module.write_outcome(old_job, run_module.Outcome())
    everything = rows(recordings, "runs_all")
    assert len(everything) == len({row["key"] for row in everything}) == 3
    assert {row["code_version"] for row in everything} == {code_version(), "0.0.1"}
    assert len({row["config_hash"] for row in everything} - {""}) == 2
    assert [row["code_version"] for row in rows(recordings, "runs")] == ["0.0.1"]  # the newest


def test_a_further_step_takes_over_what_was_done(recordings: Path, rotor: Rotor, processes: str) -> None:
    rotor("lab", "run", recordings, "--steps", "track", "--scheduler", processes)
    (before,) = rows(recordings, "runs")
    code, _, _ = rotor("lab", "run", recordings, "--steps", "track,report", "--scheduler", processes)
    assert code == 0
    (after,) = rows(recordings, "runs")
    assert (after["step"], after["response_file"]) == ("report", before["response_file"])
    assert (before["seconds_track"] > 0, after["seconds_track"]) == (True, None)
    assert (recordings / after["report_file"]).read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_a_damaged_file_is_a_row_that_failed_and_the_others_go_on(
    recordings: Path, rotor: Rotor, processes: str
) -> None:
    whole = (recordings / "monday/run.mcap").read_bytes()
    (recordings / "cut.mcap").write_bytes(whole[: len(whole) // 2])
    code, out, _ = rotor("lab", "run", recordings, "--steps", "track", "--scheduler", processes)
    assert code == 1
    assert "1 done" in out
    assert "1 failed\nfirst of those that failed: cut.mcap: is unfinished at byte" in out
    done, failed = sorted(rows(recordings, "runs"), key=lambda row: row["status"])
    assert (failed["status"], failed["step"], failed["rows"], done["status"]) == ("failed", "", None, "done")
    assert failed["sentence"].startswith("cut.mcap: is unfinished at byte")
    code, out, _ = rotor("lab", "run", recordings, "--steps", "track", "--json")
    assert (code, json.loads(out)["before"], json.loads(out)["failed"][0]["file"]) == (1, 2, "cut.mcap")


def test_a_recording_that_was_moved_is_found_where_it_is(recordings: Path, rotor: Rotor, processes: str) -> None:
    rotor("lab", "run", recordings, "--steps", "track", "--scheduler", processes)
    (recordings / "monday/run.mcap").rename(recordings / "tuesday.mcap")
    before = (recordings / rows(recordings, "runs")[0]["response_file"]).stat().st_mtime_ns
    rotor("lab", "run", recordings, "--steps", "track", "--scheduler", processes)
    (row,) = rows(recordings, "runs")
    assert row["file"] == "tuesday.mcap"
    assert (recordings / row["response_file"]).stat().st_mtime_ns == before


def test_a_folder_without_recordings_is_told_in_a_sentence(rotor: Rotor, tmp_path: Path) -> None:
    assert rotor("lab", "run", tmp_path / "none")[::2] == (
        1,
        f"error: {tmp_path}/none: is no folder, want the one that the recordings are in",
    )
    code, _, err = rotor("lab", "run", tmp_path)
    assert (code, "holds no recording, want run.mcap or response.mcap files" in err) == (1, True)
    assert list(tmp_path.iterdir()) == []


def test_workers_are_either_here_or_a_schedulers(rotor: Rotor, tmp_path: Path) -> None:
    words = ("lab", "run", tmp_path, "--workers", 2, "--scheduler", "tcp://127.0.0.1:1")
    assert rotor(*words)[::2] == (1, "error: --scheduler: has workers of its own, want no --workers")


def test_a_scheduler_that_is_not_there_is_told_in_a_sentence(
    recordings: Path, rotor: Rotor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "PATIENCE", "0.5 s")
    code, _, err = rotor("lab", "run", recordings, "--scheduler", "tcp://127.0.0.1:9")
    assert (code, err.startswith("error: tcp://127.0.0.1:9: no scheduler answers, want one such as")) == (1, True)
    assert "Traceback" not in err


def test_a_worker_of_another_version_ends_the_run_and_marks_no_recording(recordings: Path, client: Client) -> None:
    (job,) = jobs_of(recordings, LabSettings(steps=("track",)), version="0.0.1")
    with pytest.raises(ConfigError, match=r"a worker runs rotorrig .*, want 0\.0\.1"):
        list(run_module.statuses(client, [job]))
    assert not list(recordings.glob("lab/catalogue/runs/*"))


def end_worker_at_bad(job: Job) -> dict[str, Any]:
    """Do a recording; one called "bad" ends the process that has it, as too little memory does."""
    if job.recording.file.startswith("bad"):
        os.kill(os.getpid(), signal.SIGKILL)
    return work_through(job)


@pytest.mark.campaign
def test_a_recording_that_ends_its_workers_is_a_row_that_failed(
    recordings: Path, rig_config: RigConfig, rotor: Rotor, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_run_up(recordings / "bad.mcap", rig_config, amplitude=30e-6)
    write_run_up(recordings / "good.mcap", rig_config, amplitude=40e-6)
    monkeypatch.setattr(run_module, "work_through", end_worker_at_bad)
    code, out, _ = rotor("lab", "run", recordings, "--steps", "track", "--workers", 2)
    assert code == 1
    assert "first of those that failed: bad.mcap: it ended 2 workers one after the other" in out
    by_file = {row["file"]: row["status"] for row in rows(recordings, "runs")}
    assert by_file == {"bad.mcap": "failed", "good.mcap": "done", "monday/run.mcap": "done"}
    monkeypatch.undo()
    code, out, _ = rotor("lab", "run", recordings, "--steps", "track", "--workers", 2, "--retry")
    assert (code, out.startswith("3 recordings: 1 done in ")) == (0, True)


@pytest.mark.campaign
def test_two_workers_come_to_the_numbers_of_one_process_to_the_last_bit(
    rig_config: RigConfig, rotor: Rotor, processes: str, tmp_path: Path
) -> None:
    alone, together = tmp_path / "alone", tmp_path / "together"
    for folder in (alone, together):
        write_responses(folder, rig_config, 3)
    for job in jobs_of(alone, LabSettings()):
        work_through(job)
    rotor("lab", "run", together, "--scheduler", processes)
    assert_same_results(alone, together)
    kxx = query_table(together, "select value, sigma from estimates where name = 'kxx'").to_pylist()
    assert len(kxx) == 3
    assert all(abs(row["value"] - KXX) < 4 * row["sigma"] for row in kxx)


def test_two_workers_track_to_the_last_bit_as_one_process(
    recordings: Path, rig_config: RigConfig, rotor: Rotor, processes: str, tmp_path: Path
) -> None:
    write_run_up(recordings / "tuesday.mcap", rig_config, amplitude=30e-6)
    write_run_up(recordings / "wednesday.mcap", rig_config, amplitude=40e-6)
    alone = tmp_path / "alone"
    shutil.copytree(recordings, alone)
    for job in jobs_of(alone, LabSettings(steps=("track",))):
        work_through(job)
    rotor("lab", "run", recordings, "--steps", "track", "--scheduler", processes)
    assert_same_results(alone, recordings)


def assert_same_results(alone: Path, together: Path) -> None:
    """Compare every table and result file of two labs, but for when they were made and how long that took."""
    for table in ("runs", "estimates", "peaks", "events"):
        one, two = (
            [{name: value for name, value in row.items() if name not in TIMES} for row in rows(folder, table)]
            for folder in (alone, together)
        )
        assert one == two, table
    results = sorted(alone.glob("lab/results/*/*/*"))
    assert results
    for path in results:
        other = together / path.relative_to(alone)
        assert without_time(path) == without_time(other), path


def without_time(path: Path) -> Any:
    """Return a file's content, of a fit without how long it took."""
    return json.loads(path.read_bytes()) | {"wall_s": 0} if path.suffix == ".json" else path.read_bytes()


def test_pages_take_the_curves_that_were_kept_and_read_no_response_for_them(
    recordings: Path, rotor: Rotor, processes: str, tmp_path: Path
) -> None:
    rotor("lab", "run", recordings, "--steps", "track", "--scheduler", processes)
    (row,) = rows(recordings, "runs")
    assert write_lab_page(recordings, tmp_path / "kept").curves == 1
    kept = Lab(recordings).curves(row["run_id"], row["key"])
    whole = kept.read_text()
    kept.unlink()
    assert write_lab_page(recordings, tmp_path / "read").curves == 1  # as with a lab of an earlier version
    (recordings / row["response_file"]).write_bytes(b"damaged")
    assert write_lab_page(recordings, tmp_path / "neither").curves == 0
    kept.write_text(whole)
    assert write_lab_page(recordings, tmp_path / "again").curves == 1
    curves = {
        (tmp_path / page / "bode" / f"{row['run_id']}-{row['key']}.js").read_text()
        for page in ("kept", "read", "again")
    }
    assert curves == {whole}
