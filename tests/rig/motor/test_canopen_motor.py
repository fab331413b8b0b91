"""The CiA 402 driver: frames on a bus, faults of a node, and a real tty with an slcan adapter.

The far end is a node of its own making, from CiA 301 and 402; behind the tty it is the `canopen` library's.
"""

import asyncio
import itertools
import math
import threading
import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import can
import pytest

from rotorrig.rig.clock import WallClock
from rotorrig.rig.config.devices import CanOpen
from rotorrig.rig.errors import ConfigError, LimitExceeded, LinkLost
from rotorrig.rig.motor import can_link, canopen_motor
from rotorrig.rig.motor.base import Stop
from rotorrig.rig.motor.canopen_motor import CanOpenMotor
from rotorrig.sims.wire.cables.pty_bridge import PtyBridge
from rotorrig.sims.wire.motors.can_motor import serve_slcan
from rotorrig.sims.wire.motors.cia402 import Cia402
from tests.rig.wire_fakes import wait_for
from tests.sims.wire.conftest import ToyPlant, in_background

RPM = math.pi / 30
CHANNEL = "test_canopen_motor"
NODE = 5
READY, SWITCHED_ON, ENABLED, QUICK_STOP, DISABLED, FAULT = 0x231, 0x233, 0x237, 0x217, 0x250, 0x218
NEXT = {0x00: DISABLED, 0x02: QUICK_STOP, 0x06: READY, 0x07: SWITCHED_ON, 0x7F: ENABLED}


class Node:
    """A node on a virtual bus that obeys at once; `heard` is what came, frame by frame, SDO reads left out."""

    def __init__(self) -> None:
        self.objects: dict[tuple[int, int], tuple[int, int]] = {  # place: size and value
            (0x1000, 0): (4, 0x00010192), (0x1008, 0): (4, 0x32303454), (0x1016, 1): (4, 0), (0x6007, 0): (2, 1),
            (0x603F, 0): (2, 0), (0x6040, 0): (2, 0), (0x6041, 0): (2, DISABLED), (0x6042, 0): (2, 0),
            (0x6044, 0): (2, 0), (0x6046, 1): (4, 0), (0x6046, 2): (4, 6000), (0x6048, 1): (4, 1), (0x6048, 2): (2, 1),
            (0x6049, 1): (4, 1), (0x6049, 2): (2, 1), (0x604A, 1): (4, 600), (0x604A, 2): (2, 1), (0x605A, 0): (2, 2),
            (0x605B, 0): (2, 0), (0x6060, 0): (1, 0), (0x6061, 0): (1, 2), (0x6502, 0): (4, 2),
        }  # fmt: skip
        self.heard: list[str] = []
        self.spoil: deque[str] = deque()  # for the next answers: "drop", "twice", "cut", "late", "toggle", "flip"
        self.name = b""  # 1008h, read in segments; empty: what `objects` says
        self._sent: int | None = None  # bytes of it; None: no read is under way
        self.deaf = False
        self.deaf_to: tuple[int, int] | None = None
        self.refuses: set[tuple[int, int]] = set()  # writes it aborts
        self.obeys = True
        self._bus = can.Bus(interface="virtual", channel=CHANNEL)
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._end.set()
        self._thread.join()
        self._bus.shutdown()

    def send(self, can_id: int, data: bytes) -> None:
        self._bus.send(can.Message(arbitration_id=can_id, data=data, is_extended_id=False))

    def send_error(self, can_id: int) -> None:
        self._bus.send(can.Message(arbitration_id=can_id, is_error_frame=True, is_extended_id=False))

    def trip(self, code: int) -> None:
        self.objects[0x6041, 0], self.objects[0x603F, 0] = (2, FAULT), (2, code)

    def _serve(self) -> None:
        while not self._end.is_set():
            message = self._bus.recv(0.01)
            if message is None:
                continue
            frame = bytes(message.data)
            if not (message.arbitration_id == 0x600 + NODE and frame[0] & 0xE0 in (0x40, 0x60)):
                self.heard.append(f"{message.arbitration_id:03x} {frame.hex(' ')}")
            if message.arbitration_id == 0x600 + NODE and not self.deaf:
                self._answer(frame)

    def _answer(self, frame: bytes) -> None:
        place = (int.from_bytes(frame[1:3], "little"), frame[3])
        if place == self.deaf_to:
            return
        if frame[0] & 0xE0 == 0x60:
            answer = self._next_segment(frame)
        else:
            answer = self._read(frame, place) if frame[0] == 0x40 else self._write(frame, place)
        match self.spoil.popleft() if self.spoil else "":
            case "drop":
                return
            case "late":  # for the first try
                time.sleep(0.25)
            case "toggle":
                answer = b"\x80" + frame[1:4] + (0x05030000).to_bytes(4, "little")
            case "flip":
                answer = bytes([answer[0] ^ 0x10]) + answer[1:]
            case "twice":
                self.send(0x580 + NODE, answer)
            case "cut":
                answer = answer[:3]
        self.send(0x580 + NODE, answer)

    def _read(self, frame: bytes, place: tuple[int, int]) -> bytes:
        if place not in self.objects:
            return b"\x80" + frame[1:4] + (0x06020000).to_bytes(4, "little")
        if place == (0x1008, 0) and self.name:
            self._sent = 0
            return b"\x41" + frame[1:4] + len(self.name).to_bytes(4, "little")
        size, value = self.objects[place]
        return bytes([0x43 | (4 - size) << 2]) + frame[1:4] + value.to_bytes(4, "little")

    def _next_segment(self, frame: bytes) -> bytes:
        if self._sent is None:
            return b"\x80\x08\x10\x00" + (0x05040001).to_bytes(4, "little")
        if (self._sent // 7 % 2 == 1) != bool(frame[0] & 0x10):
            return b"\x80\x08\x10\x00" + (0x05030000).to_bytes(4, "little")
        data = self.name[self._sent : self._sent + 7]
        self._sent += 7
        last = self._sent >= len(self.name)
        return bytes([frame[0] & 0x10 | 7 - len(data) << 1 | last]) + data.ljust(7, b"\0")

    def _write(self, frame: bytes, place: tuple[int, int]) -> bytes:
        self._sent = None
        size = 4 - (frame[0] >> 2 & 3)
        if place not in self.objects or place in self.refuses or self.objects[place][0] != size:
            return b"\x80" + frame[1:4] + (0x06090030).to_bytes(4, "little")
        word = int.from_bytes(frame[4 : 4 + size], "little")
        self.objects[place] = size, word
        if place == (0x6040, 0) and self.obeys:
            if self.objects[0x6041, 0][1] != FAULT:
                self.objects[0x6041, 0] = (2, NEXT[word])
            elif word == 0x80:
                self.objects[0x6041, 0] = (2, DISABLED)
            if word == 0x7F:
                self.objects[0x6042, 0] = (2, 0)
        return b"\x60" + frame[1:4] + bytes(4)


@pytest.fixture
def node() -> Iterator[Node]:
    node = Node()
    yield node
    node.close()


def motor_at(**changed: object) -> CanOpenMotor:
    table = {"driver": "canopen", "interface": "virtual", "channel": CHANNEL, "node": NODE, "max_speed": 4200 * RPM}
    return CanOpenMotor(CanOpen.model_validate(table | changed, context={"si": True}))


@pytest.fixture
def motor(node: Node) -> Iterator[CanOpenMotor]:
    with motor_at() as motor:
        motor.open()
        node.heard.clear()
        yield motor


def without_heartbeat(heard: list[str]) -> list[str]:
    return [frame for frame in heard if frame != "77f 05"]


def test_opening_configures_mode_limit_stops_and_watchdog_and_starts_the_node(node: Node) -> None:
    with motor_at() as motor:
        info = motor.open()
    wait_for(lambda: node.heard[-1:] == ["000 01 05"])
    assert node.heard == [
        "605 2f 60 60 00 02 00 00 00",  # velocity mode
        "605 23 46 60 02 68 10 00 00",  # at most 4200 of the drive's 6000 rpm
        "605 2b 5b 60 00 01 00 00 00",  # shutdown: down the ramp
        "605 2b 5a 60 00 02 00 00 00",  # quick stop: down its ramp
        "605 2b 07 60 00 03 00 00 00",  # heartbeat lost: quick stop
        "605 23 16 10 01 d0 07 7f 00",  # heartbeat of node 127 within 2000 ms
        "77f 05",
        "000 01 05",  # NMT: start node 5
    ]
    assert (info.model, info.watchdog, info.remarks) == ("T402", 2.0, ())
    assert info.link == f"CANopen, virtual {CHANNEL}, 500 kbit/s, node 5"


def test_a_start_sets_the_ramps_and_walks_the_state_machine(node: Node, motor: CanOpenMotor) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    assert without_heartbeat(node.heard) == [
        "000 01 05",
        "605 23 48 60 01 b8 0b 00 00",  # 3000 rpm
        "605 2b 48 60 02 64 00 00 00",  # in 100 s
        "605 23 49 60 01 b8 0b 00 00",
        "605 2b 49 60 02 64 00 00 00",
        "605 2b 42 60 00 b0 04 00 00",  # 1200 rpm
        "605 2b 40 60 00 06 00 00 00",
        "605 2b 40 60 00 07 00 00 00",
        "605 2b 40 60 00 7f 00 00 00",
        "605 2b 42 60 00 b0 04 00 00",  # enabling has cleared it
    ]
    node.objects[0x6044, 0] = (2, 600)
    state = motor.read()
    assert (state.speed, state.setpoint) == (pytest.approx(600 * RPM), pytest.approx(1200 * RPM))
    assert (state.running, state.at_setpoint, state.fault) == (True, False, "")
    node.objects[0x6041, 0] = (2, ENABLED | 0x400)
    assert motor.read().at_setpoint


def test_a_negative_velocity_is_a_rotor_that_turns_backward(node: Node, motor: CanOpenMotor) -> None:
    assert not motor.read().reverse
    node.objects[0x6044, 0] = (2, -600 & 0xFFFF)
    state = motor.read()
    assert (state.speed, state.reverse) == (pytest.approx(600 * RPM), True)


def test_another_unit_of_velocity_is_reckoned_with(node: Node) -> None:
    with motor_at(rpm_per_unit=0.5) as motor:
        motor.open()
        motor.set_speed(1200 * RPM, ramp=30 * RPM)
        assert node.objects[0x6042, 0] == (2, 2400)
        assert node.objects[0x6048, 1][1] / node.objects[0x6048, 2][1] == 60
        assert motor.read().setpoint == pytest.approx(1200 * RPM)


def test_the_quick_stop_is_never_slower_than_the_ramp(node: Node, motor: CanOpenMotor) -> None:
    node.objects[0x604A, 1] = (4, 10)
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    assert (node.objects[0x604A, 1], node.objects[0x604A, 2]) == ((4, 3000), (2, 100))


def test_ramps_are_set_when_they_change_the_less_steep_number_first(node: Node, motor: CanOpenMotor) -> None:
    motor.set_speed(1200 * RPM, ramp=300 * RPM)  # 3000 rpm in 10 s
    for rpm_per_s, frames in (
        (300, []),
        (30, ["605 2b 48 60 02 64 00 00 00", "605 23 48 60 01 b8 0b 00 00"]),  # 100 s, then 3000 rpm
        (2000, ["605 23 48 60 01 d0 07 00 00", "605 2b 48 60 02 01 00 00 00"]),  # 2000 rpm, then 1 s
    ):
        node.heard.clear()
        motor.set_speed(1200 * RPM, ramp=rpm_per_s * RPM)
        assert [frame for frame in node.heard if " 48 60 " in frame] == frames


@pytest.mark.parametrize(
    ("kind", "frames"),
    [
        (Stop.RAMP, ["605 2b 40 60 00 06 00 00 00", "605 2b 42 60 00 00 00 00 00"]),
        (Stop.COAST, ["605 2b 40 60 00 00 00 00 00"]),
        (Stop.EMERGENCY, ["605 2b 40 60 00 02 00 00 00"]),
    ],
)
def test_a_stop_is_a_controlword_and_nothing_before_it(
    node: Node, motor: CanOpenMotor, kind: Stop, frames: list[str]
) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    node.heard.clear()
    motor.stop(kind)
    motor.stop(kind)
    assert without_heartbeat(node.heard) == frames * 2


def test_a_drive_that_would_coast_at_a_shutdown_is_ramped_to_zero(node: Node) -> None:
    node.refuses.add((0x605B, 0))
    with motor_at() as motor:
        assert "leaves it enabled" in motor.open().remarks[0]
        motor.set_speed(1200 * RPM, ramp=30 * RPM)
        node.heard.clear()
        motor.stop(Stop.RAMP)
        assert without_heartbeat(node.heard) == ["605 2b 42 60 00 00 00 00 00"]
        assert not motor.read().running  # enabled, but at rest


def test_the_heartbeat_goes_out_with_the_requests_and_only_then(node: Node) -> None:
    with motor_at(watchdog=0.5) as motor:
        motor.open()
        node.heard.clear()
        time.sleep(0.3)
        assert node.heard == []
        until = time.monotonic() + 0.6
        while time.monotonic() < until:
            motor.read()
            time.sleep(0.01)
    beats = node.heard.count("77f 05")
    assert 2 <= beats <= 6  # every eighth of a second, where requests allow


@pytest.mark.parametrize("missing", [(0x1016, 1), (0x6007, 0)])
def test_a_drive_without_a_watchdog_is_said_to_have_none(node: Node, missing: tuple[int, int]) -> None:
    del node.objects[missing]
    with motor_at() as motor:
        assert motor.open().watchdog is None
        motor.read()
    assert "77f 05" not in node.heard


@pytest.mark.parametrize("fault", ["drop", "twice", "cut", "late", "toggle"])
def test_a_spoilt_answer_costs_at_most_a_repetition(node: Node, motor: CanOpenMotor, fault: str) -> None:
    node.objects[0x6044, 0] = (2, 600)
    node.spoil.append(fault)
    assert motor.read().speed == pytest.approx(600 * RPM)
    node.spoil.append(fault)
    motor.stop(Stop.COAST)
    assert node.objects[0x6040, 0] == (2, 0)


@pytest.mark.parametrize("fault", ["", "drop", "twice", "cut", "late", "toggle", "flip"])
def test_a_name_comes_in_segments_whatever_befalls_one_of_them(node: Node, fault: str) -> None:
    node.name = b"bench inverter of 24 bytes"
    node.spoil.extend(["", "", "", "", fault])  # device type, modes, the name's beginning and two segments of it
    with motor_at() as motor:
        assert motor.open().model == node.name.decode()


def test_a_stop_between_two_segments_of_a_name_costs_the_name_a_repetition(node: Node) -> None:
    node.name = b"bench inverter of 24 bytes"
    node.spoil.extend(["", "", "", "", "late"])
    with motor_at() as motor:
        opening = threading.Thread(target=motor.open)
        opening.start()
        wait_for(lambda: len(node.spoil) == 0)
        motor.stop(Stop.EMERGENCY)
        opening.join()
        assert node.heard[0] == "605 2b 40 60 00 02 00 00 00"
        assert motor.read().speed == 0.0


def test_the_late_answer_to_another_command_does_not_confirm_a_stop(node: Node, motor: CanOpenMotor) -> None:
    node.deaf = True
    failures: list[LinkLost] = []

    def stop() -> None:
        try:
            motor.stop(Stop.COAST)
        except LinkLost as error:
            failures.append(error)

    stopping = threading.Thread(target=stop)
    stopping.start()
    while stopping.is_alive():
        node.send(0x580 + NODE, bytes.fromhex("60 42 60 00 00 00 00 00"))  # the target has been written
        node.send(0x580 + NODE, bytes.fromhex("4b 40 60 00 00 00 00 00"))  # the controlword has been read
        time.sleep(0.01)
    stops = [frame for frame in node.heard if frame == "605 2b 40 60 00 00 00 00 00"]
    assert (len(stops), len(failures)) == (4, 1)


def test_a_refusal_is_final(node: Node, motor: CanOpenMotor) -> None:
    node.refuses.add((0x6040, 0))
    with pytest.raises(LinkLost, match=r"refuses access to controlword .*: Value range .* \(abort code 06090030h\)"):
        motor.stop(Stop.COAST)
    assert without_heartbeat(node.heard) == ["605 2b 40 60 00 00 00 00 00"]


def test_threads_do_not_take_each_others_answers_and_a_stop_waits_for_one_exchange(
    node: Node, motor: CanOpenMotor
) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    node.objects[0x6044, 0] = (2, 600)
    end, states, waits = threading.Event(), [], []

    def poll() -> None:
        while not end.is_set():
            states.append(motor.read())

    polling = [threading.Thread(target=poll) for _ in range(3)]
    for thread in polling:
        thread.start()
    for _ in range(20):
        time.sleep(0.01)
        before = len(states)
        motor.stop(Stop.EMERGENCY)
        waits.append(len(states) - before)
    end.set()
    for thread in polling:
        thread.join()
    assert {round(state.speed / RPM) for state in states} == {600}
    assert {round(state.setpoint / RPM) for state in states} <= {0, 1200}
    assert max(waits) <= 3  # a reading is three exchanges: those under way may end, no other begins and ends


def test_an_answer_left_from_before_is_not_taken(node: Node, motor: CanOpenMotor) -> None:
    node.send(0x580 + NODE, bytes.fromhex("4b 44 60 00 e7 03 00 00"))  # actual value 999
    assert motor.read().speed == 0.0


def test_a_node_that_does_not_answer_is_given_up_within_a_second_or_so(node: Node, motor: CanOpenMotor) -> None:
    node.deaf = True
    began = time.monotonic()
    with pytest.raises(LinkLost, match=r"node 5: asked for statusword \(6041h:00\), no answer in 4 tries of 0\.2 s"):
        motor.read()
    assert time.monotonic() - began < 2.0


def test_a_stop_overtakes_a_request_that_waits_to_be_repeated(node: Node, motor: CanOpenMotor) -> None:
    node.deaf_to = (0x6044, 0)
    failures: list[LinkLost] = []

    def poll() -> None:
        try:
            motor.read()
        except LinkLost as error:
            failures.append(error)

    polling = threading.Thread(target=poll)
    polling.start()
    time.sleep(0.05)
    began = time.monotonic()
    motor.stop(Stop.COAST)
    assert time.monotonic() - began < 0.6  # the try under way, not the three to come
    polling.join()
    assert failures


def test_a_start_under_way_ends_where_a_stop_comes_in_between(node: Node, motor: CanOpenMotor) -> None:
    node.deaf_to = (0x604A, 1)  # it waits there
    failures: list[str] = []

    def start() -> None:
        try:
            motor.set_speed(1200 * RPM, ramp=30 * RPM)
        except LinkLost as error:
            failures.append(str(error))

    starting = threading.Thread(target=start)
    starting.start()
    wait_for(lambda: "605 2b 49 60 02 64 00 00 00" in node.heard)
    motor.stop(Stop.EMERGENCY)
    node.deaf_to = None
    starting.join()
    assert "was about to be written, but a stop came before" in failures[0]
    assert node.objects[0x6041, 0] == (2, QUICK_STOP)


def test_nothing_is_sent_when_speed_or_ramp_is_refused(node: Node, motor: CanOpenMotor) -> None:
    with pytest.raises(LimitExceeded, match="asked for 4300 rpm, want 0 to 4200 rpm"):
        motor.set_speed(4300 * RPM, ramp=30 * RPM)
    with pytest.raises(ConfigError, match=r"ramp: got 0\.05 rpm/s"):
        motor.set_speed(480 * RPM, ramp=0.05 * RPM)
    assert node.heard == []


def test_the_drives_own_limits_count_too(node: Node) -> None:
    node.objects[0x6046, 1], node.objects[0x6046, 2] = (4, 300), (4, 3000)
    with motor_at() as motor:
        motor.open()
        assert node.objects[0x6046, 2] == (4, 3000)
        for rpm in (3600, 200):
            with pytest.raises(LimitExceeded, match="want 300 to 3000 rpm"):
                motor.set_speed(rpm * RPM, ramp=30 * RPM)


def test_a_trip_is_named_and_forbids_a_start(node: Node, motor: CanOpenMotor) -> None:
    node.trip(0x3210)
    assert motor.read().fault == "DC link over-voltage (3210h)"
    with pytest.raises(LimitExceeded, match=r"over-voltage \(3210h\)'; see .*--clear-fault"):
        motor.set_speed(480 * RPM, ramp=30 * RPM)
    assert without_heartbeat(node.heard) == []
    motor.clear_fault()
    assert motor.read().fault == ""
    assert without_heartbeat(node.heard)[-2:] == ["605 2b 40 60 00 00 00 00 00", "605 2b 40 60 00 80 00 00 00"]


def test_an_emergency_is_a_fault_until_it_is_taken_back(node: Node, motor: CanOpenMotor) -> None:
    node.send(0x080 + NODE, bytes.fromhex("10 42 09 00 00 00 00 00"))
    assert motor.read().fault == "drive too hot (4210h)"
    node.send(0x080 + NODE + 1, bytes(8))  # another node's
    assert motor.read().fault == "drive too hot (4210h)"
    node.send(0x080 + NODE, bytes(8))
    assert motor.read().fault == ""


def test_a_node_that_starts_anew_is_a_lost_link(node: Node, motor: CanOpenMotor) -> None:
    node.send(0x700 + NODE, b"\x7f")  # a heartbeat
    motor.read()
    node.send(0x700 + NODE, b"\x00")  # a boot-up
    with pytest.raises(LinkLost, match="has started anew and lost its configuration; open it again"):
        motor.read()
    assert motor.open().watchdog == 2.0
    motor.read()


def test_a_bus_off_is_said(node: Node, motor: CanOpenMotor) -> None:
    node.send_error(0x04)  # controller problem: not yet
    motor.read()
    node.send_error(0x40)
    with pytest.raises(LinkLost, match="is bus off; check bit rate and termination"):
        motor.read()


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        ((0x1000, 0), 0x000F0191, "the node is a device of profile 401, want 402, a drive"),
        ((0x6502, 0), 0b1000_0000, r"the drive has no velocity mode \(vl\)"),
        ((0x6061, 0), 1, "the drive stays in mode 1, want 2"),
    ],
)
def test_another_device_is_said(
    node: Node, monkeypatch: pytest.MonkeyPatch, place: tuple[int, int], value: int, message: str
) -> None:
    monkeypatch.setattr(canopen_motor, "CONFIRM_SECONDS", 0.1)
    node.objects[place] = node.objects[place][0], value
    with motor_at() as motor, pytest.raises(LinkLost, match=message):
        motor.open()


def test_a_drive_without_the_objects_of_velocity_mode_is_said(node: Node) -> None:
    del node.objects[0x6046, 2]
    with (
        motor_at() as motor,
        pytest.raises(LinkLost, match=r"vl velocity max amount .* does not exist .*; is it a drive"),
    ):
        motor.open()


def test_a_drive_that_does_not_obey_is_said(node: Node, motor: CanOpenMotor, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(canopen_motor, "CONFIRM_SECONDS", 0.1)
    node.obeys = False
    with pytest.raises(LinkLost, match="the drive does not start, it stays switch on disabled; is its power on"):
        motor.set_speed(480 * RPM, ramp=30 * RPM)
    node.objects[0x6041, 0] = (2, ENABLED)
    with pytest.raises(LinkLost, match="took the command 'coast' but did not obey within"):
        motor.stop(Stop.COAST)


def test_a_ramp_that_is_not_obeyed_is_said_and_followed_by_another_kind_and_nothing_between(
    node: Node, motor: CanOpenMotor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(canopen_motor, "CONFIRM_SECONDS", 0.1)
    motor.set_speed(1200 * RPM, ramp=100 * RPM)
    node.obeys, node.objects[0x6044, 0] = False, (2, 1200)
    node.heard.clear()
    for kind in (Stop.RAMP, Stop.EMERGENCY, Stop.COAST, Stop.COAST):
        with pytest.raises(LinkLost, match=f"took the command '{kind.value}' but did not obey within 0.1 s"):
            motor.stop(kind)
    assert [frame[:-6] for frame in without_heartbeat(node.heard)] == [
        "605 2b 40 60 00 06 00",
        "605 2b 42 60 00 00 00",  # the target: 0
        "605 2b 40 60 00 02 00",
        "605 2b 40 60 00 00 00",
        "605 2b 40 60 00 00 00",
    ]


def test_a_velocity_that_jitters_is_not_one_that_falls(node: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(canopen_motor, "CONFIRM_SECONDS", 0.3)
    node.refuses.add((0x605B, 0))  # it is stopped by its target alone
    ended = threading.Event()

    def turn() -> None:
        for jitter in itertools.cycle((0, 2, -1, 1, -2)):
            node.objects[0x6044, 0] = (2, 1200 + jitter)
            if ended.wait(0.003):
                return

    with motor_at() as motor:
        motor.open()
        motor.set_speed(1200 * RPM, ramp=100 * RPM)
        node.objects[0x6044, 0] = (2, 1200)
        with pytest.raises(LinkLost, match=r"'ramp' but did not obey .*operation enabled at 1200 rpm"):
            motor.stop(Stop.RAMP)
        turning = threading.Thread(target=turn)
        turning.start()
        with pytest.raises(LinkLost, match="'ramp' but did not obey"):
            motor.stop(Stop.RAMP)
        ended.set()
        turning.join()


def test_a_bus_that_does_not_open_is_said() -> None:
    with pytest.raises(LinkLost, match="CAN: nosuch can0 cannot be opened"):
        motor_at(interface="nosuch", channel="can0").open()
    with pytest.raises(LinkLost, match="CAN: socketcan can77 cannot be opened"):
        motor_at(interface="socketcan", channel="can77").open()
    with pytest.raises(LinkLost, match=r"^/dev/ttyNOSUCH: the CAN adapter's port cannot be opened \(no such port"):
        motor_at(interface="slcan", channel="/dev/ttyNOSUCH@115200").open()


def test_a_closed_link_is_said_and_may_be_closed_again(motor: CanOpenMotor) -> None:
    motor.close()
    motor.close()
    with pytest.raises(LinkLost, match="the link is not open"):
        motor.read()


class Tty:
    """The emulated drive behind an slcan adapter on a pty, in a thread; `unplug` cuts it."""

    def __init__(self) -> None:
        self.plant = ToyPlant()
        self.device = Cia402(self.plant, max_speed=4200 * RPM, rpm_per_unit=1.0, clock=WallClock())
        self.cable = PtyBridge()
        self.port = self.cable.client_port
        self._running = in_background(self._serve)

    def __enter__(self) -> "Tty":
        self._running.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        self.unplug()

    def unplug(self) -> None:
        if self._running:
            running, self._running = self._running, None
            running.__exit__(None, None, None)

    @contextmanager
    def time_passes(self) -> Iterator[None]:
        """Let the rotor follow, as fast as the drive asks, for the length of the block."""
        ended = threading.Event()

        def advance() -> None:
            while not ended.wait(0.01):
                self.plant.advance(self.plant.t + 0.01)

        thread = threading.Thread(target=advance)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()

    async def _serve(self, end: asyncio.Event) -> None:
        carrying = asyncio.create_task(self.cable.run())
        with self.cable:
            async with serve_slcan(self.device, port=self.cable.device_port, node=NODE):
                await end.wait()
            carrying.cancel()
            await asyncio.wait([carrying])


@pytest.fixture
def tty() -> Iterator[Tty]:
    with Tty() as tty:
        yield tty


def test_over_a_real_tty_the_drive_turns_and_stops(tty: Tty) -> None:
    with motor_at(interface="slcan", channel=tty.port) as motor:
        info = motor.open()
        assert (info.model, info.watchdog) == ("CiA 402 bench inverter", 2.0)
        motor.set_speed(600 * RPM, ramp=600 * RPM)
        tty.plant.advance(tty.plant.t + 2.0)
        state = motor.read()
        assert (state.running, state.at_setpoint) == (True, True)
        assert state.speed == pytest.approx(600 * RPM)
        with tty.time_passes():
            motor.stop(Stop.RAMP)
        motor.set_speed(600 * RPM, ramp=600 * RPM)  # a stop under way is taken back
        motor.stop(Stop.EMERGENCY)
        assert tty.plant.commands[-1] == (0.0, pytest.approx(4200 * RPM), True)
        motor.set_speed(600 * RPM, ramp=600 * RPM)  # out of a quick stop under way
        motor.stop(Stop.COAST)
        assert tty.plant.commands[-1][2] is False
        assert not motor.read().running


def test_a_program_that_falls_silent_is_stopped_by_the_drive(tty: Tty) -> None:
    with motor_at(interface="slcan", channel=tty.port, watchdog=1.0) as motor:  # a busy machine is late by less
        motor.open()
        motor.set_speed(600 * RPM, ramp=60 * RPM)
        for _ in range(12):  # longer than the watchdog
            time.sleep(0.1)
            assert motor.read().running
        wait_for(lambda: tty.plant.commands[-1][:2] == (0.0, pytest.approx(4200 * RPM)), seconds=10.0)
        assert motor.read().setpoint == 0.0
        motor.set_speed(600 * RPM, ramp=60 * RPM)  # and may be started again
        assert motor.read().running


def test_damaged_slcan_lines_are_passed_over(tty: Tty) -> None:
    with motor_at(interface="slcan", channel=tty.port) as motor:
        motor.open()
        for noise in (b"\xff\xfe\r", b"t\r", b"t12\r", b"tzzz8\r", b"t5858zz\r", b"t5853112233\r", b"T1\r"):
            with Path(tty.cable.device_port).open("wb", buffering=0) as line:
                line.write(noise)
            assert not motor.read().running


def test_an_adapter_unplugged_is_a_lost_link_and_its_path_may_be_opened_again(tty: Tty, tmp_path: Path) -> None:
    path = tmp_path / "by-id"
    path.symlink_to(tty.port)
    with motor_at(interface="slcan", channel=str(path)) as motor:
        motor.open()
        tty.unplug()
        with pytest.raises(LinkLost, match="unplugged"):
            motor.read()
        with pytest.raises(LinkLost):
            motor.stop(Stop.EMERGENCY)
        with Tty() as other:
            path.unlink()
            path.symlink_to(other.port)
            assert motor.open().watchdog == 2.0
            assert not motor.read().running


def test_an_adapter_in_use_is_said_and_its_user_not_disturbed(tty: Tty) -> None:
    with motor_at(interface="slcan", channel=tty.port) as motor, motor_at(interface="slcan", channel=tty.port) as other:
        motor.open()
        with pytest.raises(LinkLost, match="in use by another program"):
            other.open()
        motor.read()


def test_an_adapter_at_another_bit_rate_hears_nobody(tty: Tty, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(can_link, "ANSWER_SECONDS", 0.05)
    said = pytest.raises(LinkLost, match="250 kbit/s, node 5: asked for device type")
    with motor_at(interface="slcan", channel=tty.port, bitrate=250_000) as motor, said:
        motor.open()
