"""An Eaton M-Max drive (MMX) as its Modbus master sees it: IDs in front, the plant's motor behind.

Control word, process data, status word and their scaling: manual MN04020003E (October 2013), pages 136-139; ramps and
stop function pages 83-84; time-out of the fieldbus page 132; what is not answered page 135. An ID is sent as ID - 1, as
in the frame printed on page 135. Emulated is what a rig needs:

- run, stop by ramp, coasting or "as quickly as possible", reset, setpoint from the bus
- the time-out S2.7 with fault 53, in wall time, while the drive runs
- parameters that cannot be changed in RUN; the manual does not say which exception that is, here it is 3
- a start on a turning rotor catches it, as with P6.7 = 1

Reverse, a blocked or overwritten setpoint and the ramps of 0.1 s (bits 1, 5, 6, 7) are refused as illegal values.
"""

import math
from dataclasses import dataclass
from types import MappingProxyType

from rotorrig.rig import Clock, ConfigError
from rotorrig.rig.config import ModbusRtu, ModbusTcp
from rotorrig.sims.wire.drive import Drive, OnSilence
from rotorrig.sims.wire.motors.modbus_motor import Unanswered
from rotorrig.sims.wire.plant_port import Plant

CONTROL_WORD, GENERAL_CONTROL_WORD, SETPOINT = 2001, 2002, 2003  # IDs
STATUS_WORD, GENERAL_STATUS_WORD, ACTUAL_SPEED, MOTOR_FREQUENCY, MOTOR_SPEED = 2101, 2102, 2103, 2104, 2105
CURRENT, TORQUE, POWER, VOLTAGE, DC_LINK, FAULT = 2106, 2107, 2108, 2109, 2110, 2111
MIN_FREQUENCY, MAX_FREQUENCY, ACCEL_TIME, DECEL_TIME, STOP_FUNCTION, TIME_OUT = 101, 102, 103, 104, 506, 814

LONGEST_READ = 11  # registers, page 135: with 12 there is no reply, and an error F08
BAD_REQUEST, FIELDBUS_ERROR = 8, 53
_AT_ONCE = 0.1  # s from the maximum frequency to 0: the shortest ramp of P6.6, for "as quickly as possible"

# control word, page 137
_RUN, _RESET, _COAST, _RAMP, _BLOCK = 1 << 0, 1 << 2, 1 << 3, 1 << 4, 1 << 12
_CONTROL_FROM_BUS, _SETPOINT_FROM_BUS = 1 << 8, 1 << 9
_NOT_EMULATED = 1 << 1 | 1 << 5 | 1 << 6 | 1 << 7


@dataclass(frozen=True, slots=True)
class _Parameter:
    default: int
    allowed: range
    in_run: bool  # whether it may be changed while the drive runs


_PARAMETERS = MappingProxyType(
    {
        MIN_FREQUENCY: _Parameter(0, range(0, 32001), False),  # P6.3, 0.01 Hz
        MAX_FREQUENCY: _Parameter(6000, range(0, 32001), False),  # P6.4, 0.01 Hz
        ACCEL_TIME: _Parameter(30, range(1, 30001), False),  # P6.5, 0.1 s from 0 Hz to P6.4
        DECEL_TIME: _Parameter(30, range(1, 30001), False),  # P6.6, 0.1 s
        STOP_FUNCTION: _Parameter(0, range(0, 2), False),  # P6.8: 0 free coasting, 1 ramp
        TIME_OUT: _Parameter(0, range(0, 256), True),  # S2.7, s; 0: not used
    }
)


class MMax:
    """The drive's registers, to `read` and `write`; `drive` is the drive behind them."""

    functions = frozenset({3, 4, 6, 16})

    def __init__(self, plant: Plant, *, rpm_per_hz: float, max_frequency: float, clock: Clock) -> None:
        """Set up for a rotor that turns `rpm_per_hz`; `max_frequency` [Hz] is P6.4 as commissioned.

        Raises ConfigError if the drive cannot be set to `max_frequency`.
        """
        if not 0 < max_frequency <= 320:
            raise ConfigError(
                f"motor.max_speed: takes {max_frequency:g} Hz at {rpm_per_hz:g} rpm per Hz, "
                "want at most the 320 Hz of an M-Max"
            )
        self._speed_per_hz = rpm_per_hz * math.pi / 30.0
        self._values = {number: p.default for number, p in _PARAMETERS.items()}
        self._values |= {MAX_FREQUENCY: round(100 * max_frequency), SETPOINT: 0, GENERAL_CONTROL_WORD: 0}
        self._control = 0
        self.drive = Drive(plant, clock=clock, silence_fault=FIELDBUS_ERROR)
        self._set_up()

    def read(self, address: int, count: int) -> list[int]:
        """Return `count` registers from `address`.

        Raises KeyError for one the drive does not have, Unanswered for more than it sends.
        """
        self.drive.hear()
        self.drive.tick()
        if count > LONGEST_READ:
            self.drive.trip(BAD_REQUEST)
            raise Unanswered
        known = self._values | {CONTROL_WORD: self._control} | self._process_data()
        return [known[a + 1] for a in range(address, address + count)]

    def write(self, address: int, values: list[int]) -> None:
        """Write consecutive registers, all or none.

        Raises KeyError for a register that is unknown or read-only, ValueError for a value out of range.
        """
        self.drive.hear()
        writes = {number + 1: value for number, value in enumerate(values, start=address)}
        for number, value in writes.items():
            self._check(number, value)
        command = writes.pop(CONTROL_WORD, None)
        self._values |= writes
        if command is not None:
            self._obey(command)
        self._set_up()

    def _check(self, number: int, value: int) -> None:
        if number == CONTROL_WORD:
            if value & _NOT_EMULATED:
                raise ValueError(f"control word {value:#06x} asks for what this drive is not set up for")
        elif number == SETPOINT:
            if value > 10_000:
                raise ValueError(f"setpoint: got {value}, want 0 to 10000")
        elif number != GENERAL_CONTROL_WORD:
            parameter = _PARAMETERS[number]
            if value not in parameter.allowed:
                last = parameter.allowed.stop - 1
                raise ValueError(f"ID {number}: got {value}, want {parameter.allowed.start} to {last}")
            if self.drive.active and not parameter.in_run:
                raise ValueError(f"ID {number}: cannot be changed while the drive runs")

    def _obey(self, word: int) -> None:
        """Act on a control word; run, reset and block act when they change (pages 137, 138)."""
        rising = word & ~self._control
        self._control = word
        if rising & _RESET:
            self.drive.fault = 0
        if not word & _CONTROL_FROM_BUS:
            return
        if word & _BLOCK:
            fastest = self._values[MAX_FREQUENCY] / 100 * self._speed_per_hz
            self.drive.stop(coast=False, braking=fastest / _AT_ONCE)
        elif rising & _RUN:
            self._set_up()
            self.drive.start()
        elif not word & _RUN:
            ramp = word & _RAMP or self._values[STOP_FUNCTION] == 1
            self.drive.stop(coast=bool(word & _COAST) or not ramp)

    def _set_up(self) -> None:
        """Hand the values on: a new setpoint counts at once."""
        fastest = self._values[MAX_FREQUENCY] / 100 * self._speed_per_hz
        rising, falling = (fastest / (self._values[time] / 10) for time in (ACCEL_TIME, DECEL_TIME))
        self.drive.set_reference(self._reference() * self._speed_per_hz, rising=rising, falling=falling)
        self.drive.patience = float(self._values[TIME_OUT])
        self.drive.on_silence = OnSilence.TRIP if self._values[TIME_OUT] else OnSilence.GO_ON

    def _reference(self) -> float:
        """Return the wanted frequency [Hz]: the setpoint is a share of the range from P6.3 to P6.4 (page 138)."""
        if not self._control & _SETPOINT_FROM_BUS:
            return 0.0
        low, high = (self._values[limit] / 100 for limit in (MIN_FREQUENCY, MAX_FREQUENCY))
        return low + (high - low) * self._values[SETPOINT] / 10_000

    def _process_data(self) -> dict[int, int]:
        """Return the output process data; a drive without a motor model draws no current here."""
        hertz = self.drive.speed / self._speed_per_hz
        low, high = (self._values[limit] / 100 for limit in (MIN_FREQUENCY, MAX_FREQUENCY))
        share = max(0.0, (hertz - low) / (high - low)) if high > low else 0.0
        return {
            STATUS_WORD: self._status(),
            GENERAL_STATUS_WORD: self._control >> 8 & 0b11,
            ACTUAL_SPEED: round(10_000 * share),
            MOTOR_FREQUENCY: round(100 * hertz),
            MOTOR_SPEED: round(self.drive.speed * 30.0 / math.pi),
            **dict.fromkeys((CURRENT, TORQUE, POWER, VOLTAGE, DC_LINK), 0),
            FAULT: self.drive.fault,
        }

    def _status(self) -> int:
        """Return the status word, page 139."""
        drive = self.drive
        bits = {
            0: not drive.fault,  # ready
            1: drive.active,  # run
            3: drive.fault != 0,
            5: drive.running and drive.remaining == 0,  # actual value equals setpoint
            6: drive.speed == 0.0,
        }
        return sum(1 << bit for bit, on in bits.items() if on)


def commission(table: ModbusRtu | ModbusTcp, plant: Plant, *, max_frequency: float, clock: Clock) -> MMax:
    """Return the drive as commissioned for `table`, see `inverters`."""
    return MMax(plant, rpm_per_hz=table.rpm_per_hz, max_frequency=max_frequency, clock=clock)
