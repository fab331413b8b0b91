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

import pytest
import serial

from rotorrig.rig.description import load
from rotorrig.sims.plant import truth
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


def said(process: subprocess.Popen[bytes]) -> dict[str, object]:
    assert process.stdout
    return json.loads(process.stdout.readline())


def test_it_says_one_line_and_ends_cleanly_when_its_input_ends() -> None:
    with bench(str(CONFIG), "--seed", "7") as process:
        ports = said(process)
        assert ports.keys() == {"motor_port", "daq_port", "seed"}
        assert ports["seed"] == 7
        with serial.Serial(str(ports["daq_port"]), timeout=5) as daq:
            daq.write(b"ID?\n")
            assert daq.read(3) == b"\xa5\x5a\x01"
        out, err = process.communicate(timeout=10)  # closes its input
        assert (process.returncode, out, err) == (0, b"", b"")


def test_it_ends_cleanly_when_interrupted_while_it_streams() -> None:
    with bench(str(CONFIG), "--seed", "7") as process:
        with serial.Serial(str(said(process)["daq_port"]), timeout=5) as daq:
            daq.write(b"START\n")
            assert daq.read(2) == b"\xa5\x5a"
            process.send_signal(signal.SIGINT)
            assert process.wait(10) == 0
        assert process.stderr
        assert process.stderr.read() == b""


def test_a_sealed_truth_is_used_and_its_seed_kept_secret(tmp_path: Path) -> None:
    sealed = tmp_path / "sealed.json"
    truth.seal(truth.draw(load(CONFIG), seed=4242), sealed)
    with bench(str(CONFIG), "--seed", "7", "--hidden", str(sealed)) as process:
        assert said(process)["seed"] is None


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["/nowhere/rig.toml"], "/nowhere/rig.toml: cannot be read"),
        ([str(CONFIG), "--hidden", "/nowhere/sealed.json"], "/nowhere/sealed.json: cannot be read"),
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


def test_without_an_input_to_watch_it_runs_until_told() -> None:
    with Path(os.devnull).open("rb") as nothing:
        process = subprocess.Popen([*BENCH, str(CONFIG)], stdin=nothing, stdout=subprocess.PIPE)
    with process:
        said(process)
        time.sleep(0.2)
        assert process.poll() is None
        process.terminate()
        assert process.wait(10) == 0
