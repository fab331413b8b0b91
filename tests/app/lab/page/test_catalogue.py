"""Of a recording that was worked on several times the newest of what went furthest counts, all from one task."""

from datetime import timedelta
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet
import pytest

from rotorrig.app.lab.page.catalogue import read_catalogue
from rotorrig.app.lab.schema import TABLES
from rotorrig.rig import DataError
from tests.app.lab.page.catalogue_maker import COMMON, FIRST_DAY, SCHEMAS, estimate, write_run

STIFF = {"sigma": 300.0, "unit": "N/m", "nameplate": 33_900.0}


def test_the_newest_task_of_a_run_counts_and_nothing_of_the_others(tmp_path: Path) -> None:
    old, new = FIRST_DAY, FIRST_DAY + timedelta(days=1)
    run_id = write_run(tmp_path, "a/run.mcap", key="z", made_at=new, estimates=[estimate("kxx", 2.0, **STIFF)])
    write_run(tmp_path, "a/run.mcap", key="a", made_at=old, runs={"verdict": "tied"}, peaks=[{"probe": "1x"}])
    write_run(tmp_path, "a/run.mcap", key="b", made_at=old, estimates=[estimate("kxx", 1.0, **STIFF)])
    catalogue = read_catalogue(tmp_path)
    assert [run["verdict"] for run in catalogue.runs] == [""]
    assert [row["value"] for row in catalogue.estimates[run_id]] == [2.0]
    assert catalogue.peaks == {}  # the newest task wrote none


@pytest.mark.parametrize(
    ("later", "verdict"),
    [
        ({"step": "track", "verdict": "", "status": "done"}, "tied"),
        ({"step": "diagnose", "verdict": "named", "status": "done"}, "named"),
        ({"step": "", "verdict": "", "status": "failed"}, ""),
    ],
)
def test_a_task_that_went_less_far_hides_no_diagnosis_but_a_failure_is_told(
    tmp_path: Path, later: dict[str, str], verdict: str
) -> None:
    old, new = FIRST_DAY, FIRST_DAY + timedelta(days=1)
    done = {"step": "diagnose", "verdict": "tied", "status": "done"}
    write_run(tmp_path, "a/run.mcap", key="a", made_at=old, runs=done)
    write_run(tmp_path, "a/run.mcap", key="z", made_at=new, runs=later)
    assert [run["verdict"] for run in read_catalogue(tmp_path).runs] == [verdict]


def test_runs_are_in_the_order_of_their_recording_and_causes_in_that_of_their_rank(tmp_path: Path) -> None:
    causes = [{"rank": 2, "label": "rub"}, {"rank": 1, "label": "bow"}]
    late = write_run(tmp_path, "late", runs={"recorded_at": FIRST_DAY + timedelta(days=2)}, causes=causes)
    write_run(tmp_path, "early", made_at=FIRST_DAY + timedelta(days=9), runs={"recorded_at": FIRST_DAY})
    write_run(tmp_path, "no time of its own", made_at=FIRST_DAY + timedelta(days=1), runs={"recorded_at": None})
    catalogue = read_catalogue(tmp_path)
    assert [run["file"] for run in catalogue.runs] == ["early", "no time of its own", "late"]
    assert [cause["label"] for cause in catalogue.causes[late]] == ["bow", "rub"]


def test_a_file_of_another_version_has_empty_columns_and_columns_that_nobody_asks_for(tmp_path: Path) -> None:
    write_run(tmp_path, "usual")
    row = {"run_id": "0" * 16, "key": "1" * 16, "made_at": FIRST_DAY, "file": "other", "colour": "blue"}
    table = pa.Table.from_pandas(pa.Table.from_pylist([row]).to_pandas())  # with the types that pandas gives
    pa.parquet.write_table(table, tmp_path / "lab/catalogue/runs/other.parquet")
    other = next(run for run in read_catalogue(tmp_path).runs if run["file"] == "other")
    assert other["verdict"] is None
    assert other["rig"] == "unknown rig"
    assert other["made_at"] == FIRST_DAY
    assert "colour" not in other


def test_a_folder_without_a_catalogue_says_what_makes_one(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"lab/catalogue/runs: has no part-files, want what `rotor lab run .*` writes"):
        read_catalogue(tmp_path)
    with pytest.raises(DataError, match="nowhere: is no folder"):
        read_catalogue(tmp_path / "nowhere")


@pytest.mark.parametrize("content", [b"", b"PAR1 and so on", b"notes of a day in the laboratory" * 9])
def test_a_damaged_file_is_named_in_one_sentence(tmp_path: Path, content: bytes) -> None:
    write_run(tmp_path, "usual")
    (tmp_path / "lab/catalogue/runs/broken.parquet").write_bytes(content)
    with pytest.raises(
        DataError, match=r"catalogue/runs/broken\.parquet: is no part-file of a catalogue, or damaged"
    ) as caught:
        read_catalogue(tmp_path)
    assert "\n" not in str(caught.value)


def test_a_row_without_what_identifies_it_is_refused(tmp_path: Path) -> None:
    write_run(tmp_path, "usual", runs={"file": None})
    with pytest.raises(DataError, match="runs: has a row without file"):
        read_catalogue(tmp_path)


def test_folders_may_be_called_as_they_like(tmp_path: Path) -> None:
    write_run(tmp_path / "lab [1] * ?", "usual")
    assert len(read_catalogue(tmp_path / "lab [1] * ?").runs) == 1


def test_the_maker_of_catalogues_writes_what_a_lab_does() -> None:
    for table, schema in TABLES.items():
        assert {field.name: field.type for field in schema} == {**COMMON, **SCHEMAS[table]}
