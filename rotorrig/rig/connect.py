"""Drivers by the name a config gives: the only place that chooses one.

Drivers are imported when they are chosen: a rig without CAN needs no CAN library, one without an NI board no nidaqmx.
"""

from collections.abc import Mapping
from typing import Any, assert_never

from rotorrig.rig.config import RigConfig, devices
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.motor import MotorDriver
from rotorrig.rig.probes import Daq, channels_used

Place = Mapping[str, Any]  # keys of [motor] or [daq] that stand instead of the config's: where a simulated rig is


def motor(rig: RigConfig, *, at: Place | None = None) -> MotorDriver:
    """Return the config's motor driver, not yet open; `at` says where instead. Raises ConfigError."""
    return driver_of(motor_table(rig, at=at))


def motor_table(rig: RigConfig, *, at: Place | None = None) -> devices.Motor:
    """Return the config's [motor], with the keys of `at` instead of its own. Raises ConfigError."""
    if rig.motor is None:
        raise ConfigError(f"motor: is missing in the config of '{rig.name}', want [motor] with its driver")
    return rig.motor.model_copy(update=dict(at or {}))


def driver_of(table: devices.Motor) -> MotorDriver:
    """Return the driver of a [motor] table, not yet open."""
    match table:
        case devices.ModbusRtu() | devices.ModbusTcp():
            from rotorrig.rig.motor import ModbusMotor

            return ModbusMotor(table)
        case devices.LineController():
            from rotorrig.rig.motor import LineMotor

            return LineMotor(table)
        case devices.CanOpen():
            from rotorrig.rig.motor import CanOpenMotor

            return CanOpenMotor(table)
        case _:
            assert_never(table)


def daq(rig: RigConfig, *, at: Place | None = None) -> Daq:
    """Return the config's DAQ, not yet open; `at` says where instead. Raises ConfigError."""
    if rig.daq is None:
        raise ConfigError(f"daq: is missing in the config of '{rig.name}', want [daq] with driver and sample_rate")
    table = rig.daq
    if at:  # a simulated rig has a board of its own, whatever the config names
        table = devices.StreamDaq.model_validate(
            {"driver": "stream", "sample_rate": table.sample_rate, **at}, context={"si": True}
        )
    match table:
        case devices.StreamDaq():
            from rotorrig.rig.probes import StreamDaq

            return StreamDaq(
                table.port, sample_rate=table.sample_rate, channels=channels_used(rig), baudrate=table.baudrate
            )
        case devices.OpenDaq():
            from rotorrig.rig.probes import OpenDaqDaq

            return OpenDaqDaq(table, channels=channels_used(rig))
        case devices.NiDaqmx():
            from rotorrig.rig.probes import NiDaqmxDaq

            return NiDaqmxDaq(table, channels=channels_used(rig))
        case _:
            assert_never(table)
