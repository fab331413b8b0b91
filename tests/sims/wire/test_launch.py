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
        with serial.Serial(ports.daq_port, timeout=5) as daq:
            daq.write(b"ID?\n")
            assert daq.read(3) == b"\xa5\x5a\x01"
        with serial.Serial(ports.motor_port, timeout=5) as motor:
            motor.write(bytes.fromhex("64 03 21 00 00 01 87 c3"))
            assert motor.read(5).hex(" ") == "64 03 02 06 0d"
        raise ZeroDivisionError
    with pytest.raises(serial.SerialException):
        serial.Serial(ports.motor_port)


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
