"""The only place that picks a driver by the name a config gives."""

from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.motor.base import MotorDriver
from rotorrig.rig.motor.modbus_frames import Profile
from rotorrig.rig.motor.modbus_motor import ModbusMotor
from rotorrig.rig.motor.profiles import powerflex400
from rotorrig.rig.probes.base import Daq
from rotorrig.rig.probes.calibration import channels_used
from rotorrig.rig.probes.stream_daq import StreamDaq

PROFILES: dict[str, Profile] = {"powerflex400": powerflex400.PROFILE}


def motor(rig: RigConfig, *, port: str | None = None) -> MotorDriver:
    """Return the config's motor driver, not yet open; `port` overrides the config's. Raises ConfigError."""
    if rig.motor is None:
        raise ConfigError(f"motor: is missing in the config of '{rig.name}', want [motor] with driver and port")
    match rig.motor.driver:
        case "modbus-rtu":
            return ModbusMotor(
                port or rig.motor.port,
                profile=PROFILES[rig.motor.profile],
                baudrate=rig.motor.baudrate,
                address=rig.motor.address,
                rpm_per_hz=rig.motor.rpm_per_hz,
                max_speed=rig.motor.max_speed,
            )


def daq(rig: RigConfig, *, port: str | None = None) -> Daq:
    """Return the config's DAQ, not yet open; `port` overrides the config's. Raises ConfigError."""
    if rig.daq is None:
        raise ConfigError(
            f"daq: is missing in the config of '{rig.name}', want [daq] with driver, port and sample_rate"
        )
    match rig.daq.driver:
        case "stream":
            return StreamDaq(port or rig.daq.port, sample_rate=rig.daq.sample_rate, channels=channels_used(rig))
