"""A CiA 402 drive in velocity mode (vl): its object dictionary and state machine in front of the emulated drive.

CiA 402-2 V3.0 (IEC 61800-7-201), numbers in comments being its transitions; command coding and statusword as printed in
Toshiba E6581911, pages 30 to 32. The consumer heartbeat and emergencies are CiA 301. Emulated is what a rig needs: one
direction, mode 2, quick stop option codes 0, 1, 2, 5 and 6, shutdown and disable operation options 0 and 1, abort
connection options 0 to 3. Speeds are in units of `rpm_per_unit` of the shaft. As IEC 61800-7-201 has it, enabling
(transition 4) clears the target.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from rotorrig.rig import Clock
from rotorrig.sims.wire.drive import Drive
from rotorrig.sims.wire.plant_port import Plant

MODEL = "CiA 402 bench inverter"
HEARTBEAT_LOST = 0x8130  # error code, CiA 301
GENERIC, COMMUNICATION = 0x01, 0x10  # bits of the error register 1001h

READ_ONLY, OUT_OF_RANGE, TOO_HIGH, TOO_LOW = 0x06010002, 0x06090030, 0x06090031, 0x06090032  # SDO abort codes


class Refused(Exception):
    """A write the drive does not take; `code` is the SDO abort code."""

    def __init__(self, code: int) -> None:
        super().__init__(f"0x{code:08X}")
        self.code = code


@dataclass(frozen=True, slots=True)
class Entry:
    """An object: its name and type as CiA 402 gives them, and what may be written to it."""

    name: str
    kind: str  # "u8", "u16", "u32", "i8", "i16", "text"
    default: int | str = 0
    allowed: range | tuple[int, ...] | None = None  # rising; None: read-only


_U16, _U32 = range(1 << 16), range(1 << 32)
_SLOPE = (("delta speed", "u32", range(1, 1 << 32)), ("delta time", "u16", range(1, 1 << 16)))

DICTIONARY: dict[tuple[int, int], Entry] = {
    (0x1000, 0): Entry("device type", "u32", 0x0001_0192),  # frequency converter, profile 402
    (0x1001, 0): Entry("error register", "u8"),
    (0x1008, 0): Entry("manufacturer device name", "text", MODEL),
    (0x1016, 0): Entry("consumer heartbeat time: entries", "u8", 1),
    (0x1016, 1): Entry("consumer heartbeat time 1", "u32", 0, _U32),  # node << 16 | ms
    (0x1017, 0): Entry("producer heartbeat time", "u16"),
    (0x1018, 0): Entry("identity: entries", "u8", 1),
    (0x1018, 1): Entry("vendor-ID", "u32"),
    (0x6007, 0): Entry("abort connection option code", "i16", 1, range(4)),
    (0x603F, 0): Entry("error code", "u16"),
    (0x6040, 0): Entry("controlword", "u16", 0, _U16),
    (0x6041, 0): Entry("statusword", "u16"),
    (0x6042, 0): Entry("vl target velocity", "i16", 0, range(1 << 15)),  # forward only
    (0x6043, 0): Entry("vl velocity demand", "i16"),
    (0x6044, 0): Entry("vl velocity actual value", "i16"),
    (0x6046, 0): Entry("vl velocity min max amount: entries", "u8", 2),
    (0x6046, 1): Entry("vl velocity min amount", "u32", 0, _U32),
    (0x6046, 2): Entry("vl velocity max amount", "u32", 0, _U32),
    **{
        (index, sub): Entry(f"vl velocity {what} {name}", kind, 1, allowed)
        for index, what in ((0x6048, "acceleration"), (0x6049, "deceleration"), (0x604A, "quick stop"))
        for sub, (name, kind, allowed) in enumerate(_SLOPE, start=1)
    },
    **{(index, 0): Entry("entries", "u8", 2) for index in (0x6048, 0x6049, 0x604A)},
    (0x605A, 0): Entry("quick stop option code", "i16", 2, (0, 1, 2, 5, 6)),
    (0x605B, 0): Entry("shutdown option code", "i16", 0, range(2)),
    (0x605C, 0): Entry("disable operation option code", "i16", 1, range(2)),
    (0x6060, 0): Entry("modes of operation", "i8", 0, (0, 2)),
    (0x6061, 0): Entry("modes of operation display", "i8"),
    (0x6502, 0): Entry("supported drive modes", "u32", 1 << 1),  # vl
}


class State(Enum):
    """The states of the power drive system, by their bits in the statusword."""

    SWITCH_ON_DISABLED = 0x40
    READY_TO_SWITCH_ON = 0x21
    SWITCHED_ON = 0x23
    OPERATION_ENABLED = 0x27
    QUICK_STOP_ACTIVE = 0x07
    FAULT = 0x08


_SWITCH_ON, _ENABLE_VOLTAGE, _NO_QUICK_STOP, _ENABLE_OPERATION = 1 << 0, 1 << 1, 1 << 2, 1 << 3  # controlword
_RAMP_BITS = 0b111 << 4  # ramp generator enabled, unlocked, and following the target
_FAULT_RESET, _HALT = 1 << 7, 1 << 8
_VOLTAGE_ENABLED, _REMOTE, _TARGET_REACHED, _INTERNAL_LIMIT = 1 << 4, 1 << 9, 1 << 10, 1 << 11  # statusword
_LEADS_TO = {0x605B: State.READY_TO_SWITCH_ON, 0x605C: State.SWITCHED_ON}  # by the option code that rules it
_AT_ONCE = {  # without an option code
    (State.SWITCH_ON_DISABLED, State.READY_TO_SWITCH_ON),  # 2
    (State.READY_TO_SWITCH_ON, State.SWITCHED_ON),  # 3
    (State.SWITCHED_ON, State.READY_TO_SWITCH_ON),  # 6
}


class Cia402:
    """The drive's objects, to `read` and `write`; `drive` is what stands behind them.

    `emergency(code, register)` is called for each error and, with 0, when all are gone. `master_lost` while the
    heartbeat it has been told to listen for stays away.
    """

    def __init__(self, plant: Plant, *, max_speed: float, rpm_per_unit: float, clock: Clock) -> None:
        """Stand still in front of `plant`, commissioned for `max_speed` [rad/s], lost or gained in 10 s or 1 s."""
        self.emergency: Callable[[int, int], None] = lambda code, register: None
        self.master_lost = False
        self.drive = Drive(plant, clock=clock, silence_fault=HEARTBEAT_LOST)
        self.drive.patience = math.inf  # the heartbeat is watched here: what follows is for 6007h to say
        self._clock = clock
        self._unit = rpm_per_unit * math.pi / 30.0  # rad/s
        self._state = State.SWITCH_ON_DISABLED
        self._after_ramp: State | None = None  # where a shutdown or disable operation under way leads
        self._heard: float | None = None  # the master's last heartbeat
        self._values = {place: entry.default for place, entry in DICTIONARY.items()}
        fastest = round(max_speed / self._unit)
        self._values |= {(0x6046, 2): fastest, (0x6048, 1): fastest, (0x6049, 1): fastest, (0x604A, 1): fastest}
        self._values |= {(0x6048, 2): 10, (0x6049, 2): 10}
        self._fastest = fastest

    def read(self, index: int, subindex: int) -> int | str:
        """Return an object's value. Raises KeyError for one the drive does not have."""
        self.tick()
        match index:
            case 0x1001:
                return GENERIC * bool(self.drive.fault) | (GENERIC | COMMUNICATION) * self.master_lost
            case 0x603F:
                return self.drive.fault & 0xFFFF
            case 0x6041:
                return self._statusword()
            case 0x6043 | 0x6044:  # no encoder: the ramp generator's
                return round(self.drive.speed / self._unit)
            case 0x6061:
                return self._values[0x6060, 0]
        return self._values[index, subindex]

    def write(self, index: int, subindex: int, value: int) -> None:
        """Write an object. Raises KeyError for one the drive does not have, Refused for a value it does not take."""
        allowed = DICTIONARY[index, subindex].allowed
        if allowed is None:
            raise Refused(READ_ONLY)
        if value not in allowed:
            raise Refused(TOO_HIGH if value > allowed[-1] else TOO_LOW if value < allowed[0] else OUT_OF_RANGE)
        if (index, subindex) == (0x6046, 2) and value > self._fastest:
            raise Refused(TOO_HIGH)
        self.tick()
        before, self._values[index, subindex] = self._values[index, subindex], value
        if index == 0x1016:
            self._heard = None  # watched from its first heartbeat on
        if index == 0x6040:
            assert isinstance(before, int)
            self._control(value, reset=bool(value & ~before & _FAULT_RESET))
        self._set_reference()

    def hear_heartbeat(self, node: int) -> None:
        """Take note of a heartbeat on the bus."""
        self.tick()
        if node == self._value(0x1016, 1) >> 16:
            self._heard = self._clock.now()
            if self.master_lost:
                self.master_lost = False
                self.emergency(0, 0)

    def tick(self) -> None:
        """Follow the drive: end ramps, notice a trip; act on a heartbeat that stays away."""
        self.drive.tick()
        if self.drive.fault and self._state is not State.FAULT:
            self._state, self._after_ramp = State.FAULT, None
            self.emergency(self.drive.fault & 0xFFFF, GENERIC)
        if self._after_ramp and not self.drive.active:
            self._state, self._after_ramp = self._after_ramp, None
        if self._state is State.QUICK_STOP_ACTIVE and not self.drive.active and self._value(0x605A) <= 2:
            self._state = State.SWITCH_ON_DISABLED
        time = (self._value(0x1016, 1) & 0xFFFF) / 1000
        if time and self._heard is not None and self._clock.now() - self._heard > time and not self.master_lost:
            self._lose_master()

    def _lose_master(self) -> None:
        self.master_lost = True
        self.emergency(HEARTBEAT_LOST, GENERIC | COMMUNICATION)
        match self._value(0x6007):
            case 1:
                self._state, self._after_ramp = State.FAULT, None
                self.drive.trip(HEARTBEAT_LOST)
            case 2:
                self._switch_off()
            case 3 if self._state is State.OPERATION_ENABLED:
                self._quick_stop()

    def _control(self, word: int, *, reset: bool) -> None:
        """Take a command of the controlword ; one that no transition allows changes nothing."""
        if self._state is State.FAULT:
            if reset:
                self.drive.fault, self._state = 0, State.SWITCH_ON_DISABLED  # 15
                self.emergency(0, 0)
        elif not word & _ENABLE_VOLTAGE:
            self._switch_off()  # 7, 9, 10, 12
        elif not word & _NO_QUICK_STOP:
            if self._state is State.OPERATION_ENABLED:
                self._quick_stop()  # 11
            elif self._state is not State.QUICK_STOP_ACTIVE:
                self._state = State.SWITCH_ON_DISABLED  # 7, 10
        elif not word & _SWITCH_ON:
            self._leave(0x605B)  # 2, 6, 8
        elif not word & _ENABLE_OPERATION:
            self._leave(0x605C)  # 3, 5
        else:
            self._enable()  # 3, 4, 16

    def _leave(self, option: int) -> None:
        """Shut down, or disable operation: at once, or from operation enabled as the option code says."""
        to = _LEADS_TO[option]
        if (self._state, to) in _AT_ONCE:
            self._state = to
        elif self._state is State.OPERATION_ENABLED:  # 5, 8
            self._after_ramp = to
            self.drive.stop(coast=self._value(option) == 0)
            self.tick()

    def _enable(self) -> None:
        resumes = self._after_ramp is not None or (
            self._state is State.QUICK_STOP_ACTIVE and self._value(0x605A) in (5, 6)
        )
        if self._state in (State.READY_TO_SWITCH_ON, State.SWITCHED_ON):
            self._values[0x6042, 0] = 0  # internal set-points are cleared
        elif not resumes:
            return
        self._state, self._after_ramp = State.OPERATION_ENABLED, None
        self._set_reference()
        self.drive.start()

    def _quick_stop(self) -> None:
        self._state, self._after_ramp = State.QUICK_STOP_ACTIVE, None
        self._set_reference()
        self.drive.stop(coast=self._value(0x605A) == 0)

    def _switch_off(self) -> None:
        self._after_ramp = None
        self.drive.stop(coast=True)
        if self._state is not State.FAULT:
            self._state = State.SWITCH_ON_DISABLED

    def _set_reference(self) -> None:
        """Hand target and slopes on to the drive: they count at once."""
        quick = self._state is State.QUICK_STOP_ACTIVE and self._value(0x605A) in (2, 6)
        self.drive.set_reference(
            self._target() * self._unit, rising=self._slope(0x6048), falling=self._slope(0x604A if quick else 0x6049)
        )

    def _target(self) -> int:
        """Return the target the ramp generator follows [units]."""
        word = self._value(0x6040)
        if self._value(0x6060) != 2 or word & _HALT or word & _RAMP_BITS != _RAMP_BITS:
            return 0
        target = min(self._value(0x6042), self._value(0x6046, 2))
        return max(target, self._value(0x6046, 1)) if target else 0

    def _slope(self, index: int) -> float:
        return self._value(index, 1) / self._value(index, 2) * self._unit

    def _statusword(self) -> int:
        word = self._state.value | _VOLTAGE_ENABLED | _REMOTE
        if self._state is State.OPERATION_ENABLED and self.drive.running:
            word |= _TARGET_REACHED * (self.drive.remaining == 0.0)
            word |= _INTERNAL_LIMIT * (self._value(0x6042) > self._value(0x6046, 2))
        return word

    def _value(self, index: int, subindex: int = 0) -> int:
        value = self._values[index, subindex]
        assert isinstance(value, int)
        return value
