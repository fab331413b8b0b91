"""`rotor balance` and `rotor predict`: what they print and write, and what they refuse in a sentence."""

import csv
import json
import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from rotorrig.app import cli
from rotorrig.app.commands.balancing.options import read_bands, read_radii
from rotorrig.identify.result_files import write_identification
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import ConfigError
from tests.balancing.fits import fit_from, three_runs
from tests.identify.swept import U

Run = Callable[..., tuple[int, str, str]]
FILES = ("base.mcap", "trial.mcap", "after.mcap")


@pytest.fixture(scope="module")
def folder(rig_config: RigConfig, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three runs - as it is, with 12 g mm at 90 degrees, balanced - and the fit of the first."""
    path = tmp_path_factory.mktemp("balancing")
    made = three_runs(rig_config)
    for name, response in zip(FILES, made, strict=True):
        write_response(path / name, response)
    write_identification(path / "fit.json", fit_from(made[:1]))
    return path


@pytest.fixture
def rotor(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], folder: Path) -> Run:
    """Run the command in the folder of the runs; return its code, standard output and standard error."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr(cli.err, "_width", 400)
    monkeypatch.setattr(cli.out, "_width", 400)

    def run(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["rotor", *words])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        printed = capsys.readouterr()
        return int(ended.value.code or 0), printed.out, printed.err

    return run


def test_a_correction_is_printed_with_its_interval_both_ways_round(rotor: Run) -> None:
    code, out, err = rotor("balance", *FILES[:2], "--radius", "30 mm", "--out", "one.json")
    assert (code, err) == (0, "")
    assert "angles from the keyphasor mark in the sense of rotation" in " ".join(out.split())
    row, below = out.split("influence coefficients")[1].splitlines()[:2]
    assert "g mm" in row and " g " in below
    assert "214." in row and "145." in below  # U is at 34.4 degrees: opposite to it, both ways round
    assert "repeatability in the config's [prior]" in out
    assert "ISO 21940-11: G" in out and "rotor 1.15 kg" in out
    table = json.loads(Path("one.json").read_text())
    (plane,) = table["chosen"]["planes"]
    assert plane["amount"] == pytest.approx(abs(U), rel=0.01)
    assert plane["angle"] == pytest.approx(np.angle(-U) % math.tau, abs=0.01)
    assert table["kind"] == "rotorrig balance"
    assert table["prediction"]["after"]["re"]["shape"] == [len(table["prediction"]["probe"])]


def test_masses_in_holes_a_fit_and_the_run_after(rotor: Run) -> None:
    at_hand = ("--holes", "16", "--masses", "100 mg, 0.2 g, 0.5 g", "--radius", "disk: 30 mm", "--min-max")
    code, out, err = rotor(
        "balance", *FILES[:2], "--fit", "fit.json", *at_hand, "--after", "after.mcap", "--out", "two.json", "--json"
    )
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert [c["by"] for c in found["corrections"]][:2] == ["influence coefficients", "fitted model"]
    assert {f["mass"] for f in found["holes"][0]["filled"]} <= {1e-4, 2e-4, 5e-4}
    assert found["mounted"][0]["amount"] == pytest.approx(abs(U))  # as the run after says
    assert found["comparison"]["share_inside"] > 0.9
    assert set(found["comparison"]["probes"]) == {"1x", "1y", "2x", "2y"}


def test_a_prediction_is_a_table_a_file_and_a_picture(rotor: Run) -> None:
    mass = ("--mass", "disk: 11 g mm at 214.4 deg")
    for name in ("with.csv", "with.json", "with.html"):
        code, out, err = rotor("predict", "base.mcap", "--fit", "fit.json", *mass, "--out", name)
        assert (code, err) == (0, "")
        assert "Largest 1X amplitude, µm 0-peak" in out
    lines = Path("with.csv").read_text().splitlines()
    assert "0-peak" in lines[0] and "lag = -arg z" in lines[0]
    assert lines[1] == "# disk: 11 g mm at 214.4 deg from the keyphasor mark in the sense of rotation"
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    before, after, high = (max(float(row[f"{w} [um]"]) for row in rows) for w in ("before", "after", "after high"))
    assert after < 0.1 * before and after < high
    assert json.loads(Path("with.json").read_text())["masses"][0]["amount"] == pytest.approx(11e-6)
    assert "95 % band" in Path("with.html").read_text()
    assert rotor("predict", "base.mcap", "--fit", "fit.json", *mass, "--out", "with.csv", "--force")[0] == 0


def test_amplitudes_are_printed_in_the_unit_that_is_asked_for(rotor: Run) -> None:
    """A mil is 25.4 um, and peak to peak is twice the amplitude."""
    mass = ("--mass", "disk: 11 g mm at 214.4 deg")

    def largest(*words: str) -> float:
        code, out, err = rotor(*words, "--out", "units.html", "--force")
        assert (code, err) == (0, "")
        return float(next(line for line in out.splitlines() if line.split()[:1] == ["1x"]).split()[1])

    predict = ("predict", "base.mcap", "--fit", "fit.json", *mass)
    stated = largest(*predict)
    assert largest(*predict, "--units", "mil pp") == pytest.approx(2 * stated / 25.4, rel=0.01)
    assert 'data-units="mil pp"' in Path("units.html").read_text()
    balance = ("balance", *FILES[:2], "--after", "after.mcap", "--out", "units.json", "--force", "--units", "um pp")
    code, out, err = rotor(*balance)
    assert (code, err) == (0, "")
    assert "Largest 1X amplitude, µm pp" in out and "The run after, µm pp" in out
    code, _, err = rotor(*predict, "--units", "inch", "--out", "units.html", "--force")
    assert code == 1 and "--units: got 'inch'" in err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["balance", "base.mcap", "-o", "x.json"], "no run has a trial mass and there is no fit"),
        (["balance", *FILES[:2], "--planes", "rim", "-o", "x.json"], "no disk or plane 'rim'"),
        (["balance", *FILES[:2], "--speeds", "60 Hz", "-o", "x.json"], "--speeds: got '60 Hz'"),
        (["balance", *FILES[:2], "--speeds", "9000 rpm", "-o", "x.json"], "no speed in common within"),
        (["balance", *FILES[:2], "--holes", "16", "-o", "x.json"], "--holes and --masses: got one"),
        (["balance", *FILES[:2], "--holes", "8", "--masses", "1 g", "-o", "x.json"], "--radius: missing for 'disk'"),
        (
            ["balance", *FILES[:2], "--holes", "0", "--masses", "1 g", "--radius", "3 cm", "-o", "x.json"],
            "--holes: got 0",
        ),
        (["balance", "trial.mcap", "--fit", "fit.json", "-o", "x.json"], "made of a response that was not given"),
        (["balance", *FILES[:2], "-o", "fit.json"], "fit.json: is a fit already"),
        (["predict", "base.mcap", "--fit", "fit.json", "-o", "x.csv"], "--mass: missing"),
        (["predict", "base.mcap", "--fit", "fit.json", "--mass", "disk: 1 g", "-o", "x.csv"], "trial mass: got"),
        (["predict", "base.mcap", "--fit", "fit.json", "--mass", "disk: 1 g mm at 0 deg", "-o", "x.pdf"], "'.pdf'"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(rotor: Run, words: list[str], sentence: str) -> None:
    code, _, err = rotor(*words)
    assert code == 1
    assert err.startswith("error:") and err.count("\n") == 1
    assert sentence in err


def test_speeds_are_single_ones_and_bands() -> None:
    (single, band) = read_bands("1500 rpm, 1800 to 2400 rpm")
    assert single == pytest.approx((1485 * math.pi / 30, 1515 * math.pi / 30))
    assert band == pytest.approx((60 * math.pi, 80 * math.pi))
    with pytest.raises(ConfigError, match="speeds that rise"):
        read_bands("2400 to 1800 rpm")


def test_a_radius_is_of_all_planes_or_of_each() -> None:
    planes = ["disk 1", "disk 2"]
    assert read_radii("30 mm", known=planes) == {"disk 1": 0.03, "disk 2": 0.03}
    assert read_radii("disk 1: 30 mm, disk 2: 25 mm", known=planes) == {"disk 1": 0.03, "disk 2": 0.025}
