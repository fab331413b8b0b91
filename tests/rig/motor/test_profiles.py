"""Each profile on a real wire: the frames it sends, written out from the manuals, and what a drive makes of them."""

import math
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from rotorrig.rig.clock import WallClock
from rotorrig.rig.config.description import parse
from rotorrig.rig.config.devices import ModbusRtu, ModbusTcp
from rotorrig.rig.config.drive_profiles import load_profile, profile_names
from rotorrig.rig.errors import ConfigError, LimitExceeded, LinkLost
from rotorrig.rig.motor.base import Stop
from rotorrig.rig.motor.modbus_motor import ModbusMotor
from rotorrig.rig.motor.modbus_profile import Profile
from rotorrig.sims.wire.motors.inverters import commission_drive
from tests.parameters import defer_rest
from tests.rig.wire_fakes import Drive
from tests.sims.wire.conftest import ToyPlant
from tests.sims.wire.served_inverter import Served, Wire, served

RPM = math.pi / 30
RK4 = (Path(__file__).parents[3] / "configs" / "rk4.toml").read_text()
RAMP = 300 * RPM


def profile_of(name: str) -> Profile:
    profile = load_profile(name)
    assert isinstance(profile, Profile)
    return profile


class Recorder(Drive):
    """A node that holds any register, shows what `obey` makes of a write, and keeps the frames."""

    def __init__(self, registers: dict[int, int], obey: Callable[[dict[int, int], int, int], None]) -> None:
        super().__init__()
        self.registers, self._obey = registers, obey

    def _write(self, register: int, word: int) -> None:
        self.registers[register] = word
        self._obey(self.registers, register, word)

    def sent(self) -> list[str]:
        """Return the hex of the frames since the last call, less node and checksum."""
        frames, self.requests[:] = [request[1:6].hex(" ") for request in self.requests], []
        return frames


def m_max(registers: dict[int, int], register: int, word: int) -> None:
    if register == 2000:  # status (ID 2101): bit 1 run, bit 5 at setpoint; motor frequency (ID 2104)
        registers[2100], registers[2103] = (0x23, registers[2002] * 70 // 100) if word & 1 else (0x41, 0)


def vfd_ed(registers: dict[int, int], register: int, word: int) -> None:
    if register == 0x2000:
        registers[0x2103] = registers[0x2001] if word & 2 else 0
        registers[0x2119] = 0x503 if word & 2 else 0x500
    registers[0x2102] = registers[0x2001]


def acs355(registers: dict[int, int], register: int, word: int) -> None:
    if register == 0:  # status word 40004: bits 0 to 2 ready on, ready run, operation enabled; 8 at setpoint
        state = {0x476: 0x231, 0x477: 0x233, 0x47F: 0x337}.get(word, 0x270)
        registers[3], registers[4] = state, registers[1] * 700 // 20_000 if word == 0x47F else 0


M_MAX = dict.fromkeys(range(2100, 2111), 0) | {2000: 0, 2002: 0, 100: 0, 101: 7000, 102: 30, 103: 30, 813: 0}
VFD_ED = dict.fromkeys((0x2000, 0x2001, 0x2100, 0x2101, 0x2102, 0x2103, 0x2119), 0)
ACS355 = dict.fromkeys(range(6), 0) | {1104: 700, 2007: 700, 2201: 50, 2202: 50, 3017: 0, 3018: 30, 5309: 104, 5310: 0}

#: frames in hex: function, register, word or count; a run-up to 2100 rpm (35 Hz) at 300 rpm/s (14 s to 70 Hz), stops
FRAMES = {
    "m-max": {
        "open": [
            "03 08 34 00 04",  # state: IDs 2101 to 2104
            "03 00 65 00 01",  # P6.4, ID 102
            "03 00 64 00 01",  # P6.3, ID 101
            "03 00 65 00 01",
            "03 03 2d 00 01",  # S2.7, ID 814
            "06 03 2d 00 02",  # 2 s
            "03 07 d2 00 01",  # setpoint, ID 2003
        ],
        "start": [
            "03 08 34 00 04",
            "03 00 66 00 02",  # P6.5 and P6.6
            "06 00 66 00 8c",  # 14.0 s
            "06 00 67 00 8c",
            "06 07 d2 13 88",  # 5000, half of the range
            "06 07 d0 03 10",  # from the bus, stopped
            "06 07 d0 03 01",  # run
            "03 08 34 00 04",
        ],
        Stop.RAMP: "06 07 d0 03 10",
        Stop.COAST: "06 07 d0 03 08",
        Stop.EMERGENCY: "06 07 d0 13 10",
    },
    "vfd-ed": {
        "open": ["03 21 00 00 04", "03 21 19 00 01"],  # faults and frequencies; status
        "start": [
            "03 21 00 00 04",
            "03 21 19 00 01",
            "06 20 01 0d ac",  # 35.00 Hz
            "06 20 00 00 12",  # run forward
            "03 21 00 00 04",
            "03 21 19 00 01",
        ],
        Stop.RAMP: "06 20 00 00 01",
        Stop.COAST: "06 20 00 00 01",
        Stop.EMERGENCY: "06 20 00 00 01",
    },
    "acs355": {
        "open": [
            "03 00 00 00 06",  # state: 40001 to 40006
            "03 07 d7 00 01",  # 2008
            "03 04 50 00 01",  # 1105
            "03 14 bd 00 01",  # 5310
            "06 14 bd 00 67",  # 103
            "03 14 be 00 01",  # 5311
            "06 14 be 00 65",  # 101
            "03 0b c9 00 01",  # 3018
            "06 0b c9 00 01",  # fault
            "03 0b ca 00 01",  # 3019
            "06 0b ca 00 14",  # 2.0 s
        ],
        "start": [
            "03 00 00 00 06",
            "03 08 99 00 02",  # 2202 and 2203
            "06 08 99 00 8c",  # 14.0 s
            "06 08 9a 00 8c",
            "06 00 01 27 10",  # 10000, half of REF1 MAX
            "06 00 00 04 76",
            "06 00 00 04 77",
            "06 00 00 04 7f",
            "03 00 00 00 06",
        ],
        Stop.RAMP: "06 00 00 04 7e",
        Stop.COAST: "06 00 00 04 7d",
        Stop.EMERGENCY: "06 00 00 04 7b",
    },
}
FAKES = {"m-max": (M_MAX, m_max), "vfd-ed": (VFD_ED, vfd_ed), "acs355": (ACS355, acs355)}


@pytest.fixture(params=FAKES)
def profile(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    return name


@pytest.fixture
def recorder(profile: str) -> Iterator[Recorder]:
    registers, obey = FAKES[profile]
    recorder = Recorder(dict(registers), obey)
    recorder.start()
    yield recorder
    recorder.unplug()


def motor_of(recorder: Recorder, profile: str) -> ModbusMotor:
    said = {"driver": "modbus-rtu", "port": recorder.port, "profile": profile, "max_speed": 4200 * RPM}
    said |= {"ramp": RAMP} if load_profile(profile).ramp_by_hand else {}
    return ModbusMotor(ModbusRtu.model_validate(said, context={"si": True}))


def test_the_frames_are_those_of_the_manual(recorder: Recorder, profile: str) -> None:
    frames = FRAMES[profile]
    with motor_of(recorder, profile) as motor:
        motor.open()
        assert recorder.sent() == frames["open"]
        for kind in Stop:
            motor.set_speed(2100 * RPM, ramp=RAMP)
            sent = recorder.sent()
            if kind is Stop.RAMP:  # the first: later ones find the ramp set
                assert sent == frames["start"]
            motor.stop(kind)
            assert recorder.sent()[0] == frames[kind]


def until(condition: Callable[[], bool], seconds: float = 5.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "nothing happened"
        time.sleep(0.005)


@pytest.fixture(params=["rtu", "tcp"])
def wire(request: pytest.FixtureRequest) -> Wire:
    found: Wire = request.param
    return found


@pytest.fixture(params=defer_rest(profile_names(), now=2))
def drive(request: pytest.FixtureRequest, wire: Wire) -> Iterator[Served]:
    with served(request.param, wire=wire) as drive:
        yield drive


def test_a_drive_goes_to_its_speed_and_stops_as_told(drive: Served) -> None:
    with ModbusMotor(drive.table) as motor:
        coasts = motor.open().coasts
        for kind in Stop:
            motor.set_speed(900 * RPM, ramp=RAMP)
            until(lambda: motor.read().at_setpoint)
            state = motor.read()
            assert (state.speed, state.setpoint) == pytest.approx((900 * RPM, 900 * RPM), abs=6 * RPM)  # 0.1 Hz
            assert drive.plant.speed == pytest.approx(900 * RPM, abs=0.4 * RPM)
            told = len(drive.plant.commands)
            motor.stop(kind)
            if coasts and kind is Stop.COAST:
                assert drive.plant.commands[-1][2] is False
                assert drive.plant.speed > 0.0
            else:
                assert drive.plant.commands[told][0::2] == (0.0, True)
            until(lambda: not motor.read().running and drive.plant.speed < 0.1)


def test_a_trip_is_told_with_its_number_and_forbids_a_start(drive: Served) -> None:
    with ModbusMotor(drive.table) as motor:
        motor.open()
        drive.registers.drive.trip(53)
        assert "53" in motor.read().fault
        with pytest.raises(LimitExceeded, match="has tripped with"):
            motor.set_speed(900 * RPM, ramp=RAMP)
        if profile_of(drive.table.profile).clear_fault:
            motor.clear_fault()
            assert motor.read().fault == ""
        else:
            with pytest.raises(LimitExceeded, match="cannot be cleared over Modbus"):
                motor.clear_fault()


@pytest.mark.parametrize("profile", defer_rest(name for name in profile_names() if profile_of(name).watchdog))
def test_the_drive_stops_the_rotor_when_its_master_falls_silent(profile: str) -> None:
    with served(profile, watchdog="1 s") as drive:
        with ModbusMotor(drive.table) as motor:
            assert motor.open().watchdog == 1.0
            motor.set_speed(900 * RPM, ramp=RAMP)
            until(lambda: motor.read().at_setpoint)
        until(lambda: drive.plant.speed < 0.1)


def test_every_drive_is_found_by_its_file() -> None:
    assert {"acs355", "m-max", "powerflex400", "vfd-ed"} <= set(profile_names())
    assert {name for name in profile_names() if load_profile(name).ramp_by_hand} >= {"vfd-ed"}
    assert {name for name in profile_names() if load_profile(name).keeps_ramp} >= {"m-max", "vfd-ed"}


def test_an_unknown_profile_is_refused_with_the_names_there_are() -> None:
    text = RK4.replace('profile = "powerflex400"', 'profile = "powerflex"')
    with pytest.raises(ConfigError, match=r"^rk4: motor.profile: got 'powerflex', input should be .*'acs355', 'm-max'"):
        parse(text, where="rk4")


def test_a_drive_without_an_emulator_cannot_be_simulated() -> None:
    said = {"driver": "modbus-rtu", "port": "-", "max_speed": "4200 rpm"}
    table = ModbusRtu.model_validate(said).model_copy(update={"profile": "altivar"})
    with pytest.raises(ConfigError, match=r"^motor.profile: got 'altivar', want a drive that has an emulator"):
        commission_drive(table, ToyPlant(), WallClock())


def test_another_device_that_answers_is_no_answer() -> None:
    with served("m-max", wire="tcp") as drive, ModbusMotor(drive.table) as motor:
        motor.open()
        drive.disguise.answers_as = 9
        with pytest.raises(LinkLost, match="no valid answer in 6 tries"):
            motor.read()
        drive.disguise.answers_as = None
        assert not motor.read().running


def test_a_ramp_an_m_max_cannot_be_told_while_it_runs_is_refused_before_anything_is_sent() -> None:
    with served("m-max") as drive, ModbusMotor(drive.table) as motor:
        motor.open()
        motor.set_speed(900 * RPM, ramp=RAMP)
        with pytest.raises(ConfigError, match=r"got one of 70 s, want 14 s up and 14 s down: a M-Max keeps"):
            motor.set_speed(1200 * RPM, ramp=60 * RPM)
        assert motor.read().setpoint == pytest.approx(900 * RPM, abs=0.4 * RPM)
        motor.set_speed(1200 * RPM, ramp=RAMP)  # the same one may


def test_a_ramp_that_is_set_by_hand_is_the_only_one() -> None:
    with served("vfd-ed") as drive, ModbusMotor(drive.table) as motor:
        motor.open()
        with pytest.raises(ConfigError, match=r"ramp: got 60 rpm/s, want 300 rpm/s as motor.ramp says"):
            motor.set_speed(900 * RPM, ramp=60 * RPM)
        assert not motor.read().running


def test_a_host_that_does_not_listen_is_said() -> None:
    with served("powerflex400", wire="tcp") as drive:
        port = drive.table.tcp_port
    said = {"driver": "modbus-tcp", "host": "127.0.0.1", "tcp_port": port, "max_speed": "4200 rpm"}
    table = ModbusTcp.model_validate(said)
    with pytest.raises(LinkLost, match=rf"^127.0.0.1:{port}: nobody accepts a Modbus TCP connection there"):
        ModbusMotor(table).open()


def test_a_connection_that_was_closed_is_a_lost_link() -> None:
    with served("powerflex400", wire="tcp") as drive:
        motor = ModbusMotor(drive.table)
        motor.open()
    with motor, pytest.raises(LinkLost, match="the connection was closed; is the drive on"):
        motor.read()


def test_a_unit_that_is_not_there_is_said() -> None:
    with served("powerflex400", wire="tcp", address=1) as drive:
        table = drive.table.model_copy(update={"address": 5})
        with ModbusMotor(table) as motor, pytest.raises(LinkLost, match=r"exception 11 \(no such device behind the"):
            motor.open()
