"""The Modbus drive over a real pty: what it is told, in order, and what is said when it does not answer as wanted."""

import itertools
import math
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from rotorrig.rig.config.devices import ModbusRtu
from rotorrig.rig.errors import ConfigError, LimitExceeded, LinkLost
from rotorrig.rig.motor import modbus_link, modbus_motor
from rotorrig.rig.motor.base import Stop
from rotorrig.rig.motor.modbus_motor import ModbusMotor
from tests.rig.wire_fakes import Drive, crc16, wait_for

RPM = math.pi / 30
COMMAND, REFERENCE, STATUS, FAULT, COMMANDED, OUTPUT = 8192, 8193, 8448, 8449, 8450, 8451
MAX_FREQUENCY, STOP_MODE, ACCEL, DECEL, LOSS_ACTION, LOSS_TIME = 35, 37, 39, 40, 105, 106
START_WORD, STOP_WORD = 0x0512, 0x0001


def motor_at(port: str, *, address: int = Drive.NODE, watchdog: float = 2.0) -> ModbusMotor:
    table = {"driver": "modbus-rtu", "port": port, "address": address, "max_speed": 4200 * RPM, "watchdog": watchdog}
    return ModbusMotor(ModbusRtu.model_validate(table, context={"si": True}))


@pytest.fixture(autouse=True)
def short_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modbus_motor, "CONFIRM_SECONDS", 0.15)


@pytest.fixture
def motor(drive: Drive) -> Iterator[ModbusMotor]:
    with motor_at(drive.port) as motor:
        motor.open()
        yield motor


def test_the_fakes_crc_is_that_of_the_standard() -> None:
    # read ten registers from 0 of node 1, the textbook frame
    assert crc16(bytes.fromhex("01 03 00 00 00 0A")) == bytes.fromhex("C5 CD")


def test_opening_asks_for_the_state_and_the_maximum_frequency(drive: Drive) -> None:
    with motor_at(drive.port) as motor:
        info = motor.open()
    assert info.model == "PowerFlex 400"
    assert info.link == f"Modbus RTU, {drive.port}, 19200 baud, address 100"
    # node 100, function 03, registers 8448 = 0x2100 to 8451: status, fault, commanded and output frequency
    assert drive.requests[0][:6] == bytes.fromhex("64 03 21 00 00 04")
    assert drive.requests[1][:6] == bytes.fromhex("64 03 00 23 00 01")
    assert drive.writes == []


def test_set_speed_sets_ramp_and_reference_before_it_starts(drive: Drive, motor: ModbusMotor) -> None:
    motor.set_speed(3600 * RPM, ramp=30 * RPM)
    # 4200 rpm (P035 = 70 Hz) at 30 rpm/s: 140 s; 3600 rpm = 60.00 Hz
    assert drive.writes == [(ACCEL, 14_000), (DECEL, 14_000), (REFERENCE, 6000), (COMMAND, START_WORD)]


def test_a_ramp_already_set_is_not_written_again(drive: Drive, motor: ModbusMotor) -> None:
    motor.set_speed(480 * RPM, ramp=30 * RPM)
    drive.writes.clear()
    motor.set_speed(3600 * RPM, ramp=30 * RPM)
    assert drive.writes == [(REFERENCE, 6000), (COMMAND, START_WORD)]


def test_the_state_is_in_radians_per_second(drive: Drive, motor: ModbusMotor) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    drive.registers[OUTPUT] = 1234
    drive.registers[STATUS] = 0x001F  # accelerating
    state = motor.read()
    assert state.speed == pytest.approx(740.4 * RPM)
    assert state.setpoint == pytest.approx(1200 * RPM)
    assert (state.running, state.at_setpoint, state.fault) == (True, False, "")


def test_at_setpoint_is_the_drives_own_word(motor: ModbusMotor) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    assert motor.read().at_setpoint


def test_a_drive_at_rest_has_no_setpoint(drive: Drive, motor: ModbusMotor) -> None:
    drive.registers[COMMANDED] = 6000
    drive.registers[STATUS] = 0x010D  # at reference, as some drives say at rest
    state = motor.read()
    assert (state.speed, state.setpoint, state.running, state.at_setpoint) == (0.0, 0.0, False, False)


@pytest.mark.parametrize(
    ("kind", "writes"),
    [
        (Stop.RAMP, [(COMMAND, STOP_WORD)]),
        (Stop.COAST, [(COMMAND, STOP_WORD), (STOP_MODE, 1), (COMMAND, STOP_WORD), (STOP_MODE, 0)]),
        (Stop.EMERGENCY, [(COMMAND, STOP_WORD), (DECEL, 100)]),  # 1 s from the maximum frequency
    ],
)
def test_every_stop_is_commanded_before_its_kind_is_chosen(
    drive: Drive, motor: ModbusMotor, kind: Stop, writes: list[tuple[int, int]]
) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    drive.writes.clear()
    motor.stop(kind)
    assert drive.writes == writes


def test_a_ramp_stop_after_a_coast_ramps(drive: Drive, motor: ModbusMotor) -> None:
    motor.stop(Stop.COAST)
    motor.stop(Stop.RAMP)
    assert drive.registers[STOP_MODE] == 0


def test_stopping_twice_is_stopping(drive: Drive, motor: ModbusMotor) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    for _ in range(2):
        motor.stop(Stop.COAST)
    assert not motor.read().running


def test_the_stop_command_is_out_when_the_stop_mode_is_refused(drive: Drive, motor: ModbusMotor) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    drive.exceptions[STOP_MODE] = 3
    with pytest.raises(LinkLost, match=r"stop mode .* refused with exception 3 \(illegal value\)"):
        motor.stop(Stop.COAST)
    assert drive.writes[-1] == (COMMAND, STOP_WORD)


def test_a_stop_the_drive_does_not_obey_is_said(drive: Drive, motor: ModbusMotor) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    drive.obeys = False
    with pytest.raises(LinkLost, match=r"took the command 'stop' but did not obey .*it is running, at reference"):
        motor.stop(Stop.RAMP)


class Restless(dict[int, int]):
    """Registers of a drive whose output frequency is never twice the same."""

    def __getitem__(self, register: int) -> int:
        self.turn = -getattr(self, "turn", 2)  # 0.02 Hz more, 0.02 Hz less
        return super().__getitem__(register) + (self.turn if register == OUTPUT else 0)


def test_a_frequency_that_jitters_is_not_one_that_falls(drive: Drive, motor: ModbusMotor) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    drive.obeys, drive.registers = False, Restless(drive.registers | {OUTPUT: 2000})
    for kind in Stop:
        with pytest.raises(LinkLost, match="took the command 'stop' but did not obey"):
            motor.stop(kind)


def test_a_frequency_that_falls_is_a_stop_obeyed(drive: Drive, motor: ModbusMotor) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    drive.obeys, drive.registers[OUTPUT] = False, 2000
    stopping = threading.Thread(target=motor.stop, args=[Stop.RAMP])
    asked = len(drive.requests)
    stopping.start()
    wait_for(lambda: len(drive.requests) > asked + 2)
    drive.registers[OUTPUT] = 1980
    stopping.join()
    assert len(drive.requests) < asked + 20


def test_a_stop_that_is_not_obeyed_is_followed_by_another_kind_and_nothing_between(
    drive: Drive, motor: ModbusMotor
) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    drive.obeys, drive.registers[OUTPUT] = False, 2000
    drive.writes.clear()
    for kind in (Stop.RAMP, Stop.EMERGENCY, Stop.COAST, Stop.COAST):
        with pytest.raises(LinkLost, match="did not obey"):
            motor.stop(kind)
    coast = [(COMMAND, STOP_WORD), (STOP_MODE, 1), (COMMAND, STOP_WORD), (STOP_MODE, 0)]
    assert drive.writes == [(COMMAND, STOP_WORD), (COMMAND, STOP_WORD), (DECEL, 100), *coast, *coast]


def test_a_drive_that_does_not_start_is_told_what_to_check(drive: Drive, motor: ModbusMotor) -> None:
    drive.obeys = False
    with pytest.raises(LinkLost, match=r"took the command 'start' .*it is at rest.*P036 \[Start Source\]"):
        motor.set_speed(1200 * RPM, ramp=30 * RPM)


@pytest.mark.parametrize("spoil", ["drop", "corrupt"])
def test_two_spoilt_replies_are_got_over(drive: Drive, motor: ModbusMotor, spoil: str) -> None:
    drive.spoil.extend([spoil] * 2)
    assert not motor.read().running


@pytest.mark.parametrize("spoil", ["drop", "corrupt"])
def test_a_link_that_stays_bad_is_lost_and_says_what_was_asked(
    drive: Drive, motor: ModbusMotor, spoil: str, capfd: pytest.CaptureFixture[str]
) -> None:
    drive.spoil.extend([spoil] * 8)
    with pytest.raises(LinkLost) as error:
        motor.read()
    assert str(error.value) == (
        f"Modbus RTU, {drive.port}, 19200 baud, address 100: asked to read state (register 8448 to 8451), "
        "no valid answer in 6 tries of 0.12 s"
    )
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("code", [5, 6])
def test_a_drive_that_is_busy_is_asked_again(drive: Drive, motor: ModbusMotor, code: int) -> None:
    drive.busy.extend([code] * 3)
    assert not motor.read().running
    for _ in range(8):  # exchanges of a start, each at its turn
        drive.busy.extend([code])
        motor.set_speed(1200 * RPM, ramp=30 * RPM)
        drive.busy.extend([code])
        motor.stop(Stop.COAST)
    assert not motor.read().running


def test_a_busy_drive_is_told_to_stop_again_at_once(drive: Drive, motor: ModbusMotor) -> None:
    motor.set_speed(1200 * RPM, ramp=30 * RPM)
    asked = len(drive.requests)
    drive.busy.extend([6] * 5)
    motor.stop(Stop.RAMP)
    stop = bytes.fromhex("64 06 20 00 00 01")
    assert [request[:6] for request in drive.requests[asked:]][:6] == [stop] * 6
    assert drive.writes[-1] == (COMMAND, STOP_WORD)


def test_a_stop_does_not_wait_for_a_reading_whose_drive_is_busy(drive: Drive, motor: ModbusMotor) -> None:
    drive.busy.extend([6] * 10_000)
    reading = threading.Thread(target=motor.read)
    began = len(drive.requests)
    reading.start()
    wait_for(lambda: len(drive.requests) > began + 2)
    asked = len(drive.requests)
    stopping = threading.Thread(target=motor.stop, args=[Stop.RAMP])
    stopping.start()
    wait_for(lambda: len(drive.requests) > asked + 3)
    drive.busy.clear()
    reading.join()
    stopping.join()
    assert 6 in [request[1] for request in drive.requests[asked : asked + 2]]
    assert drive.writes[-1] == (COMMAND, STOP_WORD)


def test_a_drive_that_stays_busy_is_given_up(drive: Drive, motor: ModbusMotor, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modbus_link, "BUSY_SECONDS", 0.2)
    drive.busy.extend([6] * 10_000)
    began = time.monotonic()
    with pytest.raises(LinkLost, match=r"asked to read state .* refused with exception 6 \(device busy\)"):
        motor.read()
    assert 0.2 <= time.monotonic() - began < 0.6


@pytest.mark.parametrize("code", [1, 2, 3, 4])
def test_a_refusal_is_final(drive: Drive, motor: ModbusMotor, code: int) -> None:
    asked = len(drive.requests)
    drive.busy.append(code)
    with pytest.raises(LinkLost, match=f"refused with exception {code}"):
        motor.read()
    drive.busy.append(code)
    with pytest.raises(LinkLost, match=f"refused with exception {code}"):
        motor.stop(Stop.RAMP)
    assert len(drive.requests) == asked + 2


def test_the_link_is_usable_again_once_the_drive_answers(drive: Drive, motor: ModbusMotor) -> None:
    drive.spoil.extend(["drop"] * 6)
    with pytest.raises(LinkLost):
        motor.read()
    motor.stop(Stop.RAMP)
    assert drive.writes[-1] == (COMMAND, STOP_WORD)


def test_a_wrong_node_address_gets_no_answer(drive: Drive) -> None:
    with motor_at(drive.port, address=7) as motor, pytest.raises(LinkLost, match=r"address 7: asked to read state"):
        motor.open()


def test_a_device_without_the_register_is_doubted(drive: Drive) -> None:
    del drive.registers[STATUS]
    with motor_at(drive.port) as motor, pytest.raises(LinkLost) as error:
        motor.open()
    assert str(error.value).endswith("the device refused with exception 2 (illegal address); is it a PowerFlex 400?")


@pytest.mark.parametrize("counts", [60, 40_000])  # 60 is 60 Hz counted in hertz
def test_an_implausible_maximum_frequency_is_doubted(drive: Drive, counts: int) -> None:
    drive.registers[MAX_FREQUENCY] = counts
    with motor_at(drive.port) as motor, pytest.raises(LinkLost, match="want 15 to 320 Hz; is it a PowerFlex 400"):
        motor.open()


def test_an_implausible_status_is_doubted(drive: Drive) -> None:
    drive.registers[STATUS] = 0xFFFF
    with motor_at(drive.port) as motor, pytest.raises(LinkLost, match="at once; is it a PowerFlex 400"):
        motor.open()


def test_nothing_is_sent_when_speed_or_ramp_is_refused(drive: Drive, motor: ModbusMotor) -> None:
    with pytest.raises(LimitExceeded, match="asked for 4300 rpm, want 0 to 4200 rpm"):
        motor.set_speed(4300 * RPM, ramp=30 * RPM)
    with pytest.raises(ConfigError, match="ramp: got 1 rpm/s"):
        motor.set_speed(480 * RPM, ramp=1 * RPM)
    assert drive.writes == []


def test_the_drives_own_maximum_counts_too(drive: Drive) -> None:
    drive.registers[MAX_FREQUENCY] = 5000
    with motor_at(drive.port) as motor:
        motor.open()
        with pytest.raises(LimitExceeded, match="want 0 to 3000 rpm"):
            motor.set_speed(3600 * RPM, ramp=30 * RPM)


def test_a_trip_is_named_and_forbids_a_start(drive: Drive, motor: ModbusMotor) -> None:
    drive.registers[STATUS] |= 1 << 7
    drive.registers[FAULT] = 5
    assert motor.read().fault == "overvoltage (F5)"
    with pytest.raises(LimitExceeded, match=r"has tripped with 'overvoltage \(F5\)'"):
        motor.set_speed(480 * RPM, ramp=30 * RPM)
    assert drive.writes == []
    motor.clear_fault()
    assert motor.read().fault == ""


def test_a_cut_wire_is_a_lost_link(drive: Drive, motor: ModbusMotor) -> None:
    drive.unplug()
    with pytest.raises(LinkLost, match=r"asked to read state .*, but the port is gone; was it unplugged"):
        motor.read()
    with pytest.raises(LinkLost):
        motor.stop(Stop.EMERGENCY)


def test_a_port_that_is_not_there_is_said() -> None:
    with pytest.raises(LinkLost, match=r"^/dev/ttyNOSUCH: the drive's port cannot be opened \(no such port"):
        motor_at("/dev/ttyNOSUCH").open()


def test_a_port_in_use_is_said(drive: Drive, motor: ModbusMotor) -> None:
    with pytest.raises(LinkLost, match="in use by another program"):
        motor_at(drive.port).open()


def test_a_closed_link_is_said_and_may_be_closed_again(motor: ModbusMotor) -> None:
    motor.close()
    motor.close()
    with pytest.raises(LinkLost, match=r"asked to read state .*, but the link is not open"):
        motor.read()
    assert motor.open().model == "PowerFlex 400"


def test_closing_does_not_stop_the_rotor(drive: Drive, motor: ModbusMotor) -> None:
    motor.set_speed(480 * RPM, ramp=30 * RPM)
    motor.close()
    assert drive.writes[-1] == (COMMAND, START_WORD)


def test_opening_tells_the_drive_to_stop_by_itself_when_it_hears_nothing(drive: Drive) -> None:
    drive.registers |= {LOSS_ACTION: 0, LOSS_TIME: 50}  # as delivered
    with motor_at(drive.port, watchdog=1.5) as motor:
        assert motor.open().watchdog == pytest.approx(1.5)
    assert drive.writes == [(LOSS_ACTION, 2), (LOSS_TIME, 15)]  # stop; 0.1 s a count


def test_a_watchdog_that_is_set_is_not_written_again(drive: Drive) -> None:
    with motor_at(drive.port) as motor:
        assert motor.open().watchdog == 2.0
    assert drive.writes == []


def test_a_state_is_one_exchange(drive: Drive, motor: ModbusMotor) -> None:
    drive.requests.clear()
    motor.read()
    assert [request[:6].hex(" ") for request in drive.requests] == ["64 03 21 00 00 04"]


def test_a_silent_drive_is_a_lost_link_within_a_second(drive: Drive, motor: ModbusMotor) -> None:
    drive.spoil.extend(["drop"] * 8)
    began = time.monotonic()
    with pytest.raises(LinkLost):
        motor.stop(Stop.RAMP)
    assert time.monotonic() - began < 1.0  # six tries of 0.12 s


def test_a_late_answer_is_not_taken_for_that_to_the_next_question(drive: Drive) -> None:
    # the maximum frequency comes when it has been asked for again, and so once more while the stop mode is asked for
    drive.delays.extend([0.0, 0.15, 0.05])
    with motor_at(drive.port) as motor:
        motor.open()
    assert drive.writes == []  # the stop mode is right as it is


def test_a_stop_goes_before_readers_that_wait_and_ends_a_start_under_way(drive: Drive, motor: ModbusMotor) -> None:
    ended = threading.Event()

    def poll() -> None:
        while not ended.wait(0.001):
            motor.read()

    pollers = [threading.Thread(target=poll) for _ in range(3)]
    for poller in pollers:
        poller.start()
    try:
        for _ in range(10):
            motor.set_speed(480 * RPM, ramp=30 * RPM)
            asked = len(drive.requests)
            motor.stop(Stop.RAMP)
            sent = [request[1] for request in drive.requests[asked:]]
            assert 6 in sent[:2]  # at most one read under way before the stop
    finally:
        ended.set()
        for poller in pollers:
            poller.join()


def test_a_start_that_a_stop_overtakes_is_not_sent(drive: Drive, motor: ModbusMotor) -> None:
    failures: list[BaseException] = []

    def start() -> None:
        try:
            motor.set_speed(480 * RPM, ramp=30 * RPM)
        except LimitExceeded as error:
            failures.append(error)

    drive.delays.extend(itertools.repeat(0.03, 20))  # a slow drive: the start takes long enough to be overtaken
    starter = threading.Thread(target=start)
    asked = len(drive.requests)
    starter.start()
    wait_for(lambda: len(drive.requests) > asked)
    motor.stop(Stop.RAMP)
    starter.join()
    assert "was told to stop" in str(failures[0])
    assert (COMMAND, START_WORD) not in drive.writes
    assert (COMMAND, STOP_WORD) in drive.writes


def test_a_port_whose_device_came_back_elsewhere_is_opened_again(drive: Drive, tmp_path: Path) -> None:
    name = tmp_path / "by-id"
    name.symlink_to(drive.port)
    with motor_at(str(name)) as motor:
        motor.open()
        drive.unplug()
        with pytest.raises(LinkLost):
            motor.read()
        successor = Drive()
        successor.start()
        name.unlink()
        name.symlink_to(successor.port)
        try:
            assert motor.open().model == "PowerFlex 400"
            assert not motor.read().running
        finally:
            successor.unplug()


def test_a_stop_goes_between_two_tries_of_a_reading_that_nobody_answers(drive: Drive, motor: ModbusMotor) -> None:
    drive.spoil.extend(["drop"] * 2)
    reading = threading.Thread(target=lambda: motor.read())
    began = len(drive.requests)
    reading.start()
    while len(drive.requests) == began:
        time.sleep(0.001)
    motor.stop(Stop.RAMP)
    reading.join()
    asked = [request[1] for request in drive.requests[began:]]
    assert asked[:2] == [3, 6]  # one try of the reading was under way; the stop is next
