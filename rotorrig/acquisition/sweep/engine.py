"""Runs a plan on a rig and stops the rotor however that ends.

Steps are timed by the DAQ's sample clock, so a simulated rig may run faster than real time; only how often the motor
controller is asked goes by the wall clock.
"""

import math
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime

from rotorrig.acquisition.recording import Event
from rotorrig.acquisition.sweep.fanout import Listener, Writer
from rotorrig.acquisition.sweep.interrupts import EMERGENCY, Interrupts
from rotorrig.acquisition.sweep.motor_control import READ_EVERY, STALL, MotorControl, ThreadedControl
from rotorrig.acquisition.sweep.operator import Nobody, Operator
from rotorrig.acquisition.sweep.perform import Progress, perform
from rotorrig.acquisition.sweep.run_down import RunDown, run_down
from rotorrig.acquisition.sweep.session import Session, StopTimes
from rotorrig.acquisition.sweep.steps import Ask, Ramp, Step
from rotorrig.rig import Clock, ConfigError, Interlock, LimitExceeded, LinkLost, RigError, WallClock
from rotorrig.rig.config import RigConfig
from rotorrig.rig.motor import MotorDriver, Stop
from rotorrig.rig.probes import Daq

RUN_DOWN = 180.0  # s, where the config has no [limits]
WATCHDOG_SHARE = 0.25  # of the drive's watchdog time, between two readings of it at most


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepResult:
    """How a sweep went; the data are in its recording."""

    samples: int
    seconds: float  # of the sample clock
    gaps: int  # places where samples are missing
    trip: str  # which limit was exceeded; empty: none
    events: tuple[Event, ...]
    ending: str = "stop"  # kind of the event that ended it: "stop", "abort", "emergency" or "trip"
    at_rest: bool = True  # the rotor was seen to come to rest
    stop_times: StopTimes | None = None  # by the engine's clock


@dataclass(frozen=True, slots=True, kw_only=True)
class Ending:
    """What ended a plan, and how the rotor is to be stopped for it."""

    kind: str  # of the event
    stop: Stop
    reason: str
    error: BaseException | None = None  # to be raised when the rotor is at rest and the recording closed


class _StopWanted(Exception):
    """The operator wants the sweep to end here."""


class _Aborted(Exception):
    """A signal wants the program to end."""


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
    operator: Operator | None = None,
    control: MotorControl | None = None,
    clock: Clock | None = None,
) -> SweepResult:
    """Run `steps` on opened devices, bring the rotor to rest and close the recording, whatever happens on the way.

    A limit exceeded, or a step that does not get where it should, ends the sweep with `SweepResult.trip`; the
    operator's wish ends it without. Everything else that ends it early is raised once the rotor was stopped and the
    recording closed: LinkLost, which says what became of the rotor and names the danger if no stop was confirmed and
    the rotor not seen to come to rest; DataError if it could not be recorded; KeyboardInterrupt (for SIGTERM and
    SIGHUP too). Raises ConfigError if a step asks the operator for something and there is none.
    """
    plan, clock = tuple(steps), clock or WallClock()
    operator = _operator(operator, plan)
    watchdog = rig.motor.watchdog if rig.motor else math.inf
    control = control or ThreadedControl(motor, every=_read_every(rig), watchdog=watchdog, clock=clock)
    session = Session(
        motor=motor,
        control=control,
        daq=daq,
        rig=rig,
        writer=writer,
        interlock=interlock,
        listeners=listeners,
        clock=clock,
    )
    with Interrupts(
        stop=lambda: session.halt(Stop.EMERGENCY), hangs=lambda: clock.now() - session.beaten > STALL
    ) as interrupts:
        ending = _ended(plan, session, progress, interrupts, operator, about=rig.name)
        down = _stopped(ending, plan, session, interrupts, operator, rig)
    if isinstance(ending.error, LinkLost) or not (down.at_rest or down.confirmed):
        raise LinkLost(f"{ending.reason}; {down.words}") from ending.error
    if ending.error is not None:
        raise ending.error
    return SweepResult(
        samples=session.samples,
        seconds=session.t,
        gaps=session.gaps,
        trip=next((event.text for event in session.events if event.kind == "trip"), ""),
        events=tuple(session.events),
        ending=ending.kind,
        at_rest=down.at_rest,
        stop_times=session.stop_times,
    )


def _operator(operator: Operator | None, steps: tuple[Step, ...]) -> Operator:
    if operator is None and any(isinstance(step, Ask) for step in steps):
        raise ConfigError("the plan asks for something to be done at the rotor, want an operator to ask")
    return operator or Nobody()


def _read_every(rig: RigConfig) -> float:
    """Return the seconds between readings of the drive, so that its watchdog is kept waiting by a dead program only."""
    return min(READ_EVERY, WATCHDOG_SHARE * rig.motor.watchdog) if rig.motor else READ_EVERY


def _ended(
    steps: tuple[Step, ...],
    session: Session,
    progress: Progress | None,
    interrupts: Interrupts,
    operator: Operator,
    *,
    about: str,
) -> Ending:
    """Run the steps and return what ended them."""
    try:
        session.start()
        session.note("note", f"{about}: recorded from {datetime.now(UTC):%Y-%m-%d %H:%M:%S} UTC")
        for _ in perform(steps, session, operator, progress):
            _heed(interrupts, operator)
        return Ending(kind="stop", stop=Stop.RAMP, reason="plan finished")
    except _StopWanted:
        return Ending(kind="stop", stop=Stop.RAMP, reason="stopped by the operator")
    except (_Aborted, KeyboardInterrupt):
        kind = "emergency" if interrupts.count >= EMERGENCY else "abort"
        reason = f"interrupted by the operator ({interrupts.first or 'Ctrl-C'})"
        return Ending(kind=kind, stop=Stop.EMERGENCY, reason=reason, error=KeyboardInterrupt())
    except LimitExceeded as trip:
        return Ending(kind="trip", stop=Stop.EMERGENCY, reason=str(trip))
    except LinkLost as lost:
        return Ending(kind="emergency", stop=Stop.EMERGENCY, reason=str(lost), error=lost)
    except RigError as error:
        return Ending(kind="abort", stop=Stop.EMERGENCY, reason=str(error), error=error)
    except BaseException as error:  # a defect; raised again by the caller, once the rotor stands
        return Ending(kind="abort", stop=Stop.EMERGENCY, reason=f"{type(error).__name__}: {error}", error=error)


def _heed(interrupts: Interrupts, operator: Operator) -> None:
    """Look, after every block, whether somebody wants the sweep to end."""
    if interrupts.count:
        raise _Aborted
    if operator.wants_stop():
        raise _StopWanted


def _stopped(
    ending: Ending,
    steps: tuple[Step, ...],
    session: Session,
    interrupts: Interrupts,
    operator: Operator,
    rig: RigConfig,
) -> RunDown:
    """Bring the rotor to rest, before anything else can fail; say why, and close the recording."""
    try:
        session.beat()  # a silent DAQ may have been waited for
        report = session.control.report
        if report is None or report.kind is not ending.stop:  # else the limit or the signal has done so
            session.halt(ending.stop)
        session.guarded = ending.stop is Stop.RAMP
        session.paused = False
        with suppress(Exception):  # the recorder may be what failed; `close` raises it again
            session.note(ending.kind, ending.reason)
        limit = rig.limits.run_down if rig.limits else RUN_DOWN
        ramps = [step.rate for step in steps if isinstance(step, Ramp)]
        down = run_down(session, ramp=min(ramps, default=1.0), limit=limit, interrupts=interrupts, operator=operator)
        with suppress(Exception):
            session.note("note" if down.at_rest or down.confirmed else "emergency", down.words)
    finally:
        try:
            session.close()
        except Exception:
            if ending.error is None:  # else the same fault of the recorder, or the lesser one
                raise
    return down
