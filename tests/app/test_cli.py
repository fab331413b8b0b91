"""Every mistake at the command line ends in one sentence and a non-zero exit, never in a traceback."""

import sys
from pathlib import Path

import pytest

from rotorrig.app import cli

RK4 = str(Path(__file__).parents[2] / "configs/rk4.toml")
KFUPM = Path(__file__).parents[1] / "data/kfupm-rk4"


def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["rotor", *map(str, words)])
    monkeypatch.setattr(cli.err, "_width", 400)
    with pytest.raises(SystemExit) as ended:
        cli.main()
    printed = capsys.readouterr()
    code = ended.value.code
    assert isinstance(code, int) or code is None
    return code or 0, printed.out, printed.err


def test_check_names_the_critical_speeds(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(monkeypatch, capsys, "check", RK4)
    assert code == 0
    assert "2226, 2237" in out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["check", "none.toml"], "none.toml: cannot be read"),
        (["check", RK4, "--connect"], "/dev/ttyUSB0"),
        (["sweep", RK4, "--out", "run.mcap", "--simulate", "--plan", "nope"], "plan 'nope'"),
        (["track", RK4, "--out", "x.mcap"], "rk4.toml"),
        (["track", "none.mcap", "--out", "x.mcap"], "none.mcap"),
        (["identify", RK4, "--out", "x.json"], "rk4.toml"),
        (["report", RK4, "--out", "x.html"], "rk4.toml"),
        (["replay", RK4, "--rate", "fast"], "--rate: got 'fast', want 'max' or a number"),
        (["view", RK4], "rk4.toml"),
        (["salvage", RK4, "--out", "x.mcap"], "rk4.toml"),
        (["import", RK4, "--config", RK4, "--out", "x.mcap"], "only CSV can be imported yet"),
        (["import", "none.csv", "--config", RK4, "--out", "x.mcap"], "none.csv"),
        (["simulate", RK4, "--hidden", RK4], "rk4.toml"),
    ],
    ids=lambda v: " ".join(Path(w).name for w in v)[:40] if isinstance(v, list) else "",
)
def test_a_mistake_is_one_sentence(
    words: list[str],
    said: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    code, _, err = run(monkeypatch, capsys, *words)
    assert code != 0
    assert said in err
    assert "Traceback" not in err
    assert err.startswith("error: ")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "words",
    [
        ["diagnose", "a.mcap", "b.mcap", "--out", "d.json"],
        ["diagnose", "a.mcap", "--out", "d.json", "--holdout", "b.mcap"],
        ["diagnose", "a.mcap", "--out", "d.json", "--rig-out", "e.toml"],
        ["export", "a.mcap", "--out", "a.uff"],
        ["import", "a.tdms", "--config", RK4, "--out", "a.mcap"],
    ],
    ids=" ".join,
)
def test_what_is_not_built_says_so_and_fails(
    words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code, _, err = run(monkeypatch, capsys, *words)
    assert code == 3
    assert "yet" in err


def test_the_measured_run_up_is_imported_fitted_and_shown_to_fit_poorly(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    table, mapping = KFUPM / "runup_bode_1037_2610rpm.csv", KFUPM / "mapping.toml"
    config = Path(RK4).with_name("kfupm-rk4.toml")
    assert run(monkeypatch, capsys, "import", table, "--vectors", mapping, "--config", config, "-o", "r.mcap")[0] == 0
    assert run(monkeypatch, capsys, "identify", "r.mcap", "-o", "fit.json")[0] == 0
    code, out, _ = run(monkeypatch, capsys, "diagnose", "r.mcap", "-o", "d.json")
    assert code == 0
    assert "NOT adequate" in out
    report = ["report", "r.mcap", "--fit", "fit.json", "--diagnosis", "d.json", "-o", "report.html"]
    assert run(monkeypatch, capsys, *report)[0] == 0
    page = Path("report.html").read_text()
    assert "does NOT describe this run" in page
    assert "not determined by this data" in page
