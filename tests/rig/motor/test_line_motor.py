"""The line protocol over a real pty: what the driver sends, and what it says of a far end that misbehaves."""

import math
import threading
import time
from collections import deque
from collections.abc import Iterator
from pathlib import Path

import pytest

from rotorrig.rig.config.devices import LineController
from rotorrig.rig.errors import ConfigError, LimitExceeded, LinkLost
from rotorrig.rig.motor import line_motor
from rotorrig.rig.motor.base import Stop
from rotorrig.rig.motor.line_motor import LineMotor
from tests.rig.wire_fakes import Wire, wait_for

RPM = math.pi / 30


def framed(text: str) -> bytes:
    """A line as docs/motor-line.md has it; the CRC by long division of the message followed by 16 zeros."""
    rest = int.from_bytes(text.encode("ascii") + bytes(2), "big") ^ 0xFFFF << 8 * len(text)
    for bit in reversed(range(16, rest.bit_length())):
        if rest >> bit & 1:
            rest ^= 0x11021 << bit - 16
    return f"{text}*{rest:04X}\n".encode("ascii")


class Controller(Wire):
    """Answers from a table, with faults on demand; `heard` is what came, line by line."""

    def __init__(self) -> None:
        super().__init__()
        self.says = {
            "ID": "OK 1 360000 600000 output RK4 bench controller, rev B",
            "WATCHDOG 2000": "OK 2000",
            "STATE": "OK 0 0 off -",
        }
        self.heard: list[str] = []
        self.spoil: deque[str] = deque()  # for the next replies: "drop", "corrupt", "late", "twice", "in noise"
        self.deaf_to: str | None = None  # what it does not answer
        self.obeys = True
        self._kept = b""
        self._line = b""

    def received(self, data: bytes) -> None:
        *lines, self._line = (self._line + data).split(b"\n")
        for line in lines:
            text = line.decode("ascii")
            assert framed(text.rpartition("*")[0]) == line + b"\n"
            self.heard.append(text)
            self._answer(text[1:3], text[4:].rpartition("*")[0])

    def requests(self) -> list[str]:
        """What came, without numbers and CRCs."""
        return [text[4:].rpartition("*")[0] for text in self.heard]

    def _answer(self, number: str, request: str) -> None:
        if self.deaf_to is not None and request.startswith(self.deaf_to):
            return
        if request.startswith("SPEED"):
            self.says["STATE"] = "OK 0 60000 ramping -"
        if request.startswith("STOP") and self.obeys:
            self.says["STATE"] = f"OK 0 0 {'off' if request == 'STOP COAST' else 'stopping'} -"
        reply = framed(f"<{number} {self.says.get(request, 'OK')}")
        match self.spoil.popleft() if self.spoil else "":
            case "drop":
                return
            case "corrupt":
                reply = reply.replace(b"K", b"L", 1)
            case "late":
                self._kept, reply = reply, b""
            case "twice":
                reply *= 2
            case "in noise":
                reply = b"\x00\xff<0" + reply[:5] + reply + b"<1"
        kept, self._kept = (self._kept, b"") if reply else (b"", self._kept)
        self.send(kept + reply)


@pytest.fixture
def controller() -> Iterator[Controller]:
    controller = Controller()
    controller.start()
    yield controller
    controller.unplug()


def motor_at(port: str, **changed: object) -> LineMotor:
    table = {"driver": "serial-line", "port": port, "max_speed": 4200 * RPM} | changed
    return LineMotor(LineController.model_validate(table, context={"si": True}))


@pytest.fixture
def motor(controller: Controller) -> Iterator[LineMotor]:
    with motor_at(controller.port) as motor:
        motor.open()
        controller.heard.clear()
        yield motor


def test_it_begins_with_id_and_sets_the_watchdog(controller: Controller) -> None:
    with motor_at(controller.port) as motor:
        info = motor.open()
    assert controller.heard == [">00 ID*B8EA", ">01 WATCHDOG 2000*1BBA"]  # the spec's own
    assert info.model == "RK4 bench controller, rev B"
    assert info.link == f"line protocol, {controller.port}, 115200 baud"
    assert info.watchdog == 2.0


def test_a_controller_that_watches_nothing_is_said_to(controller: Controller) -> None:
    controller.says["WATCHDOG 2000"] = "OK 0"
    with motor_at(controller.port) as motor:
        assert motor.open().watchdog is None


def test_a_start_is_one_command(controller: Controller, motor: LineMotor) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    assert controller.heard[0] == ">02 SPEED 120000 3000*B1BF"
    assert controller.requests() == ["SPEED 120000 3000", "STATE"]
    state = motor.read()
    assert (state.setpoint, state.running, state.at_setpoint) == (pytest.approx(600 * RPM), True, False)


@pytest.mark.parametrize("kind", Stop)
def test_a_stop_is_the_first_thing_sent(controller: Controller, motor: LineMotor, kind: Stop) -> None:
    motor.stop(kind)
    motor.stop(kind)
    assert controller.requests() == [f"STOP {kind.name}", "STATE"] * 2


@pytest.mark.parametrize("fault", ["drop", "corrupt", "in noise", "twice"])
def test_a_spoilt_reply_costs_at_most_a_repetition_under_the_same_number(
    controller: Controller, motor: LineMotor, fault: str
) -> None:
    controller.spoil.append(fault)
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    motor.read()
    speeds = [line for line in controller.heard if "SPEED" in line]
    assert speeds == [">02 SPEED 120000 3000*B1BF"] * (2 if fault in ("drop", "corrupt") else 1)


def test_a_late_reply_is_not_taken_for_another(controller: Controller, motor: LineMotor) -> None:
    controller.says["STATE"] = "OK 100 100 at-speed -"
    controller.spoil.extend(["late", "drop", "drop", "drop"])
    with pytest.raises(LinkLost, match="asked 'STATE', no valid answer in 4 tries"):
        motor.read()
    controller.says["STATE"] = "OK 200 200 at-speed -"
    assert motor.read().speed == pytest.approx(2 * RPM)  # the answer to the first came just before it


def test_a_silent_controller_is_given_up_within_a_second_or_so(controller: Controller, motor: LineMotor) -> None:
    controller.deaf_to = ""
    began = time.monotonic()
    with pytest.raises(LinkLost, match=r"asked 'STATE', no valid answer in 4 tries of 0\.2\d? s$"):
        motor.read()
    assert time.monotonic() - began < 2.0
    assert len(set(controller.heard)) == 1


def test_noise_is_named(controller: Controller, motor: LineMotor) -> None:
    controller.spoil.extend(["corrupt"] * 4)
    with pytest.raises(LinkLost, match=r"\(\d+ bytes came that are no reply; is it another device or baud rate\?\)"):
        motor.read()


def test_a_stop_overtakes_a_request_that_waits_to_be_repeated(controller: Controller, motor: LineMotor) -> None:
    controller.deaf_to = "STATE"
    failures: list[LinkLost] = []

    def poll() -> None:
        try:
            motor.read()
        except LinkLost as error:
            failures.append(error)

    polling = threading.Thread(target=poll)
    polling.start()
    wait_for(lambda: controller.requests() == ["STATE"])
    with pytest.raises(LinkLost):  # it has been told, but does not say that it stops
        motor.stop(Stop.EMERGENCY)
    polling.join()
    assert controller.requests()[:2] == ["STATE", "STOP EMERGENCY"]
    numbers = [int(line[1:3], 16) for line in controller.heard]
    assert numbers == sorted(numbers)  # the repetition took a new number: with its old one it would be late
    assert failures


def starting(motor: LineMotor, failures: list[str]) -> threading.Thread:
    """Start the motor in a thread of its own."""

    def start() -> None:
        try:
            motor.set_speed(1200 * RPM, ramp=30 * RPM)
        except LinkLost as error:
            failures.append(str(error))

    thread = threading.Thread(target=start)
    thread.start()
    return thread


def test_a_speed_without_a_reply_is_given_up_once_a_stop_has_gone_out(controller: Controller, motor: LineMotor) -> None:
    controller.deaf_to = "SPEED"
    failures: list[str] = []
    thread = starting(motor, failures)
    wait_for(lambda: controller.requests() == ["SPEED 120000 3000"])
    motor.stop(Stop.COAST)
    thread.join()
    assert controller.requests().count("SPEED 120000 3000") == 1
    assert "was about to be sent, but a stop came before; it is given up" in failures[0]


def test_a_speed_that_still_waits_when_a_stop_comes_is_never_sent(controller: Controller, motor: LineMotor) -> None:
    controller.spoil.append("drop")  # a reading that waits for its reply
    failures: list[str] = []
    reading = threading.Thread(target=motor.read)
    reading.start()
    wait_for(lambda: controller.requests() == ["STATE"])
    thread = starting(motor, failures)
    time.sleep(0.02)
    motor.stop(Stop.EMERGENCY)
    thread.join()
    reading.join()
    assert controller.requests()[:2] == ["STATE", "STOP EMERGENCY"]
    assert "SPEED 120000 3000" not in controller.requests()
    assert failures


def test_a_speed_whose_reply_is_lost_is_repeated_though_another_thread_reads(
    controller: Controller, motor: LineMotor
) -> None:
    controller.spoil.append("drop")
    failures: list[str] = []
    thread = starting(motor, failures)
    wait_for(lambda: controller.requests() == ["SPEED 120000 3000"])
    motor.read()  # waits for the try under way, and comes before the next
    thread.join()
    assert controller.requests() == ["SPEED 120000 3000", "STATE", "SPEED 120000 3000", "STATE"]
    assert [line[1:3] for line in controller.heard] == ["02", "03", "04", "05"]
    assert failures == []


def test_nothing_is_sent_when_speed_or_ramp_is_refused(controller: Controller, motor: LineMotor) -> None:
    with pytest.raises(LimitExceeded, match="asked for 3700 rpm, want 0 to 3600 rpm"):  # the controller's own limit
        motor.set_speed(3700 * RPM, ramp=30 * RPM)
    with pytest.raises(ConfigError, match=r"ramp: got 6100 rpm/s, want 0\.01 to 6000 rpm/s"):
        motor.set_speed(600 * RPM, ramp=6100 * RPM)
    assert controller.heard == []


def test_a_trip_is_named_and_forbids_a_start(controller: Controller, motor: LineMotor) -> None:
    controller.says["STATE"] = "OK 0 0 off over-current of the bridge"
    controller.says["SPEED 120000 3000"] = "ERR fault over-current of the bridge"
    assert motor.read().fault == "over-current of the bridge"
    with pytest.raises(LimitExceeded, match=r"over-current of the bridge'; see .*--clear-fault"):
        motor.set_speed(1200 * RPM, ramp=30 * RPM)
    controller.says["CLEAR"] = "ERR fault over-current of the bridge"
    with pytest.raises(LimitExceeded, match="its cause is still there"):
        motor.clear_fault()


def test_a_controller_that_does_not_obey_is_said(
    controller: Controller, motor: LineMotor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(line_motor, "CONFIRM_SECONDS", 0.1)
    motor.set_speed(600 * RPM, ramp=30 * RPM)
    controller.obeys = False
    with pytest.raises(LinkLost, match="took 'STOP RAMP' but did not obey within"):
        motor.stop(Stop.RAMP)


@pytest.mark.parametrize(
    ("identity", "message"),
    [
        ("OK 2 360000 600000 output X", "got protocol version 2, want 1"),
        ("OK hello", "ID: got 'hello'"),
        ("ERR command what?", "refuses 'ID' with 'command': what?"),
    ],
)
def test_another_device_is_said(controller: Controller, identity: str, message: str) -> None:
    controller.says["ID"] = identity
    with motor_at(controller.port) as motor, pytest.raises(LinkLost, match=message):
        motor.open()


def test_a_board_that_boots_when_opened_is_waited_for(controller: Controller) -> None:
    controller.spoil.extend(["drop"] * 5)  # a second: more than the tries of any other request
    with motor_at(controller.port) as motor:
        assert motor.open().model == "RK4 bench controller, rev B"


def test_a_stop_that_is_not_obeyed_is_followed_by_another_kind_and_nothing_between(
    controller: Controller, motor: LineMotor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(line_motor, "CONFIRM_SECONDS", 0.1)
    motor.set_speed(600 * RPM, ramp=30 * RPM)
    controller.obeys = False
    controller.heard.clear()
    for kind in (Stop.RAMP, Stop.EMERGENCY, Stop.COAST):
        with pytest.raises(LinkLost, match=f"took 'STOP {kind.name}' but did not obey within"):
            motor.stop(kind)
    controller.says["STATE"] = "OK 60000 0 stopping -"  # it goes down its ramp, but was told to switch off
    with pytest.raises(LinkLost, match="took 'STOP COAST' but did not obey within"):
        motor.stop(Stop.COAST)
    told = [request for request in controller.requests() if request != "STATE"]
    assert told == ["STOP RAMP", "STOP EMERGENCY", "STOP COAST", "STOP COAST"]


def test_a_cut_wire_is_a_lost_link(controller: Controller, motor: LineMotor) -> None:
    controller.unplug()
    with pytest.raises(LinkLost, match="asked 'STATE', but the port is gone; was it unplugged"):
        motor.read()
    with pytest.raises(LinkLost):
        motor.stop(Stop.EMERGENCY)


def test_after_a_loss_it_opens_what_its_path_leads_to_now(controller: Controller, tmp_path: Path) -> None:
    path = tmp_path / "by-id"
    path.symlink_to(controller.port)
    with motor_at(str(path)) as motor:
        motor.open()
        controller.unplug()
        with pytest.raises(LinkLost):
            motor.read()
        other = Controller()
        other.start()
        path.unlink()
        path.symlink_to(other.port)
        try:
            assert motor.open().watchdog == 2.0
            assert other.heard[0] == ">00 ID*B8EA"
        finally:
            other.unplug()


def test_a_port_that_is_not_there_or_in_use_is_said(controller: Controller, motor: LineMotor) -> None:
    with pytest.raises(LinkLost, match=r"^/dev/ttyNOSUCH: the controller's port cannot be opened \(no such port"):
        motor_at("/dev/ttyNOSUCH").open()
    with pytest.raises(LinkLost, match="in use by another program"):
        motor_at(controller.port).open()


def test_a_closed_link_is_said_and_may_be_closed_again(motor: LineMotor) -> None:
    motor.close()
    motor.close()
    with pytest.raises(LinkLost, match="asked 'STATE', but the link is not open"):
        motor.read()


def test_closing_does_not_stop_the_rotor(controller: Controller, motor: LineMotor) -> None:
    motor.set_speed(480 * RPM, ramp=30 * RPM)
    motor.close()
    assert not any("STOP" in line for line in controller.heard)
