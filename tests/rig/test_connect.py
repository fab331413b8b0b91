"""The config's names pick the driver."""

import pytest

from rotorrig.rig import connect
from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.motor.modbus_motor import ModbusMotor
from rotorrig.rig.probes.stream_daq import StreamDaq


def test_the_rk4_has_a_modbus_motor_and_a_stream_daq(rk4: RigConfig) -> None:
    motor, daq = connect.motor(rk4), connect.daq(rk4)
    assert isinstance(motor, ModbusMotor)
    assert isinstance(daq, StreamDaq)
    assert (motor.port, daq.port) == ("/dev/ttyUSB0", "/dev/ttyACM0")


def test_a_port_overrides_the_configs(rk4: RigConfig) -> None:
    motor, daq = connect.motor(rk4, port="/dev/pts/8"), connect.daq(rk4, port="/dev/pts/9")
    assert isinstance(motor, ModbusMotor)
    assert isinstance(daq, StreamDaq)
    assert (motor.port, daq.port) == ("/dev/pts/8", "/dev/pts/9")


def test_a_config_without_motor_or_daq_is_said(rk4: RigConfig) -> None:
    bare = rk4.model_copy(update={"motor": None, "daq": None})
    with pytest.raises(ConfigError, match=r"motor: is missing in the config of 'RK4.*want \[motor\]"):
        connect.motor(bare)
    with pytest.raises(ConfigError, match=r"daq: is missing .*want \[daq\]"):
        connect.daq(bare)
