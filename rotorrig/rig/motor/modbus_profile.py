"""Register map of a family of Modbus drives: a `Profile`, one file each in `profiles/`.

Registers are addresses as on the wire, in the protocol's data unit: a manual's "40001" is 0 there. What a family lacks,
or what no manual at hand documents, is None; the driver then does without it and says so when it is opened.
"""

from dataclasses import dataclass, field

from rotorrig.rig.motor.base import Stop


@dataclass(frozen=True, slots=True, kw_only=True)
class StopWords:
    """Stop words of the command register; None: there is none, the ramp's is sent."""

    ramp: int
    coast: int | None = None
    fast: int | None = None

    def of(self, kind: Stop) -> int:
        """Return the word for one kind of stop."""
        word = {Stop.RAMP: self.ramp, Stop.COAST: self.coast, Stop.EMERGENCY: self.fast}[kind]
        return self.ramp if word is None else word


@dataclass(frozen=True, slots=True, kw_only=True)
class Frequency:
    """A parameter that holds a frequency."""

    register: int
    step: float  # Hz per count
    range: tuple[float, float]  # Hz, what the manual allows


@dataclass(frozen=True, slots=True, kw_only=True)
class Span:
    """A reference counted from one frequency to another: `counts` of it are `high`."""

    counts: int
    high: Frequency
    low: Frequency | None = None  # where 0 counts are; None: 0 Hz


@dataclass(frozen=True, slots=True, kw_only=True)
class Ramps:
    """Acceleration and deceleration time, from 0 to the maximum frequency and back: neighbouring registers."""

    accel_time: int  # the deceleration time is the next
    step: float  # s per count
    range: tuple[float, float]  # s
    only_at_rest: bool = False  # a running drive refuses another

    @property
    def decel_time(self) -> int:
        """Register of the deceleration time."""
        return self.accel_time + 1


@dataclass(frozen=True, slots=True, kw_only=True)
class StopMode:
    """Parameter that chooses between ramp and coasting for the one stop command."""

    register: int
    ramp: int  # its values
    coast: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """Parameter the driver needs at a certain value; written if it differs."""

    register: int
    word: int
    what: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Watchdog:
    """Parameter of the communication time-out; what the drive does then is a `Setting`, or fixed."""

    register: int
    step: float  # s per count
    range: tuple[float, float]  # s


@dataclass(frozen=True, slots=True, kw_only=True)
class RunField:
    """Bits of the status that tell together whether it runs, where none of them is a flag."""

    mask: int
    running: tuple[int, ...]  # values under the mask; any other: it is off
    stopping: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """The register map of one family of drives."""

    model: str
    hint: str  # what to check if it takes commands and does nothing

    command: int  # register written to start and stop
    start: tuple[int, ...]  # its words from rest, forward; a drive that runs is sent the last
    start_pause: float = 0.0  # s between them
    stop: StopWords
    clear_fault: tuple[int, ...] = ()  # words; none: it is cleared at the drive

    state: range  # registers of the one read that tells the state
    status: int  # among them, or read after them; and the bits of its word, 0: there is none
    run_field: RunField | None = None  # in place of `running` and `decelerating`
    running: int = 0
    accelerating: int = 0
    decelerating: int = 0
    faulted: int = 0
    at_reference: int = 0  # 0: it is there when its output is its setpoint, counted alike
    forward: int = 0  # it turns forward; clear while it turns: backward
    backward: int = 0
    output_frequency: int  # among them, signed
    output_step: float  # Hz per count
    direction: int | None = None  # among them, a signed value whose sign tells the sense where the frequency has none
    setpoint: int | None  # among them, counted as the reference; None: what was last written

    fault: int  # register of the fault's number, 0 for none
    fault_mask: int = 0xFFFF  # the number's bits
    fault_letter: str = "F"
    faults: dict[int, str] = field(default_factory=dict)

    reference: int  # register of the wanted speed
    reference_scale: float | Span  # Hz per count, or a span
    max_frequency: Frequency | None = None
    ramps: Ramps | None = None
    stop_mode: StopMode | None = None
    emergency_time: float | None = None  # s from the maximum frequency to 0 after an emergency stop, by `ramps`
    settings: tuple[Setting, ...] = ()
    watchdog: Watchdog | None = None

    @property
    def state_registers(self) -> tuple[int, ...]:
        """Registers that tell the state, in the order in which they are read."""
        return (*self.state, *(() if self.status in self.state else (self.status,)))

    @property
    def highest_frequency(self) -> float:
        """Highest output frequency [Hz] that the family has, or that its signed register holds."""
        held = 0x7FFF * self.output_step
        return min(held, self.max_frequency.range[1]) if self.max_frequency else held

    @property
    def ramp_by_hand(self) -> bool:
        """True if its ramp is set at the drive and cannot be written over Modbus."""
        return self.ramps is None

    @property
    def keeps_ramp(self) -> bool:
        """True if it keeps the ramp it has while it turns."""
        return self.ramps is None or self.ramps.only_at_rest
