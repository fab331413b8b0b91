"""An Allen-Bradley PowerFlex 400 drive as its Modbus master sees it: registers in front, the plant's motor behind.

Register map, scaling and bits: Rockwell publication 22C-UM001J, Appendix E, pages 170-173; addresses as on the wire.
Parameters stand at their number (page 173). Emulated is what a rig needs:

- start, stop by ramp or coast, clear faults, reference from the network, acceleration and deceleration time 1
- the loss-of-communication watchdog (C105, C106), in wall time, while the drive runs
- output frequency as the ramp generator's, as on any drive without an encoder; a start on a turning rotor catches it
  (flying start), output is off while it coasts

Jog, local control, MOP, reverse, second ramp times, preset frequencies and DC braking are refused as illegal values.
"""

import math
from dataclasses import dataclass
from types import MappingProxyType

from rotorrig.rig import Clock, ConfigError
from rotorrig.rig.config import ModbusRtu, ModbusTcp
from rotorrig.sims.wire.drive import Drive, OnSilence
from rotorrig.sims.wire.plant_port import Plant

LOGIC_COMMAND, REFERENCE = 8192, 8193
LOGIC_STATUS, FAULT_CODE, COMMANDED_FREQUENCY, OUTPUT_FREQUENCY = 8448, 8449, 8450, 8451
MAXIMUM_FREQUENCY, STOP_MODE, ACCEL_TIME, DECEL_TIME = 35, 37, 39, 40
COMM_LOSS_ACTION, COMM_LOSS_TIME = 105, 106

COMMUNICATION_LOSS = 81  # fault F81


@dataclass(frozen=True, slots=True)
class _Parameter:
    default: int
    allowed: range


_PARAMETERS = MappingProxyType(
    {
        MAXIMUM_FREQUENCY: _Parameter(6000, range(0, 32001)),  # P035, 0.01 Hz
        STOP_MODE: _Parameter(0, range(0, 2)),  # P037: 0 ramp, 1 coast; a stop also clears a fault ("CF")
        ACCEL_TIME: _Parameter(2000, range(0, 60001)),  # P039, 0.01 s from 0 to P035
        DECEL_TIME: _Parameter(2000, range(0, 60001)),  # P040, 0.01 s from P035 to 0
        COMM_LOSS_ACTION: _Parameter(0, range(0, 4)),  # C105: 0 fault, 1 coast, 2 stop as P037, 3 go on
        COMM_LOSS_TIME: _Parameter(50, range(1, 601)),  # C106, 0.1 s
    }
)

# logic command, page 171
_STOP, _START, _CLEAR_FAULTS = 1 << 0, 1 << 1, 1 << 3
_FIELDS = (  # (lowest bit, width, values that are understood)
    (2, 1, {0}),  # jog
    (4, 2, {0b00, 0b01, 0b11}),  # direction: no command, forward, no command
    (6, 2, {0}),  # local control, MOP increment
    (8, 2, {0b00, 0b01}),  # acceleration time 1
    (10, 2, {0b00, 0b01}),  # deceleration time 1
    (12, 3, {0b000, 0b001, 0b011}),  # frequency source: as P038, or the network
    (15, 1, {0}),  # MOP decrement
)


_ON_SILENCE = (OnSilence.TRIP, OnSilence.COAST, OnSilence.RAMP, OnSilence.GO_ON)  # C105; 2 stops as P037 says


class PowerFlex400:
    """The drive's registers, to `read` and `write`; `drive` is the drive behind them."""

    functions = frozenset({3, 6, 16})  # Appendix E, page 170

    def __init__(self, plant: Plant, *, rpm_per_hz: float, max_frequency: float, clock: Clock) -> None:
        """Set up for a rotor that turns `rpm_per_hz`; `max_frequency` [Hz] is P035 as commissioned.

        Raises ConfigError if the drive cannot be set to `max_frequency`.
        """
        if round(100 * max_frequency) not in _PARAMETERS[MAXIMUM_FREQUENCY].allowed:
            raise ConfigError(
                f"motor.max_speed: takes {max_frequency:g} Hz at {rpm_per_hz:g} rpm per Hz, "
                "want at most the 320 Hz of a PowerFlex 400"
            )
        self._speed_per_count = rpm_per_hz * math.pi / 30.0 / 100  # rad/s per 0.01 Hz
        self._registers = {number: p.default for number, p in _PARAMETERS.items()} | {LOGIC_COMMAND: 0, REFERENCE: 0}
        self._registers[MAXIMUM_FREQUENCY] = round(100 * max_frequency)
        self.drive = Drive(plant, clock=clock, silence_fault=COMMUNICATION_LOSS)
        self._set_up()

    def read(self, address: int, count: int) -> list[int]:
        """Return `count` registers from `address`. Raises KeyError for one the drive does not have."""
        self.drive.hear()
        self.drive.tick()
        measured = {
            LOGIC_STATUS: self._status(),
            FAULT_CODE: self.drive.fault,
            COMMANDED_FREQUENCY: self._reference(),
            OUTPUT_FREQUENCY: round(self.drive.speed / self._speed_per_count),
        }
        known = self._registers | measured
        return [known[a] for a in range(address, address + count)]

    def write(self, address: int, values: list[int]) -> None:
        """Write consecutive registers, all or none.

        Raises KeyError for a register that is unknown or read-only, ValueError for a value out of range.
        """
        self.drive.hear()
        writes = dict(enumerate(values, start=address))
        for number, value in writes.items():
            self._check(number, value, ceiling=writes.get(MAXIMUM_FREQUENCY, self._registers[MAXIMUM_FREQUENCY]))
        self._registers |= writes
        self._set_up()
        if LOGIC_COMMAND in writes:
            self._obey(writes[LOGIC_COMMAND])

    def _check(self, number: int, value: int, *, ceiling: int) -> None:
        if number == REFERENCE:
            allowed = range(0, ceiling + 1)
        elif number == LOGIC_COMMAND:
            if any((value >> low) & ((1 << width) - 1) not in known for low, width, known in _FIELDS):
                raise ValueError(f"logic command {value:#06x} asks for what this drive is not set up for")
            return
        else:
            allowed = _PARAMETERS[number].allowed
        if value not in allowed:
            raise ValueError(f"register {number}: got {value}, want {allowed.start} to {allowed.stop - 1}")

    def _set_up(self) -> None:
        """Hand the parameters on: a new reference or ramp time counts at once."""
        fastest = max(self._registers[MAXIMUM_FREQUENCY], 1) * self._speed_per_count
        # a time of zero is the shortest the drive can set, 0.01 s
        rising, falling = (fastest / max(self._registers[time] / 100, 0.01) for time in (ACCEL_TIME, DECEL_TIME))
        self.drive.set_reference(self._reference() * self._speed_per_count, rising=rising, falling=falling)
        self.drive.patience = self._registers[COMM_LOSS_TIME] / 10
        self.drive.on_silence = _ON_SILENCE[self._registers[COMM_LOSS_ACTION]]
        if self.drive.on_silence is OnSilence.RAMP and self._registers[STOP_MODE] == 1:
            self.drive.on_silence = OnSilence.COAST

    def _obey(self, command: int) -> None:
        """Act on a logic command; a stop outranks a start, and either mode of stop clears a fault (P037, "CF")."""
        if command & (_CLEAR_FAULTS | _STOP):
            self.drive.fault = 0
        if command & _STOP:
            self.drive.stop(coast=self._registers[STOP_MODE] == 1)
        elif command & _START:
            self.drive.start()

    def _reference(self) -> int:
        return min(self._registers[REFERENCE], self._registers[MAXIMUM_FREQUENCY])

    def _status(self) -> int:
        """Return the logic status word, page 172; forward and controlled by the network whatever happens."""
        drive = self.drive
        bits = {
            0: not drive.fault,  # ready
            1: drive.active,
            2: True,  # commanded forward
            3: True,  # rotating forward
            4: drive.remaining > 0,  # accelerating
            5: drive.remaining < 0,  # decelerating
            7: drive.fault != 0,
            8: drive.running and drive.remaining == 0,  # at reference
            9: True,  # reference from the network
            10: True,  # commands from the network
        }
        return sum(1 << bit for bit, on in bits.items() if on)


def commission(table: ModbusRtu | ModbusTcp, plant: Plant, *, max_frequency: float, clock: Clock) -> PowerFlex400:
    """Return the drive as commissioned for `table`, see `inverters`."""
    return PowerFlex400(plant, rpm_per_hz=table.rpm_per_hz, max_frequency=max_frequency, clock=clock)
