"""The config's names pick the driver."""

import tomllib
from pathlib import Path

import pytest

from rotorrig.rig import connect
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.config.devices import ModbusTcp
from rotorrig.rig.config.validation import validate_table
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.motor.modbus_motor import ModbusMotor
from rotorrig.rig.probes.stream.daq import StreamDaq


def test_the_rk4_has_a_modbus_motor_and_a_stream_daq(rk4: RigConfig) -> None:
    motor, daq = connect.motor(rk4), connect.daq(rk4)
    assert isinstance(motor, ModbusMotor)
    assert isinstance(daq, StreamDaq)
    assert motor.link == "Modbus RTU, /dev/ttyUSB0, 19200 baud, address 100"
    assert daq.port == "/dev/ttyACM0"


def test_a_port_overrides_the_configs(rk4: RigConfig) -> None:
    motor, daq = connect.motor(rk4, at={"port": "/dev/pts/8"}), connect.daq(rk4, at={"port": "/dev/pts/9"})
    assert isinstance(motor, ModbusMotor)
    assert isinstance(daq, StreamDaq)
    assert motor.link == "Modbus RTU, /dev/pts/8, 19200 baud, address 100"
    assert daq.port == "/dev/pts/9"


def test_a_drive_may_hang_on_ethernet(rk4: RigConfig) -> None:
    text = """driver = "modbus-tcp"\nhost = "192.168.1.7"\nprofile = "m-max"\nmax_speed = "4200 rpm" """
    table = validate_table(ModbusTcp, tomllib.loads(text), where="motor")
    motor = connect.motor(rk4.model_copy(update={"motor": table}))
    assert isinstance(motor, ModbusMotor)
    assert motor.link == "Modbus TCP, 192.168.1.7:502, unit 1"


@pytest.mark.parametrize(
    ("said", "complaint"),
    [
        ('profile = "vfd-ed"', "motor: ramp is missing, want the one that is set at the vfd-ed by hand"),
        ('ramp = "30 rpm/s"', "motor: ramp is given, want none: a powerflex400 is told its ramp"),
        ('watchdog = "0.1 s"', "motor.watchdog: got '0.1 s', input should be greater than or equal to 0.5"),
    ],
)
def test_what_a_drive_cannot_be_told_is_said_when_the_config_is_read(said: str, complaint: str) -> None:
    config = (Path(__file__).parents[2] / "configs" / "rk4.toml").read_text()
    text = config.replace('profile = "powerflex400"\n', "").replace("[motor]\n", f"[motor]\n{said}\n")
    with pytest.raises(ConfigError) as error:
        parse(text, where="x.toml")
    assert str(error.value) == f"x.toml: {complaint}"


def test_a_config_without_motor_or_daq_is_said(rk4: RigConfig) -> None:
    bare = rk4.model_copy(update={"motor": None, "daq": None})
    with pytest.raises(ConfigError, match=r"motor: is missing in the config of 'RK4.*want \[motor\]"):
        connect.motor(bare)
    with pytest.raises(ConfigError, match=r"daq: is missing .*want \[daq\]"):
        connect.daq(bare)
