"""What every motor driver owes its user, run against the emulators over real wires, or on the bench with `--rig`.

One simulated bench serves all tests of a controller; it is in another process and knows nothing of the drivers.
"""

import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from rotorrig.rig.config.description import load, parse
from rotorrig.rig.config.devices import LineController, ModbusRtu, ModbusTcp
from rotorrig.rig.errors import ConfigError, LimitExceeded, LinkLost, RigError
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.motor.base import MotorDriver, Stop
from rotorrig.sims.wire.launch import simulated_bench
from tests.contracts.stands import MOTORS, RPM, Stand, Stream, at_rest, cleared, config, readings

ALWAYS = ("powerflex400-rtu", "serial-line")  # one by registers, one by lines of text; the others in `make test-all`
NOTICED = 2.0  # s of wall time for a driver to know that its link is lost
AT_REST = 30.0  # s of wall time for a simulated rotor to coast down, on a busy machine


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    real = metafunc.config.getoption("--rig")
    emulated = [pytest.param(name, marks=[] if name in ALWAYS else pytest.mark.campaign) for name in MOTORS]
    metafunc.parametrize("stand", [real] if real else emulated, indirect=True, scope="module")


@pytest.fixture(scope="module")
def stand(request: pytest.FixtureRequest) -> Iterator[Stand]:
    if request.param not in MOTORS:
        yield Stand(load(Path(request.param)), None)
        return
    text = config(request.param)
    with simulated_bench(text, seed=5) as ports:
        yield Stand(parse(text, where=request.param), ports)


@pytest.fixture
def motor(stand: Stand) -> Iterator[MotorDriver]:
    with stand.motor() as motor:
        motor.open()
        yield motor
        motor.stop(Stop.EMERGENCY)


@pytest.fixture
def stream(stand: Stand, motor: MotorDriver) -> Iterator[Stream]:
    with stand.daq() as daq:
        info = daq.open()
        daq.start()
        yield Stream(daq, info, Interlock(stand.rig, info), motor)
        daq.stop()  # first: simulated time waits for who reads its samples


def test_it_says_what_and_where_it_is_and_a_drive_not_yet_started_is_at_rest(stand: Stand) -> None:
    with stand.motor() as motor:
        info = motor.open()
        assert info.model
        if stand.ports:
            assert str(next(v for k, v in stand.ports.motor.items() if k in ("port", "channel", "host"))) in info.link
        motor.stop(Stop.COAST)
        state = motor.read()
        assert (state.running, state.setpoint, state.fault) == (False, 0.0, "")


def test_the_rotor_goes_where_it_is_told_at_the_ramp_asked_for_and_the_keyphasor_agrees(
    stand: Stand, motor: MotorDriver, stream: Stream
) -> None:
    plan = stand.plan
    motor.set_speed(plan.slow_roll, ramp=plan.ramp)
    stream.steady_at(plan.slow_roll)
    way = plan.start - plan.slow_roll
    motor.set_speed(plan.start, ramp=plan.ramp)
    crossings = []
    for share in (0.25, 0.85):
        stream.until(lambda share=share: stream.speed() > plan.slow_roll + share * way)
        crossings.append(stream.time())
    assert 0.6 * way / (crossings[1] - crossings[0]) == pytest.approx(plan.ramp, rel=0.05)
    stream.steady_at(plan.start)
    state = motor.read()
    assert state.running
    assert state.at_setpoint
    assert state.setpoint == pytest.approx(plan.start, abs=RPM)  # the coarsest reference counts whole rpm
    assert state.speed == pytest.approx(plan.start, rel=0.01)
    stream.interlock.check_motor(state)


def test_each_way_to_stop_does_as_it_says_and_may_be_repeated(stand: Stand, motor: MotorDriver, stream: Stream) -> None:
    speed, ramp, coasts = stand.plan.slow_roll, stand.plan.ramp, motor.open().coasts
    for kind in (Stop.COAST, Stop.RAMP, Stop.EMERGENCY):
        motor.set_speed(speed, ramp=ramp)
        stream.steady_at(speed)
        motor.stop(kind)
        motor.stop(kind)
        if kind is Stop.COAST and coasts:
            assert not motor.read().running
            stream.blocks(2.0)  # those of before, and of the ramp that some drives begin a coast stop with
            began, fast = stream.time(), stream.speed()
            stream.until(lambda fast=fast: stream.speed() < 0.95 * fast)
            # friction alone takes the simulated rotor some 30 s to rest; what it does to a real one is not known
            assert not stand.ports or stream.time() - began > 2 * 0.05 * fast / ramp
        else:
            stream.until(lambda: stream.speed() < speed / 3, seconds=2.0 + 2 * speed / ramp)
            stream.until(lambda: not motor.read().running)


def test_speeds_and_ramps_beyond_the_rig_are_refused_before_anything_moves(stand: Stand, motor: MotorDriver) -> None:
    assert stand.rig.motor
    at_rest(motor)
    with pytest.raises(LimitExceeded, match=r"asked for \d+ rpm"):
        motor.set_speed(stand.rig.motor.max_speed * 1.03, ramp=stand.plan.ramp)
    for ramp in (1e-6 * RPM, 1e9 * RPM):
        with pytest.raises(ConfigError, match="ramp: got "):
            motor.set_speed(stand.plan.slow_roll, ramp=ramp)
    assert not motor.read().running


def test_it_may_be_read_from_one_thread_while_another_commands(stand: Stand, motor: MotorDriver) -> None:
    faults: list[BaseException] = []
    done = threading.Event()

    def read() -> None:
        try:
            while not done.is_set():
                motor.read()
                time.sleep(0.005)
        except BaseException as error:
            faults.append(error)

    reader = threading.Thread(target=read)
    reader.start()
    try:
        for _ in range(3):
            motor.set_speed(stand.plan.slow_roll, ramp=stand.plan.ramp)
            motor.stop(Stop.RAMP)
    finally:
        done.set()
        reader.join(10.0)
    assert faults == []


def test_an_open_port_is_refused_to_a_second_user(stand: Stand) -> None:
    if not isinstance(stand.rig.motor, ModbusRtu | LineController):
        pytest.skip("not a serial port of its own: others may listen")
    with stand.motor() as first, stand.motor() as second:
        first.open()
        with pytest.raises(LinkLost, match="in use by another program"):
            second.open()


def test_closing_twice_is_closing_and_a_closed_one_may_be_opened_again(stand: Stand) -> None:
    motor = stand.motor()
    motor.open()
    motor.close()
    motor.close()
    with pytest.raises(LinkLost):
        motor.read()
    with motor:
        motor.open()
        assert not motor.read().running


@pytest.mark.parametrize("kind", ["drop", "corrupt", "duplicate"])
@pytest.mark.parametrize("direction", ["to-device", "from-device"])
def test_one_disturbed_message_is_no_loss(stand: Stand, motor: MotorDriver, kind: str, direction: str) -> None:
    if isinstance(stand.rig.motor, ModbusTcp) and kind == "corrupt":
        pytest.skip("TCP has checksums of its own; behind them Modbus TCP has none")
    stand.console.play([{"kind": kind, "on": "motor", "direction": direction, "count": 1}])
    assert not motor.read().running
    for _ in range(5):  # nor does anything stay in the line
        assert not motor.read().running


@pytest.mark.parametrize("kind", ["silent", "disconnect"])
def test_a_lost_link_is_known_at_once_and_opened_again_when_it_is_back(stand: Stand, kind: str) -> None:
    with stand.motor() as motor:
        motor.open()
        motor.set_speed(stand.plan.slow_roll, ramp=stand.plan.ramp)
        stand.console.play([{"kind": kind, "on": "motor"}])
        began = time.monotonic()
        with pytest.raises(LinkLost) as caught:
            readings(motor, seconds=10)
        assert time.monotonic() - began < NOTICED
        assert "\n" not in str(caught.value)
        stand.console.play([], calm=True)
        motor.open()
        at_rest(motor)
        cleared(motor)


@pytest.mark.parametrize("fault", [{}, {"address": 7}], ids=["stranger", "other address"])
def test_another_device_at_the_port_is_no_drive(stand: Stand, fault: dict[str, int]) -> None:
    if fault and not isinstance(stand.rig.motor, ModbusRtu | ModbusTcp):
        pytest.skip("has no Modbus address")
    stand.console.play([{"kind": "wrong-device", "on": "motor", **fault}])
    with stand.motor() as motor, pytest.raises(RigError) as caught:
        motor.open()
    assert "\n" not in str(caught.value)
    stand.console.play([], calm=True)
    with stand.motor() as motor:
        motor.open()


def test_a_drive_whose_master_was_killed_stops_the_rotor_by_itself(stand: Stand, tmp_path: Path) -> None:
    console = stand.console
    with stand.motor() as motor:
        watchdog = motor.open().watchdog
    if watchdog is None:
        pytest.skip("this drive has no watchdog, and its driver says so")
    assert stand.ports
    ramp, speed = stand.plan.ramp, stand.plan.slow_roll
    arguments = (stand.rig.text, repr(dict(stand.ports.motor)), str(speed), str(ramp))
    with subprocess.Popen([sys.executable, "-c", _MASTER, *arguments], stdout=subprocess.PIPE) as master:
        assert master.stdout
        assert master.stdout.readline() == b"running\n"
        assert console.speed() > 0.9 * speed
        master.kill()
    killed = time.monotonic()
    rests = console.wait_for(
        lambda line: line.get("event") == "rests" and line["wall"] > killed, timeout=watchdog + AT_REST
    )
    assert rests["wall"] - killed > watchdog - 0.5  # its watchdog's doing, not the kill's
    with stand.motor() as motor:
        motor.open()
        cleared(motor)


_MASTER = """
import ast, sys, time
from rotorrig.rig import connect
from rotorrig.rig.config.description import parse
text, place, speed, ramp = sys.argv[1:]
motor = connect.motor(parse(text, where="rig"), at=ast.literal_eval(place))
motor.open()
motor.set_speed(float(speed), ramp=float(ramp))
while True:
    if motor.read().at_setpoint:
        print("running", flush=True)
    time.sleep(0.1)
"""


def test_a_trip_of_the_drive_is_read_and_refuses_a_start(stand: Stand) -> None:
    with stand.motor() as motor:
        motor.open()
        motor.set_speed(stand.plan.slow_roll, ramp=stand.plan.ramp)
        stand.console.play([{"kind": "drive-fault"}])
        state = motor.read()
        assert state.fault
        assert not state.running
        with pytest.raises(LimitExceeded, match=r"fault|tripped"):
            motor.set_speed(stand.plan.slow_roll, ramp=stand.plan.ramp)
