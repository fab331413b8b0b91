"""Run-down after a stop: record the rotor until it is at rest, and stop it harder if it does not slow down.

docs/sweeps.md says what stops a sweep, how, and what the recording says of it.
"""

import math
from dataclasses import dataclass

from rotorrig.acquisition.sweep.interrupts import EMERGENCY_COUNT, FINAL_COUNT, Interrupts
from rotorrig.acquisition.sweep.operator import Operator
from rotorrig.acquisition.sweep.session import Session
from rotorrig.rig import LimitExceeded, LinkLost
from rotorrig.rig.config import RPM
from rotorrig.rig.motor import Stop

AT_REST = 3.0  # rad/s, 29 rpm
QUIET = 2.0  # s without a pulse, in which a shaft at that speed turns once; before two pulses no speed is known
SLOWER = 0.98  # of the speed at the stop: a rotor that is faster than that after a while does not slow down
PATIENCE = 3.0  # s of the sample clock for it, and twice the time its ramp takes
CONFIRM = 1.0  # s of wall time for it since the drive has obeyed; a simulated rig's sample clock runs ahead
BLIND = 10.0  # s of wall time to go on trying when neither samples nor the drive's word arrive
LOOK = 0.05  # s of wall time between looks at the drive when there are no samples
HARDER = {Stop.RAMP: Stop.EMERGENCY, Stop.EMERGENCY: Stop.COAST}  # what to try when a stop does nothing


@dataclass(frozen=True, slots=True, kw_only=True)
class RunDown:
    """Outcome of a run-down: at rest or not, by whose word."""

    at_rest: bool
    confirmed: bool  # the drive obeyed a stop
    words: str  # for a person


def follow_run_down(
    session: Session, *, ramp: float, limit: float, interrupts: Interrupts, operator: Operator
) -> RunDown:
    """Watch a rotor already commanded to stop until it is at rest or for `limit` seconds; never raises RigError.

    `ramp` [rad/s^2] is the slowest that a stop of kind RAMP may slow down by.
    """
    watch = _Watch(session, ramp)
    operator_warned = False
    while not watch.at_rest and not watch.over(limit) and interrupts.count < FINAL_COUNT:
        _take_block(session, watch)
        if interrupts.count >= EMERGENCY_COUNT and not watch.emergency:
            watch.emergency = True
            session.note("emergency", "emergency stop by the operator")
        report = session.control.report
        if report and report.trouble and report.tries > 1 and not operator_warned:
            operator_warned = True
            operator.tell(
                f"The drive does not confirm the stop ({report.trouble}); trying again. "
                "If the rotor does not slow down, cut its power by hand."
            )
        watch.stop_harder_if_needed()
    return watch.result()


class _Watch:
    """State of a rotor that has been commanded to stop."""

    def __init__(self, session: Session, ramp: float) -> None:
        self.emergency = False  # the operator has asked for more than an abort
        self.blind = False  # there are no samples any more
        self._session, self._ramp = session, ramp
        self._began, self._began_wall = session.t, session.clock.now()
        self._from = self._since = math.nan  # speed and sample time at which the present stop was seen to be obeyed
        self._kind: Stop | None = None  # of the stop those belong to

    @property
    def at_rest(self) -> bool:
        """True if keyphasor and drive say so, or the one of them that can be heard."""
        state, report = self._session.motor_state, self._session.control.report
        if report is None or not report.tries:
            return False  # the stop is not out yet
        off = state is not None and not state.running
        if self.blind:
            return off and not report.trouble
        still = self._session.speed < AT_REST and self._session.pulse_age >= QUIET
        return still and (off or bool(report.trouble))

    def over(self, limit: float) -> bool:
        """Return True once there is no use in waiting longer."""
        passed = self._session.clock.now() - self._began_wall
        if self.blind:
            return passed > (BLIND if self._session.motor_state is None else limit)
        return self._session.t - self._began > limit

    def stop_harder_if_needed(self) -> None:
        """Stop harder if the drive has obeyed and the rotor goes on as before."""
        session, report = self._session, self._session.control.report
        if self.blind or report is None or math.isnan(report.confirmed):
            return
        if session.motor_state is not None and not session.motor_state.running:
            return  # the power is off, there is nothing harder
        if self._kind is not report.kind:
            self._kind, self._from, self._since = report.kind, session.speed, session.t
        patience = PATIENCE
        if report.kind is Stop.RAMP:
            patience += 2 * (1 - SLOWER) * self._from / self._ramp
        waited = session.t - self._since > patience and session.clock.now() - report.confirmed > CONFIRM
        if waited and session.speed > SLOWER * self._from and session.speed > AT_REST:
            self._stop_harder(report.kind)
        elif session.speed <= SLOWER * self._from:
            self._from, self._since = session.speed, session.t  # it has to go on slowing down

    def _stop_harder(self, kind: Stop) -> None:
        session = self._session
        if (harder := HARDER.get(kind)) is None:
            return
        session.stop_rotor(harder)
        session.limits_armed = False
        session.note(
            "emergency",
            f"the rotor does not slow down, {session.speed * RPM:.0f} rpm after a stop of kind '{kind}': "
            f"'{harder}' instead",
        )

    def result(self) -> RunDown:
        """Return how the run-down ended."""
        session, report = self._session, self._session.control.report
        confirmed = report is not None and not math.isnan(report.confirmed)
        at_rest = self.at_rest
        passed = session.t - self._began
        if at_rest:
            words = f"at rest {passed:.1f} s after the stop" if not self.blind else "the drive reports that it is off"
            words += "" if confirmed else ", without the drive's word"
        elif not confirmed:
            said = report.trouble if report and report.trouble else "no answer yet"
            words = (
                f"THE ROTOR MAY STILL BE TURNING: the drive confirmed no stop in {report.tries if report else 0} tries "
                f"({said}); cut its power by hand"
            )
        else:
            seen = "not seen any more" if self.blind else f"still turning at {session.speed * RPM:.0f} rpm"
            words = f"the rotor is {seen} {passed:.0f} s after the stop, where the recording ends"
        return RunDown(at_rest=at_rest, confirmed=confirmed, words=words)


def _take_block(session: Session, watch: _Watch) -> None:
    """Take a block as during the sweep, whatever goes wrong with it; without samples, listen to the drive alone."""
    try:
        if watch.blind:
            session.clock.sleep(LOOK)
            session.beat()
            session.poll_motor()
        else:
            session.take_block()
    except LimitExceeded as trip:  # it is told to stop as fast as it can already; from here on, no limit can do more
        session.limits_armed = False
        session.note("trip", f"{trip}; while stopping")
    except LinkLost as lost:
        watch.blind = True
        session.note("note", f"{lost}; from here on only the drive says how the rotor is")
    except Exception as error:  # the recorder: what matters now is that the rotor stops
        session.note("note", f"{type(error).__name__}: {error}")
