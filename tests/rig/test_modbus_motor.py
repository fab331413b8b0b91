"""The Modbus drive over a real pty: what it is told, in order, and what is said when it does not answer as wanted."""

import math
from collections.abc import Iterator

import pytest

from rotorrig.rig.errors import ConfigError, LimitExceeded, LinkLost
from rotorrig.rig.motor import modbus_motor
from rotorrig.rig.motor.base import Stop
from rotorrig.rig.motor.modbus_motor import ModbusMotor
from rotorrig.rig.motor.profiles.powerflex400 import PROFILE
from tests.rig.wire_fakes import Drive, crc16

RPM = math.pi / 30
COMMAND, REFERENCE, STATUS, FAULT, OUTPUT = 8192, 8193, 8448, 8449, 8451
MAX_FREQUENCY, STOP_MODE, ACCEL, DECEL = 35, 37, 39, 40
START_WORD, STOP_WORD = 0x0512, 0x0001


def motor_at(port: str, *, address: int = Drive.NODE) -> ModbusMotor:
    return ModbusMotor(port, profile=PROFILE, baudrate=19200, address=address, rpm_per_hz=60.0, max_speed=4200 * RPM)


@pytest.fixture(autouse=True)
def short_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modbus_motor, "ANSWER_SECONDS", 0.15)
    monkeypatch.setattr(modbus_motor, "CONFIRM_SECONDS", 0.15)


@pytest.fixture
def motor(drive: Drive) -> Iterator[ModbusMotor]:
    with motor_at(drive.port) as motor:
        motor.open()
        yield motor


def test_the_fakes_crc_is_that_of_the_standard() -> None:
    # read ten registers from 0 of node 1, the textbook frame
    assert crc16(bytes.fromhex("01 03 00 00 00 0A")) == bytes.fromhex("C5 CD")


def test_opening_asks_for_status_and_maximum_frequency(drive: Drive) -> None:
    with motor_at(drive.port) as motor:
        info = motor.open()
    assert info.model == "PowerFlex 400"
    assert info.link == f"Modbus RTU, {drive.port}, 19200 baud, address 100"
    # node 100, function 03, register 8448 = 0x2100, one word
    assert drive.requests[0][:6] == bytes.fromhex("64 03 21 00 00 01")
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
    drive.registers[REFERENCE] = 6000
    drive.registers[STATUS] = 0x010D  # at reference, as some drives say at rest
    state = motor.read()
    assert (state.speed, state.setpoint, state.running, state.at_setpoint) == (0.0, 0.0, False, False)


@pytest.mark.parametrize(
    ("kind", "writes"),
    [
        (Stop.RAMP, [(COMMAND, STOP_WORD)]),
        (Stop.COAST, [(STOP_MODE, 1), (COMMAND, STOP_WORD)]),
        (Stop.EMERGENCY, [(DECEL, 100), (COMMAND, STOP_WORD)]),  # 1 s from the maximum frequency
    ],
)
def test_each_stop_is_chosen_before_it_is_commanded(
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


def test_the_stop_command_goes_out_even_if_the_stop_mode_is_refused(drive: Drive, motor: ModbusMotor) -> None:
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
        f"Modbus RTU, {drive.port}, 19200 baud, address 100: asked to read status (register 8448), "
        "no valid answer in 4 tries of 0.15 s"
    )
    assert capfd.readouterr().err == ""


def test_the_link_is_usable_again_once_the_drive_answers(drive: Drive, motor: ModbusMotor) -> None:
    drive.spoil.extend(["drop"] * 4)
    with pytest.raises(LinkLost):
        motor.read()
    motor.stop(Stop.RAMP)
    assert drive.writes[-1] == (COMMAND, STOP_WORD)


def test_a_wrong_node_address_gets_no_answer(drive: Drive) -> None:
    with motor_at(drive.port, address=7) as motor, pytest.raises(LinkLost, match=r"address 7: asked to read status"):
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
    with pytest.raises(LinkLost, match=r"asked to read status .*, but the port is gone; was it unplugged"):
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
    with pytest.raises(LinkLost, match=r"asked to read status .*, but the link is not open"):
        motor.read()
    assert motor.open().model == "PowerFlex 400"


def test_closing_does_not_stop_the_rotor(drive: Drive, motor: ModbusMotor) -> None:
    motor.set_speed(480 * RPM, ramp=30 * RPM)
    motor.close()
    assert drive.writes[-1] == (COMMAND, START_WORD)
