import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest
import serial

from rotorrig.rig.errors import RigError
from rotorrig.sims.wire.launch import simulated_bench

CONFIG = Path(__file__).parents[3] / "configs" / "rk4.toml"


def test_both_ports_answer_and_are_gone_after_a_fault_in_the_block_that_is_passed_on() -> None:
    with pytest.raises(ZeroDivisionError), simulated_bench(CONFIG.read_text(), seed=1) as ports:
        with serial.Serial(ports.daq["port"], timeout=5) as daq:
            daq.write(b"ID?\n")
            assert daq.read(3) == b"\xa5\x5a\x01"
        with serial.Serial(ports.motor["port"], timeout=5) as motor:
            motor.write(bytes.fromhex("64 03 21 00 00 01 87 c3"))
            assert motor.read(5).hex(" ") == "64 03 02 06 0d"
        raise ZeroDivisionError
    with pytest.raises(serial.SerialException):
        serial.Serial(ports.motor["port"])


def test_a_bench_that_does_not_start_speaks_for_itself() -> None:
    said = pytest.raises(RigError, match=r"did not start: .*config\.toml: name: is missing")
    with said, simulated_bench("[shaft]\n", seed=1):
        pass


def test_a_bench_that_is_too_slow_is_given_up() -> None:
    said = pytest.raises(RigError, match=r"did not start within 0\.01 s")
    with said, simulated_bench(CONFIG, seed=1, timeout=0.01):
        pass


def test_a_bench_that_died_under_way_is_reported(children: Callable[[int], set[int]]) -> None:
    before = children(os.getpid())
    with pytest.raises(RigError, match="ended by itself"), simulated_bench(CONFIG, seed=1):
        (child,) = children(os.getpid()) - before
        os.kill(child, 9)
        time.sleep(0.2)


def test_its_console_plays_scripts_and_tells_the_true_speed() -> None:
    with simulated_bench(CONFIG, seed=1) as ports:
        assert ports.console.speed() == 0.0
        with pytest.raises(RigError, match=r"script: faults\[0\]\.kind: got 'fire', want one of drop, "):
            ports.console.play([{"kind": "fire"}])
        ports.console.play([{"kind": "disconnect", "on": "motor", "lasts": 0.1}])
        ports.console.wait_for(lambda line: line.get("event") == "ends", timeout=5)
        assert [line["event"] for line in ports.console.messages] == ["begins", "ends"]


@pytest.mark.campaign
def test_a_script_of_faults_is_played_from_the_start(tmp_path: Path) -> None:
    script = tmp_path / "script.json"
    script.write_text('[{"kind": "disconnect", "on": "daq"}]')
    with simulated_bench(CONFIG, seed=1, faults=script) as ports:
        assert ports.console.wait_for(lambda line: "fault" in line, timeout=5)["kind"] == "disconnect"
        assert not Path(ports.daq["port"]).exists()
