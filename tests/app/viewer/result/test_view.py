"""The result in the viewer: every tab drawn without a complaint, marks where closed forms put them."""

import dataclasses
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader
from rerun.experimental import ViewerClient

from rotorrig.acquisition.recording import RawRecording
from rotorrig.app.text.amplitude_units import AmplitudeUnit
from rotorrig.app.viewer.open import Evidence, as_rrd, save_view
from rotorrig.app.viewer.plots.residual import colour_sigmas
from rotorrig.app.viewer.plots.spectrum_map import HEIGHT, WIDTH, image_of
from rotorrig.app.viewer.result.cascade import tracked_cascades
from rotorrig.app.viewer.result.curves import draw_bodes
from rotorrig.app.viewer.result.data import result_of
from rotorrig.app.viewer.result.opening import opening_rpm, read_opening
from rotorrig.app.viewer.result.rotor import exaggeration
from rotorrig.app.viewer.result.text import colour_words, verdict_words
from rotorrig.app.viewer.result.view import application_of, write_result_rrd
from rotorrig.balancing import Balance, write_balance
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.identify.identification import Identification, ModelResonance
from rotorrig.identify.result_files import write_diagnosis, write_identification
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.units import RPM
from rotorrig.rig.errors import DataError
from tests.app.conftest import make_missing
from tests.app.headless import headless_viewer, marked, needs_vulkan, views
from tests.app.viewer.rrd_content import chunks, words_in
from tests.parameters import defer_rest

BLUE, ORANGE, RED, VIOLET = (74, 163, 223), (242, 142, 43), (200, 24, 66), (176, 132, 214)
PALE, GREEN, WHITE, WORDS = (250, 200, 140), (86, 196, 150), (240, 240, 240), (202, 216, 222)
PALE_BLUE = (158, 208, 244)
RESONANCE = (252, 200, 150)  # between the two brightest colours of a map
RAD = np.pi / 30
TABS = ("Overview", "Bode", "Polar", "Centreline", "Spectrum", "Balance", "Missing force", "Rotor")


@pytest.fixture(scope="module")
def saved(
    response: OrderTrackedResponse,
    poorly_fitted: Identification,
    named: Diagnosis,
    balanced: Balance,
    tmp_path_factory: pytest.TempPathFactory,
) -> Path:
    """The .rrd of a response, its fit, its diagnosis and its balance, from their files."""
    folder = tmp_path_factory.mktemp("result")
    write_response(folder / "response.mcap", response)
    write_identification(folder / "fit.json", poorly_fitted)
    write_diagnosis(folder / "diagnosis.json", dataclasses.replace(named, missing=make_missing()))
    write_balance(folder / "balance.json", balanced)
    evidence = Evidence(fit=folder / "fit.json", diagnosis=folder / "diagnosis.json", balance=folder / "balance.json")
    save_view(folder / "response.mcap", folder / "result.rrd", evidence)
    return folder / "result.rrd"


@pytest.fixture(scope="module")
def showing(saved: Path) -> Iterator[ViewerClient]:
    """A viewer with a result open, its cursor at the critical speed."""
    with headless_viewer() as viewer:
        viewer.open(str(saved))
        time.sleep(1.0)  # until its layout is there
        viewer.set_time(timeline="speed_rpm", sequence=2230, play_state="paused")
        yield viewer


def show_tab(viewer: ViewerClient, number: int) -> None:
    """Open a tab of the layout, counted from 0."""
    layout = viewer.get_blueprint(of="recording").blueprint
    (tabs,) = (c for part in layout.values() if (c := part.get("ContainerBlueprint", {})).get("active_tab"))
    tabs["active_tab"] = tabs["contents"][number]
    viewer.set_blueprint(layout, of="recording")
    time.sleep(0.5)


def test_the_words_beside_the_pictures_name_the_cause_and_what_it_bought(
    response: OrderTrackedResponse, named: Diagnosis
) -> None:
    words = verdict_words(result_of(response, None, named))
    assert words.index("**NAMED**") < words.index(named.causes[0].words)
    assert "| bow | 18.00 ± 0.30 µm at 110.0 ± 1.0° | 812 | 5.20 → 0.410 |" in words
    assert "error on unseen data, µm 0-peak |" in words
    in_mil = verdict_words(result_of(response, None, named, unit=AmplitudeUnit("mil pp")))
    assert "| 812 | 0.409 → 0.0323 |" in in_mil  # 5.2 and 0.41 um 0-peak
    assert "error on unseen data, mil pp |" in in_mil
    assert "1.03 times the noise floor" in words
    assert "A run with a trial mass" in words


def test_the_colours_named_are_those_there_are(response: OrderTrackedResponse, named: Diagnosis) -> None:
    assert "violet" in colour_words(result_of(response, None, named))
    assert "violet" not in colour_words(result_of(response))
    assert "slow-roll compensated" in colour_words(result_of(response))
    unknown = dataclasses.replace(response, slow_roll=np.full_like(response.slow_roll, np.nan))
    assert "compensated" not in colour_words(result_of(unknown))


def test_critical_speeds_are_marked_in_both_panels_with_their_amplification(
    response: OrderTrackedResponse, tmp_path: Path
) -> None:
    result, path = result_of(response), str(tmp_path / "bode.rrd")
    stream = rr.RecordingStream("bode")
    stream.save(path)
    (amplitude, lag), *_ = draw_bodes(stream, result)
    stream.disconnect()
    drawn = dict(chunks(Path(path)))
    (strips,) = drawn["/bode/1x/critical/lines"]["LineStrips2D:strips"].to_pylist()
    (words,) = drawn["/bode/1x/critical/words"]["Points2D:labels"].to_pylist()
    found = [each.measured for each in result.critical_speeds if each.probe == "1x"]
    assert len(strips) == 2 * len(found) == 2 * len(words) > 0
    for i, resonance in enumerate(found):
        rpm = resonance.omega.value * RPM
        for strip, panel in zip(strips[2 * i : 2 * i + 2], (amplitude, lag), strict=True):
            assert np.allclose(strip, panel.place([rpm, rpm], panel.y), atol=1e-3)
        assert f"{rpm:.0f} rpm, AF {resonance.amplification.value:.3g}" in words[i]
    assert "upright lines: critical speeds as measured" in colour_words(result)


def test_the_models_critical_speeds_are_marked_beside_those_measured(
    response: OrderTrackedResponse, named: Diagnosis, tmp_path: Path
) -> None:
    found = [each for each in result_of(response).critical_speeds if each.probe == "1x"]
    speeds = [each.measured.omega for each in found]
    higher = [
        dataclasses.replace(each.measured, omega=dataclasses.replace(omega, value=1.01 * omega.value))
        for each, omega in zip(found, speeds, strict=True)
    ]
    modelled = [
        ModelResonance(response=0, probe="1x", run=each.run, resonance=model)
        for each, model in zip(found, higher, strict=True)
    ]
    result, path = result_of(response, None, dataclasses.replace(named, resonances=tuple(modelled))), tmp_path / "b.rrd"
    stream = rr.RecordingStream("bode")
    stream.save(str(path))
    (amplitude, _), *_ = draw_bodes(stream, result)
    stream.disconnect()
    drawn = dict(chunks(path))
    (strips,) = drawn["/bode/1x/critical/lines"]["LineStrips2D:strips"].to_pylist()
    (words,) = drawn["/bode/1x/critical/words"]["Points2D:labels"].to_pylist()
    assert len(words) == 2 * len(found) > 0
    for i, model in enumerate(higher):
        rpm = model.omega.value * RPM
        assert np.allclose(strips[4 * i + 2], amplitude.place([rpm, rpm], amplitude.y), atol=1e-3)
        assert words[2 * i + 1].startswith(f"{found[i].run}, model: {rpm:.0f} rpm, AF")


def test_amplitudes_are_drawn_and_told_in_the_unit_asked_for(
    response: OrderTrackedResponse, balanced: Balance, tmp_path: Path
) -> None:
    in_mil, rrd = AmplitudeUnit("mil pp"), tmp_path / "result.rrd"
    write_result_rrd(rrd, response, balance=balanced, unit=in_mil)
    words = words_in(rrd)
    assert not [word for word in words if "µm" in word]
    for told in ("1x: 1X amplitude, slow-roll compensated, mil pp", "x, mil", "y, mil"):
        assert told in words
    stream = rr.RecordingStream("bode")
    stream.save(str(tmp_path / "bode.rrd"))
    result = result_of(response, unit=in_mil)
    (amplitude, _), *_ = draw_bodes(stream, result)
    stream.disconnect()
    run = result.sweeps[0]
    drawn = dict(chunks(tmp_path / "bode.rrd"))[f"/bode/1x/amplitude/{run}-measured"]
    (dots,) = drawn["Points2D:positions"].to_pylist()
    rows = response.run == run
    peak = np.nanmax(np.abs(result.z[rows, 0])) * 2 / 25.4e-6
    highest = amplitude.top + amplitude.height * (1 - peak / amplitude.y[1])
    assert min(y for _, y in dots) == pytest.approx(highest, abs=1e-3)
    assert peak < amplitude.y[1] < 3 * peak


def test_a_residual_of_eight_sigmas_is_red_and_what_was_not_measured_has_the_grids_colour() -> None:
    assert colour_sigmas(np.array([[8.0, 20.0, np.nan]])).tolist() == [[list(RED), list(RED), [58, 64, 72]]]


def test_a_deflection_is_drawn_larger_by_a_round_factor() -> None:
    assert exaggeration(60e-6, 0.05) == pytest.approx(800)  # 833 at the most
    assert exaggeration(2e-3, 0.05) == pytest.approx(20)  # 25 at the most


def test_with_the_recording_every_run_has_its_map_with_the_resonance_brightest(
    tracked: OrderTrackedResponse, recording: RawRecording
) -> None:
    result = result_of(tracked, recording=recording)
    assert [one.run for one in result.spectra] == ["up", "up", "down", "down"]
    for one in result.spectra:
        image = image_of(one)
        assert image.shape == (HEIGHT, WIDTH)
        row, column = np.unravel_index(np.argmax(image), image.shape)
        assert np.linspace(one.rpm.max(), one.rpm.min(), HEIGHT)[row] == pytest.approx(2230, rel=0.03)
        assert np.linspace(-250.0, 250.0, WIDTH)[column] == pytest.approx(2230 / 60, abs=5.0)  # Hz
        assert image.max() == one.largest[0]


def test_a_result_opens_at_its_largest_misfit(
    saved: Path, response: OrderTrackedResponse, named: Diagnosis, good: Diagnosis
) -> None:
    rows = [i for i in range(0, len(response.omega), 20) if response.run[i] == 1]
    steps = 20 * 3120 / 364  # rpm between these rows
    assert opening_rpm(result_of(response, None, named), rows) == pytest.approx((2100 + 2350) / 2, abs=steps / 2 + 1)
    elsewhere = dataclasses.replace(named.worst[0], speed_from=1000 * RAD, speed_to=1100 * RAD)
    assert opening_rpm(
        result_of(response, None, dataclasses.replace(named, worst=(elsewhere,))), rows
    ) == pytest.approx(1050, abs=steps / 2 + 1)
    assert opening_rpm(result_of(response, None, good), rows) == pytest.approx(2230, abs=steps / 2 + 1)  # the peak
    assert opening_rpm(result_of(response), []) is None
    assert read_opening(saved) == pytest.approx(2225, abs=30)


def test_a_file_that_says_nothing_of_its_opening_is_opened_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "broken.rrd").write_text("no recording")
    assert read_opening(tmp_path / "broken.rrd") is None


def test_without_the_recording_a_cascade_has_lines_at_the_orders_tracked(response: OrderTrackedResponse) -> None:
    rows = [100, 300]
    (_, order, amplitude), _ = tracked_cascades(result_of(response), rows)
    forward = np.abs(response.order(1.0)[rows, 0] + 1j * response.order(1.0)[rows, 1]) / 2
    assert order[[0, -1]] == pytest.approx([-4.0, 4.0])
    assert (np.diff(order) > 0).all()
    assert amplitude[:, order == 1.0].ravel() == pytest.approx(forward)
    assert set(order[(amplitude > 0).any(axis=0)]) == {-2.0, -1.0, 1.0, 2.0}


def test_a_diagnosis_of_another_response_is_one_sentence(
    tmp_path: Path, response: OrderTrackedResponse, named: Diagnosis
) -> None:
    write_response(tmp_path / "response.mcap", response)
    other = dataclasses.replace(named, responses=(("00" * 8, len(response.omega)),))
    write_diagnosis(tmp_path / "diagnosis.json", other)
    with pytest.raises(DataError, match="want the diagnosis of this very response"):
        as_rrd(tmp_path / "response.mcap", tmp_path, Evidence(diagnosis=tmp_path / "diagnosis.json"))
    with pytest.raises(DataError, match=r"want a name that ends in \.rrd"):
        save_view(tmp_path / "response.mcap", tmp_path / "result.html")


def test_a_fit_or_a_run_of_another_response_is_one_sentence(
    response: OrderTrackedResponse, identification: Identification, recording: RawRecording, balanced: Balance
) -> None:
    other = dataclasses.replace(response.source, source_hash="00" * 8)
    with pytest.raises(DataError, match="want the fit of this very response"):
        result_of(response, dataclasses.replace(identification, source=other))
    with pytest.raises(DataError, match="want the run of this very response"):
        result_of(response, recording=dataclasses.replace(recording, source=other))
    with pytest.raises(DataError, match="want the first response it was made of"):
        result_of(response, balance=dataclasses.replace(balanced, source=other))


def test_a_response_without_1x_is_one_sentence(response: OrderTrackedResponse) -> None:
    without = dataclasses.replace(
        response,
        orders=(0.0, 2.0),
        z=response.z[:, :, ::2],
        covariance=response.covariance[:, ::2],
        slow_roll=response.slow_roll[:, ::2],
        slow_roll_covariance=response.slow_roll_covariance[::2],
    )
    with pytest.raises(DataError, match="has the orders 0X, 2X, want 1X among them"):
        result_of(without)


def test_a_response_is_saved_with_what_was_made_of_it(saved: Path) -> None:
    entities = {str(chunk.entity_path) for chunk in RrdReader(str(saved)).stream()}
    bode = {"/bode/1x/amplitude/1-before", "/bode/1x/phase/1-model"}
    assert {"/residual/before/map", "/residual/after/map", *bode} <= entities
    assert {"/bode/1x/critical/lines", "/bode/1x/critical/words"} <= entities
    assert {"/missing/words", "/missing/force/backward/law", "/missing/force/forward/measured"} <= entities
    assert {"/missing/place/curve", "/missing/motion/law", "/missing/motion/measured"} <= entities


def test_results_of_different_layouts_go_by_different_names(
    response: OrderTrackedResponse, tracked: OrderTrackedResponse, recording: RawRecording, named: Diagnosis
) -> None:
    """Rerun keeps one layout per name, and would show a second result in that of the first."""
    modes = ["critical speed 2229 rpm"]
    alone, whole = result_of(response), result_of(response, None, named)
    assert len({application_of(alone, modes), application_of(whole, modes), application_of(alone, [])}) == 3
    assert application_of(alone, modes) == application_of(result_of(response), list(modes))
    recorded = result_of(tracked, recording=recording)
    assert application_of(recorded, modes) != application_of(result_of(tracked), modes)
    found, read = make_missing(), make_missing(places=np.zeros(0), over_speed=None)
    one, other = (result_of(response, None, dataclasses.replace(named, missing=missing)) for missing in (found, read))
    assert application_of(one, modes) != application_of(other, modes)


@pytest.mark.viewer
@needs_vulkan
@pytest.mark.parametrize(
    ("tab", "wanted"),
    defer_rest([
        (
            "Overview",
            {
                "Verdict": (WORDS, 300), "Colours": (WORDS, 300), "Orbit 1x, 1y": (WHITE, 20),
                "Orbit 2x, 2y": (PALE_BLUE, 200), "Bode": (PALE, 50),
                "Residual 1X, sigmas of the noise: before": (RED, 500),
                "Residual 1X, sigmas of the noise: after": (WORDS, 20),
            },
        ),
        ("Bode", {f"Bode 1X, probe {probe}": (VIOLET, 30) for probe in ("1x", "1y", "2x", "2y")}),
        ("Polar", {f"Polar 1X, probe {probe}": (WHITE, 8) for probe in ("1x", "1y", "2x", "2y")}),
        (
            "Centreline",
            {"Shaft centreline: 1x": (WHITE, 5), "Shaft centreline: 2x": (WHITE, 5), "Gap": (ORANGE, 100)},
        ),
        (
            "Spectrum",
            {
                "Full spectrum over speed: 1x": (BLUE, 1000), "Full spectrum over speed: 2x": (BLUE, 1000),
                "Forward and backward whirl: 1x": (GREEN, 200), "Forward and backward whirl: 2x": (GREEN, 200),
            },
        ),
        (
            "Balance",
            {"Correction": (WORDS, 300)}
            | {f"Before and as predicted after, probe {probe}": (VIOLET, 30) for probe in ("1x", "1y", "2x", "2y")},
        ),
        (
            "Missing force",
            {
                "What is missing": (WORDS, 300), "The missing force over speed": (GREEN, 100),
                "Its place along the shaft": (GREEN, 100), "The missing force over the motion": (PALE_BLUE, 100),
            },
        ),
        ("Rotor", {"1X deflection": (GREEN, 300), "critical speed 22": (WORDS, 20)}),
    ]),
)  # fmt: skip
def test_every_view_of_a_tab_is_drawn(
    showing: ViewerClient,
    tmp_path: Path,
    tab: str,
    wanted: dict[str, tuple[tuple[int, int, int], int]],
) -> None:
    show_tab(showing, TABS.index(tab))
    seen = views(showing, tmp_path, but_hidden=True)
    for start, (colour, least) in wanted.items():
        drawn = [picture for name, picture in seen.items() if name.startswith(start)]
        assert drawn, f"no view of {list(seen)} is called {start}.."
        for picture in drawn:
            assert marked(picture, colour, within=40).sum() > least, start


@pytest.mark.viewer
@needs_vulkan
def test_the_maps_of_a_recording_are_drawn_beside_the_whirl(
    tmp_path: Path, tracked: OrderTrackedResponse, recording: RawRecording
) -> None:
    write_result_rrd(tmp_path / "recorded.rrd", tracked, recording=recording)
    with headless_viewer() as viewer:
        viewer.open(str(tmp_path / "recorded.rrd"))
        time.sleep(1.0)
        show_tab(viewer, TABS.index("Spectrum"))
        seen = views(viewer, tmp_path, but_hidden=True)
    maps = {name: picture for name, picture in seen.items() if name.startswith("Cascade")}
    assert {name[:14] for name in maps} == {"Cascade up: 1x", "Cascade down: ", "Cascade up: 2x"}
    for name, picture in maps.items():
        assert marked(picture, RESONANCE, within=40).sum() > 20, name
    assert sum(name.startswith("Forward and backward whirl") for name in seen) == 2
