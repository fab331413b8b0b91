"""Driver of variable-frequency drives on Modbus RTU or TCP: the order of register reads and writes.

What the words mean is in `modbus_frames`, where the registers are in a `Profile`, how they travel in `modbus_link`.
Parameters are read before they are written and written only if they differ: drives of this kind keep them in EEPROM,
which wears.
"""

import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

from rotorrig.rig.config import RPM, SAME_RAMP, ModbusRtu, ModbusTcp, load_profile
from rotorrig.rig.errors import BadFrame, ConfigError, LimitExceeded, LinkLost
from rotorrig.rig.motor.base import REMEDY, MotorInfo, MotorState, Stop
from rotorrig.rig.motor.modbus_frames import (
    Reading,
    Scale,
    decode_state,
    describe_fault,
    encode_ramp,
    encode_speed,
    encode_watchdog,
    radians_per_hz,
)
from rotorrig.rig.motor.modbus_link import ModbusLink
from rotorrig.rig.motor.modbus_profile import Frequency, Profile
from rotorrig.rig.motor.slowing import falls, patience

CONFIRM_SECONDS = 1.0  # for the state to follow a command
CONFIRM_PAUSE_SECONDS = 0.02


class ModbusMotor:
    """A rig.motor.base.MotorDriver for the drives that have a `Profile`.

    Its verbs may be called from several threads. A stop is sent next, whatever else is waiting for the wire, and a
    `set_speed` it overtakes sends nothing more.
    """

    def __init__(self, table: ModbusRtu | ModbusTcp) -> None:
        profile = load_profile(table.profile)
        assert isinstance(profile, Profile), "a file in profiles/ holds one"
        self._table, self._profile = table, profile
        self._link = ModbusLink(table, model=self._profile.model)
        self._scale = Scale(step=1.0)  # of the reference; this, and the drive's limit, are read when opened
        self._max_frequency: float | None = None  # Hz
        self._last_setpoint = 0.0  # rad/s, what was last asked of a drive that does not say
        self._stops = 0  # how many have been asked for
        self._ramp: float | None = None  # rad/s^2, the last asked for
        self._coasting = True  # the output is off, whether it turns or not

    @property
    def link(self) -> str:
        """Name of the link, for messages."""
        return self._link.name

    def open(self) -> MotorInfo:
        """Open the link, check who answers and set its watchdog; may be called again after a loss. Raises LinkLost."""
        p = self._profile
        self._link.open()
        try:
            self._coasting = not self._read_state().output_on
            self._max_frequency = self._read_frequency_limit(p.max_frequency) if p.max_frequency else None
            self._scale = self._read_reference_scale()
            if p.stop_mode:
                self._set_parameter(p.stop_mode.register, p.stop_mode.ramp, "stop mode")
            for setting in p.settings:
                self._set_parameter(setting.register, setting.word, setting.what)
            watchdog = self._set_watchdog()
            if p.setpoint is None:
                self._last_setpoint = self._to_speed(self._scale.hertz(self._link.read(p.reference, 1, "reference")[0]))
        except BaseException:
            self.close()
            raise
        return MotorInfo(
            model=p.model,
            link=self.link,
            watchdog=watchdog,
            coasts=p.stop.coast is not None or p.stop_mode is not None,
            one_ramp=p.keeps_ramp,
            remarks=_remarks(p),
        )

    def read(self) -> MotorState:
        """Read the drive's state: its output frequency as a speed, unsigned. Raises LinkLost."""
        reading = self._read_state()
        asked = self._last_setpoint if reading.setpoint is None else self._to_speed(self._scale.hertz(reading.setpoint))
        return MotorState(
            speed=self._to_speed(reading.frequency),
            setpoint=asked if reading.output_on else 0.0,
            running=reading.output_on,
            at_setpoint=reading.running and reading.at_reference,
            fault=self._read_fault() if reading.faulted else "",
            reverse=reading.reverse,
        )

    def set_speed(self, speed: float, *, ramp: float) -> None:
        """Go to `speed` [rad/s] at `ramp` [rad/s^2], forward, starting if at rest.

        Raises LimitExceeded if the speed is too high, the drive has tripped or a stop came in between, ConfigError if
        the drive has no such ramp, LinkLost if it does not answer or does not start. Nothing is sent if speed or ramp
        is refused.
        """
        p, stops = self._profile, self._stops
        reference = encode_speed(speed, scale=self._scale, rpm_per_hz=self._table.rpm_per_hz, fastest=self._fastest)
        ramp_time = self._encode_ramp_time(ramp)

        def overtaken() -> bool:
            return self._stops != stops

        reading = self._read_state()
        if reading.faulted:
            raise LimitExceeded(f"drive: has tripped with '{self._read_fault()}'; {REMEDY}")
        self._set_ramps(ramp_time, reading, overtaken)
        self._ramp = ramp
        self._link.write(p.reference, reference, "reference", unless=overtaken)
        self._coasting = False
        self._last_setpoint = self._to_speed(self._scale.hertz(reference))
        for word in p.start[-1:] if reading.running else p.start:
            self._link.write(p.command, word, "start", unless=overtaken)
            time.sleep(p.start_pause if word != p.start[-1] else 0.0)
        self._confirm(lambda now: now.running, "start")

    def stop(self, kind: Stop) -> None:
        """Bring the rotor to rest: RAMP at the last ramp, COAST unpowered, EMERGENCY as fast as it can follow.

        The stop command goes out first; whatever makes it another kind of stop follows. A drive that cannot be told to
        coast goes down its ramp. Raises LinkLost if the drive does not answer or does not report that it slows down:
        another kind of stop may then be tried, which is sent whatever was sent before.
        """
        self._stops += 1
        self._link.write(self._profile.command, self._profile.stop.of(kind), "stop", urgent=True)
        if kind is Stop.EMERGENCY:
            self._shorten_ramp()
        elif kind is Stop.COAST:
            self._switch_to_coasting()
        before, step = self._to_speed(self._read_state().frequency), self._to_speed(self._profile.output_step)

        def obeyed(now: Reading) -> bool:
            return (
                now.decelerating or not now.output_on or falls(self._to_speed(now.frequency), since=before, step=step)
            )

        reading = self._confirm(obeyed, "stop", within=patience(self._ramp, least=CONFIRM_SECONDS))
        self._coasting = not reading.output_on

    def clear_fault(self) -> None:
        """Clear a trip the drive remembers, once its cause is gone.

        Raises LinkLost if it stays, LimitExceeded if the drive can be cleared only where it stands.
        """
        if not self._profile.clear_fault:
            raise LimitExceeded(f"drive: a {self._profile.model} cannot be cleared over Modbus, want it reset by hand")
        for word in self._profile.clear_fault:
            self._link.write(self._profile.command, word, "clear fault")
        self._confirm(lambda now: not now.faulted, "clear fault")

    def close(self) -> None:
        """Give the port back. Does not stop the rotor."""
        self._link.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _read_state(self) -> Reading:
        p = self._profile
        words = self._link.read(p.state.start, len(p.state), "state")
        if p.status not in p.state:
            words += self._link.read(p.status, 1, "status")
        try:
            return decode_state(words, profile=p)
        except BadFrame as error:
            raise LinkLost(f"{self.link}: {error}; is it a {p.model}?") from error

    def _read_fault(self) -> str:
        number = self._link.read(self._profile.fault, 1, "fault")[0]
        return describe_fault(number & self._profile.fault_mask, profile=self._profile)

    def _read_frequency_limit(self, limit: Frequency) -> float:
        """Read a frequency limit [Hz]. Raises LinkLost for one that no such drive can have."""
        frequency = self._link.read(limit.register, 1, "frequency limit")[0] * limit.step
        low, high = limit.range
        if not low <= frequency <= high:
            raise LinkLost(
                f"{self.link}: the frequency limit (register {limit.register}) reads {frequency:g} Hz, "
                f"want {low:g} to {high:g} Hz; is it a {self._profile.model}?"
            )
        return frequency

    def _read_reference_scale(self) -> Scale:
        scale = self._profile.reference_scale
        if isinstance(scale, float):
            return Scale(step=scale)
        low = self._read_frequency_limit(scale.low) if scale.low else 0.0
        high = self._read_frequency_limit(scale.high)
        if not low < high:
            raise LinkLost(f"{self.link}: its frequency limits are {low:g} and {high:g} Hz, want the second higher")
        return Scale(step=(high - low) / scale.counts, low=low)

    def _set_watchdog(self) -> float | None:
        watchdog = self._profile.watchdog
        if watchdog is None:
            return None
        word = encode_watchdog(self._table.watchdog, watchdog=watchdog)
        self._set_parameter(watchdog.register, word, "communication loss time")
        return word * watchdog.step

    @property
    def _fastest(self) -> float:
        """The highest speed that may be asked for [rad/s]."""
        limits = [self._table.max_speed]
        if self._max_frequency is not None:
            limits.append(self._to_speed(self._max_frequency))
        if not isinstance(scale := self._profile.reference_scale, float):
            limits.append(self._to_speed(self._scale.hertz(scale.counts)))
        return min(limits)

    def _to_speed(self, hertz: float) -> float:
        return hertz * radians_per_hz(self._table.rpm_per_hz)

    def _encode_ramp_time(self, ramp: float) -> int | None:
        """Return the word of the times that make a ramp; None: it is the one set by hand. Raises ConfigError."""
        ramps, own = self._profile.ramps, self._table.ramp
        if ramps is None:
            assert own is not None, "checked with the config"
            if abs(ramp / own - 1) > SAME_RAMP:
                raise ConfigError(
                    f"ramp: got {ramp * RPM:.4g} rpm/s, want {own * RPM:.4g} rpm/s as motor.ramp says: the ramp "
                    f"of a {self._profile.model} is set by hand"
                )
            return None
        assert self._max_frequency is not None, "a drive with ramps has a maximum frequency they refer to"
        return encode_ramp(ramp, ramps=ramps, rpm_per_hz=self._table.rpm_per_hz, max_frequency=self._max_frequency)

    def _set_ramps(self, word: int | None, reading: Reading, overtaken: Callable[[], bool]) -> None:
        ramps = self._profile.ramps
        if ramps is None or word is None:
            return
        registers = {ramps.accel_time: "acceleration time", ramps.decel_time: "deceleration time"}
        present = self._link.read(ramps.accel_time, 2, "ramp times")
        if ramps.only_at_rest and reading.output_on and present != [word, word]:
            up, down = (time * ramps.step for time in present)
            raise ConfigError(
                f"ramp: got one of {word * ramps.step:g} s, want {up:g} s up and {down:g} s down: a "
                f"{self._profile.model} keeps its ramp times while it runs"
            )
        for (register, what), was in zip(registers.items(), present, strict=True):
            if was != word:
                self._link.write(register, word, what, unless=overtaken)

    def _shorten_ramp(self) -> None:
        """Shorten the ramp of an emergency stop under way, in a drive without a word for it."""
        p = self._profile
        if p.stop.fast is None and p.ramps and p.emergency_time:
            self._set_parameter(p.ramps.decel_time, round(p.emergency_time / p.ramps.step), "deceleration time")

    def _switch_to_coasting(self) -> None:
        """Switch a ramp stop under way to coasting, in a drive without a word for it."""
        p = self._profile
        if p.stop_mode is None or self._coasting:
            return
        # not read first: it is the ramp, since it was opened and after every time here; and until then it brakes
        self._link.write(p.stop_mode.register, p.stop_mode.coast, "stop mode", urgent=True)
        try:
            self._link.write(p.command, p.stop.ramp, "stop", urgent=True)
        finally:  # the next stop command must brake at once
            self._link.write(p.stop_mode.register, p.stop_mode.ramp, "stop mode", urgent=True)

    def _set_parameter(self, register: int, word: int, what: str) -> None:
        if self._link.read(register, 1, what) != [word]:
            self._link.write(register, word, what)

    def _confirm(self, done: Callable[[Reading], bool], command: str, *, within: float | None = None) -> Reading:
        """Wait until the drive's state shows that it has obeyed a command; return that state."""
        within = CONFIRM_SECONDS if within is None else within
        deadline = time.monotonic() + within
        while not done(reading := self._read_state()):
            if time.monotonic() > deadline:
                raise LinkLost(
                    f"{self.link}: the drive took the command '{command}' but did not obey within "
                    f"{within:.2g} s (it is {reading}); {self._profile.hint}"
                )
            time.sleep(CONFIRM_PAUSE_SECONDS)
        return reading


def _remarks(profile: Profile) -> tuple[str, ...]:
    """Return the limitations of a family over Modbus, for a person."""
    cannot_coast = profile.stop.coast is None and profile.stop_mode is None
    remarks = {
        "cannot be told to stop by itself when this program or the cable is gone": profile.watchdog is None,
        "its ramp is set by hand, and only that one can be asked for": profile.ramp_by_hand,
        "keeps its ramp while it runs": bool(profile.ramps and profile.ramps.only_at_rest),
        "cannot be told to coast, it stops down its ramp": cannot_coast,
        "cannot be told to stop faster than its ramp": profile.stop.fast is None and profile.emergency_time is None,
    }
    return tuple(remark for remark, holds in remarks.items() if holds)
