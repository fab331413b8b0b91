"""Motor control on threads: one for readings and commands, one for stops alone.

A stop goes out while a command or a reading is still under way, at most one exchange later. Readings are taken only
while the loop gives signs of life: when the program hangs, the drive hears nothing more and its own watchdog stops the
rotor.
"""

import math
import queue
import threading
from collections import deque

from rotorrig.rig.clock import Clock, WallClock
from rotorrig.rig.control.base import LOOP_STALL, READ_EVERY, READ_SOON, STOP_RETRY, Command, Reading, StopReport
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.motor import MotorDriver, Stop


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
        self._closing = self._link_closed = False  # the link is to be closed, is closed, for a silence
        self._commands_sent = self._commands_done = 0
        self._last_reading = -math.inf
        self._last_exchange = math.inf  # when the last reading or command ended; infinite: there was none
        self._last_beat = self._clock.now()
        self._silent_until = -math.inf
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

    def beat(self, processed: float) -> None:
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
        self._stopping, self._silent_until, self._closing = True, -math.inf, False
        self._report = StopReport(kind=kind)
        self._stops.put(kind)

    def fall_silent(self, seconds: float, *, closed: bool = False) -> None:
        """Send nothing for so long, or until another stop; with `closed`, on a link that is closed meanwhile."""
        self._silent_until = self._clock.now() + seconds
        if closed:
            self._closing = True
            self._commands.put(None)

    def close(self, *, at_rest: bool = True) -> None:
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
                    self._close_link_if_asked()
                    self._read_if_due()
            except Exception as fault:  # raised by `take_readings`, in the thread that can act on it
                self._link_lost = True
                if not self._stopping:
                    self._faults.append(fault)
                elif self._report:
                    self._stops.put(self._report.kind)  # until the link is back: the drive may have lost its power

    def _until_due(self) -> float:
        """Seconds until the next reading is due; while none may be taken, until the next look."""
        if self._link_lost or self._is_silent() or self._clock.now() - self._last_beat > LOOP_STALL:
            return self._every
        return max(0.0, self._last_reading + (READ_SOON if self._soon else self._every) - self._clock.now())

    def _is_silent(self) -> bool:
        return self._clock.now() < self._silent_until

    def _carry_out(self, command: Command | None) -> None:
        if command is None:
            return
        self._commanding = True
        try:
            if not self._stopping:
                self._check_watchdog()
                command(self._motor)
                self._last_exchange = self._clock.now()
                self._soon = True
        finally:
            self._commands_done += 1  # of one that failed or came after a stop, too: a later reading is later than it
            self._commanding = False

    def _close_link_if_asked(self) -> None:
        if self._closing:
            self._closing = False
            self._link_lost = self._link_closed = True  # until a stop has opened it again
            self._motor.close()

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
                self._wait_to_retry()

    def _wait_to_retry(self) -> None:
        self._clock.sleep(STOP_RETRY)
        while self._is_silent() and self._stops.empty() and not self._closed:
            self._clock.sleep(STOP_RETRY)

    def _try_stop(self, report: StopReport) -> StopReport:
        """Try once to stop; return the report after it."""
        overtaken, trouble = self._commanding, ""
        try:
            if report.tries or self._link_closed:
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
            self._link_closed = False
