"""`rotor lab page`: where it writes, and what it says."""

import json
from pathlib import Path

import pytest

from rotorrig.app.verbs.lab_page import page
from rotorrig.rig import DataError
from tests.app.lab.page.catalogue_maker import write_run


def test_it_writes_beside_the_catalogue_unless_told_otherwise(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_run(tmp_path, "a/run.mcap")
    page(tmp_path)
    index = tmp_path / "lab/page/index.html"
    assert index.is_file()
    assert capsys.readouterr().out == f"{index}: 1 run, 0 with Bode plots; open in any browser\n"
    page(tmp_path, out_folder=tmp_path / "out", as_json=True)
    told = json.loads(capsys.readouterr().out)
    assert told == {"file": str(tmp_path / "out/index.html"), "runs": 1, "bode_plots": 0, "unread": []}


def test_responses_that_cannot_be_read_are_told_of_three_by_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for i in range(5):
        (tmp_path / f"{i}.mcap").write_bytes(b"no response")
        write_run(tmp_path, f"{i}", runs={"response_file": f"{i}.mcap"})
    page(tmp_path)
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 4
    assert said[0].startswith(f"no Bode plot: {tmp_path / '0.mcap'}: ")
    assert said[3] == "no Bode plot of 2 more"


def test_without_a_catalogue_there_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="has no part-files, want what `rotor lab run"):
        page(tmp_path)
