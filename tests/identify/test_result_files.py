"""fit.json and diagnosis.json come back as they went, are strict JSON, and refuse other files in one sentence."""

import json
import math
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from rotorrig.identify.adequacy.misfit import Misfit
from rotorrig.identify.diagnosis import Diagnosis, Verdict
from rotorrig.identify.discovery import ForceOverSpeed, MissingForce, Rival
from rotorrig.identify.identification import (
    Direction,
    Estimate,
    Fit,
    Identification,
    ModelResonance,
    Optimum,
    SearchTrace,
    Stage,
)
from rotorrig.identify.result_files import read_diagnosis, read_identification, write_diagnosis, write_identification
from rotorrig.identify.verdict.cause import Cause, ParameterValue
from rotorrig.identify.verdict.gain import Gain, Shift
from rotorrig.identify.verdict.next_run.choice import NextRun
from rotorrig.identify.verdict.verdict import HiddenEffect
from rotorrig.processing.resonance import Resonance, Uncertain
from rotorrig.rig.errors import DataError
from rotorrig.rig.provenance import Provenance

SOURCE = Provenance(config_hash="a" * 16, code_version="0", source="run.mcap", source_hash="b" * 16)
Z = np.array([[1.5e-6 + 2e-6j, np.nan], [0.25 - 1j, 0]])
PEAK = ModelResonance(
    response=1,
    run="down",
    probe="2x",
    resonance=Resonance(
        omega=Uncertain(value=237.5, sigma=0.125),
        amplitude=Uncertain(value=2e-4, sigma=math.nan),
        lower=None,
        upper=Uncertain(value=243.75, sigma=0.25),
        amplification=None,
        damping=None,
    ),
)
FOUND = Identification(
    fits=(
        Fit(
            name="whole sweep",
            band=(50.0, 377.0),
            estimates=(
                Estimate(
                    name="kxx",
                    value=33900.0,
                    sigma=120.5,
                    unit="N/m",
                    nameplate=34000.0,
                    bounds=(1e2, 1e6),
                    interval=(33.6e3, 34.2e3),
                    interval_by="covariance",
                ),
                Estimate(name="cyy", value=1.0, sigma=math.inf, unit="N s/m", nameplate=math.nan, determined=False),
            ),
            nuisances=(Estimate(name="gain 1x", value=0.01, sigma=0.005, unit="", nameplate=0.0),),
            unknowns=("kxx", "kyy", "cxx", "cyy", "u"),
            optima=(Optimum(theta=(1.0, 2.0, 3.0, 4.0, 5.0), cost=0.5),),
            objective="f2",
            evaluations=1234,
            stop="converged",
            seed=3,
            chi2=1000.0,
            dof=990,
            prediction=Z,
            resonances=(PEAK,),
            directions=(
                Direction(weights={"kxx": 0.6, "cyy": -0.8}, sigma=math.inf, sigma_of_noise=0.25),
                Direction(weights={"kxx": 0.8, "cyy": 0.6}, sigma=0.01, sigma_of_noise=0.005),
            ),
            trace=SearchTrace(
                method="seed",
                stages=(Stage(name="genetic", steps=12, evaluations=900), Stage(name="far", steps=1, evaluations=334)),
                reduced=1,
                heads=np.array([[1.0, 2.0, 3.0, 4.0, 5.0]]),
                points=np.array([[1.0, 2.0, 3.0, 4.0, 5.0], [2.0, 3.0, 4.0, 5.0, 6.0]]),
            ),
            budget={"kxx": {"noise": 0.75, "E": 0.25}, "cyy": {"noise": 1.0, "E": 0.0}},
            words=("cyy ran into its bound",),
        ),
    ),
    effects=(),
    wall_s=1.25,
    source=SOURCE,
)
VERDICT = Diagnosis(
    verdict=Verdict.UNEXPLAINED,
    sentence="The model is NOT adequate",
    false_alarm_rate=0.05,
    noise_floor=1e-8,
    chi2=5000.0,
    dof=1000,
    p=0.0,
    resonances=(PEAK,),
    worst=(
        Misfit(
            run="up",
            probe="1x",
            order=2.0,
            speed_from=100.0,
            speed_to=120.0,
            sigma=38.0,
            residual=4e-6,
            relative=math.nan,
            phase=math.nan,
            sentence="probe 1x shows 2X",
        ),
    ),
    model="quasi-static",
    causes=(
        Cause(
            label="runout, plane 2",
            effect="runout",
            where="plane 2",
            title="probe runout",
            words="the track of plane 2 runs out by 3 um",
            chosen=True,
            plausible=False,
            evidence=120.5,
            lam=135.0,
            heldout_before=5e-6,
            heldout_after=math.nan,
            parameters={"runout": ParameterValue(value=3e-6, unit="m", sigma=math.inf)},
            theta={"runout re": 3e-6, "runout im": 0.0},
            sigmas={"runout re": math.inf, "runout im": 1e-8},
        ),
    ),
    tied=(("runout, plane 2", "bow"), ("delay", "probe_angle, 1x")),
    next_run=NextRun(
        kind="trial mass",
        words="Add a mass.",
        lam=40.0,
        separates=("bow",),
        top=400.0,
        ramp=3.0,
        speeds=(150.0, 210.5),
        minutes=6.5,
        trial=("disk: 12 g mm at 90 deg",),
        share_of_limit=0.4,
    ),
    gain=Gain(
        heldout_before=5e-6,
        heldout_after=2.2e-6,
        noise_floor=2e-6,
        on="blocks of speeds in turn",
        base={"kxx": Shift(before=1.0, after=2.0, sigma=0.5, unit="N/m")},
    ),
    hidden=(
        HiddenEffect(effect="couple", smallest=1e-3, unit="rad", missing="a second plane"),
        HiddenEffect(effect="delay", smallest=math.inf, unit="s", missing=""),
    ),
    missing=MissingForce(
        kind="force",
        words="at 480 ± 4 mm from the coupling acts a force against the motion",
        laws=("stiffness", "damping"),
        like=("a stiffness",),
        place=0.48,
        place_sigma=0.004,
        places=np.array([0.47, 0.48, 0.49]),
        probability=np.array([0.25, 0.5, 0.25]),
        rivals=(Rival(words="probe 2x reads besides", evidence=12.5),),
        over_speed=ForceOverSpeed(
            omega=np.array([100.0, 200.0]),
            force=np.array([[1 + 2j, 0.1j], [3 - 1j, 0.2]]),
            sigma=np.array([[0.1, 0.1], [0.2, 0.1]]),
            law=np.array([[1 + 1j, 0j], [3 + 0j, 0j]]),
            motion=np.array([[1e-6 + 0j, 1e-7j], [2e-6j, 0j]]),
            recording=1,
        ),
        shortfall="",
    ),
    character="strongest at 2X",
    extended_residual=Z[:, :, None],
    extended_sigmas=np.abs(Z)[:, :, None],
    responses=(("b" * 16, 2),),
    residual=Z[:, :, None],
    sigmas=np.abs(Z)[:, :, None],
    source=SOURCE,
)


def equal(a: object, b: object) -> bool:
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and np.allclose(a, b, rtol=1e-6, atol=0, equal_nan=True)
    if isinstance(a, float):
        return isinstance(b, float) and (a == b or (math.isnan(a) and math.isnan(b)))
    if isinstance(a, tuple):
        return isinstance(b, tuple) and len(a) == len(b) and all(map(equal, a, b))
    if isinstance(a, dict) and isinstance(b, dict):
        return list(a) == list(b) and all(equal(a[key], b[key]) for key in a)
    if hasattr(a, "__dataclass_fields__"):
        return type(a) is type(b) and all(equal(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    return a == b


def test_an_identification_comes_back(tmp_path: Path) -> None:
    write_identification(tmp_path / "fit.json", FOUND)
    assert equal(read_identification(tmp_path / "fit.json"), FOUND)


def test_a_file_from_before_bearing_sets_is_read(tmp_path: Path) -> None:
    write_identification(tmp_path / "fit.json", FOUND)
    table = json.loads((tmp_path / "fit.json").read_text())
    for key in ("unknowns", "directions", "budget"):
        del table["fits"][0][key]
    for estimate in table["fits"][0]["estimates"] + table["fits"][0]["nuisances"]:
        del estimate["bounds"]
    (tmp_path / "fit.json").write_text(json.dumps(table))
    fit = read_identification(tmp_path / "fit.json").fits[0]
    assert fit.unknowns == ("kxx", "kyy", "cxx", "cyy", "u")
    assert fit.directions == ()
    assert fit.estimates[0].bounds is None


def test_a_diagnosis_comes_back(tmp_path: Path) -> None:
    write_diagnosis(tmp_path / "diagnosis.json", VERDICT)
    assert equal(read_diagnosis(tmp_path / "diagnosis.json"), VERDICT)


def test_a_reading_that_was_found_has_no_place_nor_force(tmp_path: Path) -> None:
    assert VERDICT.missing is not None
    nowhere = {"place": math.nan, "place_sigma": math.nan, "places": np.zeros(0), "probability": np.zeros(0)}
    reading = replace(VERDICT.missing, kind="reading", over_speed=None, shortfall="it leaves 40 %", **nowhere)
    write_diagnosis(tmp_path / "diagnosis.json", replace(VERDICT, missing=reading))
    found = read_diagnosis(tmp_path / "diagnosis.json").missing
    assert equal(found, reading) and found is not None and not found.is_described


def test_a_diagnosis_from_before_discovery_is_read(tmp_path: Path) -> None:
    write_diagnosis(tmp_path / "diagnosis.json", VERDICT)
    table = json.loads((tmp_path / "diagnosis.json").read_text())
    del table["missing"]
    (tmp_path / "diagnosis.json").write_text(json.dumps(table))
    assert read_diagnosis(tmp_path / "diagnosis.json").missing is None


def test_the_files_are_strict_json_with_the_documented_keys(tmp_path: Path) -> None:
    write_diagnosis(tmp_path / "diagnosis.json", VERDICT)

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    table = json.loads((tmp_path / "diagnosis.json").read_text(), parse_constant=refuse)
    assert table["version"] == 2
    document = (Path(__file__).parents[2] / "docs/results.md").read_text()
    documented = document.partition("## diagnosis.json")[2]
    for key in (*table, *table["causes"][0], *table["base"]):
        assert f"`{key}`" in document if key in ("kind", "version", "conventions", "source") else key in documented
    assert set(table["base"]) == {"chi2", "dof", "p", "worst"}


def test_what_is_not_finite_in_a_table_is_null(tmp_path: Path) -> None:
    assert VERDICT.gain is not None
    kxx = Shift(before=1.0, after=np.float64(math.nan), sigma=math.inf, unit="N/m")
    gain = replace(VERDICT.gain, heldout_after=math.inf, base={"kxx": kxx})
    write_diagnosis(tmp_path / "diagnosis.json", replace(VERDICT, gain=gain, chi2=np.float64(3.0)))
    table = json.loads((tmp_path / "diagnosis.json").read_text())
    assert table["gain"]["heldout_after"] is table["gain"]["over_noise_floor"] is None
    assert table["gain"]["base"] == {"kxx": {"before": 1.0, "after": None, "sigma": None, "unit": "N/m"}}
    assert table["base"]["chi2"] == 3
    assert [effect["smallest"] for effect in table["hidden"]] == [1e-3, None]


def test_the_typed_parts_are_the_tables_that_are_documented(tmp_path: Path) -> None:
    write_diagnosis(tmp_path / "diagnosis.json", VERDICT)
    table = json.loads((tmp_path / "diagnosis.json").read_text())
    assert table["next_run"] == {
        "kind": "trial mass",
        "words": "Add a mass.",
        "lam": 40.0,
        "separates": ["bow"],
        "top": 400.0,
        "ramp": 3.0,
        "speeds": [150.0, 210.5],
        "minutes": 6.5,
        "trial": ["disk: 12 g mm at 90 deg"],
        "share_of_limit": 0.4,
    }
    assert list(table["gain"]) == ["heldout_before", "heldout_after", "noise_floor", "over_noise_floor", "on", "base"]
    assert table["gain"]["over_noise_floor"] == pytest.approx(1.1)
    assert table["hidden"][0] == {"effect": "couple", "smallest": 1e-3, "unit": "rad", "missing": "a second plane"}


def test_what_was_not_made_is_an_empty_table(tmp_path: Path) -> None:
    write_diagnosis(tmp_path / "diagnosis.json", replace(VERDICT, next_run=None, gain=None, hidden=()))
    table = json.loads((tmp_path / "diagnosis.json").read_text())
    assert (table["next_run"], table["gain"], table["hidden"]) == ({}, {}, [])
    back = read_diagnosis(tmp_path / "diagnosis.json")
    assert (back.next_run, back.gain, back.hidden) == (None, None, ())


def test_a_diagnosis_of_the_first_version_is_to_be_made_anew(tmp_path: Path) -> None:
    path = tmp_path / "diagnosis.json"
    write_diagnosis(path, VERDICT)
    path.write_text(path.read_text().replace('"version": 2', '"version": 1'))
    with pytest.raises(DataError, match="has version 1, this program reads 2"):
        read_diagnosis(path)


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{", '{"kind": "rotorrig fit"}', '{"kind": "rotorrig fit", "version": 1, "fits": [{}]}', "[" * 10**5],
)
def test_another_file_is_refused_in_one_sentence(tmp_path: Path, text: str) -> None:
    path = tmp_path / "fit.json"
    path.write_text(text)
    with pytest.raises(DataError, match=r"fit\.json: ") as caught:
        read_identification(path)
    assert "\n" not in str(caught.value)
