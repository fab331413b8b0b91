from .base import MotorDriver as MotorDriver
from .base import MotorInfo as MotorInfo
from .base import MotorState as MotorState
from .base import Stop as Stop
from .canopen_motor import CanOpenMotor as CanOpenMotor
from .line_motor import LineMotor as LineMotor
from .modbus_motor import ModbusMotor as ModbusMotor

__all__ = [
    "CanOpenMotor",
    "LineMotor",
    "ModbusMotor",
    "MotorDriver",
    "MotorInfo",
    "MotorState",
    "Stop",
]
