"""The report says what its inputs say: the inputs are closed forms with known peaks, see tests/app/conftest.py."""

import dataclasses
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from rotorrig.acquisition.recording import RawRecording
from rotorrig.app.plot_data.curves import curves
from rotorrig.app.plot_data.diagnosis_of_response import part_of
from rotorrig.app.report.html import table
from rotorrig.app.report.page import write_report
from rotorrig.balancing import Balance
from rotorrig.identify.diagnosis import Diagnosis, Verdict
from rotorrig.identify.identification import Identification, NameplateCheck
from rotorrig.identify.verdict.cause import ParameterValue
from rotorrig.identify.verdict.gain import Shift
from rotorrig.identify.verdict.next_run.choice import NextRun
from rotorrig.identify.verdict.verdict import HiddenEffect
from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.processing.settings import SpeedWindow
from rotorrig.rig.errors import DataError
from tests.app.conftest import WRONG_CONFIG, make_cause, make_gain, make_missing

TRUTH = {"kxx": 34000.0, "kyy": 34100.0, "cxx": 14.8, "cyy": 15.0, "u": 1.61e-5, "phase": 0.70}


class Page(HTMLParser):
    """Headings, table cells, links and elements of a page, in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[str] = []
        self.links: list[str] = []
        self.words: list[tuple[str, str]] = []  # element, text in it
        self.ids: list[str] = []
        self.unlabelled: list[str] = []
        self._open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.elements.append(tag)
        self.links += [value or "" for name, value in attrs if name in ("src", "href", "srcset", "action", "data")]
        self.ids += [found["id"] or ""] if "id" in found else []
        if found.get("role") == "img" and not found.get("aria-label"):
            self.unlabelled.append(tag)
        if tag not in ("meta", "link", "br", "input", "line", "rect", "circle", "path"):
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if self._open and self._open[-1] == tag:
            self._open.pop()

    def handle_data(self, data: str) -> None:
        if data.strip() and self._open and self._open[-1] not in ("script", "style"):
            self.words.append((self._open[-1], data.strip()))

    def first(self, tag: str) -> str:
        return next(words for where, words in self.words if where == tag)

    def said(self) -> str:
        return " ".join(words for _, words in self.words)


def test_a_balance_is_told_drawn_and_predicted(response: OrderTrackedResponse, balanced: Balance, path: Path) -> None:
    write_report(path, response=response, balance=balanced)
    page = Page(path.read_text())
    said = page.said()
    assert "Balancing" in said
    assert "into hole" in said and "from the keyphasor mark in the sense of rotation" in said
    assert {"predicted-0", "correction-3"} <= set(page.ids)
    assert len(page.ids) == len(set(page.ids))
    assert page.unlabelled == []
    other = dataclasses.replace(balanced, source=dataclasses.replace(balanced.source, source_hash="22" * 8))
    with pytest.raises(DataError, match="want the first response it was made of"):
        write_report(path, response=response, balance=other)


def test_what_is_missing_is_told_after_the_verdict_with_its_place_and_its_force(
    path: Path, response: OrderTrackedResponse, named: Diagnosis
) -> None:
    described = dataclasses.replace(named, verdict=Verdict.DESCRIBED, missing=make_missing())
    write_report(path, response=response, diagnosis=described)
    page = Page(path.read_text())
    assert [words for where, words in page.words if where == "h2"][:3] == [
        "A force that the model lacks acts at 485 mm from the coupling; no known cause is like it.",
        "At a glance",
        "What is missing",
    ]
    said = page.said()
    assert "At 485 ± 10 mm from the coupling" in said and "Such a law has a fluid film." in said
    assert "Nearly as good, 9 of BIC behind: probe 2x reads besides 3 %" in said
    assert {"missing-speed", "missing-motion"} <= set(page.ids)
    assert "polygon" in page.elements
    assert page.unlabelled == []


def test_what_comes_nearest_is_no_finding_and_a_reading_has_no_pictures(
    path: Path, response: OrderTrackedResponse, named: Diagnosis
) -> None:
    nowhere = {"places": np.zeros(0), "probability": np.zeros(0), "over_speed": None, "kind": "reading"}
    missing = make_missing(shortfall="it leaves 40 % of the misfit", **nowhere)
    nearest = dataclasses.replace(named, verdict=Verdict.UNEXPLAINED, missing=missing)
    write_report(path, response=response, diagnosis=nearest)
    page = Page(path.read_text())
    assert "What comes nearest, which is no finding" in [words for where, words in page.words if where == "h2"]
    assert not {"missing-speed", "missing-motion"} & set(page.ids)


def test_with_its_recording_a_report_has_a_cascade_and_time_bases(
    path: Path, tracked: OrderTrackedResponse, recording: RawRecording
) -> None:
    write_report(path, response=tracked, recording=recording)
    page = Page(path.read_text())
    said = page.said()
    assert {"cascade", "time-base", "cascade-0", "cascade-3"} <= set(page.ids)
    assert page.unlabelled == []
    assert len(page.ids) == len(set(page.ids))
    assert "1x, 1y at 250.5 mm, up run. Largest: 18" in said, "187.5 um, the critical speed passed at 260 rpm/s"
    assert "up 0.47 s, which resolve 3.2 Hz" in said  # 1 / sqrt(4.4 Hz/s), 1.5 / T
    assert "3000 rpm, top speed : frames" in said
    other = dataclasses.replace(recording, source=dataclasses.replace(recording.source, source_hash="22" * 8))
    with pytest.raises(DataError, match="want the run of this very response"):
        write_report(path, response=tracked, recording=other)


def test_without_a_recording_nothing_is_said_of_it(page: Page) -> None:
    assert not {"cascade", "time-base"} & set(page.ids)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "report.html"


@pytest.fixture(scope="module")
def full(
    tmp_path_factory: pytest.TempPathFactory,
    response: OrderTrackedResponse,
    identification: Identification,
    good: Diagnosis,
) -> Path:
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report(path, response=response, identification=identification, diagnosis=good, truth=TRUTH)
    return path


@pytest.fixture(scope="module")
def page(full: Path) -> Page:
    return Page(full.read_text())


def test_the_verdict_comes_first(page: Page) -> None:
    assert page.first("h2") == "The model describes this run."


def test_the_evidence_comes_in_order(
    path: Path, response: OrderTrackedResponse, poorly_fitted: Identification, named: Diagnosis
) -> None:
    write_report(path, response=response, identification=poorly_fitted, diagnosis=named)
    assert [words for where, words in Page(path.read_text()).words if where == "h2"] == [
        "Bent shaft: 18.0 µm at 110°. It explains what the model got wrong.",
        "At a glance",
        "Misfit between model and measurement",
        "Synchronous response (1X) against speed",
        "Causes",
        "Identified values",
        "Full spectrum",
        "Other orders",
        "Orbits at 1X",
        "Shaft centreline and gap",
        "What this data cannot show",
        "Order tracking",
        "The rig",
        "Provenance",
        "Conventions",
    ]


def test_the_first_screen_has_the_loudest_probe_and_what_was_identified(
    path: Path, response: OrderTrackedResponse, poorly_fitted: Identification, named: Diagnosis
) -> None:
    write_report(path, response=response, identification=poorly_fitted, diagnosis=named)
    text = path.read_text()
    first = Page(text[text.index('<section id="glance"') : text.index("<nav")])
    assert first.ids[:3] == ["glance", "h-glance", "first-bode-caption"]
    loudest = response.probes[int(np.nanargmax(np.nanmax(np.abs(response.compensated()), axis=0)))]
    said = first.said()
    assert f"Probe {loudest}, the loudest" in said
    assert "Critical speed of run up: 22" in said
    assert "kxx 33.90 ± 0.12 kN/m 33.9 kN/m" in said, "the extended model's, not the biased 31.2 of the base model"


def test_what_explains_nothing_is_neither_pointed_at_nor_in_the_values(
    path: Path, response: OrderTrackedResponse, poorly_fitted: Identification, named: Diagnosis
) -> None:
    gain = make_cause("probe_gain, probe 2x", "probe gain", chosen=True, evidence=90.0, after=4.1e-6)
    vain = dataclasses.replace(named, verdict=Verdict.UNEXPLAINED, causes=(gain,), tied=())
    write_report(path, response=response, identification=poorly_fitted, diagnosis=vain)
    text = path.read_text()
    first = text[text.index('<section id="glance"') : text.index("<nav")]
    assert 'class="found"' not in first
    assert "Identified, by a model that does NOT describe the run" in Page(first).said()
    assert "33.90 ± 0.12" not in Page(first).said()


def test_a_cause_with_a_place_is_pointed_at_in_the_drawing(
    path: Path, response: OrderTrackedResponse, named: Diagnosis
) -> None:
    gain = make_cause("probe_gain, probe 2x", "probe gain", chosen=True, evidence=90.0, after=4.1e-7)
    write_report(path, response=response, diagnosis=dataclasses.replace(named, causes=(gain,), tied=()))
    assert "probe gain, probe 2x at 380.5 mm." in path.read_text()


def test_every_section_is_in_the_contents(page: Page) -> None:
    linked = {link.removeprefix("#") for link in page.links if link.startswith("#")}
    assert linked <= set(page.ids)
    assert {"bode", "identified", "rig", "conventions"} <= linked


def test_a_poor_fit_says_so_with_its_misfit_in_micrometres_and_sigma(
    path: Path, response: OrderTrackedResponse, poorly_fitted: Identification, poor: Diagnosis
) -> None:
    write_report(path, response=response, identification=poorly_fitted, diagnosis=poor)
    text = path.read_text()
    page = Page(text)
    assert "does NOT describe this run" in page.first("h2")
    assert 'class="banner bad"' in text
    assert f"largest misfit {poor.worst[0].residual * 1e6:.3g} µm 0-peak, {poor.worst[0].sigma:.3g} σ" in page.said()
    assert poor.worst[0].sentence in page.said()
    assert "a model that does not describe the run" in page.said()  # beside the values it gave


def test_no_figure_stands_twice_in_the_verdict(
    path: Path, response: OrderTrackedResponse, identification: Identification, good: Diagnosis
) -> None:
    fit = dataclasses.replace(identification.fits[0], p=1e-9, scatter_ratio=1.8, adequate=False)
    write_report(path, response=response, identification=dataclasses.replace(identification, fits=(fit,)))
    assert banner_of(path).count("chi2") + banner_of(path).count("χ²") == 1
    told = dataclasses.replace(good, sentence="The model is adequate: p = 0.3.")
    write_report(path, response=response, diagnosis=told)
    assert banner_of(path).count("p = ") == 1


def banner_of(path: Path) -> str:
    text = path.read_text()
    return Page(text[text.index('<section id="verdict"') : text.index('<section id="glance"')]).said()


def test_a_poor_fit_nobody_diagnosed_is_still_called_poor(
    path: Path, response: OrderTrackedResponse, poorly_fitted: Identification
) -> None:
    write_report(path, response=response, identification=poorly_fitted)
    page = Page(path.read_text())
    assert page.first("h2").startswith("Poor fit")
    assert "10.1 times the noise" in page.said()  # sqrt(295000 / 2910)


def test_a_fit_that_fails_its_test_is_called_poor_and_says_what_to_do(
    path: Path, response: OrderTrackedResponse, identification: Identification
) -> None:
    fit = dataclasses.replace(identification.fits[0], p=1e-9, scatter_ratio=1.8, adequate=False)
    write_report(path, response=response, identification=dataclasses.replace(identification, fits=(fit,)))
    page = Page(path.read_text())
    assert page.first("h2").startswith("Poor fit")
    assert "Run rotor diagnose" in page.said()


def test_what_of_the_config_is_wrong_has_its_section(
    path: Path, response: OrderTrackedResponse, identification: Identification, good: Diagnosis
) -> None:
    cause = dataclasses.replace(make_cause("tilt, spring", "", chosen=True, evidence=20.0, after=1e-6), nameplate=True)
    wrong = dataclasses.replace(good, verdict=Verdict.NAMED, causes=(cause,), nameplate=WRONG_CONFIG)
    write_report(path, response=response, identification=identification, diagnosis=wrong)
    page = Page(path.read_text())
    assert page.first("h2").startswith("The config is wrong about this rig")
    assert [words for _, words in page.words if words in ("481 mm", "483.10 ± 0.20 mm", "4.6 σ (positions)")]
    assert "Bearing spring sits 2.10 ± 0.20 mm further" in page.said()


def test_a_config_that_nothing_pulls_at_is_said_to_be_so(
    path: Path, response: OrderTrackedResponse, identification: Identification, good: Diagnosis
) -> None:
    slight = NameplateCheck(pulls=(dataclasses.replace(WRONG_CONFIG.pulls[0], sigmas=0.4),))
    right = dataclasses.replace(good, nameplate=slight)
    write_report(path, response=response, identification=identification, diagnosis=right)
    assert "pulls at nothing the config states" in Page(path.read_text()).said()


def test_a_good_fit_nobody_diagnosed_is_not_called_good(
    path: Path, response: OrderTrackedResponse, identification: Identification
) -> None:
    write_report(path, response=response, identification=identification)
    assert Page(path.read_text()).first("h2") == "Fitted, not diagnosed"


def test_an_unexplained_run_claims_no_more_than_was_tried(
    path: Path, response: OrderTrackedResponse, poorly_fitted: Identification, poor: Diagnosis
) -> None:
    write_report(path, response=response, identification=poorly_fitted, diagnosis=poor)
    assert "causes tried" not in Page(path.read_text()).first("h2")
    tried = dataclasses.replace(poor, causes=(make_cause("bow", "residual bow", evidence=-3.0, after=5e-6),))
    write_report(path, response=response, identification=poorly_fitted, diagnosis=tried)
    assert Page(path.read_text()).first("h2").endswith("none of the causes tried explains it.")
    cut_short = dataclasses.replace(tried, cut_short=True)
    write_report(path, response=response, identification=poorly_fitted, diagnosis=cut_short)
    assert Page(path.read_text()).first("h2").endswith("The search for causes was cut short.")


def test_why_there_is_no_next_run_is_said(
    path: Path, response: OrderTrackedResponse, identification: Identification, named: Diagnosis
) -> None:
    words = "No next run could be computed: no motion."
    none = NextRun(kind="none", words=words, lam=float("nan"), separates=("bow", "runout, plane 2"))
    tied = dataclasses.replace(named, verdict=Verdict.TIED, next_run=none)
    write_report(path, response=response, identification=identification, diagnosis=tied)
    said = Page(path.read_text()).said()
    assert said.count(words) == 2, "in the verdict's banner and beside the causes"
    assert f"Next: {words}" not in said
    assert f"Next run: {words}" not in said


def test_a_named_cause_comes_with_its_size_its_evidence_and_what_it_explains(
    path: Path, response: OrderTrackedResponse, poorly_fitted: Identification, named: Diagnosis
) -> None:
    write_report(path, response=response, identification=poorly_fitted, diagnosis=named)
    page = Page(path.read_text())
    assert page.first("h2") == "Bent shaft: 18.0 µm at 110°. It explains what the model got wrong."
    said = page.said()
    assert named.causes[0].words in said
    assert "bow 18.00 ± 0.30 µm at 110.0 ± 1.0° 812 827 5.20 → 0.410 in the model, tied" in said
    assert "delay – -11 4 – not plausible" in said, "a size that no rig has is not told"
    assert "Tied: bow; runout, plane 2." in said
    assert "A run with a trial mass of 12 g mm would tell bow from runout." in said
    assert "goes from 5.2 to 0.41 µm 0-peak, 1.03 times the noise floor of 0.4 µm 0-peak." in said
    assert "kxx, stiffness, horizontal 31.2 kN/m 33.90 ± 0.12 kN/m +22.5 σ" in said  # (33900 - 31200) / 120
    assert "internal_damping: detectable from 40 N s/m; needs a run in reverse" in said
    assert "Next: A run with a trial mass of 12 g mm" in said[: said.index("Misfit between model and measurement")]


def test_of_several_responses_each_finds_its_own_rows_in_the_diagnosis(
    path: Path, response: OrderTrackedResponse, poor: Diagnosis
) -> None:
    rows = len(response.omega)
    both = dataclasses.replace(
        poor,
        residual=np.concatenate([np.zeros((5, *poor.residual.shape[1:])), poor.residual]),
        sigmas=np.concatenate([np.zeros((5, *poor.sigmas.shape[1:])), poor.sigmas]),
        responses=(("of another", 5), (response.source.source_hash, rows)),
    )
    mine = part_of(both, response)
    assert np.array_equal(mine.sigmas, poor.sigmas, equal_nan=True)
    write_report(path, response=response, diagnosis=both)
    with pytest.raises(DataError, match="want the diagnosis of this very response"):
        part_of(dataclasses.replace(both, responses=(("of another", 5),)), response)


def test_a_response_alone_makes_a_report(path: Path, response: OrderTrackedResponse) -> None:
    write_report(path, response=response)
    page = Page(path.read_text())
    assert page.first("h2") == "Measurement only"
    assert "Identified values" not in page.said()


def test_errors_against_the_simulated_rig_are_in_percent_and_in_sigma(page: Page) -> None:
    # kxx 34.21 +- 0.12 kN/m, truly 34.00: 0.21 / 34.00 and 0.21 / 0.12
    assert "34.21 ± 0.12 kN/m 33.98 to 34.45 kN/m 33.9 kN/m +0.9 % 34 kN/m +0.6 % +1.8 σ" in page.said()


def test_an_undetermined_parameter_is_said_to_be_and_its_bound_and_its_limit_are_named(page: Page) -> None:
    assert "cyy, damping, vertical not determined by this data above 62 N s/m 15 N s/m" in page.said()
    assert "at its upper bound of 1000 N s/m" in page.said()
    assert "inf" not in [words for _, words in page.words]


def test_critical_speeds_are_listed_with_their_margins(path: Path, response: OrderTrackedResponse) -> None:
    operating = SpeedWindow(3000 * np.pi / 30, 3200 * np.pi / 30)
    write_report(path, response=response, operating=operating)
    said = Page(path.read_text()).said()
    assert "Critical speeds" in said and "margin to 3000 to 3200 rpm" in said
    assert "25.5 %, wanted 15.4 %" in said  # 1 - 2234 / 3000; AF 12.4: 17 (1 - 1 / 10.9)


def test_what_the_data_cannot_tell_is_quoted(page: Page, identification: Identification) -> None:
    assert identification.fits[0].words[0] in page.said()


def test_the_search_shows_its_minima_its_stages_and_where_it_looked(page: Page) -> None:
    text = page.said()
    assert "f1 was searched by its value alone, with the chapter's algorithm: 4321 calls, converged" in text
    assert "11 generations of 1500, searched 2 clusters, reduced the bounds to 1 that were not convex" in text
    assert "minimum 1" in text
    assert "refined" in text
    assert "evaluated points" in text.lower()


def test_provenance_is_complete(page: Page) -> None:
    for word in ("0123456789abcdef", "fedcba9876543210", "run.mcap", "4321 evaluations", "seed 7", "12.3 s"):
        assert word in page.said()


def test_quoted_text_cannot_become_markup(
    path: Path, response: OrderTrackedResponse, identification: Identification, poor: Diagnosis
) -> None:
    evil = "</script><img src=http://x onerror=alert(1)>"
    rig = response.rig.model_copy(update={"name": evil, "notes": evil})
    runs = tuple(Run(name=evil, direction=run.direction) for run in response.runs)
    fit = dataclasses.replace(identification.fits[0], words=(evil,), objective=evil, stop=evil, name=evil)
    cause = dataclasses.replace(
        make_cause(evil, evil, chosen=True, evidence=1.0, after=1e-6),
        words=evil,
        parameters={evil: ParameterValue(value=1.0, unit=evil, sigma=0.1)},
    )
    diagnosis = dataclasses.replace(
        poor,
        sentence=evil,
        causes=(cause,),
        next_run=NextRun(kind=evil, words=evil, lam=1.0, separates=(evil,)),
        tied=((evil,),),
        character=evil,
        hidden=(HiddenEffect(effect=evil, smallest=1.0, unit=evil, missing=evil),),
        gain=dataclasses.replace(make_gain({evil: Shift(before=1.0, after=2.0, sigma=1.0, unit=evil)}), on=evil),
    )
    write_report(
        path,
        response=dataclasses.replace(response, rig=rig, runs=runs),
        identification=dataclasses.replace(identification, fits=(fit,), effects=(evil,)),
        diagnosis=diagnosis,
    )
    hostile = Page(path.read_text())
    assert "img" not in hostile.elements
    assert evil in hostile.said()
    assert not [link for link in hostile.links if "http" in link]


def test_nothing_is_fetched_and_every_picture_has_words(page: Page) -> None:
    assert [link for link in page.links if not link.startswith(("#", "data:,"))] == []
    assert page.unlabelled == []
    heard = [words for where, words in page.words if where == "p" and words.startswith("Bode plot of probe 1x, ")]
    assert "Run up: peak 18" in heard[0]  # 187.5 um, noise 0.3, no row just at the peak
    assert len(page.ids) == len(set(page.ids))


def test_a_report_of_a_typical_run_stays_below_four_megabytes(full: Path) -> None:
    assert full.stat().st_size < 4e6


def test_a_fit_of_another_response_is_refused(
    path: Path, response: OrderTrackedResponse, identification: Identification
) -> None:
    fit = dataclasses.replace(identification.fits[0], prediction=np.zeros((3, 4), dtype=complex))
    with pytest.raises(DataError, match=r"predicts \(speed, probe\) = \(3, 4\), the response has \(740, 4\)"):
        write_report(path, response=response, identification=dataclasses.replace(identification, fits=(fit,)))


def test_a_report_that_cannot_be_written_is_one_sentence(tmp_path: Path, response: OrderTrackedResponse) -> None:
    with pytest.raises(DataError, match="cannot be written"):
        write_report(tmp_path / "nowhere" / "report.html", response=response)


def test_without_a_slow_roll_the_vectors_stay_raw_and_the_report_says_so(
    path: Path, response: OrderTrackedResponse
) -> None:
    bare = dataclasses.replace(response, slow_roll=response.slow_roll * np.nan, slow_roll_omega=np.nan)
    write_report(path, response=bare)
    assert "No slow roll was measured" in Page(path.read_text()).said()
    assert curves(bare, 0)[0].amplitude == pytest.approx(np.abs(response.order(1.0)[response.run == 1, 0]) * 1e6)


def test_of_amplitudes_alone_no_phase_is_shown(tmp_path: Path, response: OrderTrackedResponse) -> None:
    alone = dataclasses.replace(response, amplitudes_alone=True, z=np.abs(response.z) + 0j)
    alone = dataclasses.replace(alone, slow_roll=np.full_like(response.slow_roll, np.nan))
    write_report(tmp_path / "r.html", response=alone)
    text = (tmp_path / "r.html").read_text()
    page = Page(text)
    assert "The table has amplitudes alone: no phase is known." in text
    assert not {"orbits", "full-spectrum", "polar-0"} & set(page.ids)
    peaks = [cell for tag, cell in page.words if tag == "td" and cell.endswith("°")]
    assert peaks == []
    assert "polar-0" in Page(_written(tmp_path, response)).ids


def _written(folder: Path, response: OrderTrackedResponse) -> str:
    write_report(folder / "whole.html", response=response)
    return (folder / "whole.html").read_text()


def test_a_cell_with_a_unit_of_its_own_is_no_amplitude_to_switch() -> None:
    page = table(
        "Misfits", ["where", "largest, µm 0-peak", "at"], [["1x", "3.2", "9"], ["gap", "7.7 µm of shift", "8"]]
    )
    assert re.findall(r"<td class=amplitude>([^<]*)</td>", page) == ["3.2"]
