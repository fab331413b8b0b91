"""Driver of CiA 402 drives in velocity mode on CANopen: configuration and order of commands.

The words are in `cia402_frames`, the bus in `can_link`. Everything goes by SDO, which every drive
has and confirms; what process data a drive offers differs from make to make.
"""

import math
import time
from types import TracebackType
from typing import Self

from rotorrig.rig.config import RPM, CanOpen
from rotorrig.rig.errors import BadFrame, LimitExceeded, LinkLost
from rotorrig.rig.motor import cia402_frames as cia402
from rotorrig.rig.motor.base import REMEDY, MotorInfo, MotorState, Stop
from rotorrig.rig.motor.can_link import CanLink, Refused
from rotorrig.rig.motor.cia402_frames import Item, State
from rotorrig.rig.motor.slowing import falls, patience
from rotorrig.rig.serial_port import ReopenedPort

CONFIRM_SECONDS = 1.0  # for the state to follow a command
CONFIRM_PAUSE_SECONDS = 0.01
HEARTBEATS = 4  # sent in the drive's watchdog time, if there are as many requests

_STOPS = {Stop.RAMP: cia402.SHUTDOWN, Stop.COAST: cia402.DISABLE_VOLTAGE, Stop.EMERGENCY: cia402.QUICK_STOP}


class CanOpenMotor:
    """A rig.motor.base.MotorDriver for CiA 402 drives."""

    def __init__(self, table: CanOpen) -> None:
        self._table = table
        self._unit = table.rpm_per_unit / RPM  # rad/s
        self._name = f"CANopen, {table.interface} {table.channel}, {table.bitrate / 1000:g} kbit/s, node {table.node}"
        self._reopened = ReopenedPort(table.channel.partition("@")[0]) if table.interface == "slcan" else None
        self._can: CanLink | None = None
        self._slowest = self._fastest = 0.0  # rad/s, the drive's own limits and the config's; read when opened
        self._slope: tuple[int, int] | None = None  # of the ramps, as the drive has confirmed it since it was opened
        self._shutdown_ramps = False  # shutdown goes down the ramp; else it would let the rotor coast

    def open(self) -> MotorInfo:
        """Open the bus anew, check who answers, configure the drive and its watchdog. Raises LinkLost."""
        self.close()
        if self._reopened:
            self._reopened.check()
        self._can, self._slope = CanLink(self._table, name=self._name), None
        try:
            model = self._check_device()
            self._choose_mode()
            self._read_limits()
            self._shutdown_ramps = self._try_write(cia402.SHUTDOWN_OPTION, cia402.SHUTDOWN_DOWN_THE_RAMP)
            self._try_write(cia402.QUICK_STOP_OPTION, cia402.QUICK_STOP_DOWN_ITS_RAMP)
            watchdog = self._set_watchdog()
            if watchdog:
                self._link.beat_every(watchdog / HEARTBEATS)
            self._link.start_node()
            self._read_state()  # a node that hears our heartbeat still answers
        except Refused as refusal:
            self.close()
            raise LinkLost(f"{refusal}; is it a drive with velocity mode?") from refusal
        except BaseException:
            self.close()
            raise
        remarks = () if self._shutdown_ramps else ("a stop down the ramp leaves it enabled, at speed 0 (no 605Bh)",)
        return MotorInfo(model=model, link=self._name, watchdog=watchdog, remarks=remarks)

    def read(self) -> MotorState:
        """Read the drive's state; its speed is its own belief, measured or not, unsigned. Raises LinkLost."""
        word = self._read(cia402.STATUSWORD)
        state = self._decode(word)
        enabled = state is State.OPERATION_ENABLED
        velocity = self._read(cia402.ACTUAL)
        actual = abs(velocity)
        target = abs(self._read(cia402.TARGET)) if enabled else 0
        self._refuse_restarted()
        return MotorState(
            speed=actual * self._unit,
            setpoint=target * self._unit,
            running=(enabled and target > 0) or (state in cia402.POWERED and actual > 0),
            # a unit of rounding: not every drive sets "target reached" in velocity mode
            at_setpoint=target > 0 and (cia402.is_target_reached(word) or abs(actual - target) <= 1),
            fault=self._describe_fault(state),
            reverse=velocity < 0,
        )

    def set_speed(self, speed: float, *, ramp: float) -> None:
        """Go to `speed` [rad/s] at `ramp` [rad/s^2], forward, starting if at rest.

        Raises LimitExceeded if the speed is too high or the drive has tripped, ConfigError if the drive has no such
        ramp, LinkLost if it does not answer or does not start, or if a stop comes in between. Nothing is sent if speed
        or ramp is refused.
        """
        target = cia402.encode_speed(speed, unit=self._unit, slowest=self._slowest, fastest=self._fastest)
        slope = cia402.encode_ramp(ramp, unit=self._unit)
        stops_before = self._link.stops
        self._refuse_tripped(self._read_state())
        self._refuse_restarted()
        self._link.start_node()  # one whose heartbeat stayed away, at rest, has left operational
        self._set_slope(slope, stops_before)
        self._write(cia402.TARGET, target, stops_before)  # none of before is followed once the drive is enabled,
        self._enable(stops_before)
        self._write(cia402.TARGET, target, stops_before)  # which clears it in drives that go by IEC 61800-7-201

    def stop(self, kind: Stop) -> None:
        """Bring the rotor to rest: RAMP at the last ramp, COAST unpowered, EMERGENCY down the drive's quick stop ramp.

        The stop goes out before anything that waits. Raises LinkLost if the drive does not take it or does not obey.
        """
        try:
            if kind is Stop.RAMP and not self._shutdown_ramps:
                self._link.stop(cia402.TARGET, 0)  # the drive stays enabled, at rest
            else:
                self._link.stop(cia402.CONTROLWORD, _STOPS[kind])
        except Refused as refusal:
            raise LinkLost(str(refusal)) from refusal
        if kind is not Stop.RAMP:
            self._wait_until_not(State.OPERATION_ENABLED, command=kind.value)
            return
        if self._shutdown_ramps:
            self._write(cia402.TARGET, 0)
        self._wait_until_slower()

    def clear_fault(self) -> None:
        """Reset a fault, once its cause is gone. Raises LinkLost if it stays."""
        self._write(cia402.CONTROLWORD, cia402.DISABLE_VOLTAGE)  # the reset is the rising edge of its bit
        self._write(cia402.CONTROLWORD, cia402.FAULT_RESET)
        self._wait_until_not(*cia402.FAULTED, command="fault reset")

    def close(self) -> None:
        """Leave the bus. Does not stop the rotor; the drive's watchdog will."""
        link, self._can = self._can, None
        if link:
            link.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _check_device(self) -> str:
        """Return the model. Raises LinkLost if the node is no CiA 402 drive with velocity mode."""
        profile = self._link.read(cia402.DEVICE_TYPE) & 0xFFFF
        if profile != cia402.PROFILE:
            raise LinkLost(f"{self._name}: the node is a device of profile {profile}, want {cia402.PROFILE}, a drive")
        modes = self._read_if_there(cia402.SUPPORTED_MODES)
        if modes is not None and not modes >> (cia402.VELOCITY_MODE - 1) & 1:
            raise LinkLost(f"{self._name}: the drive has no velocity mode (vl); its modes are {modes:08X}h (6502h)")
        try:
            return self._link.read_text(cia402.DEVICE_NAME) or "CiA 402 drive"
        except Refused:
            return "CiA 402 drive"

    def _choose_mode(self) -> None:
        self._link.write(cia402.MODE, cia402.VELOCITY_MODE)
        deadline = time.monotonic() + CONFIRM_SECONDS
        while (mode := self._link.read(cia402.MODE_DISPLAY)) != cia402.VELOCITY_MODE:
            if time.monotonic() > deadline:
                raise LinkLost(f"{self._name}: the drive stays in mode {mode}, want {cia402.VELOCITY_MODE}, velocity")
            time.sleep(CONFIRM_PAUSE_SECONDS)

    def _read_limits(self) -> None:
        """Read the drive's speed limits, and lower its upper one to the config's."""
        largest = self._link.read(cia402.LARGEST_AMOUNT)
        wanted = math.ceil(self._table.max_speed / self._unit - 1e-9)
        if wanted < largest and self._try_write(cia402.LARGEST_AMOUNT, wanted):
            largest = wanted
        self._fastest = min(self._table.max_speed, min(largest, cia402.FASTEST) * self._unit)
        self._slowest = self._link.read(cia402.LEAST_AMOUNT) * self._unit

    def _set_watchdog(self) -> float | None:
        """Set the drive to watch our heartbeat; return the time-out [s], None if it cannot, or would not stop."""
        seconds = self._table.watchdog
        listens = self._link.master << 16 | math.ceil(seconds * 1000)
        stops = self._try_write(cia402.ABORT_OPTION, cia402.ABORT_BY_QUICK_STOP)
        return seconds if stops and self._try_write(cia402.MASTER_HEARTBEAT, listens) else None

    def _try_write(self, item: Item, value: int) -> bool:
        """Set an optional object; return whether the drive has taken it."""
        try:
            self._link.write(item, value)
        except Refused:
            return False
        return True

    def _read_if_there(self, item: Item) -> int | None:
        try:
            return self._link.read(item)
        except Refused:
            return None

    def _set_slope(self, slope: tuple[int, int], stops_before: int) -> None:
        """Set both ramps, and see to it that an emergency stop is no slower; steeper is the drive's own business."""
        before, self._slope = self._slope, None
        if slope != before:
            # of the two numbers the one first that makes the ramp less steep: the drive may be on it
            order = -1 if before and slope[1] > before[1] else 1
            for items in (cia402.ACCELERATION, cia402.DECELERATION):
                for item, value in list(zip(items, slope, strict=True))[::order]:
                    self._write(item, value, stops_before)
            delta, seconds = (self._read_if_there(item) for item in cia402.QUICK_STOP_RAMP)
            if delta is not None and seconds and delta / seconds < slope[0] / slope[1]:
                for item, value in zip(cia402.QUICK_STOP_RAMP, slope, strict=True):
                    self._write(item, value, stops_before)
        self._slope = slope

    def _enable(self, stops_before: int) -> None:
        """Lead the drive to operation enabled, whatever its state is. Raises LimitExceeded, LinkLost."""
        deadline = time.monotonic() + CONFIRM_SECONDS
        self._refuse_tripped(state := self._read_state())
        if state is State.OPERATION_ENABLED:
            self._write(cia402.CONTROLWORD, cia402.ENABLE_OPERATION, stops_before)  # a shutdown may be under way
        while state is not State.OPERATION_ENABLED:
            if state in cia402.NEXT:
                self._write(cia402.CONTROLWORD, cia402.NEXT[state], stops_before)
            if time.monotonic() > deadline:
                raise LinkLost(
                    f"{self._name}: the drive does not start, it stays {state}; "
                    "is its power on, and is it set to be controlled from the bus?"
                )
            before, state = state, self._read_state()
            self._refuse_tripped(state)
            if state is before:
                time.sleep(CONFIRM_PAUSE_SECONDS)

    def _wait_until_not(self, *left: State, command: str) -> None:
        deadline = time.monotonic() + CONFIRM_SECONDS
        while (state := self._read_state()) in left:
            if time.monotonic() > deadline:
                raise LinkLost(
                    f"{self._name}: the drive took the command '{command}' but did not obey within "
                    f"{CONFIRM_SECONDS:g} s; it is {state}"
                )
            time.sleep(CONFIRM_PAUSE_SECONDS)

    def _wait_until_slower(self) -> None:
        """Wait until the drive slows down or is off: it is in operation enabled until the ramp has ended."""
        before = self._read_speed()
        within = patience(self._slope and self._unit * self._slope[0] / self._slope[1], least=CONFIRM_SECONDS)
        deadline = time.monotonic() + within
        while (state := self._read_state()) is State.OPERATION_ENABLED:
            speed = self._read_speed()
            if speed <= self._unit or falls(speed, since=before, step=self._unit):
                return
            if time.monotonic() > deadline:
                raise LinkLost(
                    f"{self._name}: the drive took the command 'ramp' but did not obey within {within:.2g} s; "
                    f"it is {state} at {speed * RPM:.0f} rpm, {before * RPM:.0f} rpm before"
                )
            time.sleep(CONFIRM_PAUSE_SECONDS)

    def _read_speed(self) -> float:
        return abs(self._read(cia402.ACTUAL)) * self._unit

    def _read_state(self) -> State:
        return self._decode(self._read(cia402.STATUSWORD))

    def _decode(self, word: int) -> State:
        try:
            return cia402.decode_state(word)
        except BadFrame as error:
            raise LinkLost(f"{self._name}: {error}") from error

    def _describe_fault(self, state: State) -> str:
        """Return what is wrong: the error of a trip, or else of an emergency not yet taken back; empty for nothing."""
        code = self._link.emergency
        if state in cia402.FAULTED:
            code = self._read_if_there(cia402.ERROR_CODE) or code
            return cia402.describe_error(code) if code else "fault without an error code"
        return cia402.describe_error(code) if code else ""

    def _refuse_tripped(self, state: State) -> None:
        if state in cia402.FAULTED:
            raise LimitExceeded(f"drive: has tripped with '{self._describe_fault(state)}'; {REMEDY}")

    def _refuse_restarted(self) -> None:
        if self._link.restarted:
            raise LinkLost(f"{self._name}: the node has started anew and lost its configuration; open it again")

    def _read(self, item: Item) -> int:
        try:
            return self._link.read(item)
        except Refused as refusal:
            raise LinkLost(str(refusal)) from refusal

    def _write(self, item: Item, value: int, stops_before: int | None = None) -> None:
        try:
            self._link.write(item, value, stops_before=stops_before)
        except Refused as refusal:
            raise LinkLost(str(refusal)) from refusal

    @property
    def _link(self) -> CanLink:
        if self._can is None:
            raise LinkLost(f"{self._name}: the link is not open")
        return self._can
