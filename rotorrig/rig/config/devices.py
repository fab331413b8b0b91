"""The devices of a rig as a config names them: keyphasor, motor controller, DAQ, and the limits of the interlock.

`driver` chooses the table: each kind of controller and of DAQ has one of its own, with what its link needs to be told.
"""

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, TypeAdapter, field_validator, model_validator

from rotorrig.rig.config.drive_profiles import load_profile, profile_names
from rotorrig.rig.config.nameplate import (
    MOST_CHANNELS,
    Length,
    Name,
    Part,
    RampRate,
    Rate,
    Speed,
    Text,
    Time,
    Voltage,
    check_size,
    is_none,
)
from rotorrig.rig.config.units import RPM, reads

MOST_RPM = 60_000.0  # of the shaft per Hz, or per unit of a drive's velocity: a gear of a thousand on two poles
MOST_BAUD = 100_000_000
_LARGEST_TARGET = 32767  # 6042h is an INTEGER16
_SLCAN_BITRATES = (10_000, 20_000, 50_000, 100_000, 125_000, 250_000, 500_000, 750_000, 1_000_000)

SAME_RAMP = 0.01  # relative: a ramp set by hand need not agree better with the one asked for

if TYPE_CHECKING:
    ModbusProfile = str
else:  # pydantic refuses another name and lists these
    ModbusProfile = Literal[profile_names()]


class Keyphasor(Part):
    """The once-per-turn pulse; shaft angle is zero at the chosen edge."""

    channel: int = Field(ge=0, lt=MOST_CHANNELS)  # input of the DAQ, from 0
    edge: Literal["falling", "rising"] = "falling"  # the one made by the leading side of the mark
    pulses_per_revolution: int = Field(1, ge=1, le=1024)  # if several, angle zero is the pulse after the widest spacing
    threshold: Voltage | None = None  # default: midway between the levels in the data
    #: width of the band about the threshold that a pulse must leave on both sides; default: from the levels
    hysteresis: Annotated[Voltage, Field(gt=0)] | None = Field(None, exclude_if=is_none)


class _Controller(Part):
    """Settings of every motor controller."""

    max_speed: Speed  # of the shaft
    watchdog: Time = 2.0  # silence after which the drive stops by itself, if it has a watchdog
    #: without a processed sample, after which the guardian stops the rotor; left out: 0.5 s
    guardian: Annotated[Time, Field(ge=0.1, le=60.0)] | None = Field(None, exclude_if=is_none)


class _Inverter(_Controller):
    """A variable-frequency drive."""

    profile: ModbusProfile = "powerflex400"  # drive family
    # shaft speed over output frequency: 60 / pole pairs, times the gear
    rpm_per_hz: float = Field(60.0, gt=0, le=MOST_RPM)
    # silence after which the drive stops by itself, if it has a watchdog; long enough to repeat a lost request,
    # within the range of every drive family
    watchdog: Annotated[Time, Field(ge=0.5, le=60.0)] = 2.0
    ramp: RampRate | None = None  # as set at the drive, for a profile whose ramp cannot be set remotely

    @model_validator(mode="after")
    def _knows_its_ramp(self) -> Self:
        if load_profile(self.profile).ramp_by_hand != (self.ramp is not None):
            if self.ramp is None:
                raise ValueError(f"ramp is missing, want the one that is set at the {self.profile} by hand")
            raise ValueError(f"ramp is given, want none: a {self.profile} is told its ramp")
        return self

    @model_validator(mode="after")
    def _check_frequency(self) -> Self:
        hertz, highest = self.max_speed * RPM / self.rpm_per_hz, load_profile(self.profile).highest_frequency
        if hertz > highest:
            raise ValueError(
                f"max_speed is {hertz:.4g} Hz at {self.rpm_per_hz:g} rpm per Hz, want at most {highest:g} Hz, the "
                f"highest output frequency of a {self.profile}"
            )
        return self

    @property
    def keeps_ramp(self) -> bool:
        """True if it keeps the ramp it has while it turns, so that a plan can have but one."""
        return load_profile(self.profile).keeps_ramp


class ModbusRtu(_Inverter):
    """A drive on a serial line."""

    driver: Literal["modbus-rtu"]  # chooses this table
    port: Name  # "/dev/ttyUSB0"; better, "/dev/serial/by-id/..."
    baudrate: int = Field(19200, ge=1200, le=MOST_BAUD)  # as set at the drive; 8 data bits, no parity
    address: int = Field(100, ge=1, le=247)  # of the drive on the line


class ModbusTcp(_Inverter):
    """A drive behind an Ethernet port."""

    driver: Literal["modbus-tcp"]  # chooses this table
    host: Name  # name or address: "192.168.1.10"
    tcp_port: int = Field(502, ge=1, le=65535)  # of the drive
    address: int = Field(1, ge=0, le=255)  # unit identifier; many drives ignore it


# s; a shorter one would act when a reply is lost and asked for again, a longer one does not fit CANopen's 16 bits of ms
SentWatchdog = Annotated[float, reads("time"), Field(ge=0.5, le=65.0)]


class LineController(_Controller):
    """A home-built controller that speaks the line protocol of docs/motor-line.md."""

    driver: Literal["serial-line"]  # chooses this table
    port: Name  # "/dev/ttyACM0"; better, "/dev/serial/by-id/..."
    baudrate: int = Field(115200, ge=1200, le=MOST_BAUD)  # as set at the controller
    watchdog: SentWatchdog = 2.0


class CanOpen(_Controller):
    """A CiA 402 drive in velocity mode."""

    driver: Literal["canopen"]  # chooses this table
    interface: Name = "socketcan"  # any of python-can: socketcan, slcan, pcan, kvaser, ...
    channel: Name  # "can0", or the adapter's serial port
    bitrate: int = Field(500_000, ge=10_000, le=8_000_000)  # of the bus
    node: int = Field(1, ge=1, le=127)  # of the drive
    # shaft speed per unit of the drive's velocity (vl), gear included
    rpm_per_unit: float = Field(1.0, gt=0, le=MOST_RPM)
    watchdog: SentWatchdog = 2.0

    @model_validator(mode="after")
    def _can_be_said(self) -> Self:
        units = self.max_speed * RPM / self.rpm_per_unit
        if units > _LARGEST_TARGET:
            raise ValueError(
                f"max_speed is {units:.0f} units of {self.rpm_per_unit:g} rpm, want at most {_LARGEST_TARGET}, "
                "the largest target of a CiA 402 drive"
            )
        if self.interface == "slcan" and self.bitrate not in _SLCAN_BITRATES:
            raise ValueError(f"bitrate {self.bitrate}, want one of slcan's, {', '.join(map(str, _SLCAN_BITRATES))}")
        return self


Motor = Annotated[ModbusRtu | ModbusTcp | LineController | CanOpen, Discriminator("driver")]
_MOTOR: TypeAdapter[Motor] = TypeAdapter(Motor)


def read_motor(values: Mapping[str, Any]) -> Motor:
    """Return the [motor] table of plain values in SI units, as `model_dump` gives them."""
    return _MOTOR.validate_python(dict(values), context={"si": True})


class StreamDaq(Part):
    """A board that speaks the framed serial stream of docs/daq-stream.md."""

    driver: Literal["stream"]  # chooses this table
    port: Name  # "/dev/ttyACM0"; better, "/dev/serial/by-id/..."
    baudrate: int = Field(115200, ge=1200, le=MOST_BAUD)  # of a UART; ignored by USB
    sample_rate: Rate  # of the board; any other is refused


Setting = bool | Annotated[int, AfterValidator(check_size)] | float | Text


class OpenDaq(Part):
    """A device of the openDAQ SDK; its channels are numbered in the order it lists them."""

    driver: Literal["opendaq"]  # chooses this table
    connection: Text  # "daqref://device0", "daq.nd://192.168.1.5"
    sample_rate: Rate  # requested; the device must confirm it
    device_settings: dict[Name, Setting] = Field(
        default_factory=dict
    )  # properties of the device, by the names it gives them
    channel_settings: dict[Name, Setting] = Field(default_factory=dict)  # properties of every channel: range, coupling

    @field_validator("connection")
    @classmethod
    def _names_a_protocol(cls, connection: str) -> str:
        protocol, _, place = connection.partition("://")
        if not protocol or not place:
            raise ValueError(f"got '{connection}', want a connection string such as daq.nd://192.168.1.5")
        return connection


class NiDaqmx(Part):
    """An analog input device of National Instruments, through its own driver; channel n is input ai<n>."""

    driver: Literal["nidaqmx"]  # chooses this table
    device: Name  # "Dev1", "cDAQ1Mod1"
    sample_rate: Rate  # a rate that the device's clock can produce
    terminals: Literal["default", "rse", "nrse", "diff", "pseudo-diff"] = "default"  # how the inputs are wired
    low: Voltage = -24.0  # lower end of the requested range; an eddy-current probe's output is negative
    high: Voltage = 24.0  # upper end of that range

    @field_validator("device")
    @classmethod
    def _is_a_device(cls, device: str) -> str:
        if not device or "/" in device:
            raise ValueError(
                f"got '{device}', want the device alone, such as Dev1: its inputs follow from the channels"
            )
        return device

    @model_validator(mode="after")
    def _rises(self) -> Self:
        if not self.low < self.high:
            raise ValueError(f"got low {self.low:g} V and high {self.high:g} V, want low < high")
        return self


Daq = Annotated[StreamDaq | OpenDaq | NiDaqmx, Discriminator("driver")]


class CriticalBand(Part):
    """Speed range around a critical speed, with its own vibration limits and no dwells."""

    low: Speed  # lower end
    high: Speed  # upper end
    vibration: Length  # 0-peak about the mean, any probe; replaces the limit outside
    probes: dict[str, Length] = Field(default_factory=dict)  # the same for one probe

    @model_validator(mode="after")
    def _rises(self) -> Self:
        if not self.low < self.high:
            raise ValueError("want low < high")
        return self


class PowerCut(Part):
    """What cuts the drive's power when nothing else stops the rotor: a program that switches a relay, say."""

    command: tuple[str, ...] = Field(min_length=1)  # the program and its arguments; no shell
    timeout: Time = 5.0  # for it to end


def read_power_cut(values: Mapping[str, Any]) -> PowerCut:
    """Return the [power_cut] table of plain values in SI units, as `model_dump` gives them."""
    return PowerCut.model_validate(dict(values), context={"si": True})


class Limits(Part):
    """Interlocks, any of which stops the rotor; and how critical speeds are passed."""

    overspeed: Speed  # by the keyphasor or the drive; not above motor.max_speed
    vibration: Length  # 0-peak about the mean, any probe
    probes: dict[str, Length] = Field(default_factory=dict)  # the same for one probe
    critical_bands: tuple[CriticalBand, ...] = ()  # speed ranges with higher limits
    critical_ramp: RampRate | None = None  # least rate at which ramps pass critical speeds; default: the plan's own
    run_down: Time = 180.0  # longest time to monitor and record the rotor after a stop, until it is at rest

    @model_validator(mode="after")
    def _bands_are_apart(self) -> Self:
        for below, above in pairwise(sorted(self.critical_bands, key=lambda band: band.low)):
            if above.low < below.high:
                raise ValueError(f"critical_bands: two overlap at {above.low * RPM:.0f} rpm, want them apart")
        return self

    def named_probes(self) -> Iterator[tuple[str, str]]:
        """Yield each table that gives probes a limit of their own, with the probe's name."""
        yield from (("limits.probes", name) for name in self.probes)
        for i, band in enumerate(self.critical_bands):
            yield from ((f"limits.critical_bands[{i}].probes", name) for name in band.probes)
