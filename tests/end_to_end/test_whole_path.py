"""The commands a lab types, on a simulated rig behind real wires: sweep, track, identify, diagnose, report.

Everything runs as the installed `rotor`, in processes of its own; the sealed truth is opened after the diagnosis.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from rotorrig.acquisition.files.recording_mcap import read_recording
from rotorrig.processing.files.response_mcap import read_response
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import draw, expected_estimates
from rotorrig.sims.plant.sealed_truth import seal, unseal
from rotorrig.sims.plant.truth import FaultSpec

SEED = 11
BOW, AT = 45e-6, 3.6  # m and rad, against the unbalance: 1X of 500 um at most, and seen whatever the noise is


def rotor(*words: object) -> subprocess.CompletedProcess[str]:
    """Run the command as a shell would, with a terminal wide enough not to wrap."""
    command = [sys.executable, "-m", "rotorrig.app.cli", *map(str, words)]
    return subprocess.run(
        command, capture_output=True, text=True, timeout=240, env=_environment(), stdin=subprocess.DEVNULL
    )


def _environment() -> dict[str, str]:

    return {**os.environ, "COLUMNS": "200", "TERM": "dumb", "NO_COLOR": "1"}


def done(*words: object) -> str:
    """Run the command, which must succeed, and return what it printed."""
    result = rotor(*words)
    assert result.returncode == 0, f"rotor {' '.join(map(str, words))}: {result.stdout}{result.stderr}"
    assert "Traceback" not in result.stderr
    return result.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, hurried_rig: RigConfig) -> Path:
    folder = tmp_path_factory.mktemp("lab")
    (folder / "rig.toml").write_text(hurried_rig.text)
    return folder


@pytest.fixture(scope="module")
def healthy(folder: Path) -> Path:
    done("sweep", folder / "rig.toml", "--simulate", "--seed", SEED, "--out", folder / "run.mcap")
    done("track", folder / "run.mcap", "--out", folder / "response.mcap")
    done("identify", folder / "response.mcap", "--out", folder / "fit.json")
    done("diagnose", folder / "response.mcap", "--out", folder / "diagnosis.json")
    return folder


def test_a_sweep_over_the_wire_loses_no_sample(healthy: Path) -> None:
    response = read_response(healthy / "response.mcap")
    assert [run.name for run in response.runs] == ["slow roll", "up", "down"]
    assert response.usable.all()
    rpm = response.omega * 30 / 3.141592653589793
    assert rpm.min() < 245
    assert rpm.max() > 3550


def test_what_the_rig_hid_is_found(healthy: Path, hurried_rig: RigConfig) -> None:
    truth = expected_estimates(hurried_rig, draw(hurried_rig, seed=SEED))
    fits = json.loads((healthy / "fit.json").read_text())["fits"]
    assert len(fits) == 2
    for estimate in fits[0]["estimates"][:5]:
        off = abs(estimate["value"] - truth[estimate["name"]])
        assert off < 4 * estimate["sigma"], estimate
        if not estimate["name"].startswith("c"):  # of a rig whose damping changes by a tenth sigma alone says how well
            assert off < 0.05 * truth[estimate["name"]], estimate


def test_the_healthy_rig_is_called_adequate(healthy: Path) -> None:
    diagnosis = json.loads((healthy / "diagnosis.json").read_text())
    assert diagnosis["verdict"] == "adequate"


def test_the_report_stands_alone(healthy: Path) -> None:
    page = healthy / "report.html"
    done(
        "report",
        healthy / "response.mcap",
        "--fit",
        healthy / "fit.json",
        "--diagnosis",
        healthy / "diagnosis.json",
        "--out",
        page,
    )
    text = page.read_text()
    assert "describes this run" in text
    assert 'src="http' not in text


@pytest.mark.campaign
def test_replay_and_export_read_what_was_written(healthy: Path) -> None:
    assert "replayed" in done("replay", healthy / "run.mcap")
    done("export", healthy / "response.mcap", "--out", healthy / "vectors.csv")
    assert (healthy / "vectors.csv").read_text().count("\n") > 100


@pytest.mark.campaign
def test_a_sealed_bow_is_the_first_cause_and_extends_the_model(folder: Path, hurried_rig: RigConfig) -> None:
    sealed = folder / "sealed.json"
    hidden = FaultSpec(name="bow", parameters={"amount": BOW, "angle": AT})
    seal(draw(hurried_rig, seed=SEED + 1, faults=[hidden]), sealed)
    done("sweep", folder / "rig.toml", "--simulate", "--hidden", sealed, "--out", folder / "bad.mcap")
    done("track", folder / "bad.mcap", "--out", folder / "bad_response.mcap")
    extended = folder / "extended.toml"
    said = done("diagnose", folder / "bad_response.mcap", "--out", folder / "bad.json", "--rig-out", extended)
    assert "bow" in said
    diagnosis = json.loads((folder / "bad.json").read_text())
    first = diagnosis["causes"][0]
    assert first["name"] == unseal(sealed).faults[0].name == "bow"
    assert first["parameters"]["bow"]["value"] == pytest.approx(BOW, rel=0.3)  # the rig's shaft is bent otherwise
    again = folder / "again.json"
    done("diagnose", folder / "bad_response.mcap", "--config", extended, "--out", again)
    assert json.loads(again.read_text())["base"]["chi2"] < diagnosis["base"]["chi2"]


@pytest.mark.campaign
def test_ctrl_c_stops_the_rotor_and_keeps_what_was_recorded(folder: Path) -> None:
    command = [sys.executable, "-m", "rotorrig.app.cli", "sweep", str(folder / "rig.toml"), "--simulate", "--rate", "5"]
    process = subprocess.Popen(
        [*command, "--out", str(folder / "cut.mcap")], stderr=subprocess.PIPE, text=True, env=_environment()
    )
    part = folder / "cut.mcap.part"
    deadline = time.monotonic() + 60
    while not (part.exists() and part.stat().st_size > 200_000):
        assert time.monotonic() < deadline, "nothing was recorded"
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "the rotor is at rest" in said
    assert "Traceback" not in said
    recording = read_recording(folder / "cut.mcap")
    assert recording.complete
    assert recording.samples > 10_000
    assert any(event.kind == "abort" for event in recording.events)
