"""Driver of home-built controllers on the line protocol of docs/motor-line.md: the order of the requests.

The lines are in `line_frames`, the port in `line_link`.
"""

import math
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

from rotorrig.rig.config import LineController
from rotorrig.rig.errors import BadFrame, LimitExceeded, LinkLost
from rotorrig.rig.motor import line_frames
from rotorrig.rig.motor.base import REMEDY, MotorInfo, MotorState, Stop
from rotorrig.rig.motor.line_frames import Identity
from rotorrig.rig.motor.line_link import LineLink, Refused
from rotorrig.rig.serial_port import ReopenedPort

BOOT_SECONDS = 3.0  # boards that start anew when their port is opened boot in about two
CONFIRM_SECONDS = 1.0  # for the state to follow a command
CONFIRM_PAUSE_SECONDS = 0.02

_REQUESTS = {Stop.RAMP: "STOP RAMP", Stop.COAST: "STOP COAST", Stop.EMERGENCY: "STOP EMERGENCY"}


class LineMotor:
    """A rig.motor.base.MotorDriver for controllers of the line protocol."""

    def __init__(self, table: LineController) -> None:
        self.port = table.port
        self._baudrate = table.baudrate
        self._max_speed = table.max_speed  # rad/s, the config's
        self._watchdog = table.watchdog  # s
        self._name = f"line protocol, {table.port}, {table.baudrate} baud"
        self._reopened = ReopenedPort(table.port)
        self._link: LineLink | None = None
        self._identity = Identity(max_speed=0.0, max_ramp=0.0, has_encoder=False, model="")

    def open(self) -> MotorInfo:
        """Open the port anew, check who answers and set its watchdog. Raises LinkLost."""
        self.close()
        self._reopened.check()
        self._link = LineLink(self.port, baudrate=self._baudrate, name=self._name)
        try:
            self._identity = self._read_identity()
            watchdog = self._set_watchdog()
        except BaseException:
            self.close()
            raise
        return MotorInfo(model=self._identity.model, link=self._name, watchdog=watchdog)

    def read(self) -> MotorState:
        """Read the controller's state; its speed is the encoder's, if it has one. Raises LinkLost."""
        try:
            return line_frames.decode_state(self._ask("STATE"))
        except BadFrame as error:
            raise LinkLost(f"{self._name}: {error}") from error

    def set_speed(self, speed: float, *, ramp: float) -> None:
        """Go to `speed` [rad/s] at `ramp` [rad/s^2], starting if at rest.

        Raises LimitExceeded if the speed is too high or a fault is remembered, ConfigError if the controller has no
        such ramp, LinkLost if it does not answer or does not start. Nothing is sent if speed or ramp is refused.
        """
        fastest = min(self._max_speed, self._identity.max_speed)
        wanted = line_frames.encode_speed(speed, fastest=fastest)
        slope = line_frames.encode_ramp(ramp, steepest=self._identity.max_ramp)
        self._ask(f"SPEED {wanted} {slope}")
        self._confirm(lambda state: not line_frames.is_stopped(state), "SPEED")

    def stop(self, kind: Stop) -> None:
        """Bring the rotor to rest: RAMP at the last ramp, COAST unpowered, EMERGENCY at the controller's max ramp.

        The stop goes out before anything that waits. Raises LinkLost if the controller does not take it, or does not
        say that it stops.
        """
        self._ask(_REQUESTS[kind], first=True)
        self._confirm(line_frames.is_off if kind is Stop.COAST else line_frames.is_stopped, _REQUESTS[kind])

    def clear_fault(self) -> None:
        """Clear the fault the controller remembers. Raises LimitExceeded while its cause stays, LinkLost."""
        self._ask("CLEAR")

    def close(self) -> None:
        """Give the port back. Does not stop the rotor; the controller's watchdog will."""
        link, self._link = self._link, None
        if link:
            link.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _read_identity(self) -> Identity:
        try:
            return line_frames.decode_identity(self._ask("ID", seconds=BOOT_SECONDS))
        except BadFrame as error:
            raise LinkLost(f"{self._name}: the controller's answer cannot be used: {error}") from error

    def _set_watchdog(self) -> float | None:
        """Set the watchdog; return the time [s] in force, None if the controller has none."""
        answer = self._ask(f"WATCHDOG {math.ceil(self._watchdog * 1000)}")
        if not answer.isdecimal():
            raise LinkLost(f"{self._name}: asked to set its watchdog, it says '{answer}', want the time in ms")
        return int(answer) / 1000 or None

    def _confirm(self, obeyed: Callable[[str], bool], command: str) -> None:
        """Wait until the state shows that the controller has obeyed a command."""
        deadline = time.monotonic() + CONFIRM_SECONDS
        while not obeyed(state := self._ask("STATE")):
            if time.monotonic() > deadline:
                raise LinkLost(
                    f"{self._name}: the controller took '{command}' but did not obey within {CONFIRM_SECONDS:g} s; "
                    f"its state is '{state}'"
                )
            time.sleep(CONFIRM_PAUSE_SECONDS)

    def _ask(self, request: str, *, first: bool = False, seconds: float = 0.0) -> str:
        """Ask and return the answer. Raises LimitExceeded or LinkLost for what the controller refuses."""
        link = self._link
        if link is None:
            raise LinkLost(f"{self._name}: asked '{request}', but the link is not open")
        try:
            return link.ask(request, first=first, seconds=seconds)
        except Refused as refusal:
            if refusal.code == "fault":
                remedy = "its cause is still there" if request == "CLEAR" else REMEDY
                raise LimitExceeded(f"controller: has tripped with '{refusal.reason}'; {remedy}") from refusal
            if refusal.code == "limit":
                raise LimitExceeded(str(refusal)) from refusal
            raise LinkLost(str(refusal)) from refusal
