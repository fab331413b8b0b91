"""The faults of the campaign: what is done, to what, and for how long."""

import itertools
import random
import zlib
from dataclasses import dataclass
from typing import Any

from benchmarks.parts.soak.controllers import CONTROLLERS, FOR_PAIRS, TOP

TURNS = 5.0  # rpm: the rotor has begun to turn
AT_TOP = 0.97 * TOP  # rpm
DWELL_SECONDS = 1.5  # at the top
RUN_DOWN_SECONDS = 3.0
RUN_UP = 8.5  # s from the first turn to the end of the dwell
RUN_UP_OF_ONE_RAMP = 6.3  # of a drive with one ramp, which need not settle at a gentle one
ONE_RAMP = ("m-max", "vfd-ed")


@dataclass(frozen=True, slots=True)
class Moment:
    """When a fault strikes, counted from when the rotor first exceeds a speed, another fault, or the first sample."""

    seconds: float
    above: float = 0.0  # rpm
    after: str = ""  # a fault


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """One fault; `switches` are those of the peer bench, the others befall the program."""

    name: str
    where: str  # "motor link", "drive", "DAQ", "sensor", "host", "program"
    words: str  # for the page
    switches: tuple[str, ...] = ()
    value: float | None = None  # of the switch; None: its own
    signal: str = ""
    seconds: float | None = None  # None: it stays
    single: bool = False  # not in pairs


def _switch(name: str, where: str, words: str, *, switch: str = "", **more: Any) -> Fault:
    return Fault(name=name, where=where, words=words, switches=(switch or name,), **more)


def _signal(name: str, words: str, *, signal: str = "", seconds: float | None = None) -> Fault:
    return Fault(name=name, where="program", words=words, signal=signal or name, seconds=seconds)


FAULTS = (
    _switch("link closed", "motor link", "the port goes away: unplugged, or reset and refused"),
    _switch("link silent", "motor link", "the port stays, nothing passes"),
    _switch("link dead for 4 s", "motor link", "the port goes away and comes back", switch="link closed", seconds=4.0),
    _switch("link delayed", "motor link", "every message comes 0.15 s late, for 3 s", seconds=3.0),
    _switch("link loses frames", "motor link", "a tenth of the messages is lost, for 5 s", seconds=5.0),
    _switch("link garbled", "motor link", "a tenth of the messages is spoiled, for 5 s", seconds=5.0),
    _switch("busy", "motor link", "two requests in a row are put off, every 0.7 s for 3 s", seconds=3.0),
    _switch("ignores stop", "drive", "it acknowledges every stop and does nothing; its output jitters by 0.02 Hz"),
    _switch("only coast", "drive", "it acknowledges ramped and quick stops and does nothing"),
    _switch("deaf", "drive", "it acknowledges every command and does nothing; its watchdog works"),
    _switch("reports 0", "drive", "the speed it reports is 0"),
    _switch("stale speed", "drive", "what it reports stands still"),
    _switch("runs away", "drive", "it puts out 3500 rpm and reports what was asked", switch="runs at", single=True),
    _switch("runs slow", "drive", "it puts out 60 rpm, likewise", switch="runs at", value=60.0, single=True),
    _switch("drive trips", "drive", "it cuts its output and remembers a fault"),
    _switch("drive restarts", "drive", "its power is off for 1.5 s"),
    _switch("DAQ silent", "DAQ", "it sends nothing any more"),
    _switch("DAQ loses frames", "DAQ", "a frame in twenty is lost, for good"),
    _switch(
        "DAQ loses a few frames",
        "DAQ",
        "three frames in two hundred are lost",
        switch="DAQ loses frames",
        value=0.015,
        single=True,
    ),
    _switch("DAQ late", "DAQ", "samples fall behind, to 4.5 s after 9 s"),
    _switch("DAQ restarts", "DAQ", "it begins again at sample 0"),
    _switch("keyphasor dead", "sensor", "its level is stuck"),
    _switch("keyphasor noisy", "sensor", "one sample in a hundred is off by up to 8 V"),
    _switch("probe at 0 V", "sensor", "its cable is off"),
    _switch("probe at -19.9 V", "sensor", "its target is gone"),
    Fault(
        name="one supply",
        where="sensor",
        words="keyphasor and motor link die together",
        switches=("keyphasor dead", "link closed"),
        single=True,
    ),
    Fault(name="terminal closed", where="host", words="SIGHUP; nothing can be written to it"),
    Fault(name="stdout closed", where="host", words="the pipe that its output goes to has no reader"),
    Fault(name="disk full", where="host", words="no file can grow any more"),
    Fault(name="folder deleted", where="host", words="the folder of the recording is removed"),
    _signal("SIGINT", "Ctrl-C is typed"),
    _signal("SIGTERM", "it is told to end"),
    _signal("SIGQUIT", "Ctrl-\\ is typed"),
    _signal("SIGSTOP for 3 s", "it hangs", signal="SIGSTOP", seconds=3.0),
    _signal("kill -9", "it dies", signal="SIGKILL"),
    Fault(name="guardian killed", where="program", words="kill -9 of the process that owns the motor link"),
)
BY_NAME = {fault.name: fault for fault in FAULTS}
PAIRED = tuple(fault for fault in FAULTS if not fault.single)


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One run: a controller, and faults at their moments, None for random ones."""

    set: str  # "pairs", "singles", "cases"
    controller: str
    faults: tuple[str, ...]
    number: int = 0
    name: str = ""  # of a case of its own
    at: tuple[Moment, ...] | None = None
    extra: tuple[tuple[str, Any], ...] = ()  # switches of the bench from the start: (name, value)
    rolling: float = 0.0  # rpm at which the rotor turns already
    dwell: bool = False  # a dwell at 300 rpm for 20 s instead of the plan
    limits: bool = True
    run_down: str = ""  # `limits.run_down`
    motor: tuple[tuple[str, Any], ...] = ()  # keys of [motor] instead of the controller's

    @property
    def run(self) -> str:
        """Name of the run, which its seed is made of."""
        return self.name or f"{self.controller}: {' + '.join(self.faults) or 'healthy'} #{self.number}"

    @property
    def seed(self) -> int:
        """Draws the moments, and what the faults hit."""
        return zlib.crc32(self.run.encode())

    def moments(self) -> tuple[Moment, ...]:
        """Return the moments of the faults: anywhere, often at the start, in the run-down, or one upon another."""
        if self.at is not None:
            return self.at
        rng = random.Random(self.seed)
        run_up = RUN_UP_OF_ONE_RAMP if self.controller.startswith(ONE_RAMP) else RUN_UP
        moments: list[Moment] = []
        for _ in self.faults:
            kind = rng.random()
            if moments and kind < 0.5:
                moments.append(Moment(rng.uniform(0.0, 1.0), after=self.faults[0]))
            elif moments and kind < 0.75:
                moments.append(Moment(rng.uniform(1.0, 6.0), after=self.faults[0]))
            else:
                moments.append(_moment(rng, run_up))
        return tuple(moments)


def pairs(rounds: int = 1) -> list[Case]:
    """All pairs of faults on three controllers."""
    return [
        Case(set="pairs", controller=controller, faults=(one.name, other.name), number=number)
        for number in range(rounds)
        for one, other in itertools.combinations(PAIRED, 2)
        for controller in FOR_PAIRS
    ]


def singles(rounds: int = 1) -> list[Case]:
    """Every fault, and none, on every controller."""
    names = [(), *((fault.name,) for fault in FAULTS)]
    return [
        Case(set="singles", controller=controller, faults=faults, number=number)
        for number in range(rounds)
        for faults in names
        for controller in CONTROLLERS
    ]


def _moment(rng: random.Random, run_up: float) -> Moment:
    kind = rng.random()
    if kind < 0.15:
        return Moment(rng.uniform(0.0, 0.5))
    if kind < 0.4:
        return Moment(DWELL_SECONDS + rng.uniform(0.0, RUN_DOWN_SECONDS), above=AT_TOP)
    return Moment(rng.uniform(0.0, run_up), above=TURNS)
