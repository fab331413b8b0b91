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
from enum import Enum, auto
from types import MappingProxyType

from rotorrig.rig.clock import Clock
from rotorrig.rig.errors import ConfigError
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


class _Mode(Enum):
    STOPPED = auto()  # output off: at rest or coasting
    RUNNING = auto()
    STOPPING = auto()  # down the ramp


@dataclass(frozen=True, slots=True, kw_only=True)
class _Ramp:
    """The ramp generator between two commands."""

    start: float  # s, simulated time
    begin: float  # Hz
    target: float  # Hz
    slope: float  # Hz/s, > 0

    def at(self, t: float) -> float:
        gone = self.slope * (t - self.start)
        way = self.target - self.begin
        return self.target if abs(way) <= gone else self.begin + math.copysign(gone, way)


class PowerFlex400:
    """The drive: `read` and `write` are its registers, `tick` lets it notice that time has passed."""

    def __init__(self, plant: Plant, *, rpm_per_hz: float, max_frequency: float, clock: Clock) -> None:
        """Set up for a rotor that turns `rpm_per_hz`; `max_frequency` [Hz] is P035 as commissioned.

        Raises ConfigError if the drive cannot be set to `max_frequency`.
        """
        if round(100 * max_frequency) not in _PARAMETERS[MAXIMUM_FREQUENCY].allowed:
            raise ConfigError(
                f"motor.max_speed: takes {max_frequency:g} Hz at {rpm_per_hz:g} rpm per Hz, "
                "want at most the 320 Hz of a PowerFlex 400"
            )
        self._plant, self._clock = plant, clock
        self._speed_per_hz = rpm_per_hz * math.pi / 30.0  # rad/s per Hz
        self._registers = {number: p.default for number, p in _PARAMETERS.items()} | {LOGIC_COMMAND: 0, REFERENCE: 0}
        self._registers[MAXIMUM_FREQUENCY] = round(100 * max_frequency)
        self._mode = _Mode.STOPPED
        self._fault = 0
        self._ramp = _Ramp(start=0.0, begin=0.0, target=0.0, slope=1.0)
        self._heard = clock.now()

    @property
    def active(self) -> bool:
        """Whether the output is on."""
        return self._mode is not _Mode.STOPPED

    def read(self, address: int, count: int) -> list[int]:
        """Return `count` registers from `address`. Raises KeyError for one the drive does not have."""
        self._heard = self._clock.now()
        self.tick()
        measured = {
            LOGIC_STATUS: self._status(),
            FAULT_CODE: self._fault,
            COMMANDED_FREQUENCY: round(100 * self._reference()),
            OUTPUT_FREQUENCY: round(100 * self._frequency()),
        }
        known = self._registers | measured
        return [known[a] for a in range(address, address + count)]

    def write(self, address: int, values: list[int]) -> None:
        """Write consecutive registers, all or none.

        Raises KeyError for a register that is unknown or read-only, ValueError for a value out of range.
        """
        self._heard = self._clock.now()
        writes = dict(enumerate(values, start=address))
        for number, value in writes.items():
            self._check(number, value, ceiling=writes.get(MAXIMUM_FREQUENCY, self._registers[MAXIMUM_FREQUENCY]))
        self._registers |= writes
        if LOGIC_COMMAND in writes:
            self._obey(writes[LOGIC_COMMAND])
        if self._mode is not _Mode.STOPPED and writes.keys() - {LOGIC_COMMAND}:
            self._drive()  # a new reference or ramp time counts at once

    def tick(self) -> None:
        """End a finished ramp-down; act on a link that has been silent for too long."""
        if self._mode is _Mode.STOPPING and self._frequency() == 0.0:
            self._switch_off()
        silence = self._clock.now() - self._heard
        if self._mode is _Mode.RUNNING and silence > self._registers[COMM_LOSS_TIME] / 10:
            self._lose_link()

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

    def _obey(self, command: int) -> None:
        """Act on a logic command; a stop outranks a start, and either mode of stop clears a fault (P037, "CF")."""
        if command & (_CLEAR_FAULTS | _STOP):
            self._fault = 0
        if command & _STOP:
            self._stop()
        elif command & _START and not self._fault:
            self._start()

    def _start(self) -> None:
        if self._mode is _Mode.RUNNING:
            return
        begin = self._plant.speed / self._speed_per_hz if self._mode is _Mode.STOPPED else self._frequency()
        self._mode = _Mode.RUNNING
        self._drive(begin)

    def _stop(self) -> None:
        if self._mode is _Mode.STOPPED:
            return
        if self._registers[STOP_MODE] == 1:
            self._switch_off()
        else:
            self._mode = _Mode.STOPPING
            self._drive()

    def _lose_link(self) -> None:
        match self._registers[COMM_LOSS_ACTION]:
            case 0:
                self._fault = COMMUNICATION_LOSS
                self._switch_off()
            case 1:
                self._switch_off()
            case 2:
                self._stop()

    def _switch_off(self) -> None:
        self._mode = _Mode.STOPPED
        self._plant.command(0.0, self._ramp.slope * self._speed_per_hz, False)

    def _drive(self, begin: float | None = None) -> None:
        """Head for the reference, or for zero when stopping, from frequency `begin` [Hz] or the present one."""
        begin = self._frequency() if begin is None else begin
        target = self._reference() if self._mode is _Mode.RUNNING else 0.0
        time = self._registers[ACCEL_TIME if target > begin else DECEL_TIME] / 100
        # a time of zero is the shortest the drive can set, 0.01 s
        slope = max(self._registers[MAXIMUM_FREQUENCY], 1) / 100 / max(time, 0.01)
        self._ramp = _Ramp(start=self._plant.t, begin=begin, target=target, slope=slope)
        self._plant.command(target * self._speed_per_hz, slope * self._speed_per_hz, True)

    def _reference(self) -> float:
        return min(self._registers[REFERENCE], self._registers[MAXIMUM_FREQUENCY]) / 100

    def _frequency(self) -> float:
        return 0.0 if self._mode is _Mode.STOPPED else self._ramp.at(self._plant.t)

    def _status(self) -> int:
        """Return the logic status word, page 172; forward and controlled by the network whatever happens."""
        way = self._ramp.target - self._frequency() if self.active else 0.0
        bits = {
            0: not self._fault,  # ready
            1: self.active,
            2: True,  # commanded forward
            3: True,  # rotating forward
            4: way > 0,  # accelerating
            5: way < 0,  # decelerating
            7: self._fault != 0,
            8: self._mode is _Mode.RUNNING and way == 0,  # at reference
            9: True,  # reference from the network
            10: True,  # commands from the network
        }
        return sum(1 << bit for bit, on in bits.items() if on)
