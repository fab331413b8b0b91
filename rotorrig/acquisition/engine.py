"""Runs a plan on a rig and stops the rotor however that ends.

Steps are timed by the DAQ's sample clock, so a simulated rig may run faster than real time; only how often the motor
controller is asked goes by the wall clock.
"""

import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from types import FrameType

from rotorrig.acquisition.fanout import Listener, Writer
from rotorrig.acquisition.plans import Coast, Dwell, Mark, Ramp, Step, Trial
from rotorrig.acquisition.recording import Event
from rotorrig.acquisition.session import POLL_AT_SPEED, Session
from rotorrig.rig.clock import Clock, WallClock
from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import LimitExceeded, RigError
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.motor.base import MotorDriver, Stop
from rotorrig.rig.probes.base import Daq
from rotorrig.rig.units import RPM

Progress = Callable[[Step, float, float], None]  # step, fraction of the sweep 0..1, speed [rad/s]

AT_SPEED = 0.005  # relative distance from the target that counts as there
SLIP = 0.05  # an induction motor stays behind its frequency: so far off is there too ...
SLIP_STEADY = 3.0  # ... once the speed has been steady for so many seconds
RAMP_SLACK = (2.0, 20.0)  # a ramp may take twice its time and 20 s more
COAST_LIMIT = 900.0  # s; an RK4 needs about 45
COAST_GUESS = 45.0  # s, for the progress alone


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepResult:
    """How a sweep went; the data are in its recording."""

    samples: int
    seconds: float  # of the sample clock
    gaps: int  # places where samples are missing
    trip: str  # which limit was exceeded; empty: the plan was finished
    events: tuple[Event, ...]


def run_sweep(
    steps: Iterable[Step],
    *,
    motor: MotorDriver,
    daq: Daq,
    rig: RigConfig,
    writer: Writer,
    interlock: Interlock,
    listeners: Sequence[Listener] = (),
    progress: Progress | None = None,
    clock: Clock | None = None,
) -> SweepResult:
    """Run `steps` on opened devices, then close the recording; the rotor is told to stop whatever happens.

    A limit exceeded, or a step that does not get where it should, ends the sweep with `SweepResult.trip`. Everything
    else that ends it early is raised after the rotor was stopped and the recording closed: LinkLost, DataError if it
    could not be recorded, KeyboardInterrupt (for SIGTERM and SIGHUP too). Raises LinkLost, naming the danger, if no
    stop was confirmed.
    """
    session = Session(
        motor=motor, daq=daq, writer=writer, interlock=interlock, listeners=listeners, clock=clock or WallClock()
    )
    with _signals_do(signal.default_int_handler):  # a closed terminal or a `kill` stops the rotor as Ctrl-C does
        trip = _run_and_stop(tuple(steps), session, progress, about=rig.name)
    return SweepResult(
        samples=session.samples, seconds=session.t, gaps=session.gaps, trip=trip, events=tuple(session.events)
    )


def _run_and_stop(steps: tuple[Step, ...], session: Session, progress: Progress | None, *, about: str) -> str:
    """Run the steps, end the session however they end, and return what tripped, if something did."""
    stop, kind, reason = Stop.EMERGENCY, "stop", "ended by an unforeseen error"
    try:
        session.start()
        session.note("note", f"{about}: recorded from {datetime.now(UTC):%Y-%m-%d %H:%M:%S} UTC")
        _run(steps, session, progress)
        stop, reason = Stop.RAMP, "plan finished"
    except LimitExceeded as trip:
        kind, reason = "trip", str(trip)
    except KeyboardInterrupt:
        reason = "interrupted by the operator"
        raise
    except Exception as error:
        reason = str(error) if isinstance(error, RigError) else f"{type(error).__name__}: {error}"
        raise
    finally:
        _end(session, stop, kind, reason)
    return reason if kind == "trip" else ""


def _end(session: Session, stop: Stop, kind: str, reason: str) -> None:
    """Bring the rotor to rest, before anything else can fail; then say why, and close."""
    with _signals_do(signal.SIG_IGN):  # an impatient second Ctrl-C must not keep the rotor from being stopped
        try:
            session.bring_to_rest(stop)
        except RigError as error:
            reason = f"{reason}; {error}"
            raise
        finally:
            try:
                session.note(kind, reason)
            finally:
                session.close()


@contextmanager
def _signals_do(handler: Callable[[int, FrameType | None], object] | signal.Handlers) -> Iterator[None]:
    """Let `handler` see to Ctrl-C, `kill` and a closed terminal while the block runs."""
    if threading.current_thread() is not threading.main_thread():
        yield  # Python delivers signals to the main thread only
        return
    before = {number: signal.signal(number, handler) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    try:
        yield
    finally:
        for number, previous in before.items():
            signal.signal(number, previous)


def _run(steps: tuple[Step, ...], session: Session, progress: Progress | None) -> None:
    done = shown = 0.0
    for step, share in zip(steps, _shares(steps), strict=True):
        for part in _performed(step, session):
            shown = max(shown, done + share * min(part, 1.0))  # a measured speed falters, progress does not
            if progress:
                progress(step, shown, session.speed)
        done += share


def _performed(step: Step, session: Session) -> Iterator[float]:
    """Perform a step; yield after every block how much of it is done, about 0 to 1."""
    match step:
        case Mark():
            session.note("mark", step.label)
        case Trial():
            session.note("trial", step.mass)
        case Ramp():
            yield from _ramped(step, session)
        case Dwell():
            yield from _dwelt(step, session)
        case Coast():
            yield from _coasted(step, session)


def _ramped(step: Ramp, session: Session) -> Iterator[float]:
    start, began = session.speed, session.t
    factor, slack = RAMP_SLACK
    limit = factor * abs(step.to - start) / step.rate + slack
    session.command(step.to, ramp=step.rate)
    while not _there(step.to, session):
        if session.t - began > limit:
            raise LimitExceeded(f"ramp to {step.to * RPM:.0f} rpm: not there after {limit:.0f} s, {_readings(session)}")
        session.take()
        yield (session.speed - start) / (step.to - start) if step.to != start else 1.0
    if abs(session.speed - step.to) > AT_SPEED * step.to:
        session.note("note", f"steady at {session.speed * RPM:.1f} rpm, asked for {step.to * RPM:.1f} rpm: slip")


def _dwelt(step: Dwell, session: Session) -> Iterator[float]:
    began = session.t
    while session.t - began < step.seconds:
        session.take()
        yield (session.t - began) / step.seconds


def _coasted(step: Coast, session: Session) -> Iterator[float]:
    start, began = session.speed, session.t
    session.coast()
    while session.speed > step.until:
        if session.t - began > COAST_LIMIT:
            raise LimitExceeded(
                f"coast to {step.until * RPM:.0f} rpm: not there after {COAST_LIMIT:.0f} s, {_readings(session)}"
            )
        session.take()
        yield (start - session.speed) / (start - step.until)


def _there(target: float, session: Session) -> bool:
    """Whether the keyphasor and the drive agree that the target speed is reached."""
    off = abs(session.speed - target)
    slipping = off <= SLIP * target and session.steady >= SLIP_STEADY
    if off > AT_SPEED * target and not slipping:
        return False
    session.poll(at_most_every=POLL_AT_SPEED)
    return session.state is not None and session.state.at_setpoint


def _readings(session: Session) -> str:
    """Say what keyphasor and drive read, for an error."""
    state = session.state
    drive = "has not answered since the command"
    if state is not None:
        where = "at" if state.at_setpoint else "not at"
        drive = f"reports {state.speed * RPM:.0f} rpm, {where} its setpoint of {state.setpoint * RPM:.0f} rpm"
    return f"the keyphasor reads {session.speed * RPM:.0f} rpm and the drive {drive}"


def _shares(steps: tuple[Step, ...]) -> list[float]:
    """Return what part of the sweep's time each step should take; they add up to 1."""
    speed, seconds = 0.0, []
    for step in steps:
        match step:
            case Ramp():
                seconds.append(abs(step.to - speed) / step.rate)
                speed = step.to
            case Dwell():
                seconds.append(step.seconds)
            case Coast():
                seconds.append(COAST_GUESS)
                speed = step.until
            case Mark() | Trial():
                seconds.append(0.0)
    total = sum(seconds) or 1.0
    return [s / total for s in seconds]
