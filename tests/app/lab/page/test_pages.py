"""The folder of pages: what is written, what stays, what is never touched, and that nothing typed becomes markup."""

import dataclasses
import json
import os
import re
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

from rotorrig.app.lab.page import write_lab_page
from rotorrig.processing.files import write_response
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig import DataError
from tests.app.lab.page.catalogue_maker import RIGS, estimate, make_lab, write_run

DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)
NASTY = (
    '</script><img src=x onerror="alert(1)">/run.mcap',
    "a \"quoted\" & 'named' <b>file</b>.mcap",
    "javascript:alert(1)",
    "${style} $body %(x)s {0} \u2028 ü 転.mcap",
    "<!-- <script> #%3C?.mcap",
)


def data_of(folder: Path) -> dict[str, Any]:
    """What the page is drawn from."""
    (found,) = DATA.findall((folder / "index.html").read_text())
    table: dict[str, Any] = json.loads(found)
    return table


def contents(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def with_response(tmp_path: Path, response: OrderTrackedResponse) -> Path:
    """A lab of one run with a response."""
    add_response(tmp_path, "a/run.mcap", response)
    return tmp_path


def add_response(lab: Path, name: str, response: OrderTrackedResponse, *, key: str = "first") -> str:
    path = lab / "lab" / "results" / key / "response.mcap"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_response(path, response)
    written = path.relative_to(lab).as_posix()
    return write_run(lab, name, key=key, runs={"status": "done", "response_file": written})


def test_pages_of_many_runs_are_few_small_files(tmp_path: Path) -> None:
    make_lab(tmp_path, runs=200)
    written = write_lab_page(tmp_path, tmp_path / "page")
    assert (written.runs, written.curves, written.unread) == (200, 0, ())
    assert contents(tmp_path / "page") == {
        "index.html",
        "unit-choice.js",
        "lab.js",
        "lab-plots.js",
        "plotly.min.js",
    }
    assert (tmp_path / "page/index.html").stat().st_size < 200 * 1500 + 30_000  # bytes
    table = data_of(tmp_path / "page")
    assert len(table["runs"]) == 200
    kxx = next(trend for trend in table["trends"] if trend["name"] == "kxx")
    first_rig = [value for index, value, *_ in kxx["points"] if table["runs"][index]["rig"] == RIGS[0]]
    assert first_rig[0] - first_rig[-1] == pytest.approx(4.0, abs=1.5)  # kN/m lost in two years


@pytest.mark.parametrize("name", NASTY)
def test_nothing_that_was_typed_becomes_markup(tmp_path: Path, name: str) -> None:
    lab = tmp_path / name.replace("/", "_")
    words = f"sentence {name}"
    runs = {"rig": name, "sentence": words, "verdict": name}
    write_run(
        lab, name, runs=runs, estimates=[estimate(name, 1.0, 0.1, name, 2.0)], causes=[{"rank": 1, "label": name}]
    )
    write_lab_page(lab, tmp_path / "page")
    text = (tmp_path / "page/index.html").read_text()
    assert text.count("<script") == 4
    assert text.count("<img") == text.count("<b>") == 0
    run = data_of(tmp_path / "page")["runs"][0]
    assert (run["file"], run["rig"], run["sentence"]) == (name, name, words)


def test_a_report_is_linked_by_an_address_that_leads_to_it_and_nowhere_else(tmp_path: Path) -> None:
    lab = tmp_path / "lab [1]"
    for i, name in enumerate((*NASTY[1:], "gone")):
        report = Path("lab", "results", name, "report.html")
        if name != "gone":
            (lab / report).parent.mkdir(parents=True)
            (lab / report).write_text("a report")
        write_run(lab, f"{i}", runs={"report_file": report.as_posix()})
    write_lab_page(lab, tmp_path / "page")
    links = [run.get("report") for run in data_of(tmp_path / "page")["runs"]]
    assert links.count(None) == 1
    for link in filter(None, links):
        assert re.fullmatch(r"[\w./~%-]+", link)  # neither a scheme, nor a question, nor a fragment
        assert (tmp_path / "page" / unquote(link)).read_text() == "a report"


def test_curves_are_made_once_and_again_when_the_run_was_worked_on_again(
    with_response: Path, response: OrderTrackedResponse
) -> None:
    page = with_response / "page"
    assert write_lab_page(with_response, page).curves == 1
    (first,) = (page / "bode").iterdir()
    os.utime(first, (0, 0))
    write_lab_page(with_response, page)
    assert first.stat().st_mtime == 0
    assert data_of(page)["runs"][0]["bode"] == f"bode/{first.name}"
    (page / "bode" / "notes.txt").write_text("mine")
    add_response(with_response, "a/run.mcap", response, key="second")
    write_lab_page(with_response, page)
    assert not first.exists()
    assert len(list((page / "bode").iterdir())) == 2  # the new one, and what is not ours


def test_a_response_that_cannot_be_read_costs_its_bode_plot_alone(
    with_response: Path, response: OrderTrackedResponse
) -> None:
    write_run(with_response, "gone", runs={"response_file": "nowhere/response.mcap"})
    (with_response / "bad.mcap").write_bytes(b"no response")
    write_run(with_response, "bad", runs={"response_file": "bad.mcap"})
    without = dataclasses.replace(response, orders=(0.0, 3.0, 2.0))
    add_response(with_response, "without 1X", without, key="third")
    written = write_lab_page(with_response, with_response / "page")
    assert (written.runs, written.curves) == (4, 1)
    assert len(written.unread) == 2
    assert any("bad.mcap" in sentence for sentence in written.unread)
    assert any(sentence.endswith("has no 1X, want it for a Bode plot") for sentence in written.unread)


def test_progress_is_the_share_of_the_files_written(tmp_path: Path, response: OrderTrackedResponse) -> None:
    write_response(tmp_path / "response.mcap", response)
    make_lab(tmp_path, runs=6, response=tmp_path / "response.mcap", responses=6)
    told: list[float] = []
    written = write_lab_page(tmp_path, tmp_path / "page", progress=told.append)
    assert written.curves == len(list((tmp_path / "page/bode").iterdir())) == len(told) > 3
    assert told == sorted(told) and told[-1] == 1.0


def test_limits_are_those_of_the_config_of_a_rigs_newest_response(
    with_response: Path, response: OrderTrackedResponse
) -> None:
    assert response.rig.limits is not None
    peak = {"run": "up", "probe": "1x", "critical_speed_rpm": 2230.0, "peak_um": 187.5}
    write_run(with_response, "b", peaks=[peak])
    write_lab_page(with_response, with_response / "page")
    trend = next(trend for trend in data_of(with_response / "page")["trends"] if trend["name"] == "peak 1x up")
    assert trend["lines"] == {RIGS[0]: [[response.rig.limits.vibration * 1e6, "limit of vibration, all orders"]]}


def test_pages_of_earlier_are_replaced_and_other_files_are_not(tmp_path: Path) -> None:
    write_run(tmp_path, "a")
    page = tmp_path / "page"
    write_lab_page(tmp_path, page)
    write_lab_page(tmp_path, page)
    other = tmp_path / "other"
    other.mkdir()
    write_lab_page(tmp_path, other)  # empty
    thesis = tmp_path / "thesis"
    thesis.mkdir()
    (thesis / "chapter.tex").write_text("a year's work")
    with pytest.raises(DataError, match="thesis: has other files, want another folder, or --force"):
        write_lab_page(tmp_path, thesis)
    assert contents(thesis) == {"chapter.tex"}
    write_lab_page(tmp_path, thesis, force=True)
    assert (thesis / "chapter.tex").read_text() == "a year's work"
    assert "index.html" in contents(thesis)


def test_an_index_of_something_else_is_never_replaced(tmp_path: Path) -> None:
    write_run(tmp_path, "a")
    (tmp_path / "site").mkdir()
    (tmp_path / "site/index.html").write_text("<title>home</title>")
    with pytest.raises(DataError, match=r"site/index.html: is no page of a lab, want another folder"):
        write_lab_page(tmp_path, tmp_path / "site", force=True)
    assert (tmp_path / "site/index.html").read_text() == "<title>home</title>"
    (tmp_path / "file").write_text("")
    with pytest.raises(DataError, match="file: is a file, want a folder"):
        write_lab_page(tmp_path, tmp_path / "file")
    with pytest.raises(DataError, match="file/page: cannot be written"):
        write_lab_page(tmp_path, tmp_path / "file" / "page")


def test_a_lab_without_a_catalogue_leaves_no_folder_behind(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="is no folder"):
        write_lab_page(tmp_path / "lab", tmp_path / "page")
    assert not (tmp_path / "page").exists()


def test_hashes_that_are_none_never_name_a_file(with_response: Path) -> None:
    import pyarrow.parquet as parquet

    (path,) = (with_response / "lab/catalogue/runs").iterdir()
    table = parquet.read_table(path)
    parquet.write_table(table.set_column(0, "run_id", [["../../escape"]]), path)
    with pytest.raises(DataError, match=r"catalogue has run_id '../../escape', want 16 hexadecimal digits"):
        write_lab_page(with_response, with_response / "page")
