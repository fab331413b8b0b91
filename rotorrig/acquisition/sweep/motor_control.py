"""Motor control during a sweep, on threads of its own: the loop that watches the samples never waits for a wire.

`ThreadedControl` has one thread for readings and commands and one for stops alone: a stop goes out while a command or
a reading is still under way, at most one exchange later. No caller waits. Readings are taken only while the loop gives
signs of life: when the program hangs, the drive hears nothing more and its own watchdog stops the rotor.

`DirectControl` does the same in the caller's thread, by the caller's clock: for tests that must be repeatable.
"""

import math
import queue
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol, Self

from rotorrig.rig import Clock, LimitExceeded, WallClock
from rotorrig.rig.motor import MotorDriver, MotorState, Stop

READ_EVERY = 0.25  # s between readings
READ_SOON = 0.05  # s, while the drive's word is all that is missing
LOOP_STALL = 3.0  # s without a sign of life after which the loop is taken to hang; a silent DAQ is waited for 2 s
STOP_RETRY = 0.2  # s between tries


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """One reading of the controller."""

    state: MotorState
    commands_done: int  # commands carried out before it


@dataclass(frozen=True, slots=True, kw_only=True)
class StopReport:
    """Progress of a stop; times on the control's clock [s], NaN: not yet."""

    kind: Stop
    handed: float = math.nan  # when the driver was first called
    confirmed: float = math.nan  # when the drive had obeyed
    tries: int = 0
    trouble: str = ""  # why the last try failed

    def after_try(self, trouble: str, now: float) -> Self:
        """Return the report after one more try, which failed by `trouble`, or succeeded if that is empty."""
        return replace(self, tries=self.tries + 1, trouble=trouble, confirmed=math.nan if trouble else now)


Command = Callable[[], None]


class MotorControl(Protocol):
    """Motor controller as the session sees it. Nothing but `close` waits."""

    @property
    def report(self) -> StopReport | None:
        """Progress of the last stop; None: there was none."""
        ...

    def start(self) -> None:
        """Start to take readings."""
        ...

    def beat(self) -> None:
        """Give a sign of life; readings are taken for `LOOP_STALL` seconds after it."""
        ...

    def send(self, command: Command) -> int:
        """Queue a command, to be carried out unless a stop comes first; return its number, counted from 1."""
        ...

    def read_soon(self) -> None:
        """Have the next reading taken soon."""
        ...

    def take_readings(self) -> list[Reading]:
        """Return the readings since the last call. Raises what a reading or command raised, once, until a stop."""
        ...

    def stop(self, kind: Stop) -> None:
        """Send a stop at once; commands after it are refused. What goes wrong is tried again, see `report`.

        May be called from a signal handler, and again with another kind, which then stands instead.
        """
        ...

    def close(self) -> None:
        """End the threads; may be called twice. Does not stop the rotor."""
        ...


class ThreadedControl:
    """Motor control with threads of its own."""

    def __init__(
        self, motor: MotorDriver, *, every: float = READ_EVERY, watchdog: float = math.inf, clock: Clock | None = None
    ) -> None:
        """Take an opened motor to be read `every` so many seconds; its drive stops after `watchdog` s of silence."""
        self._motor, self._every, self._watchdog, self._clock = motor, every, watchdog, clock or WallClock()
        self._commands: queue.SimpleQueue[Command | None] = queue.SimpleQueue()  # None: take a reading that is due
        self._stops: queue.SimpleQueue[Stop | None] = queue.SimpleQueue()  # its `put` may interrupt itself
        self._readings: deque[Reading] = deque()
        self._faults: deque[Exception] = deque()
        self._wire = threading.Lock()  # held while the worker is at the wire
        self._commanding = False  # the worker is carrying out a command
        self._stopping = self._closed = self._soon = self._link_lost = False
        self._commands_sent = self._commands_done = 0
        self._last_reading = -math.inf
        self._last_exchange = math.inf  # when the last reading or command ended; infinite: there was none
        self._last_beat = self._clock.now()
        self._report: StopReport | None = None
        self._threads = [
            threading.Thread(target=self._send_stops, name="motor stop", daemon=True),
            threading.Thread(target=self._send_commands_and_read, name="motor", daemon=True),
        ]

    @property
    def report(self) -> StopReport | None:
        """Progress of the last stop; None: there was none."""
        return self._report

    def start(self) -> None:
        """Start the threads: one takes readings, one stands ready to stop."""
        for thread in self._threads:
            thread.start()

    def beat(self) -> None:
        """Give a sign of life."""
        self._last_beat = self._clock.now()

    def send(self, command: Command) -> int:
        """Queue a command, to be carried out unless a stop comes first; return its number, counted from 1."""
        self._commands_sent += 1
        self._commands.put(command)
        return self._commands_sent

    def read_soon(self) -> None:
        """Have the next reading taken soon."""
        if not self._soon:
            self._soon = True
            self._commands.put(None)

    def take_readings(self) -> list[Reading]:
        """Return the readings since the last call. Raises what a reading or command has raised, once."""
        if self._faults and not self._stopping:
            raise self._faults.popleft()
        readings = []
        while self._readings:
            readings.append(self._readings.popleft())
        return readings

    def stop(self, kind: Stop) -> None:
        """Send a stop at once."""
        self._stopping = True
        self._report = StopReport(kind=kind)
        self._stops.put(kind)

    def close(self) -> None:
        """End the threads; may be called twice. Does not stop the rotor."""
        self._closed = True
        self._commands.put(None)
        self._stops.put(None)
        for thread in self._threads:
            if thread.is_alive():
                thread.join()

    def _send_commands_and_read(self) -> None:
        """Carry out commands and take readings, until closed."""
        while not self._closed:
            try:
                command = self._commands.get(timeout=self._until_due())
            except queue.Empty:
                command = None
            try:
                with self._wire:
                    self._carry_out(command)
                    self._read_if_due()
            except Exception as fault:  # raised by `take_readings`, in the thread that can act on it
                self._link_lost = True
                if not self._stopping:
                    self._faults.append(fault)
                elif self._report:
                    self._stops.put(self._report.kind)  # until the link is back: the drive may have lost its power

    def _until_due(self) -> float:
        """Seconds until the next reading is due; while none may be taken, until the next look."""
        if self._link_lost or self._clock.now() - self._last_beat > LOOP_STALL:
            return self._every
        return max(0.0, self._last_reading + (READ_SOON if self._soon else self._every) - self._clock.now())

    def _carry_out(self, command: Command | None) -> None:
        if command is None:
            return
        self._commanding = True
        try:
            if not self._stopping:
                self._check_watchdog()
                command()
                self._last_exchange = self._clock.now()
                self._soon = True
        finally:
            self._commands_done += 1  # of one that failed or came after a stop, too: a later reading is later than it
            self._commanding = False

    def _check_watchdog(self) -> None:
        """Raise LimitExceeded if this program hung for so long that the drive's watchdog may have stopped the rotor.

        A command decided before would start it again, perhaps with somebody's hands at it.
        """
        if (silent := self._clock.now() - self._last_exchange) > self._watchdog:
            raise LimitExceeded(
                f"drive: was not spoken to for {silent:.1f} s, as this program hung; "
                f"its watchdog stops the rotor after {self._watchdog:g} s"
            )

    def _read_if_due(self) -> None:
        if self._closed or self._until_due() > 0:
            return
        self._soon = False
        commands_done = self._commands_done
        state = self._motor.read()
        self._last_reading = self._last_exchange = self._clock.now()
        self._readings.append(Reading(state=state, commands_done=commands_done))

    def _send_stops(self) -> None:
        """Send one stop after the other, each until it is confirmed or another replaces it."""
        while (kind := self._stops.get()) is not None:
            report = StopReport(kind=kind, handed=self._clock.now())
            while True:
                report = self._try_stop(report)
                if not self._stops.empty():
                    break
                self._report = report
                if not report.trouble or self._closed:
                    break
                self._clock.sleep(STOP_RETRY)

    def _try_stop(self, report: StopReport) -> StopReport:
        """Try once to stop; return the report after it."""
        overtaken, trouble = self._commanding, ""
        try:
            if report.tries:
                self._reopen_link()
            self._motor.stop(report.kind)
            if overtaken:  # the command it went ahead of may have started the drive again
                with self._wire:
                    self._motor.stop(report.kind)
            self._link_lost = False
        except Exception as error:  # whatever went wrong: what matters now is that the rotor stops
            trouble = str(error) or type(error).__name__
        return report.after_try(trouble, self._clock.now())

    def _reopen_link(self) -> None:
        """Open the link anew: it may have been unplugged and be back under the same name."""
        self._link_lost = True  # no readings meanwhile
        with self._wire:
            self._motor.open()


class DirectControl:
    """Motor control in the caller's thread: what is due is done in `beat`."""

    def __init__(self, motor: MotorDriver, *, clock: Clock, every: float = READ_EVERY) -> None:
        """Take an opened motor to be read `every` so many seconds of `clock`."""
        self._motor, self._every, self._clock = motor, every, clock
        self._readings: list[Reading] = []
        self._faults: list[Exception] = []
        self._last_reading = self._last_try = -math.inf
        self._commands_sent = 0
        self._started = self._stopping = self._link_lost = False
        self._report: StopReport | None = None

    @property
    def report(self) -> StopReport | None:
        """Progress of the last stop; None: there was none."""
        return self._report

    def start(self) -> None:
        """Start to take readings."""
        self._started = True

    def beat(self) -> None:
        """Take a reading that is due, and try a stop again that failed."""
        if self._report and self._report.trouble and self._clock.now() - self._last_try >= STOP_RETRY:
            self._try_stop(reopen=True)
        if self._clock.now() - self._last_reading >= self._every:
            self._read()

    def send(self, command: Command) -> int:
        """Carry out a command, unless there was a stop; return its number, counted from 1."""
        self._commands_sent += 1
        if not self._stopping:
            self._try_exchange(command)
        return self._commands_sent

    def read_soon(self) -> None:
        """Take a reading, unless there was one just now."""
        if self._clock.now() - self._last_reading >= READ_SOON:
            self._read()

    def take_readings(self) -> list[Reading]:
        """Return the readings since the last call. Raises what a reading or command has raised, once."""
        if self._faults and not self._stopping:
            raise self._faults.pop(0)
        readings, self._readings = self._readings, []
        return readings

    def stop(self, kind: Stop) -> None:
        """Send a stop."""
        self._stopping = True
        self._report = StopReport(kind=kind, handed=self._clock.now())
        self._try_stop(reopen=False)

    def close(self) -> None:
        """Do nothing: there are no threads."""

    def _read(self) -> None:
        if self._started and not self._link_lost:
            self._last_reading = self._clock.now()
            self._try_exchange(
                lambda: self._readings.append(Reading(state=self._motor.read(), commands_done=self._commands_sent))
            )

    def _try_exchange(self, exchange: Command) -> None:
        try:
            exchange()
        except Exception as fault:
            self._link_lost = True
            if not self._stopping:
                self._faults.append(fault)
            elif self._report:
                self._report = self._report.after_try(str(fault), self._clock.now())  # so that the stop is tried again

    def _try_stop(self, *, reopen: bool) -> None:
        report, trouble = self._report, ""
        assert report is not None
        self._last_try = self._clock.now()
        try:
            if reopen:
                self._motor.open()
            self._motor.stop(report.kind)
            self._link_lost = False
        except Exception as error:
            trouble = str(error) or type(error).__name__
        self._report = report.after_try(trouble, self._clock.now())
