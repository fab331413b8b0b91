"""`rotor check --connect`: what motor and DAQ say of themselves, over real wires."""

import io
import subprocess
import sys
from pathlib import Path

import pytest

from rotorrig.acquisition.proof_test import read_certificate
from rotorrig.app.commands import check as checking
from rotorrig.rig import connect
from rotorrig.rig.config.description import parse
from rotorrig.rig.errors import ConfigError, LimitExceeded, LinkLost
from rotorrig.sims.wire.launch import simulated_bench

RK4 = (Path(__file__).parents[3] / "configs" / "rk4.toml").read_text()


def test_motor_and_daq_are_asked_what_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    text = RK4.replace('profile = "powerflex400"', 'profile = "vfd-ed"\nramp = "30 rpm/s"')
    assert "vfd-ed" in text
    with simulated_bench(text, seed=1) as ports:
        for port, stands_in in (("/dev/ttyUSB0", ports.motor["port"]), ("/dev/ttyACM0", ports.daq["port"])):
            text = text.replace(port, stands_in)
        checking.show_devices(parse(text, where="x.toml"))
    said = " ".join(capsys.readouterr().out.split())
    assert f"motor: VFD-ED on Modbus RTU, {ports.motor['port']}, 19200 baud, address 100" in said
    assert "0 rpm, at rest, no fault, no watchdog" in said
    assert "cannot be told to coast, it stops down its ramp" in said
    assert "DAQ: rotorrig simulated DAQ" in said


def test_both_are_tried_before_either_is_missed() -> None:
    text = RK4.replace("/dev/ttyUSB0", "/dev/ttyNOMOTOR").replace("/dev/ttyACM0", "/dev/ttyNODAQ")
    with pytest.raises(LinkLost, match=r"^/dev/ttyNOMOTOR: .*; /dev/ttyNODAQ: "):
        checking.show_devices(parse(text, where="x.toml"))


@pytest.mark.campaign
def test_a_fault_the_drive_remembers_keeps_it_from_starting_until_it_is_cleared(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with simulated_bench(RK4, seed=1) as ports:
        text = RK4.replace("/dev/ttyUSB0", ports.motor["port"]).replace("/dev/ttyACM0", ports.daq["port"])
        rig = parse(text, where="x.toml")
        ports.console.play([{"kind": "drive-fault", "code": 13}])
        with connect.motor(rig) as motor, pytest.raises(LimitExceeded, match=r"ground fault \(F13\).*--clear-fault"):
            motor.open()
            motor.set_speed(60.0, ramp=30.0)
        checking.clear_fault(rig)
        checking.clear_fault(rig)
        with connect.motor(rig) as motor:
            motor.open()
            assert motor.read().fault == ""
    said = capsys.readouterr().out.splitlines()
    assert said == ["motor: fault cleared: ground fault (F13)", "motor: no fault to clear"]


def test_a_proof_test_turns_nothing_that_nobody_confirmed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO())
    with pytest.raises(
        ConfigError, match=r"no terminal to confirm at that the rotor may be turned; want one, or --yes"
    ):
        checking.run_proof_test(parse(RK4, where="x.toml"), out_file=None, simulation=None, yes=False)


def test_a_proof_test_inside_a_critical_band_is_refused() -> None:
    band = '\n[[limits.critical_bands]]\nlow = "200 rpm"\nhigh = "280 rpm"\nvibration = "900 um"\n'
    text = RK4.replace("[plans.default]", f"{band}\n[plans.default]")
    with pytest.raises(ConfigError, match=r"^proof test: holds 240 rpm inside the critical band"):
        checking.run_proof_test(parse(text, where="x.toml"), out_file=None, simulation=None, yes=True)


@pytest.mark.campaign
def test_a_simulated_rig_is_proven_by_one_command(tmp_path: Path) -> None:
    out = tmp_path / "rk4.proof.json"
    command = [
        sys.executable,
        "-m",
        "rotorrig.app.cli",
        "check",
        "rk4",
        "--proof-test",
        "--simulate",
        "--out",
        str(out),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=400)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[0].startswith("Proof test at 240 rpm")
    assert "6 protections stopped the rotor in time" in done.stdout
    certificate = read_certificate(out)
    assert certificate.passed and certificate.simulated
    assert certificate.config_hash == parse(RK4, where="x.toml").hash
