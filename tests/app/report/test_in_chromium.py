"""The report in a browser: it loads, draws and prints, asks nobody for anything, and can be used by keyboard and ear.

Accessibility is judged by axe-core where the package is there (axe-core-python, which brings its script along).
"""

import dataclasses
import importlib.util
import json
import re
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from rotorrig.acquisition.recording import RawRecording
from rotorrig.app.report.balance_sheet import write_balance_sheet
from rotorrig.app.report.page import write_report
from rotorrig.balancing import Balance
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.app.browser import Tab, browser, needs_chromium
from tests.app.conftest import make_response
from tests.parameters import defer_rest

pytestmark = [pytest.mark.browser, needs_chromium]

AXE = importlib.util.find_spec("axe_core_python")
PAPERS = {"A4": (8.27, 11.69), "Letter": (8.5, 11.0)}  # inch
LOOKS: dict[str, dict[str, Any]] = {
    "light": {"width": 1200},
    "dark": {"width": 1200, "dark": True},
    "phone": {"width": 390},
}
#: Bode and polar first; then residuals of 1X and 2X before and after, whirl; 4 Bode, 4 polar; search;
#: 2 full spectra; 2X; 2 centrelines
PLOTS = 21


@pytest.fixture(scope="module")
def tab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    with browser(tmp_path_factory.mktemp("profile")) as tab:
        yield tab


@pytest.fixture(scope="module")
def report(
    tmp_path_factory: pytest.TempPathFactory,
    response: OrderTrackedResponse,
    poorly_fitted: Identification,
    named: Diagnosis,
) -> Path:
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report(path, response=response, identification=poorly_fitted, diagnosis=named)
    return path


def opened(tab: Tab, report: Path, **look: Any) -> None:
    """Show a report, as it stands if it is the one that is open, in the window of a laptop unless told otherwise."""
    tab.look(**{"width": 1200, **look})
    if tab.shows != report:
        tab.open(report)


def test_every_plot_is_drawn_without_a_complaint_and_nothing_is_asked_for(tab: Tab, report: Path) -> None:
    tab.look(width=1200)
    tab.open(report)
    drawn = tab.run("[...document.querySelectorAll('.canvas')].map(c => c.querySelectorAll('.main-svg').length > 0)")
    assert drawn == [True] * PLOTS
    assert tab.complaints == []
    assert [url for url in tab.requests if not url.startswith(("file:", "data:", "blob:"))] == []


def test_a_plot_on_its_own_is_a_picture_with_ink_in_it(tab: Tab, report: Path, tmp_path: Path) -> None:
    opened(tab, report)
    tab.picture(tmp_path / "plot.png", ".canvas")
    with Image.open(tmp_path / "plot.png") as picture:
        assert picture.width > 400
        assert len(picture.convert("L").getcolors() or []) > 20


def test_the_first_tab_skips_to_the_verdict_and_the_toggle_is_reached(tab: Tab, report: Path) -> None:
    opened(tab, report)
    tab.press("Tab")
    assert tab.run("document.activeElement.textContent") == "Skip to the content"
    assert tab.run("document.activeElement.getBoundingClientRect().left") >= 0  # it shows itself
    for _ in range(200):
        tab.press("Tab")
        if tab.run("document.activeElement.id") == "log-amplitude":
            break
    tab.press(" ")
    assert tab.run("document.getElementById('bode-0').layout.yaxis.type") == "log"
    assert tab.run("document.getElementById('bode-0').layout.yaxis2.type") != "log"  # the phase
    tab.press(" ")
    assert tab.run("document.getElementById('bode-0').layout.yaxis.type") == "linear"


def test_the_page_cannot_ask_for_anything_either(tab: Tab, report: Path) -> None:
    opened(tab, report)
    asked = tab.run("fetch('http://127.0.0.1:9/').then(() => 'answered', (error) => 'refused')")
    assert asked == "refused"
    assert any("Content Security Policy" in complaint for complaint in tab.complaints)


def test_a_plot_shows_the_numbers_it_was_given(tab: Tab, report: Path) -> None:
    opened(tab, report)
    peak = tab.run("Math.max(...document.getElementById('bode-0')._fullData.find((t) => t.name === 'up, model').y)")
    assert peak == pytest.approx(187.5, rel=0.01)  # e / (2 zeta), the extended model


def test_every_plots_data_is_json_that_cannot_end_its_element(report: Path) -> None:
    found = re.findall(r'<script type="application/json"[^>]*>(.*?)</script>', report.read_text(), re.DOTALL)
    assert len(found) == PLOTS
    for data in found:
        assert "<" not in data
        assert {"data", "layout"} <= set(json.loads(data))


@pytest.mark.parametrize("width", defer_rest([390, 1200, 1600]))
def test_nothing_is_wider_than_the_window(tab: Tab, report: Path, width: int) -> None:
    opened(tab, report, width=width)
    tab.run("document.querySelectorAll('details').forEach((part) => (part.open = true))")  # a folded plot has no width
    wide = "[...document.querySelectorAll('.canvas .main-svg')].filter(s => s.clientWidth > innerWidth).length"
    page = "document.documentElement.scrollWidth"
    patience = time.monotonic() + 30
    while (tab.run(page) > width or tab.run(wide)) and time.monotonic() < patience:
        time.sleep(0.1)  # a plot follows its window with some delay
    shown_width, wider = tab.run(page), tab.run(wide)
    tab.run("document.querySelectorAll('details').forEach((part) => (part.open = false))")
    assert shown_width <= width
    assert wider == 0


@pytest.mark.campaign
@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_letters_in_plots_and_drawings_stand_out_from_the_paper(tab: Tab, report: Path, dark: bool) -> None:
    opened(tab, report, dark=dark)
    colours = tab.run(
        "[...new Set([...document.querySelectorAll('main svg text')].map((t) => getComputedStyle(t).fill))]"
    )
    paper = luminance(tab.run("getComputedStyle(document.body).backgroundColor"))
    for colour in colours:
        light, deep = sorted((luminance(colour), paper), reverse=True)
        assert (light + 0.05) / (deep + 0.05) >= 4.5, colour  # WCAG 2.2, 1.4.3


def luminance(colour: str) -> float:
    """Return the relative luminance of "rgb(r, g, b)" (WCAG 2.2).

    >>> luminance("rgb(255, 255, 255)"), luminance("rgb(0, 0, 0)")
    (1.0, 0.0)
    """
    values = [int(part) / 255 for part in re.findall(r"\d+", colour)[:3]]
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values]
    return float(np.dot(linear, [0.2126, 0.7152, 0.0722]))


@pytest.mark.campaign
def test_headings_lead_down_one_step_at_a_time(tab: Tab, report: Path) -> None:
    opened(tab, report)
    levels = tab.run("[...document.querySelectorAll('h1,h2,h3,h4')].map((h) => Number(h.tagName[1]))")
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert max(np.diff(levels)) <= 1


@pytest.mark.skipif(shutil.which("pdftotext") is None, reason="needs pdftotext (Debian: poppler-utils)")
@pytest.mark.parametrize("paper", defer_rest(PAPERS))
def test_it_prints_within_the_margins_with_all_that_was_folded(
    tab: Tab, report: Path, tmp_path: Path, paper: str
) -> None:
    width, height = PAPERS[paper]
    opened(tab, report)
    (tmp_path / "report.pdf").write_bytes(tab.paper(width=width, height=height))
    pages = words_of(tmp_path / "report.pdf")
    assert 5 < len(pages) < 20
    assert "Bent shaft: 18.0 µm at 110°" in pages[0][0]
    everything = " ".join(text for text, _ in pages)
    for words in ("disk 280.5 0.809 kg,", "speed, rpm", f"1 / {len(pages)}"):
        assert words in everything
    assert "Skip to the content" not in everything
    for _, right in pages:
        assert right <= 72 * width - 38  # pt; the margin is 14 mm


@pytest.fixture(scope="module")
def sheet(tmp_path_factory: pytest.TempPathFactory, response: OrderTrackedResponse, balanced: Balance) -> Path:
    """The sheet of two planes, each corrected by three methods, with all there is to say."""
    first = balanced.corrections[0]
    both = dataclasses.replace(first, planes=("disk", "rim"), W=np.tile(first.W, 2), covariance=np.eye(4) * 1e-14)
    told = dataclasses.replace(
        balanced,
        planes=both.planes,
        radii=dict.fromkeys(both.planes, 0.03),
        corrections=(both, dataclasses.replace(both, by="fitted model"), both),
        chosen=both,
        disagreement=1.9,
        mounted=np.tile(balanced.mounted, 2),
        placing=None,
    )
    path = tmp_path_factory.mktemp("sheet") / "sheet.html"
    write_balance_sheet(path, told, response.rig)
    return path


@pytest.mark.skipif(shutil.which("pdftotext") is None, reason="needs pdftotext (Debian: poppler-utils)")
@pytest.mark.parametrize("paper", defer_rest(PAPERS))
def test_a_balance_sheet_is_one_sheet(tab: Tab, sheet: Path, tmp_path: Path, paper: str) -> None:
    width, height = PAPERS[paper]
    opened(tab, sheet)
    assert tab.complaints == []
    (tmp_path / "sheet.pdf").write_bytes(tab.paper(width=width, height=height))
    ((words, right),) = words_of(tmp_path / "sheet.pdf")
    for wanted in ("Add", "mark 0°", "fitted model", "ISO 21940-11", "Probe 2y", " rpm", "needs no network"):
        assert wanted in words
    assert right <= 72 * width - 26  # pt; the margin is 10 mm


def words_of(pdf: Path) -> list[tuple[str, float]]:
    """Return of every page its text and how far right its words go [pt]."""
    done = subprocess.run(["pdftotext", "-bbox", str(pdf), "-"], capture_output=True, text=True, check=True)
    pages = done.stdout.split("<page ")[1:]
    return [
        (" ".join(re.findall(r">([^<]+)</word>", page)), max(map(float, re.findall(r'xMax="([\d.]+)"', page))))
        for page in pages
    ]


@pytest.mark.campaign
def test_after_printing_the_plots_are_as_wide_as_before(tab: Tab, report: Path) -> None:
    opened(tab, report)
    width = "document.querySelector('#bode-0 .main-svg').clientWidth"
    before = tab.run(width)
    tab.run("dispatchEvent(new Event('beforeprint')); 0")
    assert tab.run(width) == pytest.approx(0.57 * 680, abs=1)
    tab.run("dispatchEvent(new Event('afterprint')); 0")
    assert tab.run(width) == pytest.approx(before, abs=2)


@pytest.mark.skipif(AXE is None, reason="needs axe-core-python")
def test_a_checker_of_accessibility_finds_nothing(tab: Tab, report: Path) -> None:
    opened(tab, report)
    prepare_for_axe(tab)
    found = {"structure": judged(tab, "document", "rules: { 'color-contrast': { enabled: false } }")}
    places = "[['header'], ['#verdict'], ['#glance'], ['.contents'], ['#causes'], ['#identified'], ['footer']]"
    for name, look in LOOKS.items():
        tab.look(**look)
        found[name] = judged(
            tab, f"{{ include: {places} }}", "runOnly: ['color-contrast', 'scrollable-region-focusable']"
        )
    assert [name for name, broken in found.items() if broken] == [], found


@pytest.mark.skipif(AXE is None, reason="needs axe-core-python")
def test_what_a_recording_adds_is_drawn_fits_a_telephone_and_is_accessible(
    tab: Tab, tmp_path: Path, tracked: OrderTrackedResponse, recording: RawRecording
) -> None:
    write_report(tmp_path / "recorded.html", response=tracked, recording=recording)
    opened(tab, tmp_path / "recorded.html", width=390)
    maps = "[...document.querySelectorAll('.canvas[id^=cascade-]')].map(c => c.querySelectorAll('image').length)"
    assert tab.run(maps) == [1] * 4
    assert tab.run("document.querySelectorAll('#time-base svg').length") == 18  # three each of three speeds, two planes
    assert tab.complaints == []
    assert tab.run("document.documentElement.scrollWidth") <= 390
    prepare_for_axe(tab)
    assert judged(tab, "document", "rules: { 'color-contrast': { enabled: false } }") == []
    places = "{ include: [['#cascade'], ['#time-base']] }"
    assert judged(tab, places, "runOnly: ['color-contrast', 'scrollable-region-focusable']") == []


def prepare_for_axe(tab: Tab) -> None:
    """Unfold the page, take out what is drawn in its plots, and load the checker."""
    assert AXE is not None and AXE.origin is not None
    tab.shows = None  # it is not left as it is
    # what is drawn in a plot is hidden from screen readers, and the contrast of its letters is measured above
    tab.run("document.querySelectorAll('.main-svg').forEach((svg) => svg.replaceChildren())")
    tab.run("document.querySelectorAll('details').forEach((details) => (details.open = true))")
    tab.run(Path(AXE.origin).with_name("axe.min.js").read_text(encoding="utf-8") + "; 0")


def judged(tab: Tab, where: str, options: str) -> list[tuple[str, list[str]]]:
    """Return the rules that parts of the page break, with the elements that do."""
    broken = tab.run(f"axe.run({where}, {{ resultTypes: ['violations'], {options} }}).then((r) => r.violations)")
    return [(rule["id"], [node["html"] for node in rule["nodes"][:3]]) for rule in broken]


def test_without_javascript_words_tables_and_drawings_are_there(tab: Tab, report: Path) -> None:
    tab.look(width=1200)
    tab.open(report, scripts=False)
    seen = tab.run("document.body.innerText")
    for words in (
        "Bent shaft: 18.0 µm at 110°",
        "Without JavaScript the plots are missing",
        "1X peaks, measured and model",
    ):
        assert words in seen
    assert "Bode plot of probe 1x, 1X amplitude" in seen  # in the plot's place
    assert tab.run("document.querySelectorAll('svg.drawing').length") == 3


@pytest.mark.campaign
def test_a_response_of_twenty_thousand_rows_makes_no_heavier_page(
    tab: Tab, tmp_path: Path, rig: RigConfig, response: OrderTrackedResponse
) -> None:
    write_report(tmp_path / "short.html", response=response)
    huge = make_response(rig, rows=10_000)
    write_report(tmp_path / "huge.html", response=huge)
    assert len(huge.omega) > 20_000
    assert (tmp_path / "huge.html").stat().st_size < (tmp_path / "short.html").stat().st_size + 500e3
    opened(tab, tmp_path / "huge.html")
    points = tab.run("document.querySelectorAll('.point').length")
    assert 500 < points < 10_000


def test_a_browser_that_cannot_unpack_the_plots_says_so(tab: Tab, report: Path, tmp_path: Path) -> None:
    page = report.read_text(encoding="utf-8")
    old = page.replace("<script>\n", "<script>\ndelete globalThis.DecompressionStream;\n", 1)
    assert old != page
    (tmp_path / "old.html").write_text(old, encoding="utf-8")
    tab.look(width=1200)
    tab.open(tmp_path / "old.html", wait="rotorReport.drawn.catch(() => 0)")
    assert "This browser cannot unpack the plots" in tab.run("document.body.innerText")
    assert "1X peaks, measured and model" in tab.run("document.body.innerText")
