"""Run a plan on a rig and bring the rotor to rest, however the plan ends.

The path to the stop: `run_sweep` -> `_run_plan` (every step, until something ends it) -> `_stop_rotor` ->
`Session.stop_rotor` -> `MotorControl.stop` -> `MotorDriver.stop`, then `follow_run_down` until rest is proven.

Steps are timed by the DAQ's sample clock, so a simulated rig may run faster than real time; only the interval between
readings of the motor controller is wall time.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial

from rotorrig.acquisition.recording import Event
from rotorrig.acquisition.sweep.before_start import look_before_start
from rotorrig.acquisition.sweep.fanout import Listener, Writer
from rotorrig.acquisition.sweep.interrupts import EMERGENCY_COUNT, Interrupts
from rotorrig.acquisition.sweep.operator import Nobody, Operator, Steadfast
from rotorrig.acquisition.sweep.perform import perform_steps
from rotorrig.acquisition.sweep.rest import RotorState
from rotorrig.acquisition.sweep.run_down import RunDown, follow_run_down
from rotorrig.acquisition.sweep.session import Session, StopTimes
from rotorrig.acquisition.sweep.steps import Ask, Ramp, Step
from rotorrig.rig import Clock, ConfigError, Interlock, LimitExceeded, LinkLost, NotAtRest, RigError, WallClock
from rotorrig.rig.config import RigConfig
from rotorrig.rig.control import LOOP_STALL, READ_EVERY, Ladder, MotorControl, cut_power
from rotorrig.rig.motor import Stop
from rotorrig.rig.probes import Daq

Progress = Callable[[Step, float, float], None]  # step, fraction of the sweep 0..1, speed [rad/s]

RUN_DOWN_LIMIT = 180.0  # s, where the config has no [limits]
WATCHDOG_SHARE = 0.25  # of the drive's watchdog time, between two readings of it at most


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepResult:
    """Outcome of a sweep; the data are in its recording."""

    samples: int
    seconds: float  # of the sample clock
    gaps: int  # places where samples are missing
    trip: str  # which limit was exceeded; empty: none
    events: tuple[Event, ...]
    ending: str = "stop"  # kind of the event that ended it: "stop", "abort", "emergency" or "trip"
    state: RotorState = RotorState.AT_REST  # of the rotor at the end
    stop_times: StopTimes | None = None  # by the engine's clock


@dataclass(frozen=True, slots=True, kw_only=True)
class Ending:
    """Cause of a plan's end, and the stop it calls for."""

    kind: str  # of the event
    stop: Stop
    reason: str
    error: BaseException | None = None  # to be raised when the rotor is at rest and the recording closed


class SweepInterrupted(KeyboardInterrupt):
    """A sweep ended by Ctrl-C or another signal; the rotor is proven at rest."""


class _StopRequested(Exception):
    """The operator asked for the sweep to end here."""


class _AbortRequested(Exception):
    """A signal asked for the program to end."""


def run_sweep(
    steps: Iterable[Step],
    *,
    control: MotorControl,
    daq: Daq,
    rig: RigConfig,
    writer: Writer,
    interlock: Interlock,
    listeners: Sequence[Listener] = (),
    progress: Progress | None = None,
    operator: Operator | None = None,
    watchdog: float | None = None,
    clock: Clock | None = None,
    rolling: bool = False,
) -> SweepResult:
    """Run `steps` on opened devices, bring the rotor to rest and close the recording, whatever happens on the way.

    `watchdog` [s] is the drive's own, None: it has none. A limit exceeded, or a step that does not reach its target,
    ends the sweep with `SweepResult.trip`; the operator's stop ends it without. Anything else that ends it early is
    raised once the rotor is proven at rest and the recording closed: LinkLost, DataError if recording failed,
    SweepInterrupted (by Ctrl-C, SIGTERM, SIGHUP or SIGQUIT). Raises NotAtRest, which says all that, if the operator has
    left a rotor that is not proven at rest; ConfigError if a step needs an operator and there is none. A rotor that
    turns before the start is a trip unless `rolling`.
    """
    plan, clock = tuple(steps), clock or WallClock()
    steadfast = Steadfast(_require_operator(operator, plan))
    session = Session(
        control=control,
        daq=daq,
        rig=rig,
        writer=writer,
        interlock=interlock,
        listeners=listeners,
        clock=clock,
        speed=math.inf if rolling else 0.0,
    )
    ladder = Ladder(ramp=_slowest_ramp(plan), watchdog=watchdog, power_cut=rig.power_cut is not None)
    with Interrupts(
        stop=lambda: session.stop_rotor(Stop.EMERGENCY), loop_hangs=lambda: clock.now() - session.last_beat > LOOP_STALL
    ) as interrupts:
        ending = _run_plan(plan, session, progress, interrupts, steadfast, about=rig.name, rolling=rolling)
        run_down = _stop_rotor(ending, session, interrupts, steadfast, rig, ladder)
    if not run_down.at_rest:
        raise NotAtRest(f"{run_down.words} ({ending.reason})") from ending.error
    if isinstance(ending.error, LinkLost):
        raise LinkLost(f"{ending.reason}; {run_down.words}") from ending.error
    if ending.error is not None:
        raise ending.error
    return SweepResult(
        samples=session.samples,
        seconds=session.t,
        gaps=session.gaps,
        trip=next((event.text for event in session.events if event.kind == "trip"), ""),
        events=tuple(session.events),
        ending=ending.kind,
        state=run_down.state,
        stop_times=session.stop_times,
    )


def _require_operator(operator: Operator | None, steps: tuple[Step, ...]) -> Operator:
    if operator is None and any(isinstance(step, Ask) for step in steps):
        raise ConfigError("the plan asks for something to be done at the rotor, want an operator to ask")
    return operator or Nobody()


def reading_interval(rig: RigConfig) -> float:
    """Return the seconds between readings of the drive, so that only a dead program lets its watchdog run out."""
    return min(READ_EVERY, WATCHDOG_SHARE * rig.motor.watchdog) if rig.motor else READ_EVERY


def _slowest_ramp(steps: tuple[Step, ...]) -> float:
    return min((step.rate for step in steps if isinstance(step, Ramp)), default=1.0)


def _run_plan(
    steps: tuple[Step, ...],
    session: Session,
    progress: Progress | None,
    interrupts: Interrupts,
    operator: Steadfast,
    *,
    about: str,
    rolling: bool,
) -> Ending:
    """Stream and perform the steps until something ends them; return what did. Stops nothing itself."""
    try:
        session.start()
        session.note("note", f"{about}: recorded from {datetime.now(UTC):%Y-%m-%d %H:%M:%S} UTC")
        for _ in look_before_start(session, rolling=rolling):
            _check_interrupts(interrupts, operator)
        for step, done in perform_steps(steps, session, operator):
            if progress:
                operator.attempt(partial(progress, step, done, session.speed))
            _check_interrupts(interrupts, operator)
        return Ending(kind="stop", stop=Stop.RAMP, reason="plan finished")
    except _StopRequested:
        return Ending(kind="stop", stop=Stop.RAMP, reason=operator.fault or "stopped by the operator")
    except (_AbortRequested, KeyboardInterrupt):
        kind = "emergency" if interrupts.count >= EMERGENCY_COUNT else "abort"
        reason = f"interrupted by the operator ({interrupts.first or 'Ctrl-C'})"
        return Ending(kind=kind, stop=Stop.EMERGENCY, reason=reason, error=SweepInterrupted())
    except LimitExceeded as trip:
        return Ending(kind="trip", stop=Stop.EMERGENCY, reason=str(trip))
    except LinkLost as lost:
        return Ending(kind="emergency", stop=Stop.EMERGENCY, reason=str(lost), error=lost)
    except RigError as error:
        return Ending(kind="abort", stop=Stop.EMERGENCY, reason=str(error), error=error)
    except BaseException as error:  # a defect; raised again by the caller, once the rotor stands
        return Ending(kind="abort", stop=Stop.EMERGENCY, reason=f"{type(error).__name__}: {error}", error=error)


def _check_interrupts(interrupts: Interrupts, operator: Operator) -> None:
    """Raise if a signal or the operator has asked for the sweep to end; called after every block."""
    if interrupts.count:
        raise _AbortRequested
    if operator.wants_stop():
        raise _StopRequested


def _stop_rotor(
    ending: Ending, session: Session, interrupts: Interrupts, operator: Operator, rig: RigConfig, ladder: Ladder
) -> RunDown:
    """Stop the rotor before anything else can fail, record why, follow it to rest, close the recording."""
    at_rest = False
    try:
        report = session.control.report
        if report is None or report.kind is not ending.stop:  # else the limit or the signal has sent it already
            session.stop_rotor(ending.stop)
        session.note_stop()  # the guardian may have sent it
        session.beat()  # a silent DAQ may have been waited for
        session.limits_armed = ending.stop is Stop.RAMP
        session.recording_paused = False
        with suppress(Exception):  # the recorder may be what failed; `close` raises it again
            session.note(ending.kind, ending.reason)
        run_down = follow_run_down(
            session,
            ladder=ladder,
            limit=rig.limits.run_down if rig.limits else RUN_DOWN_LIMIT,
            interrupts=interrupts,
            operator=operator,
            cut_power=partial(cut_power, rig.power_cut) if rig.power_cut else None,
        )
        at_rest = run_down.at_rest
        with suppress(Exception):
            session.note("note" if at_rest else "emergency", run_down.words)
    finally:
        try:
            session.close(at_rest=at_rest)
        except Exception:
            if ending.error is None and at_rest:  # else the same fault of the recorder, or the lesser one
                raise
    return run_down
