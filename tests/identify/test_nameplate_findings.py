"""Rigs of the blind plant put together otherwise than their config says: what is found of it, and what is not."""

from pathlib import Path

import pytest

from benchmarks.parts.blind.run import record
from rotorrig.identify.base_fit.fit import identify
from rotorrig.identify.diagnosis import Diagnosis, Verdict, diagnose
from rotorrig.identify.result_files import read_diagnosis, read_identification, write_diagnosis, write_identification
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.sims.effects.base import catalogue
from rotorrig.sims.plant.truth import Geometry

TRIED = {"delay", "skew_stiffness", "unbalance_plane", "probe_gain", "probe_angle"}
DISK, BRACKET = 7e-3, -5e-3  # m
PLACES = {"disk_position, disk", "bearing_position, left B", "bearing_position, left A"}  # a span is longer or shorter
WITHIN = 1.96  # standard deviations: 95 %


def with_priors(rig: RigConfig, *keys: str) -> RigConfig:
    old = "[prior] "
    assert old in rig.text
    before, _, after = rig.text.partition(old)
    head, _, rest = after.partition("\n")
    return parse("\n".join([f"{before}{old}{head}", *keys, rest]), where="careful rk4.toml")


def swept(rig: RigConfig, geometry: Geometry) -> OrderTrackedResponse:
    return track(record(rig, seed=7, geometry=geometry, unmodelled=False))


def judged(response: OrderTrackedResponse) -> Diagnosis:
    every = {effect.name for effect in catalogue(response.rig)}
    return diagnose([response], without=every - TRIED)


@pytest.fixture(scope="module")
def off(hurried_rig: RigConfig) -> OrderTrackedResponse:
    """The disk sits elsewhere, on a rig whose positions are said to be known to 0.3 mm."""
    return swept(with_priors(hurried_rig, 'position = "0.3 mm"'), Geometry(disk_shifts=(DISK,)))


@pytest.fixture(scope="module")
def found(off: OrderTrackedResponse) -> Diagnosis:
    return judged(off)


def test_a_disk_that_sits_elsewhere_is_named_with_where_it_is(found: Diagnosis) -> None:
    assert found.sentence.startswith("The config is wrong here: ")
    assert "the disk sits " in found.sentence
    assert "mm further from the coupling than the config says" in found.sentence
    (disk,) = [cause for cause in found.causes if cause.label == "disk_position, disk"]
    assert disk.nameplate
    assert abs(disk.theta["off"] - DISK) < WITHIN * disk.sigmas["off"] < DISK


def test_it_is_the_one_finding_tied_with_what_else_would_explain_it(found: Diagnosis) -> None:
    """A bearing nearer to the coupling lengthens the span as a disk further from it does: which is first is chance."""
    (finding,) = found.nameplate.findings
    assert finding.group == found.nameplate.pulls[0].group == "positions"
    assert finding.sigmas > 4
    told = {each.label: each for each in (finding.deviation, *finding.alternatives)}
    assert {"disk_position, disk", "bearing_position, left B"} <= told.keys() <= PLACES
    assert told["disk_position, disk"].nameplate == pytest.approx(0.2805)
    assert found.verdict is Verdict.TIED
    ((first, *others),) = found.tied
    assert (first, {first, *others}) == (finding.deviation.label, told.keys())
    assert "; or " in found.sentence
    assert "bearing left B sits" in found.sentence


@pytest.mark.campaign
def test_two_probes_in_a_bracket_move_together(hurried_rig: RigConfig) -> None:
    """On a rig that is its model but for that, and says so: one statement, tied with what would explain as much.

    A small unbalance elsewhere has evidence of 33.39, the bracket of 33.32, and no other statement is off beside it.
    """
    exact = with_priors(
        hurried_rig,
        'position = "0.3 mm"',
        "model_error = 0",
        "repeatability = 0",
        "harmonic_error = 0",
        "damping_over_speed = 0",
        'mark_radius = "10 m"',
    )
    found = judged(swept(exact, Geometry(probe_shifts=(0.0, 0.0, BRACKET, BRACKET))))
    assert found.verdict is Verdict.TIED
    (group,) = found.tied
    (cause,) = [cause for cause in found.causes if cause.nameplate]
    assert cause.label == "probe_position, 2x"
    assert cause.label in group
    assert cause.words.startswith("probes 2x and 2y sit ")
    assert cause.words.endswith("mm nearer to the coupling than the config says")
    assert abs(cause.theta["off"] - BRACKET) < WITHIN * cause.sigmas["off"] < abs(BRACKET) / 2


def test_a_diagnosis_with_findings_comes_back_from_its_file(found: Diagnosis, tmp_path: Path) -> None:
    write_diagnosis(tmp_path / "d.json", found)
    back = read_diagnosis(tmp_path / "d.json")
    assert back.nameplate == found.nameplate
    assert back.causes[0].nameplate


@pytest.mark.campaign
def test_an_identification_finds_it_too(off: OrderTrackedResponse, tmp_path: Path) -> None:
    found = identify([off])
    whole = found.fits[0]
    assert whole.adequate
    assert whole.p > 0.01
    (finding,) = whole.nameplate.findings
    assert "disk_position, disk" in {each.label for each in (finding.deviation, *finding.alternatives)} <= PLACES
    pulls = {nuisance.name: nuisance.pull for nuisance in whole.nuisances}
    assert pulls["position disk disk"] > 3 > abs(pulls["gain 1x"])
    write_identification(tmp_path / "f.json", found)
    back = read_identification(tmp_path / "f.json").fits[0]
    assert (back.nameplate, back.p, back.adequate) == (whole.nameplate, whole.p, whole.adequate)


@pytest.mark.campaign
def test_ordinary_deviations_are_no_finding(hurried_rig: RigConfig) -> None:
    """Everything one standard deviation off, this way or that."""
    ordinary = Geometry(
        disk_shifts=(-1e-3,),
        bearing_shifts=(1e-3, -1e-3, 1e-3),
        probe_shifts=(1e-3, 1e-3, -1e-3, -1e-3),
        diameter_factor=1.002,
        hub_factors=(1.05,),
        tilt_stiffnesses=(20.0, 20.0, 20.0),
    )
    found = judged(swept(hurried_rig, ordinary))
    assert found.verdict is Verdict.ADEQUATE
    assert found.nameplate.findings == ()
    assert max(pull.sigmas for pull in found.nameplate.pulls) < 3
