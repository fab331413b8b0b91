"""Encoding and decoding of a Modbus drive's register words, by its `Profile`: pure functions."""

import math
from dataclasses import dataclass

from rotorrig.rig.config import RPM
from rotorrig.rig.errors import BadFrame, ConfigError, LimitExceeded
from rotorrig.rig.motor.modbus_profile import Profile, Ramps, Watchdog


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """A drive's state words, decoded."""

    running: bool  # it was started and not stopped; some drives say so until the ramp has ended
    accelerating: bool
    decelerating: bool
    faulted: bool
    at_reference: bool
    frequency: float  # Hz, of the output, unsigned
    reverse: bool  # it turns backward
    setpoint: int | None  # word, counted as the reference; None: the drive does not say

    @property
    def output_on(self) -> bool:
        """True while the drive powers the motor."""
        return self.running or self.frequency > 0.0

    def __str__(self) -> str:
        names = ("running", "accelerating", "decelerating", "faulted", "at_reference")
        return ", ".join(name.replace("_", " ") for name in names if getattr(self, name)) or "at rest"


def decode_state(words: list[int], *, profile: Profile) -> Reading:
    """Return the meaning of the words of `profile.state_registers`. Raises BadFrame for a contradictory status.

    >>> from rotorrig.rig.motor.profiles.powerflex400 import PROFILE
    >>> reading = decode_state([0b1_0000_1111, 0, 6000, 6000], profile=PROFILE)
    >>> print(reading, reading.frequency)
    running, at reference 60.0
    """
    p = profile
    word_at = dict(zip(p.state_registers, words, strict=True))
    output = from_twos_complement(word_at[p.output_frequency])
    frequency = abs(output) * p.output_step
    setpoint = None if p.setpoint is None else word_at[p.setpoint]
    status = word_at[p.status]
    if status & p.accelerating and status & p.decelerating:
        raise BadFrame(f"status: got 0x{status:04x}, accelerating and decelerating at once")
    return Reading(
        running=status & p.run_field.mask in p.run_field.running if p.run_field else bool(status & p.running),
        accelerating=bool(status & p.accelerating),
        decelerating=_decelerates(status, p),
        faulted=bool(status & p.faulted if p.faulted else word_at[p.fault] & p.fault_mask),
        at_reference=bool(status & p.at_reference) if p.at_reference else output > 0 and setpoint == output,
        frequency=frequency,
        reverse=output < 0
        or (output > 0 and bool((status ^ p.forward) & (p.forward | p.backward)))
        or (p.direction is not None and from_twos_complement(word_at[p.direction]) < 0),
        setpoint=setpoint,
    )


def _decelerates(status: int, profile: Profile) -> bool:
    field = profile.run_field
    return status & field.mask == field.stopping if field else bool(status & profile.decelerating)


def from_twos_complement(word: int) -> int:
    """Return a register's word as a number in two's complement.

    >>> from_twos_complement(0xFFFF), from_twos_complement(0x7FFF)
    (-1, 32767)
    """
    return word - 0x1_0000 if word & 0x8000 else word


def describe_fault(number: int, *, profile: Profile) -> str:
    """Return a fault's name and number, "overvoltage (F5)".

    >>> from rotorrig.rig.motor.profiles.powerflex400 import PROFILE
    >>> describe_fault(5, profile=PROFILE), describe_fault(99, profile=PROFILE)
    ('overvoltage (F5)', 'fault F99, see its manual')
    """
    code = f"{profile.fault_letter}{number}"
    name = profile.faults.get(number)
    return f"{name} ({code})" if name else f"fault {code}, see its manual"


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """Scale of the reference: `low` Hz at 0, then `step` Hz per count."""

    step: float
    low: float = 0.0

    def hertz(self, word: int) -> float:
        """Return the frequency of a reference word."""
        return self.low + word * self.step


def encode_speed(speed: float, *, scale: Scale, rpm_per_hz: float, fastest: float) -> int:
    """Return the reference nearest to `speed` [rad/s]. Raises LimitExceeded outside `scale.low` to `fastest` [rad/s].

    >>> encode_speed(3600 / RPM, scale=Scale(step=0.01), rpm_per_hz=60.0, fastest=400.0)  # 60.00 Hz, two poles
    6000
    """
    slowest = scale.low * radians_per_hz(rpm_per_hz)
    if not slowest <= speed <= fastest:
        raise LimitExceeded(
            f"speed: asked for {speed * RPM:.0f} rpm, want {slowest * RPM:.0f} to {fastest * RPM:.0f} rpm, "
            "the least of motor.max_speed in the config and the drive's maximum frequency"
        )
    return round((speed / radians_per_hz(rpm_per_hz) - scale.low) / scale.step)


def encode_ramp(ramp: float, *, ramps: Ramps, rpm_per_hz: float, max_frequency: float) -> int:
    """Return the time word of `ramp` [rad/s^2]: the time from 0 to `max_frequency` [Hz].

    Raises ConfigError if the drive cannot be set to it.
    """
    if not ramp > 0:
        raise ConfigError(f"ramp: got {ramp:g} rad/s^2, want more than 0")
    seconds = max_frequency * radians_per_hz(rpm_per_hz) / ramp
    shortest, longest = ramps.range
    if not shortest <= seconds <= longest:
        slowest, fastest = (ramp * RPM * seconds / t for t in (longest, shortest))
        raise ConfigError(
            f"ramp: got {ramp * RPM:.4g} rpm/s, which takes {seconds:.4g} s from 0 to the drive's "
            f"{max_frequency:g} Hz, want {slowest:.4g} to {fastest:.4g} rpm/s ({longest:g} to {shortest:g} s)"
        )
    return round(seconds / ramps.step)


def encode_watchdog(patience: float, *, watchdog: Watchdog) -> int:
    """Return the word of the shortest time a drive can be set to that is not below `patience` [s], or of its longest.

    >>> encode_watchdog(1.5, watchdog=Watchdog(register=813, step=1.0, range=(1.0, 255.0)))
    2
    """
    shortest, longest = watchdog.range
    counts = min(max(patience, shortest), longest) / watchdog.step
    return math.ceil(counts - 1e-6)  # 2.0 s is 20 tenths, whatever binary makes of it


def radians_per_hz(rpm_per_hz: float) -> float:
    """Return the shaft speed [rad/s] per hertz of the drive's output."""
    return rpm_per_hz / RPM
