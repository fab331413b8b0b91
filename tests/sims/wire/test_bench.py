"""The bench as a process: what it says, what it refuses, and that it never outlives who started it."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest
import serial

from rotorrig.rig.config.description import load
from rotorrig.sims.plant.draw import draw
from rotorrig.sims.plant.sealed_truth import seal
from rotorrig.sims.wire.bench import main

CONFIG = Path(__file__).parents[3] / "configs" / "rk4.toml"
BENCH = [sys.executable, "-m", "rotorrig.sims.wire.bench"]


@contextlib.contextmanager
def bench(*arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(
        [*BENCH, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    with process:
        try:
            yield process
        finally:
            process.kill()


def said(process: subprocess.Popen[bytes]) -> dict[str, Any]:
    assert process.stdout
    return json.loads(process.stdout.readline())


def test_it_says_where_it_is_and_ends_cleanly_with_the_speed_when_its_input_ends() -> None:
    with bench(str(CONFIG), "--seed", "7") as process:
        ports = said(process)
        assert ports.keys() == {"motor", "daq", "seed"}
        assert ports["seed"] == 7
        with serial.Serial(str(ports["daq"]["port"]), timeout=5) as daq:
            daq.write(b"ID?\n")
            assert daq.read(3) == b"\xa5\x5a\x01"
        out, err = process.communicate(timeout=10)  # closes its input
        assert (process.returncode, err) == (0, b"")
        (last,) = out.splitlines()
        assert json.loads(last).keys() == {"t", "wall", "speed"}


def test_it_ends_cleanly_when_interrupted_while_it_streams() -> None:
    with bench(str(CONFIG), "--seed", "7") as process:
        with serial.Serial(str(said(process)["daq"]["port"]), timeout=5) as daq:
            daq.write(b"START\n")
            assert daq.read(2) == b"\xa5\x5a"
            process.send_signal(signal.SIGINT)
            assert process.wait(10) == 0
        assert process.stderr
        assert process.stderr.read() == b""


@pytest.mark.campaign
def test_a_sealed_truth_is_used_and_its_seed_kept_secret(tmp_path: Path) -> None:
    sealed = tmp_path / "sealed.json"
    seal(draw(load(CONFIG), seed=4242), sealed)
    with bench(str(CONFIG), "--seed", "7", "--hidden", str(sealed)) as process:
        assert said(process)["seed"] is None


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["/nowhere/rig.toml"], "/nowhere/rig.toml: cannot be read"),
        ([str(CONFIG), "--hidden", "/nowhere/sealed.json"], "/nowhere/sealed.json: cannot be read"),
        ([str(CONFIG), "--faults", "/nowhere/script.json"], "/nowhere/script.json: cannot be read"),
    ],
)
def test_what_it_cannot_use_is_named_in_a_sentence(
    arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(sentence)
    assert err.count("\n") == 1


@pytest.mark.parametrize("rate", ["0", "-1", "fast", "nan", "inf"])
def test_a_rate_that_is_none_is_refused(rate: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main([str(CONFIG), f"--rate={rate}"])
    assert f"got '{rate}', want a number above 0" in capsys.readouterr().err


def test_a_config_without_a_drive_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = CONFIG.read_text()
    config = tmp_path / "rig.toml"
    config.write_text(text[: text.index("[motor]")] + text[text.index("[daq]") :])
    assert main([str(config)]) == 2
    assert capsys.readouterr().err == f"{config}: has no [motor], want one: the bench emulates what it names\n"


def test_it_dies_with_a_parent_that_was_killed(children: Callable[[int], set[int]]) -> None:
    parent = subprocess.Popen(
        [sys.executable, "-c", _PARENT, str(CONFIG)], stdout=subprocess.PIPE, start_new_session=True
    )
    with parent:
        assert parent.stdout
        assert parent.stdout.readline() == b"running\n"
        (child,) = children(parent.pid)
        parent.kill()
        parent.wait(10)
    until = time.monotonic() + 10
    while _alive(child) and time.monotonic() < until:
        time.sleep(0.02)
    assert not _alive(child)


def _alive(process: int) -> bool:
    """Whether it runs; a zombie nobody in a container reaps does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


_PARENT = """
import sys, time
from pathlib import Path
from rotorrig.sims.wire.launch import simulated_bench
with simulated_bench(Path(sys.argv[1]), seed=1):
    print("running", flush=True)
    time.sleep(60)
"""


@pytest.mark.campaign
def test_without_an_input_to_watch_it_runs_until_told() -> None:
    with Path(os.devnull).open("rb") as nothing:
        process = subprocess.Popen([*BENCH, str(CONFIG)], stdin=nothing, stdout=subprocess.PIPE)
    with process:
        said(process)
        time.sleep(0.2)
        assert process.poll() is None
        process.terminate()
        assert process.wait(10) == 0


MOTORS = {
    "modbus-rtu": '[motor]\ndriver = "modbus-rtu"\nport = "unused"\nmax_speed = "4200 rpm"\n',
    "modbus-tcp": '[motor]\ndriver = "modbus-tcp"\nhost = "unused"\nmax_speed = "4200 rpm"\n',
    "serial-line": '[motor]\ndriver = "serial-line"\nport = "unused"\nmax_speed = "4200 rpm"\n',
    "canopen": '[motor]\ndriver = "canopen"\nchannel = "unused"\nmax_speed = "4200 rpm"\n',
}
SEEN = ("modbus-tcp", "serial-line")  # one that listens and one that does not; the others in `make test-all`


@pytest.mark.parametrize(
    "driver", [pytest.param(name, marks=[] if name in SEEN else pytest.mark.campaign) for name in MOTORS]
)
def test_it_listens_on_the_loopback_alone(driver: str, tmp_path: Path) -> None:
    text = CONFIG.read_text()
    config = tmp_path / "rig.toml"
    config.write_text(text[: text.index("[motor]")] + MOTORS[driver] + text[text.index("[daq]") :])
    with bench(str(config)) as process:
        motor = said(process)["motor"]
        listening = [c.laddr for c in psutil.Process(process.pid).net_connections("inet") if c.raddr == ()]
    assert {address.ip for address in listening} == ({"127.0.0.1"} if driver == "modbus-tcp" else set())
    assert ("127.0.0.1", motor.get("tcp_port")) in listening or driver != "modbus-tcp"


def test_it_plays_the_scripts_on_its_input_and_says_what_came_of_them(tmp_path: Path) -> None:
    script = tmp_path / "script.json"
    script.write_text('[{"kind": "silent", "on": "motor", "lasts": 0.2}]')
    with bench(str(CONFIG), "--faults", str(script)) as process:
        port = said(process)["daq"]["port"]
        begins, ends = said(process), said(process)
        assert (begins["event"], ends["event"], ends["kind"]) == ("begins", "ends", "silent")
        assert ends["wall"] - begins["wall"] == pytest.approx(0.2, abs=0.1)
        assert process.stdin
        for line in ("[]", "[3]", '[{"kind": "disconnect", "on": "daq"}]'):
            process.stdin.write(f"{line}\n".encode())
        process.stdin.flush()
        assert said(process) == {"t": 0.0, "wall": pytest.approx(time.monotonic(), abs=5), "speed": 0.0, "played": 0}
        assert said(process)["refused"].startswith("script: faults[0]: ")
        assert said(process)["event"] == "begins"
        assert said(process)["played"] == 1
        assert not Path(port).exists()


def test_nobody_who_reads_what_it_says_holds_up_its_emulators() -> None:
    with bench(str(CONFIG)) as process:
        port = said(process)["daq"]["port"]
        assert process.stdin
        for _ in range(2000):  # answers of 60 bytes each, twice what a pipe holds
            process.stdin.write(b"[]\n")
        process.stdin.flush()
        with serial.Serial(str(port), timeout=5) as daq:
            daq.write(b"ID?\n")
            assert daq.read(3) == b"\xa5\x5a\x01"


@pytest.mark.campaign
def test_what_the_client_of_the_daq_is_sent_is_kept_if_wanted(tmp_path: Path) -> None:
    kept = tmp_path / "wire"
    with bench(str(CONFIG), "--wire", str(kept)) as process, serial.Serial(said(process)["daq"]["port"]) as daq:
        daq.timeout = 5
        daq.write(b"ID?\n")
        head = daq.read(6)
        sent = head + daq.read(int.from_bytes(head[4:6], "little") + 4)
        process.communicate(timeout=60)  # closes its input: what was sent has been kept when it has ended
    assert kept.read_bytes() == sent


def test_a_wire_that_cannot_be_kept_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main([str(CONFIG), "--wire", str(tmp_path)])
    assert "argument --wire: can't open" in capsys.readouterr().err
