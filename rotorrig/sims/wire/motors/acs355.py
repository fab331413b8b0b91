"""An ABB ACS355 drive as its Modbus master sees it: the ABB drives profile in front, the plant's motor behind.

Registers: user's manual 3AUA0000066143, pages 312-313 (rev. E 326: 4xxxx is sent as xxxx - 1); states: page 319;
meaning of the words: ABB drives profile, as in the ACS550-02 manual, pages 240-247. Emulated is what a rig needs:

- the state machine of ABB DRV FULL, with OFF1 (ramp, 2203), OFF2 (coasting) and OFF3 (in the time of 2208)
- REF1 in scalar mode, 20000 being 1105 REF1 MAX, limited by 2008; actual values mapped by 5310 to 5317
- the communication watchdog 3018, 3019 with fault 28, in wall time, while the drive runs

A negative reference, a held or zeroed ramp (control word bits 4 to 6), EXT2 and 3018 = 2 are refused as illegal values.
"""

import math
from dataclasses import dataclass
from enum import Enum, auto
from types import MappingProxyType

from rotorrig.rig import Clock, ConfigError
from rotorrig.rig.config import ModbusRtu, ModbusTcp
from rotorrig.sims.wire.drive import Drive, OnSilence
from rotorrig.sims.wire.plant_port import Plant

CONTROL_WORD, REF1, REF2, STATUS_WORD, ACTUAL_1, ACTUAL_8 = 1, 2, 3, 4, 5, 12  # 4xxxx
SPEED, OUTPUT_FREQUENCY, LAST_FAULT, REF1_MAX, MAX_FREQUENCY = 101, 103, 401, 1105, 2008  # parameters, 4ggnn
ACCEL_TIME, DECEL_TIME, EMERGENCY_TIME = 2202, 2203, 2208
COMM_FAULT_FUNCTION, COMM_FAULT_TIME, FIRST_MAPPING = 3018, 3019, 5310

SERIAL_1_ERR = 28
_FULL_REFERENCE = 20_000

# control word: OFF1 to OFF3 and inhibit act when they are 0
_OFF1, _OFF2, _OFF3, _OPERATE, _RESET, _REMOTE, _EXT2 = 1 << 0, 1 << 1, 1 << 2, 1 << 3, 1 << 7, 1 << 10, 1 << 11
_RAMP_ACTS = 0b111 << 4


class _State(Enum):
    INHIBITED = auto()  # switch-on inhibited
    READY_ON = auto()  # to switch on
    READY_RUN = auto()  # to operate
    ENABLED = auto()  # operating


@dataclass(frozen=True, slots=True)
class _Parameter:
    default: int
    allowed: range


_PARAMETERS = MappingProxyType(
    {
        REF1_MAX: _Parameter(500, range(0, 5001)),  # 0.1 Hz
        MAX_FREQUENCY: _Parameter(500, range(0, 6001)),  # 0.1 Hz
        ACCEL_TIME: _Parameter(50, range(0, 18001)),  # 0.1 s from 0 to 2008
        DECEL_TIME: _Parameter(50, range(0, 18001)),  # 0.1 s
        EMERGENCY_TIME: _Parameter(10, range(0, 18001)),  # 0.1 s
        COMM_FAULT_FUNCTION: _Parameter(0, range(0, 4)),  # 0 not selected, 1 fault, 2 constant speed 7, 3 last speed
        COMM_FAULT_TIME: _Parameter(30, range(0, 601)),  # 0.1 s
        **{FIRST_MAPPING + n: _Parameter(OUTPUT_FREQUENCY if n == 0 else 0, range(0, 9999)) for n in range(8)},
    }
)


class Acs355:
    """The drive's registers, to `read` and `write`; `drive` is the drive behind them."""

    functions = frozenset({3, 6, 16, 23})

    def __init__(self, plant: Plant, *, rpm_per_hz: float, max_frequency: float, clock: Clock) -> None:
        """Set up for a rotor that turns `rpm_per_hz`; `max_frequency` [Hz] is 2008 and 1105 as commissioned.

        Raises ConfigError if the drive cannot be set to `max_frequency`.
        """
        if not 0 < max_frequency <= 500:
            raise ConfigError(
                f"motor.max_speed: takes {max_frequency:g} Hz at {rpm_per_hz:g} rpm per Hz, "
                "want at most the 500 Hz of an ACS355's reference"
            )
        self._speed_per_hz = rpm_per_hz * math.pi / 30.0
        self._values = {number: p.default for number, p in _PARAMETERS.items()} | {CONTROL_WORD: 0, REF1: 0, REF2: 0}
        self._values[REF1_MAX] = self._values[MAX_FREQUENCY] = math.ceil(10 * max_frequency - 1e-6)
        self._state = _State.INHIBITED
        self._last_fault = 0
        self.drive = Drive(plant, clock=clock, silence_fault=SERIAL_1_ERR)
        self._set_up()

    def read(self, address: int, count: int) -> list[int]:
        """Return `count` registers from `address`. Raises KeyError for one the drive does not have."""
        self.drive.hear()
        self._tick()
        known = self._values | {STATUS_WORD: self._status(), LAST_FAULT: self._last_fault, **self._actual_values()}
        return [known[a + 1] for a in range(address, address + count)]

    def write(self, address: int, values: list[int]) -> None:
        """Write consecutive registers, all or none.

        Raises KeyError for a register that is unknown or read-only, ValueError for a value out of range.
        """
        self.drive.hear()
        self._tick()
        writes = {number + 1: value for number, value in enumerate(values, start=address)}
        for number, value in writes.items():
            _check(number, value)
        rising = writes.get(CONTROL_WORD, 0) & ~self._values[CONTROL_WORD]
        self._values |= writes
        self._set_up()
        if CONTROL_WORD in writes:
            self._obey(writes[CONTROL_WORD], rising)

    def _tick(self) -> None:
        self.drive.tick()
        if self.drive.fault:
            self._last_fault, self._state = self.drive.fault, _State.INHIBITED

    def _obey(self, word: int, rising: int) -> None:
        """Go through the states of page 319 as far as a control word leads."""
        if not word & _REMOTE:
            return
        if rising & _RESET:
            self.drive.fault = 0
        if not word & _OFF2:
            self._state = _State.INHIBITED
            self.drive.stop(coast=True)
        elif not word & _OFF3:
            self._state = _State.INHIBITED
            self.drive.stop(coast=False, braking=self._slope(EMERGENCY_TIME))
        elif not word & _OFF1:
            self._state = _State.READY_ON
            self.drive.stop(coast=False)
        elif self._state is not _State.INHIBITED and not self.drive.fault:
            self._operate(bool(word & _OPERATE))

    def _operate(self, enabled: bool) -> None:
        if enabled:
            self._state = _State.ENABLED
            self.drive.start()
        else:
            if self._state is _State.ENABLED:
                self.drive.stop(coast=True)
            self._state = _State.READY_RUN

    def _set_up(self) -> None:
        """Hand the values on: a new reference or ramp time counts at once."""
        hertz = min(self._values[REF1] / _FULL_REFERENCE * self._values[REF1_MAX], self._values[MAX_FREQUENCY]) / 10
        rising, falling = (self._slope(time) for time in (ACCEL_TIME, DECEL_TIME))
        self.drive.set_reference(hertz * self._speed_per_hz, rising=rising, falling=falling)
        self.drive.patience = self._values[COMM_FAULT_TIME] / 10
        self.drive.on_silence = OnSilence.TRIP if self._values[COMM_FAULT_FUNCTION] == 1 else OnSilence.GO_ON

    def _slope(self, time: int) -> float:
        """Return the ramp of a time parameter [rad/s^2]; a time of zero is the shortest there is, 0.1 s."""
        fastest = max(self._values[MAX_FREQUENCY], 1) / 10 * self._speed_per_hz
        return fastest / max(self._values[time] / 10, 0.1)

    def _actual_values(self) -> dict[int, int]:
        """Return registers 40005 to 40012; of the signals that may be mapped there are speed [rpm] and frequency."""
        tenths = round(10 * self.drive.speed / self._speed_per_hz)
        signals = {SPEED: round(self.drive.speed * 30 / math.pi), OUTPUT_FREQUENCY: tenths}
        registers = range(ACTUAL_1, ACTUAL_8 + 1)
        return {r: signals.get(self._values[FIRST_MAPPING + r - ACTUAL_1], 0) for r in registers}

    def _status(self) -> int:
        """Return the status word."""
        drive, state, word = self.drive, self._state, self._values[CONTROL_WORD]
        bits = {
            0: state is not _State.INHIBITED,  # ready to switch on
            1: state in (_State.READY_RUN, _State.ENABLED),  # ready to operate
            2: state is _State.ENABLED,  # operation enabled
            3: drive.fault != 0,
            4: word & _OFF2,
            5: word & _OFF3,
            6: state is _State.INHIBITED,
            8: state is _State.ENABLED and drive.remaining == 0,  # at setpoint
            9: True,  # remote
        }
        return sum(1 << bit for bit, on in bits.items() if on)


def _check(number: int, value: int) -> None:
    """Raise KeyError for what cannot be written, ValueError for a value the drive does not take."""
    if number == CONTROL_WORD:
        if value & _REMOTE and (value & _RAMP_ACTS != _RAMP_ACTS or value & _EXT2):
            raise ValueError(f"control word {value:#06x} asks for what this drive is not set up for")
    elif number in (REF1, REF2):
        if value & 0x8000:
            raise ValueError(f"reference: got {value - 0x10000}, want 0 to 32767: this rig turns one way")
    elif value not in _PARAMETERS[number].allowed or (number, value) == (COMM_FAULT_FUNCTION, 2):
        allowed = _PARAMETERS[number].allowed
        raise ValueError(f"parameter {number}: got {value}, want {allowed.start} to {allowed.stop - 1}")


def commission(table: ModbusRtu | ModbusTcp, plant: Plant, *, max_frequency: float, clock: Clock) -> Acs355:
    """Return the drive as commissioned for `table`, see `inverters`."""
    return Acs355(plant, rpm_per_hz=table.rpm_per_hz, max_frequency=max_frequency, clock=clock)
