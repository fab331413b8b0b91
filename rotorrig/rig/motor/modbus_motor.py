"""A variable-frequency drive on Modbus RTU: owns the client and the order of register accesses.

What the words mean is in `modbus_frames`, where the registers are in a `Profile`. Parameters are read before they are
written and written only if they differ: drives of this kind keep them in EEPROM, which wears.
"""

import logging
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

from pymodbus.client import ModbusSerialClient
from pymodbus.exceptions import ModbusException
from pymodbus.pdu import ModbusPDU

from rotorrig.rig.errors import BadFrame, LimitExceeded, LinkLost
from rotorrig.rig.motor.base import MotorInfo, MotorState, Stop
from rotorrig.rig.motor.modbus_frames import (
    DriveStatus,
    Profile,
    decode_speed,
    decode_status,
    encode_ramp,
    encode_speed,
    fault_text,
    radians_per_hz,
)
from rotorrig.rig.serial_port import why_closed

ANSWER_SECONDS = 0.5  # for one reply; an 8 byte reply at 19200 baud takes 5 ms, a busy drive some tens
RETRIES = 3  # after a timeout or a damaged reply
CONFIRM_SECONDS = 1.0  # for the status to follow a command
CONFIRM_PAUSE_SECONDS = 0.02
ILLEGAL = {1: "illegal function", 2: "illegal address", 3: "illegal value", 4: "device failure", 6: "device busy"}

# without a handler, Python prints pymodbus' own account of every retry to stderr; errors are told by LinkLost
logging.getLogger("pymodbus").addHandler(logging.NullHandler())


class ModbusMotor:
    """A rig.motor.base.MotorDriver for the drives that have a `Profile`."""

    def __init__(
        self, port: str, *, profile: Profile, baudrate: int, address: int, rpm_per_hz: float, max_speed: float
    ) -> None:
        self.port = port
        self._profile = profile
        self._address = address
        self._rpm_per_hz = rpm_per_hz
        self._max_speed = max_speed  # rad/s, the config's
        self._max_frequency = 0.0  # Hz, the drive's; read when opened
        self._link = f"Modbus RTU, {port}, {baudrate} baud, address {address}"
        self._client = ModbusSerialClient(port, baudrate=baudrate, timeout=ANSWER_SECONDS, retries=RETRIES)
        self._is_open = False

    def open(self) -> MotorInfo:
        """Open the link and check who answers. Raises LinkLost."""
        if not self._client.connect():
            raise LinkLost(f"{self.port}: the drive's port cannot be opened ({why_closed(self.port)})")
        self._is_open = True
        try:
            self._status()
            self._max_frequency = self._checked_max_frequency()
        except BaseException:
            self.close()
            raise
        return MotorInfo(model=self._profile.model, link=self._link)

    def read(self) -> MotorState:
        """Read the drive's state: its output frequency as a speed, unsigned. Raises LinkLost."""
        status = self._status()
        return MotorState(
            speed=self._read_speed(self._profile.output_frequency, "output frequency"),
            setpoint=self._read_speed(self._profile.reference, "reference") if status.running else 0.0,
            running=status.running,
            at_setpoint=status.running and status.at_reference,
            fault=self._fault() if status.faulted else "",
        )

    def set_speed(self, speed: float, *, ramp: float) -> None:
        """Go to `speed` [rad/s] at `ramp` [rad/s^2], forward, starting if at rest.

        Raises LimitExceeded if the speed is too high or the drive has tripped, ConfigError if the drive has no such
        ramp, LinkLost if it does not answer or does not start. Nothing is sent if speed or ramp is refused.
        """
        p = self._profile
        drive_limit = self._max_frequency * radians_per_hz(self._rpm_per_hz)
        reference = encode_speed(
            speed, profile=p, rpm_per_hz=self._rpm_per_hz, fastest=min(self._max_speed, drive_limit)
        )
        ramp_time = encode_ramp(ramp, profile=p, rpm_per_hz=self._rpm_per_hz, max_frequency=self._max_frequency)
        if self._status().faulted:
            raise LimitExceeded(f"drive: has tripped with '{self._fault()}'; clear the fault before starting it")
        self._set_parameter(p.accel_time, ramp_time, "acceleration time")
        self._set_parameter(p.decel_time, ramp_time, "deceleration time")
        self._write(p.reference, reference, "reference")
        self._write(p.command, p.start_forward, "start")
        self._confirm(lambda status: status.running, "start")

    def stop(self, kind: Stop) -> None:
        """Bring the rotor to rest: RAMP at the last ramp, COAST unpowered, EMERGENCY as fast as it can follow.

        The stop command goes out even if the drive refuses to be told how. Raises LinkLost if the drive does not answer
        or does not report that it slows down.
        """
        try:
            self._choose_stop(kind)
        finally:
            self._write(self._profile.command, self._profile.stop, "stop")
        self._confirm(lambda status: status.decelerating or not status.running, "stop")

    def clear_fault(self) -> None:
        """Clear a trip the drive remembers, once its cause is gone. Raises LinkLost if it stays."""
        self._write(self._profile.command, self._profile.clear_fault, "clear fault")
        self._confirm(lambda status: not status.faulted, "clear fault")

    def close(self) -> None:
        """Give the port back. Does not stop the rotor."""
        self._is_open = False
        self._client.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _checked_max_frequency(self) -> float:
        p = self._profile
        low, high = p.max_frequency_range
        frequency = self._read(p.max_frequency, "maximum frequency") * p.frequency_step
        if not low <= frequency <= high:
            raise LinkLost(
                f"{self._link}: the maximum frequency (parameter {p.max_frequency}) reads {frequency:g} Hz, "
                f"want {low:g} to {high:g} Hz; is it a {p.model}?"
            )
        return frequency

    def _status(self) -> DriveStatus:
        word = self._read(self._profile.status, "status")
        try:
            return decode_status(word, profile=self._profile)
        except BadFrame as error:
            raise LinkLost(f"{self._link}: {error}; is it a {self._profile.model}?") from error

    def _fault(self) -> str:
        return fault_text(self._read(self._profile.fault, "fault"), profile=self._profile)

    def _read_speed(self, register: int, what: str) -> float:
        return decode_speed(self._read(register, what), profile=self._profile, rpm_per_hz=self._rpm_per_hz)

    def _choose_stop(self, kind: Stop) -> None:
        p = self._profile
        if kind is Stop.EMERGENCY:
            self._set_parameter(p.decel_time, round(p.emergency_time / p.time_step), "deceleration time")
        mode = p.stop_mode_coast if kind is Stop.COAST else p.stop_mode_ramp
        self._set_parameter(p.stop_mode, mode, "stop mode")

    def _set_parameter(self, register: int, word: int, what: str) -> None:
        if self._read(register, what) != word:
            self._write(register, word, what)

    def _confirm(self, done: Callable[[DriveStatus], bool], command: str) -> None:
        """Wait for the status to say that a command has been obeyed."""
        deadline = time.monotonic() + CONFIRM_SECONDS
        while not done(status := self._status()):
            if time.monotonic() > deadline:
                raise LinkLost(
                    f"{self._link}: the drive took the command '{command}' but did not obey within "
                    f"{CONFIRM_SECONDS:g} s (it is {status}); {self._profile.hint}"
                )
            time.sleep(CONFIRM_PAUSE_SECONDS)

    def _read(self, register: int, what: str) -> int:
        """Return the word of a register. Raises LinkLost naming the port, register and what was asked."""
        asked = f"read {what} (register {register})"
        try:
            reply = self._opened(asked).read_holding_registers(register, device_id=self._address)
        except ModbusException as error:
            raise self._no_answer(asked) from error
        self._refuse_exception(reply, asked)
        if len(reply.registers) != 1:
            raise LinkLost(f"{self._link}: asked to {asked}, got {len(reply.registers)} words, want 1")
        return reply.registers[0]

    def _write(self, register: int, word: int, what: str) -> None:
        """Write a word; the drive's echo must match. Raises LinkLost like `_read`."""
        asked = f"write {what} = {word} (register {register})"
        try:
            reply = self._opened(asked).write_register(register, word, device_id=self._address)
        except ModbusException as error:
            raise self._no_answer(asked) from error
        self._refuse_exception(reply, asked)
        if (reply.address, reply.registers) != (register, [word]):
            raise LinkLost(
                f"{self._link}: asked to {asked}, it confirmed {reply.registers} in register {reply.address}"
            )

    def _opened(self, asked: str) -> ModbusSerialClient:
        if not self._is_open:
            raise LinkLost(f"{self._link}: asked to {asked}, but the link is not open")
        return self._client

    def _no_answer(self, asked: str) -> LinkLost:
        if not self._client.connected:
            return LinkLost(f"{self._link}: asked to {asked}, but the port is gone; was it unplugged?")
        return LinkLost(
            f"{self._link}: asked to {asked}, no valid answer in {1 + RETRIES} tries of {ANSWER_SECONDS:g} s"
        )

    def _refuse_exception(self, reply: ModbusPDU, asked: str) -> None:
        if reply.isError():
            reason = ILLEGAL.get(reply.exception_code, "unknown reason")
            raise LinkLost(
                f"{self._link}: asked to {asked}, the device refused with exception {reply.exception_code} "
                f"({reason}); is it a {self._profile.model}?"
            )
