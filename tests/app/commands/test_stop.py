"""`rotor stop` over real wires: a rotor that turns by itself, one left to a guardian, one whose sweep runs."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from rotorrig.acquisition.sweep import stop_only
from rotorrig.app.commands import stop as stopping
from rotorrig.app.commands.stop import stop
from rotorrig.rig import connect
from rotorrig.rig.config.description import RigConfig, load
from rotorrig.rig.config.units import RPM
from rotorrig.rig.control.guarded import GuardedControl
from rotorrig.rig.control.registry import ask_guardian
from rotorrig.rig.errors import LinkLost, NotAtRest
from rotorrig.sims.wire.launch import BenchPorts, simulated_bench

ROOT = Path(__file__).parents[3]
RK4 = (ROOT / "configs/rk4.toml").read_text()
FEW_RPM = 30.0


def wired(text: str, ports: BenchPorts) -> str:
    """Return the config's text with the bench's ports, and a guardian that bears a busy processor."""
    text = text.replace('"/dev/ttyUSB0"', f'"{ports.motor["port"]}"\nguardian = "5 s"')
    return text.replace('"/dev/ttyACM0"', f'"{ports.daq["port"]}"')


@pytest.fixture(scope="module")
def ports() -> Iterator[BenchPorts]:
    with simulated_bench(RK4, seed=3) as ports:
        yield ports


@pytest.fixture
def config(ports: BenchPorts, tmp_path: Path) -> Path:
    path = tmp_path / "rig.toml"
    path.write_text(wired(RK4, ports))
    return path


@pytest.fixture
def rig(config: Path) -> RigConfig:
    return load(config)


def rotor(*words: str | Path) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "rotorrig.app.cli", *map(str, words)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT)


def run_rotor(*words: str | Path) -> tuple[int, str, str]:
    """Run `rotor`; return its exit status and the last lines it printed on standard output and on standard error."""
    with rotor(*words) as process:
        out, err = process.communicate(timeout=60)
    return process.returncode, out.strip().split("\n")[-1], err.strip().split("\n")[-1]


def wait_for(what: Callable[[], object], *, timeout: float = 40.0) -> None:
    until = time.monotonic() + timeout
    while not what():
        assert time.monotonic() < until, "what was waited for did not happen"
        time.sleep(0.05)


def speed(ports: BenchPorts) -> float:
    return abs(ports.console.speed()) * RPM


def is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def spin_up(rig: RigConfig) -> None:
    """Start the rotor as another program would, which closes the link and leaves it turning."""
    motor = connect.motor(rig)
    motor.open()
    motor.set_speed(900 / RPM, ramp=300 / RPM)
    motor.close()


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A program that waits for a sign of the rotor no longer than a test would."""
    monkeypatch.setattr(stop_only, "PATIENCE", 1.0)


@pytest.mark.campaign
def test_a_rotor_that_another_program_left_turning_is_brought_to_rest(tmp_path: Path) -> None:
    """In real time: it has to be seen as it slows down, so its drive does not stop it before a busy machine comes."""
    with simulated_bench(RK4, seed=3, rate=1.0) as ports:
        config = tmp_path / "rig.toml"
        config.write_text(wired(RK4, ports).replace("guardian =", 'watchdog = "30 s"\nguardian ='))
        spin_up(load(config))
        wait_for(lambda: speed(ports) > 300)
        status, last, complaint = run_rotor("stop", config)
        assert complaint == ""  # first: it says why
        assert status == 0
        assert last.startswith("at rest ")
        assert speed(ports) < FEW_RPM
        assert ask_guardian(connect.motor_table(load(config)), "state") is None


@pytest.mark.usefixtures("impatient")
def test_a_rotor_that_gives_no_pulse_is_not_said_to_be_at_rest_though_the_drive_is_off(
    ports: BenchPorts, rig: RigConfig
) -> None:
    wait_for(lambda: speed(ports) < FEW_RPM)
    with pytest.raises(NotAtRest, match="whether the rotor turns is unknown: for 1 s the keyphasor gave no pulse"):
        stop(rig, say=lambda text: None)
    assert ask_guardian(connect.motor_table(rig), "state") is None


def test_without_samples_the_drive_is_stopped_and_rest_is_unknown(ports: BenchPorts, rig: RigConfig) -> None:
    assert rig.daq
    spin_up(rig)
    wait_for(lambda: speed(ports) > 300)
    blind = rig.model_copy(update={"daq": rig.daq.model_copy(update={"port": "/dev/no-such-port"})})
    with pytest.raises(NotAtRest, match=r"says that it is off; whether the rotor turns is unknown.*no-such-port"):
        stop(blind, say=lambda text: None)
    wait_for(lambda: speed(ports) < FEW_RPM)
    assert ask_guardian(connect.motor_table(rig), "state") is None


def test_a_link_that_cannot_be_opened_is_no_rest(rig: RigConfig) -> None:
    assert rig.motor
    gone = rig.model_copy(update={"motor": rig.motor.model_copy(update={"port": "/dev/no-such-port"})})
    with pytest.raises(NotAtRest, match=r"MAY STILL BE TURNING.*no-such-port"):
        stop(gone, say=lambda text: None)


def answer_as_guardian(monkeypatch: pytest.MonkeyPatch, **answer: object) -> list[str]:
    """Answer `rotor stop` as a guardian does; return what it was asked."""
    asked: list[str] = []

    def ask(table: object, question: str) -> dict[str, object]:
        asked.append(question)
        return answer

    monkeypatch.setattr(stopping, "ask_guardian", ask)
    return asked


def test_a_sweep_that_runs_is_told_to_stop(rig: RigConfig, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = answer_as_guardian(monkeypatch, sweep=4711, reason="", pid=4712)
    last = "told the sweep of process 4711 to stop; it reports what becomes of the rotor"
    assert stop(rig, say=pytest.fail) == last
    assert asked == ["stop"]


def test_of_a_sweep_that_hangs_its_process_and_why_are_named(rig: RigConfig, monkeypatch: pytest.MonkeyPatch) -> None:
    answer_as_guardian(monkeypatch, sweep=4711, reason="no sample was processed for 5 s", pid=4712)
    with pytest.raises(NotAtRest, match=r"^THE ROTOR MAY STILL BE TURNING: the sweep of process 4711 hangs .no sample"):
        stop(rig, say=pytest.fail)


@pytest.mark.campaign
@pytest.mark.usefixtures("impatient")
def test_a_rotor_left_to_a_guardian_is_taken_over_from_it(
    ports: BenchPorts, config: Path, rig: RigConfig, tmp_path: Path
) -> None:
    out, table = tmp_path / "run.mcap", connect.motor_table(rig)
    process = rotor("sweep", config, "--out", out)
    wait_for(lambda: speed(ports) > 100)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    log = tmp_path / "run.mcap.guardian.txt"
    wait_for(lambda: speed(ports) < FEW_RPM)
    assert "the sweep's process is gone; sent the quick stop" in log.read_text()
    guardian = ask_guardian(table, "state")
    assert guardian
    assert guardian["sweep"] is None

    status, _, complaint = run_rotor("sweep", config, "--out", tmp_path / "second.mcap")
    assert status == 1
    assert complaint.endswith(
        "a guardian of a sweep that is gone still holds its link; want it ended by `rotor stop CONFIG` first"
    )
    assert not (tmp_path / "second.mcap").exists()

    with pytest.raises(NotAtRest, match="has obeyed the stop and is off"):  # it was not seen to stop
        stop(rig, say=lambda text: None)
    assert "'rotor stop' took over" in log.read_text()
    assert not is_alive(guardian["pid"])
    assert ask_guardian(table, "state") is None


@pytest.mark.campaign
def test_a_sweep_that_runs_is_told_to_stop_and_reports(
    ports: BenchPorts, config: Path, rig: RigConfig, tmp_path: Path
) -> None:
    process = rotor("sweep", config, "--out", tmp_path / "run.mcap")
    wait_for(lambda: speed(ports) > 100)
    with pytest.raises(LinkLost, match=f"for the sweep of process {process.pid} still holds its link"):
        GuardedControl(rig, log=tmp_path / "log.txt").open()
    status, last, _ = run_rotor("stop", config)
    assert status == 0
    assert last == f"told the sweep of process {process.pid} to stop; it reports what becomes of the rotor"
    _, complaint = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "'rotor stop' asked for it" in complaint
    assert "the rotor is at rest" in complaint
    assert speed(ports) < FEW_RPM


@pytest.mark.campaign
@pytest.mark.usefixtures("impatient")
def test_a_sweep_that_hangs_is_no_rest(ports: BenchPorts, config: Path, rig: RigConfig, tmp_path: Path) -> None:
    process = rotor("sweep", config, "--out", tmp_path / "run.mcap")
    wait_for(lambda: speed(ports) > 100)
    process.send_signal(signal.SIGSTOP)
    wait_for(lambda: (ask_guardian(connect.motor_table(rig), "state") or {})["reason"])
    with pytest.raises(NotAtRest, match=f"sweep of process {process.pid} hangs .no sample was processed"):
        stop(rig, say=lambda text: None)
    process.kill()
    process.communicate()
    wait_for(lambda: (ask_guardian(connect.motor_table(rig), "state") or {})["sweep"] is None)
    said: list[str] = []
    with pytest.raises(NotAtRest, match="has obeyed the stop and is off"):
        stop(rig, say=said.append)
    assert "has let go of the motor link" in said[0]
