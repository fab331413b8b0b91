"""Bode tables of another group's generator through the commands: import, diagnose, report."""

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.conftest import CONFIGS
from tests.end_to_end.numpy_rotor import Hidden, mapping, ramped, table, vectors, with_noise, write

TRIAL = 12e-6j
WITH_TRIAL = 'direction = "up"\ntrial = [{ disk = "disk", amount = "12 g mm", angle = "90 deg" }]'


def rotor(*words: object) -> str:
    """Run the command as a shell would; it must succeed. Return what it printed."""
    environment = {**os.environ, "COLUMNS": "400", "TERM": "dumb", "NO_COLOR": "1"}
    result = subprocess.run(
        [sys.executable, "-W", "error::RuntimeWarning", "-m", "rotorrig.app.cli", *map(str, words)],
        capture_output=True,
        text=True,
        timeout=400,
        env=environment,
        stdin=subprocess.DEVNULL,
    )
    assert result.returncode == 0, f"rotor {' '.join(map(str, words))}: {result.stdout}{result.stderr}"
    assert "Traceback" not in result.stderr
    return result.stdout


def imported(folder: Path, csv: str, toml: str, *, name: str = "table") -> Path:
    """Import a table; return the response's path."""
    csv_path, toml_path = write(folder, csv, toml, name=name)
    response = folder / f"{name}.mcap"
    rotor("import", csv_path, "--config", CONFIGS / "rk4.toml", "--mapping", toml_path, "--out", response)
    return response


def diagnosed(*responses: Path) -> tuple[dict[str, Any], str]:
    """Diagnose; return diagnosis.json and what was printed."""
    out = responses[0].with_name("diagnosis.json")
    said = rotor("diagnose", *responses, "--out", out)
    return json.loads(out.read_text()), said


def bare_and_trial(hidden: Hidden, rpm: np.ndarray, planes: tuple[str, ...]) -> tuple[str, str]:
    """Return table and mapping of a run without and one with a trial mass; no ramp, no turns, no slow roll known."""
    rng = np.random.default_rng(1)
    runs = {
        "bare": (rpm, with_noise(vectors(rpm, hidden, planes=planes), rng)),
        "trial": (rpm, with_noise(vectors(rpm, hidden, planes=planes, trial=TRIAL), rng)),
    }
    return table(runs), mapping({"bare": 'direction = "up"', "trial": WITH_TRIAL}, planes=planes)


CASES = {
    "a bow in one plane": (
        Hidden(bow=22e-6),
        np.linspace(480, 3600, 80),
        ("1",),
        {"runout, plane 1", "bow", "coupling"},
    ),
    "a late probe of two planes, at low speeds": (
        Hidden(delay={"1y": 1e-3}),
        np.linspace(480, 1500, 80),
        ("1", "2"),
        {"delay, probe 1y", "probe_angle, probe 1y", "delay, probe 2y"},
    ),
}


@pytest.mark.campaign
@pytest.mark.parametrize("case", CASES)
def test_tied_causes_of_a_table_that_tells_no_times_come_with_a_next_run_and_what_it_supposes(
    tmp_path: Path, case: str
) -> None:
    hidden, rpm, planes, tied = CASES[case]
    response = imported(tmp_path, *bare_and_trial(hidden, rpm, planes))
    diagnosis, said = diagnosed(response)
    assert diagnosis["verdict"] == "tied"
    assert set(diagnosis["tied"][0]) == tied
    run = diagnosis["next_run"]
    assert set(run["separates"]) == tied
    assert math.isfinite(run["lam"]) and run["lam"] > 0
    assert run["words"] in said
    assert "Assumed, as the recording does not say: a ramp of 30 rpm/s" in run["words"]
    assert "no slow roll" in run["words"]
    if planes == ("1",):
        assert run["kind"] == "second plane"
        assert "with 2x and 2y" in run["words"], "the config has a second plane, the table does not"
    page = tmp_path / "report.html"
    rotor("report", response, "--diagnosis", tmp_path / "diagnosis.json", "--out", page)
    assert "Assumed, as the recording does not say: a ramp of 30 rpm/s" in page.read_text()


def identified(response: Path) -> dict[str, Any]:
    """Identify; return the whole sweep's fit, its estimates by name."""
    out = response.with_suffix(".json")
    rotor("identify", response, "--out", out)
    fit = json.loads(out.read_text())["fits"][0]
    return {**fit, "estimates": {each["name"]: each for each in fit["estimates"]}}


def misfit(fit: dict[str, Any]) -> float:
    return fit["chi2"] / fit["dof"]


def off(fit: dict[str, Any], name: str, truth: float) -> float:
    """Return by how many of its own standard deviations an estimate is off."""
    return abs(fit["estimates"][name]["value"] - truth) / fit["estimates"][name]["sigma"]


@pytest.fixture(scope="module")
def up_and_down() -> dict[str, tuple[np.ndarray, dict[str, np.ndarray]]]:
    """A run-up and a run-down at 500 rpm/s, integrated in time: the peak comes late and low."""
    rng = np.random.default_rng(3)
    runs = {"up": ramped(700, 3300, 500, turns=8), "down": ramped(3300, 700, 500, turns=8)}
    return {name: (rpm, with_noise(read, rng)) for name, (rpm, read) in runs.items()}


@pytest.mark.campaign
def test_a_stated_ramp_puts_the_moving_speed_into_the_model(
    tmp_path: Path, up_and_down: dict[str, tuple[np.ndarray, dict[str, np.ndarray]]]
) -> None:
    hann, ramp = 'window = "hann"', 'ramp = "500 rpm/s"\nrevolutions = 8'
    told = mapping({name: f'direction = "{name}"\n{ramp}' for name in up_and_down}, top=hann)
    untold = mapping({name: f'direction = "{name}"' for name in up_and_down}, top=hann)
    fit = identified(imported(tmp_path, table(up_and_down), told))
    assert misfit(fit) < 1.2
    for name, truth in (("kxx", 33.9e3), ("kyy", 34.6e3), ("cxx", 15.0), ("u", 15e-6)):
        assert off(fit, name, truth) < 3, name
    steady = identified(imported(tmp_path, table(up_and_down), untold, name="steady"))
    assert misfit(steady) > 100, "without it the speeds are taken as steady"


def test_without_the_number_of_turns_a_row_is_one_and_the_import_says_so(
    tmp_path: Path, up_and_down: dict[str, tuple[np.ndarray, dict[str, np.ndarray]]]
) -> None:
    lines = {name: f'direction = "{name}"\nramp = "500 rpm/s"' for name in up_and_down}
    csv, toml = write(tmp_path, table(up_and_down), mapping(lines))
    out = tmp_path / "r.mcap"
    said = rotor("import", csv, "--config", CONFIGS / "rk4.toml", "--mapping", toml, "--out", out)
    assert "Note: times were derived from the speeds, and the model follows the moving speed" in said
    assert "Note: one turn supposed: the table gives a ramp but not over how many turns a row was averaged" in said


COMPENSATED = 1300.0  # rpm, of a hasty slow roll: 0.6 of the critical speed


def without_slow_roll(rpm: np.ndarray, hidden: Hidden) -> tuple[dict[str, np.ndarray], dict[str, complex]]:
    """Return the vectors of two planes less those at 1300 rpm, and these."""
    planes = ("1", "2")
    taken = {name: z[0] for name, z in vectors(np.array([COMPENSATED]), hidden, planes=planes).items()}
    read = with_noise(vectors(rpm, hidden, planes=planes), np.random.default_rng(4))
    return {name: z - taken[name] for name, z in read.items()}, taken


@pytest.mark.campaign
def test_a_compensated_table_with_its_vectors_is_that_of_the_raw_ones(tmp_path: Path) -> None:
    rpm, hidden = np.linspace(600, 3600, 80), Hidden(bow=22e-6, runout={"1": 9e-6j})
    read, taken = without_slow_roll(rpm, hidden)
    stated = f'[slow_roll]\nspeed = "{COMPENSATED} rpm"\n' + "".join(
        f'[[slow_roll.vectors]]\nprobe = "{name}"\namplitude = "{abs(z) * 1e6} um"\nphase = "{np.angle(z)} rad"\n'
        for name, z in taken.items()
    )
    raw = {name: z + taken[name] for name, z in read.items()}
    up = {"up": 'direction = "up"'}
    fits = [
        identified(imported(tmp_path, table({"up": (rpm, vectors)}), toml + stated, name=name))
        for name, vectors, toml in (
            ("raw", raw, mapping(up, planes=("1", "2"))),
            ("compensated", read, mapping(up, planes=("1", "2"), top="compensated = true")),
        )
    ]
    for name, estimate in fits[0]["estimates"].items():
        assert fits[1]["estimates"][name]["value"] == pytest.approx(estimate["value"], abs=0.02 * estimate["sigma"])


@pytest.mark.campaign
def test_compensated_by_a_vector_nobody_kept_the_model_subtracts_its_own(tmp_path: Path) -> None:
    """The prior of runout is made small: else it takes over what was subtracted, to within 4 um."""
    rpm, up = np.linspace(600, 3600, 80), {"up": 'direction = "up"'}
    read, _ = without_slow_roll(rpm, Hidden(runout={"1": 9e-6j, "2": 5e-6}))
    text = (CONFIGS / "rk4.toml").read_text()
    assert 'runout = "4 um"' in text
    (tmp_path / "rig.toml").write_text(text.replace('runout = "4 um"', 'runout = "0.2 um"'))
    fits, notes = [], []
    for name, top, more in (
        ("told", "compensated = true", f'[slow_roll]\nspeed = "{COMPENSATED} rpm"\n'),
        ("untold", "", ""),
    ):
        toml = mapping(up, planes=("1", "2"), top=top) + more
        csv, toml_path = write(tmp_path, table({"up": (rpm, read)}), toml, name=name)
        out = tmp_path / f"{name}.mcap"
        notes.append(rotor("import", csv, "--config", tmp_path / "rig.toml", "--mapping", toml_path, "--out", out))
        fits.append(identified(out))
    told, untold = fits
    assert "Note: the vectors stay compensated, and the model subtracts its own response at 1300 rpm" in notes[0]
    assert "stay compensated" not in notes[1]
    assert misfit(told) < 1.3
    assert misfit(untold) > 3
    for name, truth in (("kxx", 33.9e3), ("kyy", 34.6e3), ("u", 15e-6)):
        assert off(told, name, truth) < 3, name
    diagnosis, _ = diagnosed(tmp_path / "told.mcap")
    assert diagnosis["verdict"] in ("adequate", "cannot tell")
    page = tmp_path / "report.html"
    rotor("report", tmp_path / "told.mcap", "--diagnosis", tmp_path / "diagnosis.json", "--out", page)
    assert "The table came slow-roll compensated, by a vector at 1300 rpm that it does not tell." in page.read_text()


def complex_table(rpm: np.ndarray, read: dict[str, np.ndarray], *, conjugated: bool | None) -> tuple[str, str]:
    """Return table and mapping of real and imaginary parts; `conjugated` False: the table is, the mapping denies it."""
    sign = 1 if conjugated is None else -1
    lines = ["rpm," + ",".join(f"{name} {part}" for name in read for part in ("re", "im"))]
    for i, speed in enumerate(rpm):
        lines.append(
            ",".join([f"{speed:.2f}", *(f"{z[i].real * 1e6:.4f},{sign * z[i].imag * 1e6:.4f}" for z in read.values())])
        )
    toml = '[speed]\ncolumn = "rpm"\nunit = "1 rpm"\n[[runs]]\nname = "up"\ndirection = "up"\n'
    toml += '[uncertainty]\nabsolute = "0.3 um"\n'
    for name in read:
        toml += f'[[vectors]]\nprobe = "{name}"\nreal = "{name} re"\nimaginary = "{name} im"\nunit = "1 um"\n'
        toml += "" if conjugated is None else f"conjugated = {str(conjugated).lower()}\n"
    return "\n".join(lines) + "\n", toml


@pytest.mark.campaign
def test_a_conjugated_table_is_that_of_the_vectors_and_a_wrong_sign_is_remarked_upon(tmp_path: Path) -> None:
    rpm = np.linspace(600, 3600, 80)
    read = with_noise(vectors(rpm), np.random.default_rng(6))
    found = {}
    for name, conjugated in (("plain", None), ("conjugated", True), ("wrong", False)):
        csv, toml = write(tmp_path, *complex_table(rpm, read, conjugated=conjugated), name=name)
        out = tmp_path / f"{name}.mcap"
        said = rotor("import", csv, "--config", CONFIGS / "rk4.toml", "--mapping", toml, "--out", out)
        found[name] = ("whirl backward" in said, identified(out)["estimates"] if name != "wrong" else {})
    assert [backward for backward, _ in found.values()] == [False, False, True]
    for name, estimate in found["plain"][1].items():
        assert found["conjugated"][1][name]["value"] == pytest.approx(estimate["value"])
