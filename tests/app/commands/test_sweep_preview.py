"""`rotor sweep --dry-run` says what would happen, when, and what speaks against it."""

import sys
from pathlib import Path

import pytest

from rotorrig.acquisition.sweep.plans import Ramp
from rotorrig.acquisition.sweep.timeline import plan_timeline
from rotorrig.app import cli
from rotorrig.app.commands import sweep_preview
from rotorrig.rig.config.description import RigConfig, load, parse
from rotorrig.rig.config.units import RPM

RK4 = Path(__file__).parents[3] / "configs/rk4.toml"
BAND = '\n[[limits.critical_bands]]\nlow = "2000 rpm"\nhigh = "2400 rpm"\nvibration = "1200 um"\n'
INSIDE = '\n[plans.test]\nkind = "dwell"\nspeed = "2200 rpm"\ntime = "1 h"\nramp = "60 rpm/s"\n'
STEPPED = (
    '\n[plans.test]\nkind = "stepped"\nslow_roll = "240 rpm"\nslow_roll_time = "6 s"\n'
    'speeds = ["2200 rpm"]\nramp = "60 rpm/s"\ndwell = "10 s"\n'
)
MASSES = '\n[plans.test]\nkind = "trial-mass"\nmasses = ["disk: 12 g mm at 0 deg"]\n'


def previewed(
    config: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: str
) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["rotor", "sweep", str(config), "--dry-run", *words])
    monkeypatch.setattr(cli.out, "_width", 120)
    monkeypatch.setattr(cli.err, "_width", 400)
    with pytest.raises(SystemExit) as ended:
        cli.main()
    printed = capsys.readouterr()
    return int(ended.value.code or 0), printed.out, printed.err


def test_steps_times_limits_size_and_critical_speeds_are_shown(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    code, out, err = previewed(RK4, monkeypatch, capsys)
    assert (code, err) == (0, "")
    (ramp,) = [line for line in out.splitlines() if "480 → 3600" in line]
    assert " ".join(ramp.split()) == "17.0 121.0 ramp 480 → 3600 30 passes critical 2226, 2237 rpm"
    assert "time: about 167 s, coast-down assumed to take 45 s; then run-down to rest" in out
    assert "file: about 8 MB, 5 channels at 10000 Hz" in out  # 167 s x 10 kHz x 5 x 2 bytes, halved
    assert "limits: 4000 rpm, 900 um 0-peak" in out
    assert "critical speeds of the nameplate model: 2226, 2237 rpm" in out
    assert list(tmp_path.iterdir()) == []


def test_what_is_refused_is_shown_all_the_same_and_fails(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    config = tmp_path / "rig.toml"
    config.write_text(RK4.read_text() + BAND + INSIDE)
    code, out, err = previewed(config, monkeypatch, capsys, "--plan", "test")
    assert code == 1
    assert "in band 2000-2400 rpm" in out
    assert "2000-2400 rpm 1200 um" in out
    assert "refused: holds 2200 rpm inside the critical band 2000-2400 rpm, want it to pass" in out
    assert err == ("error: plans.test: holds 2200 rpm inside the critical band 2000-2400 rpm, want it to pass\n")


def test_speeds_to_hold_are_shown_and_what_is_no_speed_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    config = tmp_path / "rig.toml"
    config.write_text(RK4.read_text() + STEPPED)
    held = ("--plan", "test", "--hold", "900 rpm", "--hold", "1500 rpm")
    code, out, _ = previewed(config, monkeypatch, capsys, *held)
    assert code == 0
    assert "dwell 900 rpm" in out
    assert "dwell 1500 rpm" in out
    assert "2200" not in out
    code, _, err = previewed(config, monkeypatch, capsys, "--plan", "test", "--hold", "900")
    assert (code, err) == (1, "error: --hold: got '900', want a speed with its unit, such as '480 rpm'\n")
    code, _, err = previewed(config, monkeypatch, capsys, "--hold", "900 rpm")
    assert code == 1
    assert "plan 'default': is of kind run-up-coast-down, want one of kind stepped to hold speeds" in err


def test_mounting_a_mass_takes_a_time_nobody_knows(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    config = tmp_path / "rig.toml"
    config.write_text(RK4.read_text() + MASSES)
    code, out, _ = previewed(config, monkeypatch, capsys, "--plan", "test")
    assert code == 0
    assert "ask: mount 'disk: 12 g mm at 0 deg'" in out
    assert "2 coast-downs assumed to take 45 s each; plus operator time, asked once" in out


@pytest.fixture(scope="module")
def rig() -> RigConfig:
    return load(RK4)


@pytest.mark.parametrize("plain", [True, False])
def test_the_chart_rises_where_the_speed_does(plain: bool) -> None:
    steps = plan_timeline([Ramp(to=100.0, rate=10.0), Ramp(to=50.0, rate=1.0)])  # 10 s up, 50 s half-way down
    chart = sweep_preview.chart(steps, criticals=[75.0], width=80, plain=plain).plain
    lines = chart.splitlines()
    assert chart.isascii() is plain
    assert lines[0].lstrip().startswith("955 rpm")
    assert lines[-1].split() == ["0", "s", "60", "s"]
    full = "#" if plain else "█"
    margin = lines[-1].index("0 s")
    heights = [sum(line[margin:].ljust(80)[column] == full for line in lines[:-1]) for column in range(60)]
    assert heights[:10] == sorted(heights[:10])
    assert max(heights[8:14]) == 10
    assert heights[14:] == sorted(heights[14:], reverse=True)
    assert heights[-5] in (5, 6)
    assert f"critical {75.0 * RPM:.0f} rpm" in lines[2]


def test_a_rig_without_limits_is_told_so() -> None:
    bare = parse(RK4.read_text().replace('[limits]\noverspeed = "4000 rpm"\nvibration = "900 um"', ""), where="x")
    said = sweep_preview.limits_words(bare)
    assert said == "the config has no [limits]: 4410 rpm and the probes' linear range"  # 1.05 times motor.max_speed
