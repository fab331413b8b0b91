"""Perform the steps of a plan: the command each sends, the condition it waits for, and its time limit."""

from collections.abc import Iterator

from rotorrig.acquisition.sweep.operator import Operator
from rotorrig.acquisition.sweep.rest import AT_REST, RotorState
from rotorrig.acquisition.sweep.session import Session
from rotorrig.acquisition.sweep.steps import Ask, Coast, Dwell, Mark, Provoke, Ramp, Rest, Step, Trial
from rotorrig.acquisition.sweep.timeline import plan_timeline
from rotorrig.rig import LimitExceeded
from rotorrig.rig.config import RPM
from rotorrig.rig.motor import Stop

AT_SPEED = 0.005  # relative distance from the target that counts as there
SLIP = 0.055  # an induction motor lags 5 % behind its frequency, read to 0.5 %: within this counts as there too ...
SLIP_STEADY = 3.0  # ... once the speed has been steady for so many seconds
DISAGREEMENT = 5.0  # s for which a drive may be at its setpoint and the rotor steady somewhere else
FACTOR = 1.5  # between the two: not slip, but another number of pole pairs, or a rotor that does not turn ...
FACTOR_SECONDS = 2.0  # ... for which so long is enough
DWELL_BAND = 0.1  # relative: a rotor that strays so far from the speed it is to dwell at, twice the slip ...
DWELL_SECONDS = 2.0  # ... and for so long, has lost it
RAMP_SLACK = (2.0, 20.0)  # a ramp may take twice its time and 20 s more
COAST_LIMIT = 900.0  # s; an RK4 needs about 45


def perform_steps(steps: tuple[Step, ...], session: Session, operator: Operator) -> Iterator[tuple[Step, float]]:
    """Perform the steps; after every block yield the present one and the fraction of the sweep done, 0 to 1.

    Raises LimitExceeded if one does not reach its target in time.
    """
    timed = plan_timeline(steps)
    total = timed[-1].end if timed and timed[-1].end else 1.0
    shown = 0.0
    for part in timed:
        for done in _perform_step(part.step, session, operator):
            now = (part.begin + part.seconds * min(done, 1.0)) / total
            shown = max(shown, now)  # a measured speed falters, progress does not
            yield part.step, shown


def _perform_step(step: Step, session: Session, operator: Operator) -> Iterator[float]:
    """Perform one step; after every block yield the fraction done, about 0 to 1."""
    match step:
        case Mark():
            session.note("mark", step.label)
        case Trial():
            session.note("trial", step.mass)
        case Ramp():
            yield from _ramp(step, session)
        case Dwell():
            yield from _dwell(step, session)
        case Coast():
            yield from _coast(step, session)
        case Rest():
            yield from _come_to_rest(session)
        case Ask():
            yield from _ask_operator(step, session, operator)
        case Provoke():
            yield from _provoke(step, session)


def _ramp(step: Ramp, session: Session) -> Iterator[float]:
    start, began = session.speed, session.t
    factor, slack = RAMP_SLACK
    limit = factor * abs(step.end - start) / step.rate + slack
    rising = step.end > start
    session.command_speed(step.to, ramp=step.rate)
    while not (_at_speed(step.to, session) if step.until is None else _is_past(step.until, session, rising=rising)):
        if session.t - began > limit:
            raise LimitExceeded(
                f"ramp to {step.end * RPM:.0f} rpm: not there after {limit:.0f} s, {_both_speeds(session)}"
            )
        session.take_block()
        _check_agreement(step, session, since=began)
        yield (session.speed - start) / (step.end - start) if step.end != start else 1.0
    if step.until is None and abs(session.speed - step.to) > AT_SPEED * step.to:
        session.note("note", f"steady at {session.speed * RPM:.1f} rpm, asked for {step.to * RPM:.1f} rpm: slip")


def _dwell(step: Dwell, session: Session) -> Iterator[float]:
    began = agreed = session.t
    while session.t - began < step.seconds:
        session.take_block()
        if abs(session.speed - session.commanded_speed) <= DWELL_BAND * session.commanded_speed:
            agreed = session.t
        elif session.commanded_speed and session.t - agreed > DWELL_SECONDS:
            raise LimitExceeded(
                f"dwell at {session.commanded_speed * RPM:.0f} rpm: not kept for {session.t - agreed:.0f} s, "
                f"{_both_speeds(session)}"
            )
        yield (session.t - began) / step.seconds


def _coast(step: Coast, session: Session) -> Iterator[float]:
    start, began = session.speed, session.t
    session.command_stop(Stop.COAST)
    while session.speed > step.until:
        if session.t - began > COAST_LIMIT:
            raise LimitExceeded(
                f"coast to {step.until * RPM:.0f} rpm: not there after {COAST_LIMIT:.0f} s, {_both_speeds(session)}"
            )
        session.take_block()
        yield (start - session.speed) / (start - step.until)


def _come_to_rest(session: Session) -> Iterator[float]:
    start, began = max(session.speed, AT_REST), session.t
    session.command_stop(Stop.RAMP)
    while not _at_rest(session):
        if session.t - began > COAST_LIMIT:
            raise LimitExceeded(f"stop: not at rest after {COAST_LIMIT:.0f} s, {_both_speeds(session)}")
        session.take_block()
        yield 1 - session.speed / start


def _ask_operator(step: Ask, session: Session, operator: Operator) -> Iterator[float]:
    """Wait for the operator with limits off, since a hand at the rotor exceeds them; a drive that runs still trips.

    Samples are not recorded meanwhile: a rotor turned by hand gives no pulses of a run. The stream goes on.
    """
    session.note("pause", f"{step.request}; not recorded until that is done")
    session.limits_armed, session.recording_paused = False, True
    operator.ask(step.request)
    while not operator.has_answered():
        session.take_block()
        state = session.motor_state
        if state is not None and state.running:
            session.stop_rotor(Stop.EMERGENCY)
            raise LimitExceeded(f"drive: runs at {state.speed * RPM:.0f} rpm while the rotor is worked on")
        yield 0.0
    session.limits_armed, session.recording_paused = True, False
    session.note("note", f"done: {step.request}")


def _provoke(step: Provoke, session: Session) -> Iterator[float]:
    session.note("note", f"proof test: {step.what}")
    session.limits_armed = step.limits
    step.act()
    while not step.has_stopped():
        yield 0.0
        session.take_block()
    session.limits_armed = True


def _at_speed(target: float, session: Session) -> bool:
    """Return True once keyphasor and drive agree that the target speed is reached."""
    off = abs(session.speed - target)
    slipping = off <= SLIP * target and session.steady_for >= SLIP_STEADY
    if off > AT_SPEED * target and not slipping:
        return False
    session.control.read_soon()
    session.poll_motor()
    return session.motor_state is not None and session.motor_state.at_setpoint


def _check_agreement(step: Ramp, session: Session, *, since: float) -> None:
    """Raise LimitExceeded if the drive has long been at its setpoint while the rotor holds another speed."""
    state = session.motor_state
    steady_for = min(session.steady_for, session.t - since)
    by_a_factor = not 1 / FACTOR < session.speed / step.to < FACTOR
    if (
        state is None
        or not state.at_setpoint
        or steady_for < (FACTOR_SECONDS if by_a_factor else DISAGREEMENT)
        or abs(session.speed - step.to) <= SLIP * step.to
    ):
        return
    raise LimitExceeded(
        f"ramp to {step.end * RPM:.0f} rpm: the rotor does not follow, for {steady_for:.0f} s {_both_speeds(session)}"
    )


def _is_past(speed: float, session: Session, *, rising: bool) -> bool:
    return session.speed >= speed if rising else session.speed <= speed


def _at_rest(session: Session) -> bool:
    """Return True once the rotor is proven at rest and the drive off: hands may come near it."""
    off = session.motor_state is not None and not session.motor_state.running
    return off and session.rest is RotorState.AT_REST


def _both_speeds(session: Session) -> str:
    """Speed by keyphasor and by drive, for an error message."""
    state = session.motor_state
    drive = "has not answered since the command"
    if state is not None:
        where = "at" if state.at_setpoint else "not at"
        drive = f"reports {state.speed * RPM:.0f} rpm, {where} its setpoint of {state.setpoint * RPM:.0f} rpm"
    return f"the keyphasor reads {session.speed * RPM:.0f} rpm and the drive {drive}"
