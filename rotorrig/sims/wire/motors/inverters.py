"""Emulated Modbus drive for a config's `[motor]`: the file its `profile` names, commissioned for the rig.

A drive's file in this folder has the name of its profile and a function `commission`, as `Emulator` says.
"""

import importlib
import importlib.util
from typing import Protocol, cast

from rotorrig.rig import Clock, ConfigError
from rotorrig.rig.config import RPM, ModbusRtu, ModbusTcp
from rotorrig.sims.wire.motors.modbus_motor import Registers
from rotorrig.sims.wire.plant_port import Plant

_FOLDER = "rotorrig.sims.wire.motors"


class Emulator(Protocol):
    """The module of an emulated drive."""

    def commission(
        self, table: ModbusRtu | ModbusTcp, plant: Plant, *, max_frequency: float, clock: Clock
    ) -> Registers:
        """Return the drive's registers, set up by hand as `table` needs it, up to `max_frequency` [Hz].

        Raises ConfigError if such a drive cannot be set to `max_frequency`.
        """
        ...


def commission_drive(table: ModbusRtu | ModbusTcp, plant: Plant, clock: Clock) -> Registers:
    """Return the registers of the drive that `table` names, its maximum frequency set to `max_speed`.

    Raises ConfigError if there is no emulator of that drive, or if it cannot turn the rotor so fast.
    """
    name = f"{_FOLDER}.{table.profile.replace('-', '_')}"
    if importlib.util.find_spec(name) is None:
        raise ConfigError(f"motor.profile: got '{table.profile}', want a drive that has an emulator, {name}")
    emulator = cast(Emulator, importlib.import_module(name))
    max_frequency = table.max_speed * RPM / table.rpm_per_hz
    return emulator.commission(table, plant, max_frequency=max_frequency, clock=clock)
