"""Objects and state words of a CiA 402 drive in velocity mode (vl), CiA 402-2 V3.0 (IEC 61800-7-201): pure functions.

Speeds are in the drive's velocity unit, rpm unless its manual says otherwise; `unit` is that of the shaft in rad/s.
"""

from dataclasses import dataclass
from enum import Enum

from rotorrig.rig.config import RPM
from rotorrig.rig.errors import BadFrame, ConfigError, LimitExceeded

PROFILE = 402
VELOCITY_MODE = 2
FASTEST = (1 << 15) - 1  # units: the target is an INTEGER16


@dataclass(frozen=True, slots=True)
class Item:
    """An object of the device's dictionary: an integer, or a text."""

    index: int
    subindex: int
    size: int  # bytes; 0: a text
    name: str
    signed: bool = False

    def __str__(self) -> str:
        return f"{self.name} ({self.index:04X}h:{self.subindex:02X})"

    def encode(self, value: int) -> bytes:
        """Return the bytes of a value. Raises OverflowError if they do not hold it.

        >>> TARGET.encode(-300).hex()
        'd4fe'
        """
        return value.to_bytes(self.size, "little", signed=self.signed)

    def decode(self, data: bytes) -> int:
        """Return the value from its bytes; a device may send more than it has. Raises BadFrame if less."""
        if len(data) < self.size:
            raise BadFrame(f"{self}: got {len(data)} bytes, want {self.size}")
        return int.from_bytes(data[: self.size], "little", signed=self.signed)


DEVICE_TYPE = Item(0x1000, 0, 4, "device type")
DEVICE_NAME = Item(0x1008, 0, 0, "manufacturer device name")
MASTER_HEARTBEAT = Item(0x1016, 1, 4, "consumer heartbeat time")
ABORT_OPTION = Item(0x6007, 0, 2, "abort connection option code", signed=True)
ERROR_CODE = Item(0x603F, 0, 2, "error code")
CONTROLWORD = Item(0x6040, 0, 2, "controlword")
STATUSWORD = Item(0x6041, 0, 2, "statusword")
TARGET = Item(0x6042, 0, 2, "vl target velocity", signed=True)
ACTUAL = Item(0x6044, 0, 2, "vl velocity actual value", signed=True)
LEAST_AMOUNT = Item(0x6046, 1, 4, "vl velocity min amount")
LARGEST_AMOUNT = Item(0x6046, 2, 4, "vl velocity max amount")
ACCELERATION = Item(0x6048, 1, 4, "vl velocity acceleration delta speed"), Item(0x6048, 2, 2, "delta time")
DECELERATION = Item(0x6049, 1, 4, "vl velocity deceleration delta speed"), Item(0x6049, 2, 2, "delta time")
QUICK_STOP_RAMP = Item(0x604A, 1, 4, "vl velocity quick stop delta speed"), Item(0x604A, 2, 2, "delta time")
QUICK_STOP_OPTION = Item(0x605A, 0, 2, "quick stop option code", signed=True)
SHUTDOWN_OPTION = Item(0x605B, 0, 2, "shutdown option code", signed=True)
MODE = Item(0x6060, 0, 1, "modes of operation", signed=True)
MODE_DISPLAY = Item(0x6061, 0, 1, "modes of operation display", signed=True)
SUPPORTED_MODES = Item(0x6502, 0, 4, "supported drive modes")

# values of the option codes
ABORT_BY_QUICK_STOP = 3
QUICK_STOP_DOWN_ITS_RAMP = 2  # and on to switch on disabled
SHUTDOWN_DOWN_THE_RAMP = 1  # of 6049h

# controlwords
DISABLE_VOLTAGE = 0x0000
QUICK_STOP = 0x0002
SHUTDOWN = 0x0006
SWITCH_ON = 0x0007
ENABLE_OPERATION = 0x007F  # with bits 4, 5, 6: ramp generator enabled, unlocked, following the target
FAULT_RESET = 0x0080


class State(Enum):
    """The states of the power drive system: mask and bits of the statusword."""

    NOT_READY_TO_SWITCH_ON = (0x4F, 0x00)
    SWITCH_ON_DISABLED = (0x4F, 0x40)
    READY_TO_SWITCH_ON = (0x6F, 0x21)
    SWITCHED_ON = (0x6F, 0x23)
    OPERATION_ENABLED = (0x6F, 0x27)
    QUICK_STOP_ACTIVE = (0x6F, 0x07)
    FAULT_REACTION_ACTIVE = (0x4F, 0x0F)
    FAULT = (0x4F, 0x08)

    def __str__(self) -> str:
        return self.name.lower().replace("_", " ")


#: state -> controlword that leads on towards operation enabled
NEXT = {
    State.SWITCH_ON_DISABLED: SHUTDOWN,
    State.READY_TO_SWITCH_ON: SWITCH_ON,
    State.SWITCHED_ON: ENABLE_OPERATION,
    State.QUICK_STOP_ACTIVE: DISABLE_VOLTAGE,
}
FAULTED = (State.FAULT, State.FAULT_REACTION_ACTIVE)
POWERED = (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE)

_TARGET_REACHED = 1 << 10

_ERRORS = {  # error codes of 603Fh and of emergencies: CiA 402-1 and CiA 301
    0x2310: "continuous over-current",
    0x2320: "short circuit or earth leakage",
    0x3210: "DC link over-voltage",
    0x3220: "DC link under-voltage",
    0x4210: "drive too hot",
    0x4310: "motor too hot",
    0x7121: "motor blocked",
    0x8110: "CAN overrun, messages lost",
    0x8120: "CAN error passive",
    0x8130: "heartbeat or life guarding lost",
    0x8140: "recovered from bus off",
}
_CLASSES = {  # by the first digit
    0x1: "generic error",
    0x2: "current",
    0x3: "voltage",
    0x4: "temperature",
    0x5: "device hardware",
    0x6: "device software",
    0x7: "additional modules",
    0x8: "monitoring",
    0x9: "external error",
    0xF: "device specific",
}


def decode_state(word: int) -> State:
    """Return the state a statusword tells. Raises BadFrame for one that tells none.

    >>> print(decode_state(0x0637))
    operation enabled
    """
    for state in State:
        mask, bits = state.value
        if word & mask == bits:
            return state
    raise BadFrame(f"statusword: got {word:04X}h, which is no state of CiA 402")


def is_target_reached(word: int) -> bool:
    """Return bit 10 of a statusword."""
    return bool(word & _TARGET_REACHED)


def describe_error(code: int) -> str:
    """Return an error code's meaning and number.

    >>> describe_error(0x3210), describe_error(0x3130)
    ('DC link over-voltage (3210h)', 'voltage (3130h)')
    """
    return f"{_ERRORS.get(code) or _CLASSES.get(code >> 12, 'unknown error')} ({code:04X}h)"


def encode_speed(speed: float, *, unit: float, slowest: float, fastest: float) -> int:
    """Return the target nearest to `speed`; speeds in rad/s.

    Raises LimitExceeded below 0, above `fastest`, or below `slowest`, where the drive would turn faster than asked.
    """
    if not (speed == 0 or slowest <= speed <= fastest):
        raise LimitExceeded(
            f"speed: asked for {speed * RPM:.0f} rpm, want {slowest * RPM:.0f} to {fastest * RPM:.0f} rpm, "
            "the least of motor.max_speed in the config and the drive's own limits (6046h)"
        )
    return round(speed / unit)


def encode_ramp(ramp: float, *, unit: float) -> tuple[int, int]:
    """Return delta speed [units] and delta time [s] nearest to `ramp` [rad/s^2]. Raises ConfigError.

    The time is the least power of ten that gives the speed four digits, so that it is off by 0.05 % at most.

    >>> encode_ramp(30 / RPM, unit=1 / RPM)  # 30 rpm/s
    (3000, 100)
    """
    units = ramp / unit
    for seconds in (1, 10, 100, 1000, 10000):
        if 999.5 <= units * seconds < FASTEST + 0.5:
            return round(units * seconds), seconds
    raise ConfigError(
        f"ramp: got {ramp * RPM:.4g} rpm/s, want {0.1 * unit * RPM:.4g} to {FASTEST * unit * RPM:.4g} rpm/s, "
        "what a CiA 402 drive can be told"
    )
