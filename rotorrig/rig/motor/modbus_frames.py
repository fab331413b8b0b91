"""Register words of a Modbus drive to values and back: pure; which registers and bits, a `Profile` says."""

from dataclasses import asdict, dataclass

from rotorrig.rig.errors import BadFrame, ConfigError, LimitExceeded
from rotorrig.rig.units import RPM


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """The register map of one family of drives, addresses as on the wire. One file each in `profiles/`."""

    model: str
    hint: str  # what to check if it takes commands and does nothing

    command: int  # register written to start and stop
    start_forward: int  # its words
    stop: int
    clear_fault: int

    reference: int  # registers of the wanted and the actual frequency
    output_frequency: int
    frequency_step: float  # Hz per count of both, and of max_frequency

    status: int  # register, and the bits of its word
    running: int
    accelerating: int
    decelerating: int
    faulted: int
    at_reference: int

    fault: int  # register of the fault's number
    faults: dict[int, str]

    max_frequency: int  # parameters, by their register
    max_frequency_range: tuple[float, float]  # Hz, what the manual allows
    stop_mode: int
    stop_mode_ramp: int  # its values
    stop_mode_coast: int
    accel_time: int
    decel_time: int
    time_step: float  # s per count, from 0 to the maximum frequency
    time_range: tuple[float, float]  # s
    emergency_time: float  # s, the shortest the drive can follow


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveStatus:
    """The status word, its bits by name."""

    running: bool
    accelerating: bool
    decelerating: bool
    faulted: bool
    at_reference: bool

    def __str__(self) -> str:
        return ", ".join(name.replace("_", " ") for name, is_set in asdict(self).items() if is_set) or "at rest"


def decode_status(word: int, *, profile: Profile) -> DriveStatus:
    """Return the meaning of a status word. Raises BadFrame for one that contradicts itself.

    >>> from rotorrig.rig.motor.profiles.powerflex400 import PROFILE
    >>> print(decode_status(0b1_0000_1111, profile=PROFILE))
    running, at reference
    """
    if word & profile.accelerating and word & profile.decelerating:
        raise BadFrame(f"status: got 0x{word:04x}, accelerating and decelerating at once")
    return DriveStatus(
        running=bool(word & profile.running),
        accelerating=bool(word & profile.accelerating),
        decelerating=bool(word & profile.decelerating),
        faulted=bool(word & profile.faulted),
        at_reference=bool(word & profile.at_reference),
    )


def fault_text(number: int, *, profile: Profile) -> str:
    """Return a fault's name and number, "overvoltage (F5)".

    >>> from rotorrig.rig.motor.profiles.powerflex400 import PROFILE
    >>> fault_text(5, profile=PROFILE), fault_text(99, profile=PROFILE)
    ('overvoltage (F5)', 'unknown fault (F99)')
    """
    return f"{profile.faults.get(number, 'unknown fault')} (F{number})"


def decode_speed(word: int, *, profile: Profile, rpm_per_hz: float) -> float:
    """Return the shaft speed [rad/s] of a frequency word.

    >>> from rotorrig.rig.motor.profiles.powerflex400 import PROFILE
    >>> round(decode_speed(6000, profile=PROFILE, rpm_per_hz=60.0) * RPM)  # 60.00 Hz, two poles
    3600
    """
    return word * profile.frequency_step * radians_per_hz(rpm_per_hz)


def encode_speed(speed: float, *, profile: Profile, rpm_per_hz: float, fastest: float) -> int:
    """Return the frequency word nearest to `speed` [rad/s]. Raises LimitExceeded above `fastest` [rad/s] or below 0."""
    if not 0 <= speed <= fastest:
        raise LimitExceeded(
            f"speed: asked for {speed * RPM:.0f} rpm, want 0 to {fastest * RPM:.0f} rpm, "
            "the least of motor.max_speed in the config and the drive's maximum frequency"
        )
    return round(speed / radians_per_hz(rpm_per_hz) / profile.frequency_step)


def encode_ramp(ramp: float, *, profile: Profile, rpm_per_hz: float, max_frequency: float) -> int:
    """Return the acceleration time word of `ramp` [rad/s^2]: the time from 0 to `max_frequency` [Hz].

    Raises ConfigError if the drive cannot be set to it.
    """
    if not ramp > 0:
        raise ConfigError(f"ramp: got {ramp:g} rad/s^2, want more than 0")
    seconds = max_frequency * radians_per_hz(rpm_per_hz) / ramp
    shortest, longest = profile.time_range
    if not shortest <= seconds <= longest:
        slowest, fastest = (ramp * RPM * seconds / t for t in (longest, shortest))
        raise ConfigError(
            f"ramp: got {ramp * RPM:.4g} rpm/s, which takes {seconds:.4g} s from 0 to the drive's "
            f"{max_frequency:g} Hz, want {slowest:.4g} to {fastest:.4g} rpm/s ({longest:g} to {shortest:g} s)"
        )
    return round(seconds / profile.time_step)


def radians_per_hz(rpm_per_hz: float) -> float:
    """Return the shaft speed [rad/s] per hertz of the drive's output."""
    return rpm_per_hz / RPM
