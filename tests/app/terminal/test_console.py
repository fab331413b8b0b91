"""What a person sees at the terminal and what a program reads from it: bars, JSON, help, completion."""

import json
import os
import pty
import re
import select
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from benchmarks.parts.blind.run import record
from rotorrig.acquisition.files.recording_mcap import write_recording
from rotorrig.app import cli
from rotorrig.app.terminal.console import tell
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.units import RPM

ROTOR = [sys.executable, "-m", "rotorrig.app.cli"]
RK4 = Path(__file__).parents[3] / "configs/rk4.toml"
READ_BY_PROGRAMS = (
    *(
        "check",
        "sweep",
        "investigate",
        "replay",
        "track",
        "identify",
        "diagnose",
        "balance",
        "predict",
        "import",
        "export",
        "salvage",
    ),
)


@pytest.fixture(scope="module")
def run_file(tmp_path_factory: pytest.TempPathFactory, brief_rig: RigConfig) -> Path:
    """A sweep of some seconds."""
    path = tmp_path_factory.mktemp("console") / "run.mcap"
    write_recording(path, record(brief_rig, seed=3))
    return path


def piped(*words: object) -> subprocess.CompletedProcess[str]:
    done = subprocess.run([*ROTOR, *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done


def at_a_terminal(*words: object) -> str:
    """Return what a verb shows on standard error where that is a terminal of 200 columns."""
    master, slave = pty.openpty()
    environment = {**os.environ, "COLUMNS": "200", "TERM": "xterm-256color"}
    process = subprocess.Popen(
        [*ROTOR, *map(str, words)], stdout=subprocess.DEVNULL, stderr=slave, stdin=subprocess.DEVNULL, env=environment
    )
    os.close(slave)
    shown = b""
    while select.select([master], [], [], 60)[0]:
        try:
            part = os.read(master, 65536)
        except OSError:  # the other end was closed
            break
        if not part:
            break
        shown += part
    assert process.wait() == 0
    os.close(master)
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown.decode())


def test_help_fits_a_screen_of_24_lines_with_every_verb_in_a_line() -> None:
    shown = CliRunner().invoke(cli.app, ["--help"], env={"COLUMNS": "80"}).output.rstrip("\n").splitlines()
    assert len(shown) <= 24
    assert max(map(len, shown)) <= 80
    assert not any(line.endswith("...") for line in shown[1:])
    first = shown.index("Commands:") + 1
    assert [line.split()[0] for line in shown[first:-1]] == [*cli.VERBS, "lab"]
    assert "--version" in shown[-1]


@pytest.mark.parametrize("verb", list(cli.VERBS))
def test_every_verb_explains_itself(verb: str) -> None:
    shown = CliRunner().invoke(cli.app, [verb, "-h"], env={"COLUMNS": "100"}).output
    options = re.findall(r"^  (?:-\w, )?(--[\w-]+)(.*)$", shown, re.MULTILINE)
    assert ("--json" in dict(options)) == (verb in READ_BY_PROGRAMS)


def test_what_a_program_reads_is_one_json_object_and_nothing_else(tmp_path: Path, run_file: Path) -> None:
    done = piped("track", run_file, "-o", tmp_path / "r.mcap", "--json")
    assert done.stderr == ""
    tracked = json.loads(done.stdout)
    assert [run["name"] for run in tracked["runs"]] == ["slow roll", "up", "down"]
    assert sum(run["rows"] for run in tracked["runs"]) == tracked["rows"]
    up = tracked["runs"][1]
    assert 230 < up["from_rpm"] < up["to_rpm"] < 1510

    exported = piped("export", run_file, "-o", tmp_path / "run.csv", "--json")
    assert (exported.stderr, json.loads(exported.stdout)["file"]) == ("", str(tmp_path / "run.csv"))
    replayed = json.loads(piped("replay", run_file, "--from", "2", "--json").stdout)
    assert replayed["seconds"] == pytest.approx(
        json.loads(piped("salvage", run_file, "-o", tmp_path / "s.mcap", "--json").stdout)["seconds"] - 2, abs=1e-3
    )


def test_a_dry_run_can_be_read(rig_config: RigConfig) -> None:
    seen = json.loads(piped("sweep", RK4, "--dry-run", "--json").stdout)
    assert seen["objections"] == []
    fastest = max(step["to_rpm"] for step in seen["steps"])
    assert fastest == pytest.approx(rig_config.plans["default"].fastest * RPM)
    assert json.loads(piped("check", RK4, "--json").stdout)["critical_speeds_rpm"] == seen["critical_speeds_rpm"]


def test_what_is_not_a_number_is_null(capsys: pytest.CaptureFixture[str]) -> None:
    tell("", {"a": float("nan"), "b": [1.5, float("inf")], "c": {"d": (True, None, "x")}}, as_json=True)
    assert json.loads(capsys.readouterr().out) == {"a": None, "b": [1.5, None], "c": {"d": [True, None, "x"]}}


def test_a_long_job_shows_its_share_its_rate_and_the_time_left(tmp_path: Path, run_file: Path) -> None:
    shown = at_a_terminal("replay", run_file, "--rate", "10")
    assert re.search(r"replaying .* \d+ % 0:00:0\d 0:00:0\d left [\d.]+ x real time", shown)
    rates = [float(rate) for rate in re.findall(r"left ([\d.]+) x real time", shown)]
    assert rates[-1] == pytest.approx(10, rel=0.15)


@pytest.mark.campaign
def test_nothing_is_drawn_where_nobody_looks(tmp_path: Path, run_file: Path) -> None:
    assert piped("replay", run_file).stderr == ""
    said = piped("track", run_file, "-o", tmp_path / "r.mcap").stderr.splitlines()
    assert len(said) > 1
    assert all(line.startswith(("slow roll: ", "remark: ")) for line in said)  # words for a person, no bar


@pytest.mark.parametrize(
    ("typed", "offered"),
    [("rotor di", ["diagnose"]), (f"rotor sweep {RK4} --plan d", ["default"]), ("rotor track --me", ["--method"])],
)
def test_a_shell_completes_verbs_options_and_plans(typed: str, offered: list[str]) -> None:
    environment = {
        **os.environ,
        "_ROTOR_COMPLETE": "complete_bash",
        "COMP_WORDS": typed,
        "COMP_CWORD": str(len(typed.split()) - 1),
    }
    program = Path(sys.executable).with_name("rotor")
    done = subprocess.run([program], env=environment, capture_output=True, text=True, check=False)
    assert done.stdout.split() == offered
