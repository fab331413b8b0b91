"""Who talks to the motor controller during a sweep, so that the loop that watches the samples never waits for a wire.

`ThreadedControl` has one thread for readings and commands and one for stops alone: a stop goes out while a command or
a reading is still under way, at most one exchange later. Nobody who calls it waits. Readings are taken only while the
loop shows that it lives: of a program that hangs the drive hears nothing more, and its own watchdog stops the rotor.

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
STALL = 3.0  # s without a sign of life after which the loop is taken to hang; a silent DAQ is waited for 2 s
STOP_PAUSE = 0.2  # s between tries


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """One reading of the controller."""

    state: MotorState
    orders: int  # commands that had been carried out before


@dataclass(frozen=True, slots=True, kw_only=True)
class StopReport:
    """What became of a stop; times on the control's clock [s], NaN: not yet."""

    kind: Stop
    handed: float = math.nan  # when the driver was first called
    confirmed: float = math.nan  # when the drive had obeyed
    tries: int = 0
    trouble: str = ""  # why the last try failed

    def after(self, trouble: str, now: float) -> Self:
        """Return the report after one more try, which failed by `trouble`, or did not if that is empty."""
        return replace(self, tries=self.tries + 1, trouble=trouble, confirmed=math.nan if trouble else now)


Order = Callable[[], None]


class MotorControl(Protocol):
    """The motor controller as the session sees it. Nothing but `close` waits."""

    @property
    def report(self) -> StopReport | None:
        """What became of the last stop; None: there was none."""
        ...

    def start(self) -> None:
        """Begin to read."""
        ...

    def beat(self) -> None:
        """Say that the loop lives; readings are taken for `STALL` seconds after that."""
        ...

    def send(self, order: Order) -> int:
        """Have a command carried out, unless a stop comes first; return its number, counted from 1."""
        ...

    def hurry(self) -> None:
        """Ask for a reading soon."""
        ...

    def readings(self) -> list[Reading]:
        """Return the readings since the last call. Raises what a reading or command has raised, once, until a stop."""
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
    """A MotorControl with threads of its own."""

    def __init__(
        self, motor: MotorDriver, *, every: float = READ_EVERY, watchdog: float = math.inf, clock: Clock | None = None
    ) -> None:
        """Take an opened motor to be read `every` so many seconds; after `watchdog` seconds of silence it stops."""
        self._motor, self._every, self._watchdog, self._clock = motor, every, watchdog, clock or WallClock()
        self._orders: queue.SimpleQueue[Order | None] = queue.SimpleQueue()  # None: look at what is due
        self._stops: queue.SimpleQueue[Stop | None] = queue.SimpleQueue()  # its `put` may interrupt itself
        self._found: deque[Reading] = deque()
        self._faults: deque[Exception] = deque()
        self._using = threading.Lock()  # held while the worker is at the wire
        self._ordering = False  # the worker carries out a command
        self._halted = self._ended = self._soon = self._lost = False
        self._sent = self._done = 0
        self._read_at = -math.inf
        self._spoken_at = math.inf  # when the last reading or command ended; infinite: there was none
        self._beat = self._clock.now()
        self._report: StopReport | None = None
        self._threads = [
            threading.Thread(target=self._stop_all, name="motor stop", daemon=True),
            threading.Thread(target=self._work, name="motor", daemon=True),
        ]

    @property
    def report(self) -> StopReport | None:
        """What became of the last stop; None: there was none."""
        return self._report

    def start(self) -> None:
        """Begin to read, and be ready to stop."""
        for thread in self._threads:
            thread.start()

    def beat(self) -> None:
        """Say that the loop lives."""
        self._beat = self._clock.now()

    def send(self, order: Order) -> int:
        """Have a command carried out, unless a stop comes first; return its number, counted from 1."""
        self._sent += 1
        self._orders.put(order)
        return self._sent

    def hurry(self) -> None:
        """Ask for a reading soon."""
        if not self._soon:
            self._soon = True
            self._orders.put(None)

    def readings(self) -> list[Reading]:
        """Return the readings since the last call. Raises what a reading or command has raised, once."""
        if self._faults and not self._halted:
            raise self._faults.popleft()
        found = []
        while self._found:
            found.append(self._found.popleft())
        return found

    def stop(self, kind: Stop) -> None:
        """Send a stop at once."""
        self._halted = True
        self._report = StopReport(kind=kind)
        self._stops.put(kind)

    def close(self) -> None:
        """End the threads; may be called twice. Does not stop the rotor."""
        self._ended = True
        self._orders.put(None)
        self._stops.put(None)
        for thread in self._threads:
            if thread.is_alive():
                thread.join()

    def _work(self) -> None:
        """Carry out commands and take readings until the end."""
        while not self._ended:
            try:
                order = self._orders.get(timeout=self._until_due())
            except queue.Empty:
                order = None
            try:
                with self._using:
                    self._carry_out(order)
                    self._read_if_due()
            except Exception as fault:  # raised by `readings`, in the thread that can act on it
                self._lost = True
                if not self._halted:
                    self._faults.append(fault)
                elif self._report:
                    self._stops.put(self._report.kind)  # until the link is back: the drive may have lost its power

    def _until_due(self) -> float:
        """Return the seconds until the next reading is due; while none may be taken, until the next look."""
        if self._lost or self._clock.now() - self._beat > STALL:
            return self._every
        return max(0.0, self._read_at + (READ_SOON if self._soon else self._every) - self._clock.now())

    def _carry_out(self, order: Order | None) -> None:
        if order is None:
            return
        self._ordering = True
        try:
            if not self._halted:
                self._see_that_it_has_listened()
                order()
                self._spoken_at = self._clock.now()
                self._soon = True
        finally:
            self._done += 1  # of one that failed or came after a stop, too: a later reading is later than it
            self._ordering = False

    def _see_that_it_has_listened(self) -> None:
        """Raise LimitExceeded if this program has hung for so long that the drive may have stopped the rotor by itself.

        A command that was decided before would start it again, with somebody's hands at it perhaps.
        """
        if (silent := self._clock.now() - self._spoken_at) > self._watchdog:
            raise LimitExceeded(
                f"drive: was not spoken to for {silent:.1f} s, as this program hung; "
                f"its watchdog stops the rotor after {self._watchdog:g} s"
            )

    def _read_if_due(self) -> None:
        if self._ended or self._until_due() > 0:
            return
        self._soon = False
        orders = self._done
        state = self._motor.read()
        self._read_at = self._spoken_at = self._clock.now()
        self._found.append(Reading(state=state, orders=orders))

    def _stop_all(self) -> None:
        """Send one stop after the other, each until it is confirmed or another stands instead."""
        while (kind := self._stops.get()) is not None:
            report = StopReport(kind=kind, handed=self._clock.now())
            while True:
                report = self._tried(report)
                if not self._stops.empty():
                    break
                self._report = report
                if not report.trouble or self._ended:
                    break
                self._clock.sleep(STOP_PAUSE)

    def _tried(self, report: StopReport) -> StopReport:
        """Try to stop and return what came of it."""
        overtaken, trouble = self._ordering, ""
        try:
            if report.tries:
                self._reopen()
            self._motor.stop(report.kind)
            if overtaken:  # the command it went ahead of may have started the drive again
                with self._using:
                    self._motor.stop(report.kind)
            self._lost = False
        except Exception as error:  # whatever went wrong: what matters now is that the rotor stops
            trouble = str(error) or type(error).__name__
        return report.after(trouble, self._clock.now())

    def _reopen(self) -> None:
        """Open the link anew: it may have been unplugged and be back under the same name."""
        self._lost = True  # no readings meanwhile
        with self._using:
            self._motor.open()


class DirectControl:
    """A MotorControl in the caller's thread: what is due is done in `beat`."""

    def __init__(self, motor: MotorDriver, *, clock: Clock, every: float = READ_EVERY) -> None:
        """Take an opened motor to be read `every` so many seconds of `clock`."""
        self._motor, self._every, self._clock = motor, every, clock
        self._found: list[Reading] = []
        self._faults: list[Exception] = []
        self._read_at = self._tried_at = -math.inf
        self._sent = 0
        self._started = self._halted = self._lost = False
        self._report: StopReport | None = None

    @property
    def report(self) -> StopReport | None:
        """What became of the last stop; None: there was none."""
        return self._report

    def start(self) -> None:
        """Begin to read."""
        self._started = True

    def beat(self) -> None:
        """Take a reading and try a stop again if it is time to."""
        if self._report and self._report.trouble and self._clock.now() - self._tried_at >= STOP_PAUSE:
            self._try(reopen=True)
        if self._clock.now() - self._read_at >= self._every:
            self._read()

    def send(self, order: Order) -> int:
        """Carry out a command, unless there was a stop; return its number, counted from 1."""
        self._sent += 1
        if not self._halted:
            self._guarded(order)
        return self._sent

    def hurry(self) -> None:
        """Take a reading, unless there was one just now."""
        if self._clock.now() - self._read_at >= READ_SOON:
            self._read()

    def readings(self) -> list[Reading]:
        """Return the readings since the last call. Raises what a reading or command has raised, once."""
        if self._faults and not self._halted:
            raise self._faults.pop(0)
        found, self._found = self._found, []
        return found

    def stop(self, kind: Stop) -> None:
        """Send a stop."""
        self._halted = True
        self._report = StopReport(kind=kind, handed=self._clock.now())
        self._try(reopen=False)

    def close(self) -> None:
        """Do nothing: there are no threads."""

    def _read(self) -> None:
        if self._started and not self._lost:
            self._read_at = self._clock.now()
            self._guarded(lambda: self._found.append(Reading(state=self._motor.read(), orders=self._sent)))

    def _guarded(self, do: Order) -> None:
        try:
            do()
        except Exception as fault:
            self._lost = True
            if not self._halted:
                self._faults.append(fault)
            elif self._report:
                self._report = self._report.after(str(fault), self._clock.now())  # so that it is tried again

    def _try(self, *, reopen: bool) -> None:
        report, trouble = self._report, ""
        assert report is not None
        self._tried_at = self._clock.now()
        try:
            if reopen:
                self._motor.open()
            self._motor.stop(report.kind)
            self._lost = False
        except Exception as error:
            trouble = str(error) or type(error).__name__
        self._report = report.after(trouble, self._clock.now())
