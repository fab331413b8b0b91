"""The unit of amplitudes, switched on the page: what is stated in µm 0-peak changes, and nothing else does."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from rotorrig.app.report.page import write_report
from rotorrig.app.text.amplitude_units import AMPLITUDE_UNITS
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from tests.app.browser import Tab, browser, needs_chromium

pytestmark = [pytest.mark.browser, needs_chromium]

PP_IN_MIL = 2 / 25.4
TRACE = "document.getElementById('{0}')._fullData[0].{1}"
WORDS = "document.querySelector('main').innerText"


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


def opened(tab: Tab, report: Path) -> None:
    """Open the page as if nobody had chosen anything."""
    tab.look(width=1200)
    tab.open(report)
    tab.run("localStorage.clear()")
    tab.open(report)


def choose(tab: Tab, unit: str) -> None:
    tab.run(f"(() => {{ chooser.value = {json.dumps(unit)}; chooser.dispatchEvent(new Event('change')); }})()")


def values(tab: Tab, figure: str, which: str) -> np.ndarray:
    listed = tab.run(
        f"JSON.stringify([...{TRACE.format(figure, which)}].flatMap((row) => row.length ? [...row] : row))"
    )
    return np.array(json.loads(listed), dtype=float)


def cells(tab: Tab, caption: str) -> list[list[str]]:
    of_table = f"[...document.querySelectorAll('table')].find(t => t.caption?.textContent.startsWith({caption!r}))"
    rows = tab.run(f"JSON.stringify([...{of_table}.rows].map(r => [...r.cells].map(c => c.textContent)))")
    table: list[list[str]] = json.loads(rows)
    return table


def test_the_page_offers_what_the_program_takes(tab: Tab, report: Path) -> None:
    opened(tab, report)
    assert tab.run("JSON.stringify([...chooser.options].map(o => o.value))") == json.dumps(
        AMPLITUDE_UNITS, ensure_ascii=False, separators=(",", ":")
    )


def test_tables_tell_amplitudes_in_the_unit_chosen_and_the_rest_as_before(tab: Tab, report: Path) -> None:
    opened(tab, report)
    before = cells(tab, "1X peaks")
    choose(tab, "mil pp")
    after = cells(tab, "1X peaks")
    assert before[0][1] == "peak, µm 0-peak"
    assert after[0][1] == "peak, mil pp"
    for old, new in zip(before[1:], after[1:], strict=True):
        assert [cell for i, cell in enumerate(new) if i % 3 != 1] == [cell for i, cell in enumerate(old) if i % 3 != 1]
        for i in range(1, len(old), 3):
            assert float(new[i]) == pytest.approx(PP_IN_MIL * float(old[i]), rel=0.006)
            assert len(re.sub(r"^0+|[.]", "", new[i])) >= 3
    choose(tab, "µm 0-peak")
    assert cells(tab, "1X peaks") == before


def test_what_a_cause_gains_is_told_in_it(tab: Tab, report: Path) -> None:
    opened(tab, report)
    gains = "goes from 5.2 to 0.41 {0}, 1.03 times the noise floor of {1} {0}."
    assert gains.format("µm 0-peak", "0.4") in tab.run(WORDS)
    choose(tab, "mil pp")
    assert gains.replace("5.2 to 0.41", "0.41 to 0.032").format("mil pp", "0.031") in tab.run(WORDS)
    header, bow, *_ = cells(tab, "Causes tried")
    column = header.index("error on unseen data, mil pp")
    assert bow[column] == "0.409 → 0.0323"


@pytest.mark.parametrize(
    ("figure", "which"),
    [("first-bode", "y"), ("first-polar", "r"), ("order-2", "y"), ("whirl", "z"), ("whirl", "customdata")],
)
def test_figures_are_drawn_in_it(tab: Tab, report: Path, figure: str, which: str) -> None:
    opened(tab, report)
    before = values(tab, figure, which)
    choose(tab, "mil pp")
    np.testing.assert_allclose(values(tab, figure, which), PP_IN_MIL * before, rtol=1e-5)
    assert "µm" not in (tab.run(TRACE.format(figure, "hovertemplate")) or "")
    assert "µm" not in tab.run(f"document.getElementById('{figure}').textContent")


def test_a_polar_plot_has_round_numbers_and_none_at_its_centre(tab: Tab, report: Path) -> None:
    opened(tab, report)
    choose(tab, "mil pp")
    ticks = json.loads(
        tab.run("JSON.stringify(document.getElementById('first-polar').layout.polar.radialaxis.tickvals)")
    )
    first = float(f"{ticks[0]:.1e}".split("e")[0])
    assert first in (1.0, 2.0, 5.0)
    assert ticks == pytest.approx([ticks[0], 2 * ticks[0], 3 * ticks[0]])
    assert ticks[2] <= values(tab, "first-polar", "r").max() * 1.5


def test_lags_and_spectra_stay_as_they_are(tab: Tab, report: Path) -> None:
    opened(tab, report)
    lag = "document.getElementById('first-bode')._fullData.find(t => t.yaxis === 'y2')"
    kept = [tab.run(f"JSON.stringify([...{lag}.y])"), tab.run("document.getElementById('full-0').textContent")]
    words = tab.run("document.getElementById('full-0-caption').textContent")
    choose(tab, "µm pp")
    assert kept == [tab.run(f"JSON.stringify([...{lag}.y])"), tab.run("document.getElementById('full-0').textContent")]
    assert tab.run("document.getElementById('full-0-caption').textContent") == words
    assert "µm 0-peak" in words


def test_sentences_with_a_stated_amplitude_follow_and_lengths_do_not(tab: Tab, report: Path) -> None:
    opened(tab, report)
    before = tab.run(WORDS)
    choose(tab, "µm pp")
    after = tab.run(WORDS)
    stated = re.findall(r"([\d.]+) µm 0-peak", before)
    told = re.findall(r"([\d.]+) µm pp", after)
    assert stated
    assert [float(number) for number in told] == pytest.approx([2 * float(number) for number in stated], rel=0.006)
    others = r"[\d.]+ µm(?! 0-peak| pp)"
    assert re.findall(others, before) == re.findall(others, after)


def test_a_choice_is_kept_for_the_next_page_and_outlives_the_writer_s(
    tab: Tab, report: Path, tmp_path: Path, response: OrderTrackedResponse
) -> None:
    opened(tab, report)
    path = tmp_path / "mils.html"
    write_report(path, response=response, units="mil pp")
    tab.open(path)
    assert tab.run("chooser.value") == "mil pp"
    assert "peak, mil pp" in cells(tab, "1X peaks")[0]
    assert "mil pp" in tab.run("document.getElementById('first-bode').textContent")
    choose(tab, "µm pp")
    tab.open(report)
    assert tab.run("chooser.value") == "µm pp"
    assert tab.complaints == []
