"""The pages of a lab in a browser: they open at once, are searched, sorted and followed, by keyboard and ear too."""

import importlib.util
import json
import shutil
import time
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest

from rotorrig.app.lab.page import write_lab_page
from rotorrig.processing.files import write_response
from rotorrig.processing.response import OrderTrackedResponse
from tests.app.browser import Tab, browser, needs_chromium
from tests.app.lab.page.catalogue_maker import DAYS, FIRST_DAY, RIGS, make_lab, write_run
from tests.parameters import defer_rest

pytestmark = [pytest.mark.browser, needs_chromium]

AXE = importlib.util.find_spec("axe_core_python")
RUNS = 300  # and two more
OPENS_WITHIN = 1000.0  # ms; a fifth of it was measured
NASTY = '</script><img src=x onerror="alert(1)"> <b>&amp;</b>/run.mcap'
PATIENCE = 30.0  # s


@pytest.fixture(scope="module")
def tab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    with browser(tmp_path_factory.mktemp("profile")) as tab:
        yield tab


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory, response: OrderTrackedResponse) -> Path:
    """Two years, of which the last runs have curves, and a run with a nasty name, newest of all."""
    lab = tmp_path_factory.mktemp("lab")
    write_response(lab / "response.mcap", response)
    make_lab(lab, runs=RUNS, response=lab / "response.mcap", responses=12)
    report = lab / "lab" / "results" / "report.html"
    report.write_text("<title>report</title>")
    write_run(
        lab,
        NASTY,
        made_at=FIRST_DAY + timedelta(days=DAYS + 1),
        runs={"rig": RIGS[1], "sentence": f"probe 2y is silent {NASTY}"},
    )
    finished = {"status": "done", "step": "report", "verdict": "adequate", "report_file": "lab/results/report.html"}
    write_run(lab, "reported/run.mcap", runs=finished)
    write_lab_page(lab, lab / "lab" / "page")
    return lab / "lab" / "page" / "index.html"


def opened(tab: Tab, page: Path, address: str = "", **look: Any) -> Tab:
    """Show the page anew, with what stands behind # in its address."""
    tab.look(**{"width": 1200, "height": 900, **look})
    tab.open(page, fragment=address, wait="rotorLab.shown")
    return tab


def wait_for(tab: Tab, condition: str) -> None:
    deadline = time.monotonic() + PATIENCE
    while not tab.run(f"Boolean({condition})"):
        assert time.monotonic() < deadline, condition
        time.sleep(0.05)


def address_of(tab: Tab) -> str:
    """What stands behind # once nothing more has come for a moment."""
    fragment: str = tab.run("new Promise((done) => setTimeout(() => done(location.hash.slice(1)), 400))")
    return fragment


def column(tab: Tab, selector: str) -> list[str]:
    found: list[str] = tab.run(f"[...document.querySelectorAll({json.dumps(selector)})].map((e) => e.innerText)")
    return found


def type_text(tab: Tab, text: str) -> None:
    tab.run("document.getElementById('text').focus()")
    tab.call("Input.insertText", text=text)


def choose(tab: Tab, name: str, value: str) -> None:
    """Choose from a list as a hand does."""
    tab.run(
        f"(() => {{ const list = document.getElementById({json.dumps(name)}); list.value = {json.dumps(value)};"
        "for (const kind of ['input', 'change']) list.dispatchEvent(new Event(kind, { bubbles: true })); })()"
    )


def test_the_table_is_there_within_a_second_and_nothing_else_was_loaded(tab: Tab, page: Path) -> None:
    opened(tab, page)
    assert tab.run("rotorLab.shown") < OPENS_WITHIN
    assert column(tab, "#count") == [f"{RUNS + 2} of {RUNS + 2} runs"]
    assert len(column(tab, "#rows th")) == 25
    assert {url.rpartition("/")[2].partition("#")[0] for url in tab.requests} == {
        "index.html",
        "unit-choice.js",
        "lab.js",
        "lab-plots.js",
    }
    assert tab.complaints == []


def test_nothing_is_asked_of_a_network_even_where_all_is_drawn(tab: Tab, page: Path) -> None:
    opened(tab, page, height=4000)
    wait_for(tab, "document.querySelector('#trend-plot .point')")
    assert [url for url in tab.requests if not url.startswith(("file:", "data:", "blob:"))] == []
    assert tab.complaints == []
    assert tab.run("fetch('http://127.0.0.1:9/').then(() => 'answered', () => 'refused')") == "refused"


def test_a_name_is_shown_as_it_was_typed_and_does_nothing(tab: Tab, page: Path) -> None:
    opened(tab, page)
    assert column(tab, "#rows th")[0] == NASTY
    assert column(tab, "#rows .status small")[0] == f"probe 2y is silent {NASTY}"
    assert tab.run("document.querySelectorAll('main img, main b').length") == 0


def test_a_report_is_one_step_away(tab: Tab, page: Path) -> None:
    opened(tab, page, "text=reported")
    assert column(tab, "#rows .status") == ["done: report"]
    link = tab.run("document.querySelector('#rows a').href")
    assert link == (page.parents[1] / "results" / "report.html").as_uri()
    assert tab.run("document.querySelector('#rows a').ariaLabel") == "report of reported/run.mcap"


def test_a_script_between_the_lines_would_not_run(tab: Tab, page: Path) -> None:
    opened(tab, page)
    tab.run(
        "document.body.append(Object.assign(document.createElement('script'), { textContent: 'globalThis.ran = 1' }))"
    )
    assert tab.run("globalThis.ran ?? 'refused'") == "refused"


def test_text_verdict_and_rig_filter_and_the_address_keeps_them(tab: Tab, page: Path) -> None:
    opened(tab, page)
    type_text(tab, "WINDOW bowed")
    choose(tab, "verdict", "named")
    choose(tab, "rig", RIGS[0])
    verdicts, rigs = column(tab, "#rows td:nth-of-type(4)"), column(tab, "#rows .rig-name")
    assert set(verdicts) == {"named"}
    assert set(rigs) == {RIGS[0]}
    told, address = column(tab, "#count"), address_of(tab)
    opened(tab, page, address)
    assert column(tab, "#count") == told
    assert tab.run("['text', 'verdict', 'rig'].map((id) => document.getElementById(id).value)") == [
        "WINDOW bowed",
        "named",
        RIGS[0],
    ]
    tab.run("document.getElementById('clear').click()")
    assert column(tab, "#count") == [f"{RUNS + 2} of {RUNS + 2} runs"]


def test_the_failures_sentence_is_found_and_shown(tab: Tab, page: Path) -> None:
    opened(tab, page, "text=3+edges")
    assert set(column(tab, "#rows .status small")) == {"keyphasor: 3 edges in 41 s, want one per turn"}
    assert set(column(tab, "#rows td:nth-of-type(4)")) == {"failed"}


def test_headings_sort_by_number_with_what_is_not_known_last(tab: Tab, page: Path) -> None:
    opened(tab, page)
    choose(tab, "size", "all")
    button = "document.querySelector('#head [data-column=kxx] button')"
    for order in ("ascending", "descending"):
        tab.run(f"{button}.click()")
        cells = column(tab, "#rows td:nth-of-type(6)")
        known = [float(cell.split()[0]) for cell in cells if cell != "–"]
        assert cells[len(known) :] == ["–"] * (len(cells) - len(known))
        assert known == sorted(known, reverse=order == "descending")
        assert tab.run("document.querySelector('#head [data-column=kxx]').ariaSort") == order
        assert tab.run(f"document.activeElement === {button}")


def test_values_are_rounded_to_their_uncertainty(tab: Tab, page: Path) -> None:
    opened(tab, page)
    for value, words in (
        ([34.2337, 0.5892], "34.23 ± 0.59"),
        ([2.80139, 0.029], "2.801 ± 0.029"),
        ([3012.0, 250.0], "3010 ± 250"),
        ([31.0, None], "31"),
    ):
        assert tab.run(f"plusMinus({json.dumps(value)})") == words
    assert tab.run("[digits(12, 3), digits(0.17, 3), digits(2250.6, 4), digits(undefined, 3), withUnit('4', '°')]") == [
        "12.0",
        "0.170",
        "2251",
        "–",
        "4°",
    ]


def test_pages_of_the_table_lead_through_all_runs(tab: Tab, page: Path) -> None:
    opened(tab, page)
    assert tab.run("document.getElementById('previous').disabled")
    seen = set()
    while True:
        seen |= set(column(tab, "#rows th"))
        if tab.run("document.getElementById('next').disabled"):
            break
        tab.run("document.getElementById('next').click()")
    assert len(seen) == RUNS + 2
    assert column(tab, "#pages") == ["page 13 of 13"]


def test_a_files_button_shows_all_of_its_run(tab: Tab, page: Path) -> None:
    opened(tab, page, "verdict=adequate")
    button = "document.querySelector('#rows th button')"
    tab.run(f"{button}.focus()")
    tab.press("Enter")
    assert tab.run(f"{button}.ariaExpanded") == "true"
    assert tab.run(f"document.activeElement === {button}")
    (said,) = column(tab, "#rows .all")
    for words in ("The model is adequate.", "kyy, stiffness, vertical", "kN/m (", "largest 1X, 2y down", "Q 1"):
        assert words in said
    tab.run(f"{button}.click()")
    assert column(tab, "#rows .all") == []


def test_a_trend_shows_a_rigs_values_with_bars_and_nameplate(tab: Tab, page: Path) -> None:
    opened(tab, page, height=4000)
    wait_for(tab, "document.querySelector('#trend-plot .point')")
    choose(tab, "trend-rig", RIGS[0])
    drawn = "document.getElementById('trend-plot').data"
    traces = tab.run(f"{drawn}.map(({{ name, y, error_y: bar }}) => [name, y, bar?.array, bar?.arrayminus])")
    assert traces[0][:2] == ["nameplate", [33.9, 33.9]]
    values = [value for name, y, *_ in traces if name in ("adequate", "another verdict") for value in y]
    assert f"{len(values)} runs of {RIGS[0]}; bars are 95 % intervals" in column(tab, "#trend-caption")[0]
    adequate = next(trace for trace in traces if trace[0] == "adequate")
    assert adequate[2] == pytest.approx([0.6] * len(adequate[1]), abs=1e-3)  # two sigmas of 300 N/m
    assert adequate[3] == pytest.approx(adequate[2], abs=1e-3)
    assert adequate[1][0] - adequate[1][-1] == pytest.approx(4.0, abs=1.5)


def test_the_filter_holds_for_trends_too_and_says_so_where_none_is_left(tab: Tab, page: Path) -> None:
    opened(tab, page, "verdict=failed", height=4000)
    wait_for(tab, "document.getElementById('trend-caption').textContent")
    assert column(tab, "#trend-caption")[0].startswith(f"No run of {RIGS[0]} that passes the filter has a value")
    assert tab.run("document.getElementById('walk').hidden")


def test_the_arrow_keys_walk_along_a_trend_and_enter_marks_the_run(tab: Tab, page: Path) -> None:
    opened(tab, page, height=4000)
    wait_for(tab, "document.querySelector('#trend-plot .point')")
    slider = "document.getElementById('point')"
    tab.run(f"{slider}.focus()")
    for _ in range(60):
        tab.press("ArrowLeft")
    words = tab.run(f"{slider}.ariaValueText")
    tab.press("Enter")
    marked = column(tab, "#rows tr.open th")
    assert words.endswith(marked[0])  # 60 points before the newest: on another page of the table
    assert tab.run("document.activeElement.innerText") == marked[0]
    assert column(tab, "#pages") != ["page 1 of 13"]
    assert "run=" in address_of(tab)


def test_a_click_on_a_point_marks_its_run(tab: Tab, page: Path) -> None:
    opened(tab, page, height=4000)
    wait_for(tab, "document.querySelector('#trend-plot .point')")
    box = tab.run(
        "(() => { const point = document.querySelector('#trend-plot .points .point').getBoundingClientRect();"
        "return [point.x + point.width / 2, point.y + point.height / 2] })()"
    )
    for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
        button = {} if kind == "mouseMoved" else {"button": "left", "clickCount": 1}
        tab.call("Input.dispatchMouseEvent", type=kind, x=box[0], y=box[1], **button)
        time.sleep(0.2)  # Plotly looks for the nearest point a while after the pointer came to rest
    wait_for(tab, "document.querySelector('#rows tr.open')")
    assert len(column(tab, "#rows tr.open th")) == 1


def test_up_to_six_runs_are_overlaid_each_by_a_file_of_its_own(tab: Tab, page: Path) -> None:
    opened(tab, page, "verdict=adequate", height=5000)
    boxes = "document.querySelectorAll('#rows input')"
    for i in range(6):
        tab.run(f"{boxes}[{i}].click()")
    wait_for(tab, "document.getElementById('bode-plot').data?.length === 24")  # two sweeps, amplitude and lag
    assert tab.run(f"[...{boxes}].filter((box) => box.disabled).length") > 0
    assert tab.run(
        "document.querySelectorAll('#rows tr').length > [...document.querySelectorAll('#rows input')].length"
    )
    assert len([url for url in tab.requests if "/bode/" in url]) == 6
    assert len(column(tab, "#peaks tr")) == 12
    peak = tab.run("Math.max(...document.getElementById('bode-plot').data[0].y)")
    assert peak == pytest.approx(187.5, rel=0.01)  # e / (2 zeta)
    choose(tab, "direction", "-1")
    wait_for(tab, "document.getElementById('bode-plot').data.length === 12")
    tab.run("document.querySelector('#chosen button').click()")
    wait_for(tab, "document.getElementById('bode-plot').data.length === 10")
    address = address_of(tab)
    opened(tab, page, address, height=5000)
    wait_for(tab, "document.getElementById('bode-plot').data?.length === 20")
    assert tab.complaints == []


def test_amplitudes_are_told_in_the_unit_chosen_and_nothing_else_changes(tab: Tab, page: Path, tmp_path: Path) -> None:
    in_mil = 2 / 25.4
    draw_all(tab, page)
    choose(tab, "quantity", tab.run("trends.find(({ name }) => name.startsWith('peak ')).name"))
    wait_for(tab, "document.getElementById('trend-caption').textContent.includes('µm 0-peak')")

    def told() -> list[Any]:
        trend = "document.getElementById('trend-plot').data.find(({ name, y }) => name === 'adequate' && y.length)"
        plot = "document.getElementById('bode-plot')"
        words = ["#rows td:nth-of-type(11)", "#peaks td:nth-of-type(2)"]
        amplitudes = [[float(text) for text in column(tab, which) if text != "–"] for which in words]
        drawn = [tab.run(f"[...{trend}.y]"), tab.run(f"{plot}.data[0].y.map((y) => y ?? 0)")]
        others = [
            column(tab, "#rows td:nth-of-type(6)"),
            tab.run(f"[...{plot}.data[0].x]"),
            column(tab, "#peaks td")[2],
        ]
        return [[*amplitudes, *drawn], others]

    before, others = told()
    choose(tab, "units", "mil pp")
    wait_for(tab, "document.getElementById('trend-caption').textContent.includes('mil pp')")
    wait_for(tab, "document.getElementById('bode-plot').layout.yaxis.title.text === 'mil pp'")
    after, same = told()
    assert same == others
    for one, other in zip(before, after, strict=True):
        assert len(one) > 1
        assert other == pytest.approx([value * in_mil for value in one], rel=0.02)  # of three digits
    assert column(tab, "#head [data-column=residual]")[0].startswith("residual, mil pp")
    assert "mil pp at" in column(tab, "#rows .all")[0]
    assert column(tab, "#peaks-unit") == ["mil pp"]
    tab.open(page, wait="rotorLab.shown")
    assert column(tab, "#head [data-column=residual]")[0].startswith("residual, mil pp"), "the choice is kept"
    tab.run("localStorage.clear()")
    write_lab_page(page.parents[2], tmp_path, units="µm pp")
    tab.open(tmp_path / "index.html", wait="rotorLab.shown")
    assert column(tab, "#head [data-column=residual]")[0].startswith("residual, µm pp")
    assert tab.complaints == []


def test_a_file_that_is_lost_is_named(tab: Tab, page: Path, tmp_path: Path) -> None:
    copy = tmp_path / "page"
    shutil.copytree(page.parent, copy)
    for path in (copy / "bode").iterdir():
        path.unlink()
    opened(tab, copy / "index.html", "verdict=adequate", height=4000)
    tab.run("document.querySelector('#rows input').click()")
    wait_for(tab, "document.getElementById('bode-words').textContent.includes('.js is missing beside this page')")
    (copy / "plotly.min.js").unlink()
    opened(tab, copy / "index.html", height=4000)
    wait_for(
        tab, "document.getElementById('trend-caption').textContent === 'plotly.min.js is missing beside this page'"
    )
    assert len(column(tab, "#rows th")) == 25


@pytest.mark.parametrize("width", defer_rest([390, 1200, 1600]))
def test_nothing_is_wider_than_the_window(tab: Tab, page: Path, width: int) -> None:
    draw_all(tab, page, width=width)
    wait_for(tab, f"document.documentElement.scrollWidth <= {width}")  # a plot follows its window with some delay
    wait_for(tab, "[...document.querySelectorAll('.canvas .main-svg')].every((svg) => svg.clientWidth <= innerWidth)")


def draw_all(tab: Tab, page: Path, **look: Any) -> None:
    """Show the page with a run open, trends, and Bode plots of two runs."""
    opened(tab, page, "verdict=adequate", **{"height": 5000, **look})
    tab.run("[0, 1].forEach((i) => document.querySelectorAll('#rows input')[i].click())")
    tab.run("document.querySelector('#rows th button').click()")
    wait_for(tab, "document.querySelector('#trend-plot .point') && document.getElementById('bode-plot').data")


@pytest.mark.skipif(AXE is None, reason="needs axe-core-python")
@pytest.mark.parametrize(
    "look", defer_rest([{"width": 1200}, {"width": 1200, "dark": True}, {"width": 390}]), ids=["light", "dark", "phone"]
)
def test_a_checker_of_accessibility_finds_nothing(tab: Tab, page: Path, look: dict[str, Any]) -> None:
    assert AXE is not None and AXE.origin is not None
    draw_all(tab, page, **look)
    # what is drawn in a plot is hidden from screen readers; its letters have the page's own colour
    tab.run("document.querySelectorAll('.main-svg').forEach((svg) => svg.replaceChildren())")
    tab.run(Path(AXE.origin).with_name("axe.min.js").read_text(encoding="utf-8") + "; 0")
    broken = tab.run("axe.run(document, { resultTypes: ['violations'] }).then((r) => r.violations)")
    assert [(rule["id"], [node["html"] for node in rule["nodes"][:3]]) for rule in broken] == []


def test_a_lab_of_failures_has_its_table_and_says_that_nothing_can_be_followed(tab: Tab, tmp_path: Path) -> None:
    write_run(tmp_path, "a/run.mcap", runs={"recorded_at": None, "rig": None, "sentence": None, "step": None})
    write_lab_page(tmp_path, tmp_path / "page")
    opened(tab, tmp_path / "page" / "index.html", height=3000)
    assert column(tab, "#rows .status") == ["failed"]
    assert column(tab, "#trend-caption") == ["No run has values to follow."]
    assert column(tab, "#bode-words") == ["Choose up to 6 runs by the boxes in the table."]
    assert tab.complaints == []


def test_links_within_the_page_leave_the_filter_in_the_address(tab: Tab, page: Path) -> None:
    opened(tab, page, "verdict=named")
    tab.run("document.querySelector('.contents a[href=\"#trends\"]').click()")
    assert tab.run("document.activeElement.id") == "trends"
    assert "verdict=named" in address_of(tab)


def test_without_javascript_the_page_says_what_prints_the_runs(tab: Tab, page: Path) -> None:
    tab.look(width=1200)
    tab.open(page, scripts=False)
    assert "rotor lab query prints them" in tab.run("document.body.innerText")
