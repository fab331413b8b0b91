"""Questions to a catalogue: the newest rows of every recording, in SQL that reaches no other file."""

import json
import math
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import duckdb
import pandas as pd
import pyarrow.parquet as pq
import pytest

from rotorrig.app.lab.catalogue import open_catalogue, query
from rotorrig.app.lab.schema import TABLES
from rotorrig.app.lab.storage import Lab, write_parts
from rotorrig.rig import DataError
from tests.app.lab.conftest import Rotor


def made(folder: Path, run_id: str, key: str, *, hour: int, estimates: Mapping[str, float], **run: Any) -> None:
    """Write a computation of a recording into the catalogue, with these columns of its row in `runs`."""
    lab = Lab.of(folder)
    lab.make_folders()
    keys = {"run_id": run_id, "key": key, "code_version": "0.1.0", "made_at": datetime(2026, 11, 26, hour, tzinfo=UTC)}
    texts = dict.fromkeys(("rig", "nameplate_hash", "config_hash", "sentence", "verdict"), "")
    row = {**texts, "file": f"{run_id}.mcap", "kind": "run", "status": "done", "step": "identify", **run}
    fitted = [
        {"fit": "whole sweep", "name": name, "value": value, "sigma": math.inf, "unit": "N/m", "determined": True}
        for name, value in estimates.items()
    ]
    rows: dict[str, list[dict[str, Any]]] = {name: [] for name in TABLES}
    rows |= {"runs": [keys | row], "estimates": [keys | estimate for estimate in fitted]}
    write_parts(lab, run_id, key, rows)


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    """A lab of two recordings: "a" identified twice, then only tracked; "b" failed."""
    made(tmp_path, "a", "1", hour=8, estimates={"kxx": 33e3, "kyy": 34e3})
    made(tmp_path, "a", "2", hour=9, estimates={"kxx": 35e3})
    made(tmp_path, "a", "3", hour=10, estimates={}, step="track")
    made(tmp_path, "b", "4", hour=7, estimates={}, status="failed", sentence="b.mcap: is damaged", step="")
    return tmp_path


def test_a_table_shows_the_newest_rows_of_a_recording_and_the_other_all(lab: Path) -> None:
    assert query(lab, "select run_id, key from runs order by 1").to_numpy().tolist() == [["a", "3"], ["b", "4"]]
    assert query(lab, "select key, name, value from estimates").to_numpy().tolist() == [["2", "kxx", 35e3]]
    assert query(lab, "select count(*) n from runs_all")["n"].tolist() == [4]
    assert query(lab, "select count(*) n from estimates_all")["n"].tolist() == [3]


def test_times_are_in_utc_wherever_one_is(lab: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TZ", "America/New_York")
    frame = query(lab, "select made_at, hour(made_at) as h from runs where run_id = 'b'")
    assert (frame["made_at"][0], frame["h"][0]) == (pd.Timestamp("2026-11-26T07:00:00Z"), 7)


def test_every_table_is_there_with_its_columns_even_if_it_is_empty(lab: Path) -> None:
    with open_catalogue(lab) as connection:
        for name, schema in TABLES.items():
            assert connection.sql(f"select * from {name}").columns == schema.names


@pytest.mark.parametrize(
    "sql",
    [
        "select * from read_text('{file}')",
        "select * from '{file}'",
        "select * from read_parquet('{file}')",
        "select * from glob('/etc/*')",
    ],
)
def test_a_query_reads_no_other_file(lab: Path, tmp_path: Path, sql: str) -> None:
    file = next(tmp_path.glob("lab/catalogue/runs/*.parquet"))
    with pytest.raises(DataError):
        query(lab, sql.format(file=file))


@pytest.mark.parametrize(
    "sql",
    [
        "copy runs to '{file}'",
        "attach '{file}'",
        "export database '{file}'",
        "drop table runs_all",
        "set enable_external_access = true",
        "create table x as select 1; select 1",
        "",
    ],
)
def test_a_query_is_one_select_and_writes_nothing(lab: Path, tmp_path: Path, sql: str) -> None:
    with pytest.raises(DataError, match="want one SELECT"):
        query(lab, sql.format(file=tmp_path / "x"))
    assert not (tmp_path / "x").exists()


@pytest.mark.parametrize(
    "sql", ["copy (select 1) to '{file}'", "attach '{file}'", "set enable_external_access = true", "install httpfs"]
)
def test_the_connection_itself_reaches_no_file_either(lab: Path, tmp_path: Path, sql: str) -> None:
    with open_catalogue(lab) as connection, pytest.raises(duckdb.Error):
        connection.execute(sql.format(file=tmp_path / "x"))
    assert not (tmp_path / "x").exists()


def test_a_wrong_query_ends_in_one_sentence(lab: Path, rotor: Rotor) -> None:
    code, out, err = rotor("lab", "query", lab, "select fil from runs")
    assert (code, out) == (1, "")
    assert err.startswith('error: query: Binder Error: Referenced column "fil" not found')


def test_a_folder_without_catalogue_and_a_damaged_part_file_are_named(tmp_path: Path, rotor: Rotor, lab: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    assert (
        "empty: has no catalogue, want a folder that `rotor lab run` has"
        in rotor("lab", "query", empty, "from runs")[2]
    )
    (lab / "lab/catalogue/runs/b-4.parquet").write_bytes(b"PAR1 no longer")
    code, _, err = rotor("lab", "query", lab, "from runs")
    assert (code, "b-4.parquet: is no part-file of a catalogue, or damaged" in err) == (1, True)


def test_rows_are_printed_as_a_table_and_as_json(lab: Path, rotor: Rotor) -> None:
    sql = "select r.file, e.value, e.sigma, e.low95, r.made_at from runs r join estimates e using (run_id)"
    code, out, _ = rotor("lab", "query", lab, sql, "--json")
    assert (code, json.loads(out)) == (
        0,
        {"file": "a.mcap", "value": 35e3, "sigma": None, "low95": None, "made_at": "2026-11-26T10:00:00+00:00"},
    )
    out = rotor("lab", "query", lab, "select file, value, low95 from estimates join runs using (run_id)")[1]
    assert [line.split() for line in out.splitlines() if "a.mcap" in line] == [["a.mcap", "35000", "–"]]
    assert "1 row" in out


def test_columns_of_one_name_are_told_apart(lab: Path, rotor: Rotor) -> None:
    out = rotor("lab", "query", lab, "select a.file, b.file from runs a, runs b where a.file < b.file", "--json")[1]
    assert json.loads(out) == {"file": "a.mcap", "file_2": "b.mcap"}


def test_rows_are_written_to_files_that_are_replaced_with_force_alone(lab: Path, rotor: Rotor, tmp_path: Path) -> None:
    csv, parquet = tmp_path / "rows.csv", tmp_path / "rows.parquet"
    words = ("lab", "query", lab, "select name, value from estimates", "--csv", csv, "--parquet", parquet)
    assert rotor(*words)[0] == 0
    assert pd.read_csv(csv, comment="#").to_numpy().tolist() == [["kxx", 35000]]
    assert pq.read_table(parquet).to_pylist() == [{"name": "kxx", "value": 35e3}]
    before = parquet.read_bytes()
    assert "rows.csv: is there already, want another name, or --force" in rotor(*words)[2]
    assert rotor(*words, "--force")[0] == 0
    parquet.write_bytes(pq_of_another_program(tmp_path))
    assert "rows.parquet: is a file of another kind already" in rotor(*words, "--force")[2]
    assert before != parquet.read_bytes()


def pq_of_another_program(folder: Path) -> bytes:
    pd.DataFrame({"x": [1.0]}).to_parquet(folder / "other")
    return (folder / "other").read_bytes()
