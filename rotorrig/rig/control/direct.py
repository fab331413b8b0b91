"""Motor control in the caller's thread, by the caller's clock: for sweeps that must be repeatable."""

import math
from collections.abc import Callable

from rotorrig.rig.clock import Clock
from rotorrig.rig.control.base import READ_EVERY, READ_SOON, STOP_RETRY, Command, Reading, StopReport
from rotorrig.rig.motor import MotorDriver, Stop


class DirectControl:
    """Motor control in the caller's thread: what is due is done in `beat`."""

    def __init__(self, motor: MotorDriver, *, clock: Clock, every: float = READ_EVERY) -> None:
        """Take an opened motor to be read `every` so many seconds of `clock`."""
        self._motor, self._every, self._clock = motor, every, clock
        self._readings: list[Reading] = []
        self._faults: list[Exception] = []
        self._last_reading = self._last_try = self._silent_until = -math.inf
        self._commands_sent = 0
        self._started = self._stopping = self._link_lost = self._link_closed = False
        self._report: StopReport | None = None

    @property
    def report(self) -> StopReport | None:
        """Progress of the last stop; None: there was none."""
        return self._report

    def start(self) -> None:
        """Start to take readings."""
        self._started = True

    def beat(self, processed: float) -> None:
        """Take a reading that is due, and try a stop again that failed."""
        if self._clock.now() < self._silent_until:
            return
        if self._report and self._report.trouble and self._clock.now() - self._last_try >= STOP_RETRY:
            self._try_stop(reopen=True)
        if self._clock.now() - self._last_reading >= self._every:
            self._read()

    def send(self, command: Command) -> int:
        """Carry out a command, unless there was a stop; return its number, counted from 1."""
        self._commands_sent += 1
        if not self._stopping:
            self._try_exchange(lambda: command(self._motor))
        return self._commands_sent

    def read_soon(self) -> None:
        """Take a reading, unless there was one just now."""
        if self._clock.now() - self._last_reading >= READ_SOON and self._clock.now() >= self._silent_until:
            self._read()

    def take_readings(self) -> list[Reading]:
        """Return the readings since the last call. Raises what a reading or command has raised, once."""
        if self._faults and not self._stopping:
            raise self._faults.pop(0)
        readings, self._readings = self._readings, []
        return readings

    def stop(self, kind: Stop) -> None:
        """Send a stop."""
        self._stopping, self._silent_until = True, -math.inf
        self._report = StopReport(kind=kind, handed=self._clock.now())
        self._try_stop(reopen=self._link_closed)

    def fall_silent(self, seconds: float, *, closed: bool = False) -> None:
        """Send nothing for so long, or until another stop; with `closed`, on a link that is closed meanwhile."""
        self._silent_until = self._clock.now() + seconds
        if closed:
            self._motor.close()
            self._link_lost = self._link_closed = True

    def close(self, *, at_rest: bool = True) -> None:
        """Do nothing: there are no threads."""

    def _read(self) -> None:
        if self._started and not self._link_lost:
            self._last_reading = self._clock.now()
            self._try_exchange(
                lambda: self._readings.append(Reading(state=self._motor.read(), commands_done=self._commands_sent))
            )

    def _try_exchange(self, exchange: Callable[[], None]) -> None:
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
                self._link_closed = False
            self._motor.stop(report.kind)
            self._link_lost = False
        except Exception as error:
            trouble = str(error) or type(error).__name__
        self._report = report.after_try(trouble, self._clock.now())
