"""Guardian of a sweep: a process that owns the motor link and stops the rotor whatever becomes of the sweep's own.

`python -m rotorrig.rig.control.guardian DESCRIPTOR`, in a session of its own, started by `GuardedControl`. It hears the
sweep's process say after every block up to which sample it has come. When that process ends, or has not processed a
sample for the time given, or the computer slept, the guardian stops the rotor, harder if the drive does not obey, and
writes what it did beside the recording. It has no samples, so it never says that the rotor is at rest. It goes on until
`rotor stop` takes over, or until its time is up.
"""

import contextlib
import json
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import asdict
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from rotorrig.rig import connect
from rotorrig.rig.clock import WallClock
from rotorrig.rig.config import Motor, read_motor, read_power_cut
from rotorrig.rig.control import registry
from rotorrig.rig.control.base import Reading, SetSpeed, StopForNow
from rotorrig.rig.control.ladder import Ladder, Measure
from rotorrig.rig.control.line import CHUNK, Line, Message
from rotorrig.rig.control.power_cut import cut_power
from rotorrig.rig.control.sleep import SleepGuard
from rotorrig.rig.control.threaded import ThreadedControl
from rotorrig.rig.motor import MotorInfo, Stop

LOOK = 0.02  # s between looks at who has fallen silent
SIGN_OF_LIFE = 0.1  # s between ours
REPEAT = 2.0  # s between stops to a drive that says that it is off
FRESH = 1.0  # s for which a reading counts
ASK_SECONDS = 0.2  # for who asks at the socket to say what: meanwhile this loop stands still


class Guardian:
    """The loop of the guardian; `order` is the first message of the sweep's process."""

    def __init__(self, line: Line, order: Message) -> None:
        self._line, self._order = line, order
        self._table: Motor = read_motor(order["motor"])
        cut = order["power_cut"]
        self._power_cut = read_power_cut(cut) if cut else None
        self._motor = connect.driver_of(self._table)
        self._clock = WallClock()
        self._control = ThreadedControl(
            self._motor, every=order["every"], watchdog=self._table.watchdog, clock=self._clock
        )
        self._info: MotorInfo | None = None
        self._parent = os.getppid()
        self._sleep = SleepGuard()
        self._server: socket.socket | None = None
        self._logs = [Path(order["log"]), registry.guardian_log(self._table)]
        self._started = self._over = self._failed = False
        self._armed = False  # a speed was sent: from here on samples have to be processed
        self._stopping = False  # a stop for good was sent, by whomever
        self._reason = ""  # why the guardian acts; empty: it does not
        self._orphan_since: float | None = None
        self._processed = -1.0  # sample time [s] the sweep's process has come to
        self._progress_at = self._beat_at = self._looked_at = self._clock.now()
        self._stops = 0  # number of the stop the present report is of
        self._told: Any = None
        self._told_at = self._repeated_at = 0.0
        self._reading: Reading | None = None
        self._read_at = -1.0
        self._ladder = Ladder(ramp=1.0, watchdog=None, power_cut=False)

    def run(self) -> None:
        """Open the link and guard it until the sweep's process says that all is well, or until time is up."""
        try:
            self._info = self._motor.open()
            self._server = registry.serve(self._table)
        except Exception as error:
            self._line.tell(refused=str(error), kind=type(error).__name__)
            self._motor.close()
            return
        self._ladder = Ladder(ramp=1.0, watchdog=self._info.watchdog, power_cut=self._power_cut is not None)
        self._line.tell(opened=asdict(self._info), pid=os.getpid(), awake=self._sleep.start())
        try:
            while not self._over:
                for message in self._line.hear(LOOK):
                    self._attempt(partial(self._obey, message))
                for work in (self._answer, self._watch, self._tell):
                    self._attempt(work)
        finally:
            self._sleep.end()
            self._control.close()
            self._motor.close()
            self._end_service()

    def _attempt(self, work: Callable[[], None]) -> None:
        """Do a part of the loop; a defect in it stops the rotor and does not end the loop."""
        try:
            work()
        except Exception as defect:
            if self._failed or not self._started:
                return
            self._failed = True  # said once, and no stop for every turn of the loop
            self._intervene(f"a defect of the guardian ({type(defect).__name__}: {defect})")

    def _obey(self, message: Message) -> None:
        match message:
            case {"beat": processed}:
                self._take_beat(processed)
            case {"set_speed": speed, "ramp": ramp}:
                self._armed, self._progress_at = True, self._clock.now()
                self._control.send(SetSpeed(speed=speed, ramp=ramp))
            case {"stop_for_now": kind}:
                self._control.send(StopForNow(kind=Stop(kind)))
            case {"stop": kind, "number": number}:
                self._stopping, self._stops = True, number
                self._control.stop(Stop(kind))
            case {"silence": seconds, "closed": closed}:
                self._control.fall_silent(seconds, closed=closed)
            case {"read_soon": _}:
                self._control.read_soon()
            case {"start": _}:
                self._started = True
                self._control.start()
            case {"close": at_rest}:
                self._over = at_rest or not self._started
                if not self._over:
                    self._orphan_since = self._clock.now()
                    self._intervene("the sweep's process ended with the rotor not proven at rest")

    def _take_beat(self, processed: float) -> None:
        now = self._clock.now()
        if processed > self._processed:
            self._processed, self._progress_at = processed, now
        self._beat_at = now
        self._control.beat(processed)
        if self._reason and self._orphan_since is None:
            self._write("the sweep's process goes on and has the stop in hand")
            self._reason = ""

    def _watch(self) -> None:
        """Act if the sweep's process is gone or stuck, or the computer slept."""
        now = self._clock.now()
        seconds, self._looked_at = now - self._looked_at, now
        if self._orphan_since is None and (self._line.ended or os.getppid() != self._parent):
            if not self._started:
                self._over = True
                return
            self._orphan_since = now
            self._intervene("the sweep's process is gone")
        if (slept := self._sleep.slept()) and self._armed:
            self._intervene(f"the computer slept for {slept:.0f} s")
        patience = self._order["patience"]
        if self._armed and not self._stopping and now - self._progress_at > patience:
            self._intervene(f"no sample was processed for {now - self._progress_at:.1f} s")
        if self._stopping and not self._reason and now - self._beat_at > patience + self._order["daq_silence"]:
            self._intervene("the sweep's process hangs during the stop")
        if self._reason:
            self._climb(now, seconds)

    def _intervene(self, reason: str) -> None:
        """Stop the rotor as fast as the drive can, and say why."""
        if self._reason and self._orphan_since is None:
            return
        self._reason = reason
        self._stopping = True
        self._control.stop(Stop.EMERGENCY)
        self._repeated_at = self._clock.now()
        self._ladder.begin(Measure.EMERGENCY, self._speed(self._clock.now()))
        self._line.tell(acted=reason)
        self._write(f"{reason}; sent the quick stop; whether the rotor turns is unknown from here on")

    def _climb(self, now: float, seconds: float) -> None:
        """Keep the readings going, repeat the stop, and take the next measure if the drive does not obey."""
        self._control.beat(self._processed)
        if self._orphan_since is not None and now - self._orphan_since > self._order["persist"]:
            self._write(f"gave up after {self._order['persist']:.0f} s; rotor: unknown")
            self._over = True
        elif self._reading and now - self._read_at < FRESH and not self._reading.state.running:
            if now - self._repeated_at > REPEAT:
                self._repeated_at = now
                self._control.stop(Stop.EMERGENCY)
        elif measure := self._ladder.advance(seconds, self._speed(now)):
            self._take(measure)

    def _take(self, measure: Measure) -> None:
        self._repeated_at = self._clock.now()
        if stop := measure.stop:
            self._control.stop(stop)
        elif measure is Measure.SILENCE:
            self._control.fall_silent(self._ladder.silence)
        elif self._power_cut:
            threading.Thread(target=self._cut_power, daemon=True).start()  # this loop goes on meanwhile
        self._write(f"the drive does not report that it slows down: {measure}")

    def _cut_power(self) -> None:
        assert self._power_cut
        self._write(cut_power(self._power_cut))

    def _speed(self, now: float) -> float | None:
        """Speed by the drive [rad/s]; None: it has not said of late."""
        return self._reading.state.speed if self._reading and now - self._read_at < FRESH else None

    def _tell(self) -> None:
        """Pass on readings, faults and the stop's progress, and give signs of life."""
        now = self._clock.now()
        try:
            readings = self._control.take_readings()
        except Exception as fault:
            self._line.tell(fault=str(fault), kind=type(fault).__name__)
            readings = []
        for reading in readings:
            self._reading, self._read_at = reading, now
            self._line.tell(reading=asdict(reading.state), commands_done=reading.commands_done)
        report = self._control.report
        if report is not None and report != self._told:
            self._told = report
            self._line.tell(report=asdict(report), number=self._stops)
        if now - self._told_at > SIGN_OF_LIFE:
            self._told_at = now
            self._line.tell(alive=now)

    def _answer(self) -> None:
        """Answer `rotor stop`, if it asks."""
        with contextlib.suppress(OSError, ValueError, AttributeError):  # nobody asks, or no question
            if self._server is None:
                return
            asker, _ = self._server.accept()
            with asker:
                asker.settimeout(ASK_SECONDS)
                ask = json.loads(asker.recv(CHUNK)).get("ask")
                orphan = self._orphan_since is not None
                answer = {"pid": os.getpid(), "sweep": None if orphan else self._parent, "reason": self._reason}
                if ask == "stop" and orphan:
                    self._write("'rotor stop' took over")
                    self._over = True
                    self._control.close()
                    self._motor.close()
                    self._end_service()  # before the answer: who takes over has one of its own
                elif ask == "stop":
                    self._intervene("'rotor stop' asked for it")
                asker.sendall(json.dumps(answer).encode() + b"\n")

    def _end_service(self) -> None:
        """Be asked nothing more; done once, as another guardian of this link may serve under the same name then."""
        if self._server is not None:
            registry.end_service(self._server)
            self._server = None

    def _write(self, text: str) -> None:
        """Write a line of what was done beside the recording; where that is impossible, into the temporary folder."""
        stamp = f"{datetime.now(UTC):%Y-%m-%d %H:%M:%S.%f}"[:-3]
        for path in self._logs:
            with contextlib.suppress(OSError, ValueError), path.open("a", encoding="utf-8") as file:
                file.write(f"{stamp} UTC guardian: {text}\n")
                return


def main() -> None:
    """Guard the link that the sweep's process orders; the descriptor of the line to it is the argument."""
    for number in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM, signal.SIGQUIT, signal.SIGTSTP):
        signal.signal(number, signal.SIG_IGN)  # the sweep's process hears them too; this one ends by its own rules
    line = Line(socket.socket(fileno=int(sys.argv[1])))
    patience = time.monotonic() + 10.0
    orders: list[Message] = []
    while not orders and not line.ended and time.monotonic() < patience:
        orders = line.hear(1.0)
    if not orders:
        return
    try:
        guardian = Guardian(line, orders[0])
    except Exception as error:
        line.tell(refused=str(error), kind=type(error).__name__)
        return
    guardian.run()


if __name__ == "__main__":
    main()
