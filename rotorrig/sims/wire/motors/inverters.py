"""Which emulated inverter stands behind a config's `[motor]`: the one its `profile` names, as commissioned for it."""

from typing import assert_never

from rotorrig.rig import Clock
from rotorrig.rig.config import RPM, ModbusRtu, ModbusTcp
from rotorrig.sims.wire.motors.acs355 import Acs355
from rotorrig.sims.wire.motors.m_max import MMax
from rotorrig.sims.wire.motors.modbus_motor import Registers
from rotorrig.sims.wire.motors.powerflex400 import PowerFlex400
from rotorrig.sims.wire.motors.vfd_ed import VfdEd
from rotorrig.sims.wire.plant_port import Plant


def registers_of(table: ModbusRtu | ModbusTcp, plant: Plant, clock: Clock) -> Registers:
    """Return the registers of the drive that `table` names, its maximum frequency set to `max_speed`.

    Raises ConfigError if such a drive cannot turn the rotor so fast.
    """
    rpm_per_hz = table.rpm_per_hz
    max_frequency = table.max_speed * RPM / rpm_per_hz
    match table.profile:
        case "powerflex400":
            return PowerFlex400(plant, rpm_per_hz=rpm_per_hz, max_frequency=max_frequency, clock=clock)
        case "m-max":
            return MMax(plant, rpm_per_hz=rpm_per_hz, max_frequency=max_frequency, clock=clock)
        case "vfd-ed":
            assert table.ramp is not None, "checked with the config"
            by_hand = {"ramp": table.ramp, "time_out": table.watchdog}
            return VfdEd(plant, rpm_per_hz=rpm_per_hz, max_frequency=max_frequency, **by_hand, clock=clock)
        case "acs355":
            return Acs355(plant, rpm_per_hz=rpm_per_hz, max_frequency=max_frequency, clock=clock)
        case _:
            assert_never(table.profile)
