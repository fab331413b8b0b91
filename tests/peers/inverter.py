"""Output stage of a drive: ramp generator, stops, trips, watchdog; and what can be wrong with it."""

import random
import time
from collections.abc import Callable
from dataclasses import dataclass

from tests.peers.journal import Journal

Clock = Callable[[], float]


@dataclass(slots=True)
class Switches:
    """What is wrong with a drive; all off in a sound one."""

    ignores_stop: bool = False  # every stop is acknowledged and nothing is done; the output jitters by 0.02 Hz
    only_coast: bool = False  # ramped and quick stops are acknowledged and nothing is done
    deaf: bool = False  # every command is acknowledged and nothing is done; its watchdog still stops it
    reports_zero: bool = False  # its speed reads 0
    stale: bool = False  # what it reports stands still
    no_watchdog: bool = False  # silence does not stop it, whatever was set
    runs_at: float | None = None  # rpm put out, whatever is asked; it reports what was asked
    speed_factor: float = 1.0  # of the output, e.g. 2 for half the pole pairs
    backward: bool = False  # it turns the other way, and says so where its protocol can (not on the line protocol)


@dataclass(frozen=True, slots=True)
class Report:
    """What a drive says of itself, speeds in rpm by its own count."""

    output: float
    target: float
    on: bool
    stopping: bool
    fault: int
    backward: bool = False

    @property
    def at_target(self) -> bool:
        """True at the speed asked for."""
        return self.on and not self.stopping and abs(self.output - self.target) < 0.5


class Inverter:
    """Ramps an output [rpm, by the drive's own count] to its target; a stop ends with the output off."""

    def __init__(self, journal: Journal, *, clock: Clock = time.monotonic, seed: int = 0) -> None:
        """Start at rest, with a ramp of 100 rpm/s and no watchdog."""
        self.switches = Switches()
        self.up = self.down = 100.0  # rpm/s
        self.quick = 1000.0  # rpm/s, of a quick stop
        self.watchdog = 0.0  # s of silence; 0: none
        self.watchdog_stops_by = "trip"  # or a kind of stop
        self.watchdog_fault = 0
        self.fault = 0
        self.shaft: Clock = lambda: 0.0  # rpm of the rotor, which a start catches
        self.on = False
        self.output = self.target = 0.0
        self._stop: str | None = None  # kind under way
        self._journal, self._clock, self._rng = journal, clock, random.Random(seed)
        self._heard = clock()
        self._last: Report | None = None

    def heard(self) -> None:
        """Take note of a request: the master is alive."""
        self._heard = self._clock()

    @property
    def silent_for(self) -> float:
        """Seconds since the last request."""
        return self._clock() - self._heard

    def run(self, target: float) -> bool:
        """Go to `target` rpm, from the speed of a rotor that turns; False if a fault is in the way."""
        self._journal.event("command", kind="run", rpm=round(target, 2))
        if self.fault:
            return False
        if self.switches.deaf:
            return True
        if not self.on:
            self.output = self.shaft()
        self.on, self._stop, self.target = True, None, target
        return True

    def stop(self, kind: str) -> None:
        """Stop by `ramp`, `quick` or `coast`; one never takes back a harder one."""
        self._journal.event("command", kind=kind, on=self.on)
        switches = self.switches
        if switches.deaf or switches.ignores_stop or (switches.only_coast and kind != "coast"):
            return
        if kind == "coast":
            self.switch_off()
        elif self.on and not (self._stop == "quick" and kind == "ramp"):
            self._stop, self.target = kind, 0.0

    def switch_off(self) -> None:
        """Cut the output: the rotor coasts."""
        self.on, self._stop, self.output, self.target = False, None, 0.0, 0.0

    def trip(self, code: int) -> None:
        """Cut the output and remember a fault."""
        self._journal.event("trip", code=code)
        self.fault = code
        self.switch_off()

    def clear(self) -> None:
        """Forget the fault."""
        self.fault = 0

    def advance(self, seconds: float) -> float | None:
        """Ramp for `seconds`; return the speed put on the shaft [rpm], None if the output is off."""
        if self.on and self.watchdog and self.silent_for > self.watchdog and not self.switches.no_watchdog:
            self._bite()
        if not self.on:
            return None
        rate = self.quick if self._stop == "quick" else (self.up if self.target > self.output else self.down)
        change = rate * seconds
        self.output += max(-change, min(change, self.target - self.output))
        if self._stop and self.output <= 0.0:
            self.switch_off()
            return None
        if self.switches.runs_at is not None:
            return self.switches.runs_at
        jitter = self._rng.uniform(-1.2, 1.2) if self.switches.ignores_stop else 0.0  # 0.02 Hz at 60 rpm/Hz
        return self.output * self.switches.speed_factor + jitter

    def report(self) -> Report:
        """Return what the drive says of itself."""
        jitter = self._rng.uniform(-1.2, 1.2) if self.switches.ignores_stop and self.on else 0.0
        backward = self.switches.backward and self.output > 0
        now = Report(self.output + jitter, self.target, self.on, self._stop is not None, self.fault, backward)
        if self.switches.stale and self._last is not None:
            return self._last
        self._last = now
        if self.switches.reports_zero:
            return Report(0.0, now.target, now.on, now.stopping, now.fault)
        return now

    def _bite(self) -> None:
        """Do what the watchdog is set to do after so much silence."""
        self._journal.event("watchdog", after=round(self.silent_for, 3))
        self.heard()
        if self.watchdog_stops_by == "trip":
            self.trip(self.watchdog_fault)
            return
        self.fault = self.watchdog_fault
        if self.watchdog_stops_by == "coast":
            self.switch_off()
        elif self._stop != "quick":
            self._stop, self.target = self.watchdog_stops_by, 0.0
