"""Table 7 by the chapter's algorithm: what is run, in which order, and what is kept of it."""

from pathlib import Path

import pytest

from benchmarks.chea_table7 import arguments, collect, jobs, plain, read, restore

RUN = {"calls": 9, "error": 0.5, "exact_after": float("inf")}
STAGES = dict.fromkeys(("founders", "mature", "heads", "from_basin", "arrived", "elsewhere", "error"), 0.5)
COUNTS = {"runs": 4, "truths": 2, "stages": 1}


def test_a_run_that_is_stopped_has_some_of_all() -> None:
    order = list(jobs(COUNTS))
    assert len(order) == 3 * (4 + 2 + 1)
    assert {kind for kind, _, _ in order[:9]} == {"runs", "truths", "stages"}
    assert {name for _, name, _ in order[:3]} == {"f1", "f2", "f3"}


def test_what_is_kept_comes_back(tmp_path: Path) -> None:
    rows = {job: {**STAGES, "held": float("nan")} if job[0] == "stages" else RUN for job in jobs(COUNTS)}
    measured = collect(list(jobs(COUNTS)), rows)
    kept = plain(measured["f2"])
    assert kept["stages"][0]["held"] is None
    assert kept["runs"] == [{"calls": 9, "error": 0.5, "exact_after": None}] * 4
    assert restore(kept)["runs"] == measured["f2"]["runs"]
    assert plain(restore(kept)) == kept


def test_runs_that_ended_are_read_again(tmp_path: Path) -> None:
    cache = tmp_path / "runs.jsonl"
    assert read(cache) == {}
    cache.write_text('["runs", "f1", 3, {"calls": 9, "error": 0.5, "exact_after": Infinity}]\n', encoding="utf-8")
    assert read(cache) == {("runs", "f1", 3): RUN}


def test_a_count_of_none_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        arguments(["--staged", "0"])
    assert "--staged is 0, want at least 1" in capsys.readouterr().err
