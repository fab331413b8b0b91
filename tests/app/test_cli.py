"""Every mistake at the command line ends in one sentence and a non-zero exit, never in a traceback."""

import sys
from pathlib import Path

import numpy as np
import pytest

from rotorrig.app import cli
from rotorrig.identify.result_files import read_identification
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig import code_version
from rotorrig.rig.config.description import RigConfig
from tests.identify.matched import matched_response, sought

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
        (["check", "rk5"], "config 'rk5': is neither a file nor bundled, want a path or one of kfupm-rk4, rk4"),
        (["sweep", "rk5", "--dry-run"], "config 'rk5'"),
        (["simulate", "rk5"], "config 'rk5'"),
        (["demo", "--config", "rk5"], "config 'rk5'"),
        (["import", "none.csv", "--config", "rk5", "--out", "x.mcap"], "config 'rk5'"),
        (["export", "rk5", "--ross", "--out", "x.json"], "config 'rk5'"),
        (["diagnose", "none.mcap", "--config", "rk5", "--out", "d.json"], "config 'rk5'"),
        (["init", "rk5"], "config 'rk5'"),
        (["init", "rk4", "--out", "none/rk4.toml"], "none/rk4.toml: cannot be written"),
        (["init", "--out", "my.toml"], "--out: wants the NAME of a bundled config"),
        (["check", RK4, "--connect"], "/dev/ttyUSB0"),
        (["sweep", RK4, "--out", "run.mcap", "--simulate", "--plan", "nope"], "plan 'nope'"),
        (["track", RK4, "--out", "x.mcap"], "rk4.toml"),
        (["sweep", RK4, "--out", "run.mcap", "--simulate", "--trial", "disc: 1 g mm at 0 deg"], "trial mass 'disc: 1"),
        (["diagnose", "none.mcap", "--out", "d.json"], "none.mcap"),
        (["track", "none.mcap", "--out", "x.mcap"], "none.mcap"),
        (["identify", RK4, "--out", "x.json"], "rk4.toml"),
        (["report", RK4, "--out", "x.html"], "rk4.toml"),
        (["replay", RK4, "--rate", "fast"], "--rate: got 'fast', want 'max' or a number"),
        (["view", RK4], "rk4.toml"),
        (["salvage", RK4, "--out", "x.mcap"], "rk4.toml"),
        (["import", RK4, "--config", RK4, "--out", "x.mcap"], "cannot be imported, want one of .csv"),
        (["import", "none.csv", "--config", RK4, "--out", "x.mcap"], "none.csv"),
        (["export", "none.mcap", "--out", "x.uff"], "none.mcap: is not there"),
        (["export", RK4, "--out", "x.uff"], "rk4.toml: is no MCAP file"),
        (["export", "none.mcap", "--out", "x.xlsx"], "x.xlsx: ends in '.xlsx', want a name that ends in .csv or .uff"),
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


def test_a_bundled_config_is_written_where_nothing_is(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(monkeypatch, capsys, "init", "rk4", "--out", "my.toml")[0] == 0
    assert Path("my.toml").read_text() == Path(RK4).read_text()
    with Path("my.toml").open("a") as file:
        file.write("# mine\n")
    code, _, err = run(monkeypatch, capsys, "init", "rk4", "--out", "my.toml")
    assert (code, err) == (1, "error: my.toml: is there already, want another name, or --force to replace it\n")
    assert Path("my.toml").read_text().endswith("# mine\n")
    assert run(monkeypatch, capsys, "init", "rk4", "--out", "my.toml", "--force")[0] == 0
    assert Path("my.toml").read_text() == Path(RK4).read_text()


def test_without_a_name_the_bundled_configs_are_listed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    _, out, _ = run(monkeypatch, capsys, "init")
    assert [line.split()[0] for line in out.splitlines()] == ["kfupm-rk4", "rk4"]


def test_the_version_is_the_one_that_files_carry(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, capsys, "--version")[:2] == (0, f"rotorrig {code_version()}\n")


@pytest.mark.campaign
def test_the_measured_run_up_is_imported_fitted_and_shown_to_fit_poorly(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    table, mapping = KFUPM / "runup_bode_1037_2610rpm.csv", KFUPM / "mapping.toml"
    config = Path(RK4).with_name("kfupm-rk4.toml")
    assert run(monkeypatch, capsys, "import", table, "--vectors", mapping, "--config", config, "-o", "r.mcap")[0] == 0
    assert run(monkeypatch, capsys, "identify", "r.mcap", "-o", "fit.json")[0] == 0
    assert run(monkeypatch, capsys, "report", "r.mcap", "--fit", "fit.json", "-o", "report.html")[0] == 0
    page = Path("report.html").read_text()
    assert "Poor fit: the model does NOT describe this run" in page
    assert "not determined by this data" in page


@pytest.mark.campaign
def test_intervals_come_from_the_profile_or_the_bootstrap_when_asked(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, rig_config: RigConfig
) -> None:
    write_response(tmp_path / "r.mcap", few_rows(rig_config))
    for words, made_by in ((["--profile"], "profile likelihood"), (["--bootstrap", "40"], "bootstrap")):
        code, out, _ = run(
            monkeypatch,
            capsys,
            "identify",
            tmp_path / "r.mcap",
            "-o",
            tmp_path / "fit.json",
            "--seed",
            "3",
            "--force",
            *words,
        )
        assert code == 0
        kxx = read_identification(tmp_path / "fit.json").fits[0].estimate("kxx")
        assert kxx.interval_by == made_by
        low, high = kxx.interval or (0.0, 0.0)
        assert low < 33e3 < high  # the truth
        assert any(f"{low / 1e3:.{digits}f}" in out for digits in (1, 2))  # as many as its sigma leaves


def few_rows(rig: RigConfig) -> OrderTrackedResponse:
    """A response of the model itself."""
    bearing = (np.diag([33e3, 36e3]), np.diag([14.0, 16.0]))
    rng = np.random.default_rng(3)
    return matched_response(
        sought(rig), bearings={"spring": bearing}, unbalance={"disk": 14e-6}, rng=rng, noise=3e-6, top=2600.0
    )
