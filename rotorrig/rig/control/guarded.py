"""Motor control through a guardian: the process that owns the motor link and outlives this one.

If the guardian dies or hangs, this process opens the link itself and stops the rotor.
"""

import contextlib
import socket
import subprocess
import sys
import threading
from collections import deque
from dataclasses import replace
from pathlib import Path
from typing import Any

from rotorrig.rig import connect, errors
from rotorrig.rig.clock import Clock, WallClock
from rotorrig.rig.config import RigConfig
from rotorrig.rig.control import registry
from rotorrig.rig.control.base import READ_EVERY, Command, Reading, SetSpeed, StopReport
from rotorrig.rig.control.line import Line, Message
from rotorrig.rig.control.threaded import ThreadedControl
from rotorrig.rig.errors import LimitExceeded, LinkLost, RigError
from rotorrig.rig.motor import MotorInfo, MotorState, Stop

PATIENCE = 0.5  # s without a processed sample, where the config does not say
PERSIST = 1800.0  # s for which the guardian goes on stopping a rotor that nobody looks after
START_SECONDS = 60.0  # for the guardian to start and open the link
HANG = 1.0  # s without a sign of life from the guardian
HEAR = 0.05  # s between looks at that
BEAT_EVERY = 0.02  # s between beats that are passed on
END_SECONDS = 5.0  # for the guardian to end
KILL_SECONDS = 1.0  # for a killed one to be gone


class GuardedControl:
    """A rig.control.MotorControl whose driver is in the guardian's process."""

    def __init__(
        self,
        rig: RigConfig,
        *,
        log: Path,
        at: connect.Place | None = None,
        every: float = READ_EVERY,
        patience: float = PATIENCE,
        persist: float = PERSIST,
        clock: Clock | None = None,
    ) -> None:
        """Take a rig; nothing is started yet.

        `log` is where the guardian writes what it did; `patience` [s], how long it waits for a processed sample;
        `persist` [s], how long it goes on stopping a rotor that nobody looks after.
        """
        self._table = connect.motor_table(rig, at=at)
        self._rig, self._at, self._every, self._clock = rig, at, every, clock or WallClock()
        cut = rig.power_cut
        self._order = {
            "motor": self._table.model_dump(),
            "power_cut": cut.model_dump() if cut else None,
            "every": every,
            "patience": patience,
            "persist": persist,
            "daq_silence": 2.0,
            "log": str(log.absolute()),
        }
        self._readings: deque[Reading] = deque()
        self._faults: deque[Exception] = deque()
        self._report: StopReport | None = None
        self._commands_sent = self._stops_sent = 0
        self._stopping = self._closed = self._soon = False
        self._beaten_at = -1.0
        self._opened: Message | None = None
        self._own: ThreadedControl | None = None  # once the guardian is gone
        self._process: subprocess.Popen[bytes] | None = None
        self._thread = threading.Thread(target=self._listen, name="guardian's line", daemon=True)

    @property
    def report(self) -> StopReport | None:
        """Progress of the last stop; None: there was none."""
        return self._own.report if self._own else self._report

    @property
    def guardian(self) -> int | None:
        """Process number of the guardian; None: there is none."""
        return self._process.pid if self._process else None

    def open(self) -> MotorInfo:
        """Start the guardian, which opens the link. Raises what the driver raises, LinkLost if it does not start."""
        self._refuse_second()
        here, there = socket.socketpair()
        with there:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", "rotorrig.rig.control.guardian", str(there.fileno())],
                pass_fds=[there.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
            )
        self._line = Line(here)
        self._line.tell(**self._order)
        until = self._clock.now() + START_SECONDS
        while self._clock.now() < until and not self._line.ended:
            for message in self._line.hear(HEAR):
                if "refused" in message:
                    self._end()
                    raise _error(message["kind"], message["refused"])
                if "opened" in message:
                    self._opened = message
                    self._heard_at = self._clock.now()
                    self._thread.start()
                    return MotorInfo(**{**message["opened"], "remarks": tuple(message["opened"]["remarks"])})
        self._end()
        raise LinkLost("guardian: the process that is to guard the motor link did not start")

    def start(self) -> None:
        """Start to take readings."""
        self._line.tell(start=True)

    def beat(self, processed: float) -> None:
        """Tell up to which sample time [s] the loop has come."""
        if self._own:
            self._own.beat(processed)
        elif (now := self._clock.now()) - self._beaten_at >= BEAT_EVERY:
            self._beaten_at = now
            self._line.tell(beat=processed)

    def send(self, command: Command) -> int:
        """Queue a command, to be carried out unless a stop comes first; return its number, counted from 1."""
        self._commands_sent += 1
        if isinstance(command, SetSpeed):
            self._line.tell(set_speed=command.speed, ramp=command.ramp)
        else:
            self._line.tell(stop_for_now=command.kind.value)
        self._soon = False
        return self._commands_sent

    def read_soon(self) -> None:
        """Have the next reading taken soon."""
        if not self._soon:
            self._soon = True
            self._line.tell(read_soon=True)

    def take_readings(self) -> list[Reading]:
        """Return the readings since the last call. Raises what a reading or command has raised, once, until a stop."""
        if self._faults and not self._stopping:
            raise self._faults.popleft()
        readings = []
        if self._own and self._stopping:  # no command was sent after its stop, so its readings are later than all
            readings = [replace(reading, commands_done=self._commands_sent) for reading in self._own.take_readings()]
        while self._readings:
            self._soon = False
            readings.append(self._readings.popleft())
        return readings

    def stop(self, kind: Stop) -> None:
        """Send a stop at once."""
        self._stopping = True
        self._stops_sent += 1
        self._report = StopReport(kind=kind)
        if self._own:
            self._own.stop(kind)
        else:
            self._line.tell(stop=kind.value, number=self._stops_sent)

    def fall_silent(self, seconds: float, *, closed: bool = False) -> None:
        """Send the drive nothing for so long, or until another stop; with `closed`, on a link closed meanwhile."""
        if self._own:
            self._own.fall_silent(seconds, closed=closed)
        else:
            self._line.tell(silence=seconds, closed=closed)

    def close(self, *, at_rest: bool = True) -> None:
        """End the guardian; with `at_rest` False it goes on without this process. May be called twice."""
        if self._closed:
            return
        self._closed = True
        if self._own:
            self._own.close()
            return
        if self._process is None:  # it did not start, or ended
            return
        self._line.tell(close=at_rest)
        if at_rest:
            self._end()

    def _refuse_second(self) -> None:
        """Raise LinkLost if another guardian holds this link."""
        if other := registry.ask_guardian(self._table, "state"):
            whose = f"for the sweep of process {other['sweep']}" if other["sweep"] else "of a sweep that is gone"
            raise LinkLost(
                f"motor: a guardian {whose} still holds its link; want it ended by `rotor stop CONFIG` first"
            )

    def _listen(self) -> None:
        """Take what the guardian says; take its place when it is gone."""
        while not self._closed and self._own is None:
            for message in self._line.hear(HEAR):
                self._heard_at = self._clock.now()
                with contextlib.suppress(TypeError, ValueError):  # of a message of another version
                    self._take(message)
            if self._closed:
                return
            if self._line.ended:
                self._take_over("its process ended")
            elif self._line.full or self._clock.now() - self._heard_at > HANG:
                self._take_over(f"nothing was heard of it for {HANG:g} s")

    def _take(self, message: Message) -> None:
        match message:
            case {"reading": state, "commands_done": done}:
                self._readings.append(Reading(state=MotorState(**state), commands_done=done))
            case {"report": report, "number": number} if number == self._stops_sent:
                self._report = StopReport(**{**report, "kind": Stop(report["kind"])})
            case {"fault": text, "kind": kind}:
                self._faults.append(_error(kind, text))
            case {"acted": reason}:
                self._faults.append(LimitExceeded(f"guardian: {reason}; it has stopped the rotor"))

    def _take_over(self, reason: str) -> None:
        """Open the link from this process and stop the rotor: the guardian does not do it any more."""
        self._end(kill=True)
        motor = connect.motor(self._rig, at=self._at)
        with contextlib.suppress(Exception):  # tried again with every stop
            motor.open()
        own = ThreadedControl(motor, every=self._every, watchdog=self._table.watchdog, clock=self._clock)
        own.start()
        self._own, sent = own, None
        while sent is not (kind := self._report.kind if self._report else Stop.EMERGENCY):
            own.stop(kind)  # again, if the program has just asked for another
            sent = kind
        self._faults.append(LinkLost(f"guardian: {reason}; the stop was sent without it"))

    def _end(self, *, kill: bool = False) -> None:
        """Wait for the guardian's end, or see to it."""
        process, self._process = self._process, None
        if process is None:
            return
        if not kill:
            try:
                process.wait(END_SECONDS)
            except subprocess.TimeoutExpired:
                kill = True
        if kill:
            process.kill()
            with contextlib.suppress(subprocess.TimeoutExpired):  # one stuck in a device is not waited for
                process.wait(KILL_SECONDS)
        if threading.current_thread() is not self._thread and self._thread.is_alive():
            self._thread.join(END_SECONDS)
        self._line.close()


def _error(kind: str, text: str) -> Exception:
    """Return the error of this program that the guardian met; another one as a LinkLost that names it."""
    known: Any = getattr(errors, kind, None)
    if isinstance(known, type) and issubclass(known, RigError):
        return known(text)
    return LinkLost(f"guardian: {kind}: {text}")
