"""Run-down after a stop: watch and record the rotor until it is proven at rest, and stop it harder while it is not.

docs/sweeps.md says what stops a sweep, how, and what the recording says of it.
"""

import math
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from rotorrig.acquisition.sweep.interrupts import EMERGENCY_COUNT, Interrupts
from rotorrig.acquisition.sweep.operator import Operator
from rotorrig.acquisition.sweep.rest import RotorState
from rotorrig.acquisition.sweep.session import Session
from rotorrig.rig import LimitExceeded, LinkLost
from rotorrig.rig.config import RPM
from rotorrig.rig.control import Ladder, Measure
from rotorrig.rig.motor import Stop

CONFIRM = 1.0  # s of wall time for a stop to show once it was tried; a simulated rig's sample clock runs ahead
LOOK = 0.05  # s of wall time between looks at the drive when there are no samples
PATIENT = 4.0  # times slower up the ladder while the drive says that it is off and nobody sees the rotor
LEAVE_COUNT = 2  # signals that leave a rotor not proven at rest, once that was offered
WARN_AFTER = 12.0  # s of wall time after which the operator is told that rest is not proven ...
WARN_EVERY = 60.0  # ... and how often again


@dataclass(frozen=True, slots=True, kw_only=True)
class RunDown:
    """Outcome of a run-down."""

    state: RotorState
    confirmed: bool  # the drive obeyed a stop
    words: str  # for a person
    is_off: bool = False  # the drive has obeyed and is off, and there is nothing more to be done about an unseen rotor

    @property
    def at_rest(self) -> bool:
        """Whether the rotor is proven at rest."""
        return self.state is RotorState.AT_REST


def follow_run_down(
    session: Session,
    *,
    ladder: Ladder,
    limit: float,
    interrupts: Interrupts,
    operator: Operator,
    cut_power: Callable[[], str] | None,
    patience: float = math.inf,
) -> RunDown:
    """Watch a rotor already commanded to stop until it is proven at rest, or the operator leaves it; never raises.

    A rotor that turns is recorded for as long as it does, one of which nothing is seen for `limit` seconds; `cut_power`
    switches the drive's supply off, where that can be done, and returns what came of it. After `patience` seconds
    without a sign of the rotor there is nothing more to be done about a drive that has obeyed and is off.
    """
    watch = _Watch(session, ladder, operator, cut_power)
    while session.rest is not RotorState.AT_REST or not watch.stop_was_sent:
        if watch.is_left(interrupts.count):
            break
        if watch.shows_nothing_for(patience):
            return watch.result(unseen_for=patience)
        watch.take_block()
        if interrupts.count >= EMERGENCY_COUNT and not watch.emergency:
            watch.make_it_an_emergency()
        watch.record_what_turns(limit)
        watch.warn_of_trouble()
        watch.offer_to_leave(interrupts.count)
        watch.stop_harder_if_needed()
    return watch.result()


class _Watch:
    """State of a rotor that has been commanded to stop."""

    def __init__(
        self, session: Session, ladder: Ladder, operator: Operator, cut_power: Callable[[], str] | None
    ) -> None:
        self.began = session.t
        self.emergency = False  # the operator has asked for more than an abort
        self._session, self._ladder, self._operator, self._cut_power = session, ladder, operator, cut_power
        self._blind = False  # there are no samples any more
        self._began_wall = self._looked_wall = session.clock.now()
        self._looked = session.t
        self._unseen_since = self._began_wall  # when the rotor was last seen, or the drive not off by its word
        self._warn_at = self._began_wall + WARN_AFTER
        self._warned_of_trouble = self._climbed = False
        self._offered_at: int | None = None  # signals that had come when leaving was offered; None: it was not
        self._begun: Stop | None = None  # kind of stop the ladder knows of
        self._tried_at = math.nan  # wall time at which it was first tried

    @property
    def stop_was_sent(self) -> bool:
        """True once the drive, or at least its link, was sent a stop."""
        report = self._session.control.report
        return report is not None and report.tries > 0

    def take_block(self) -> None:
        """Take a block as during the sweep, whatever goes wrong with it; without samples, listen to the drive alone."""
        session = self._session
        try:
            if self._blind:
                session.clock.sleep(LOOK)
                session.beat()
                session.poll_motor()
                self._bring_back_samples()
            else:
                session.take_block()
        except LimitExceeded as trip:  # it is being stopped already; from here on, no limit can do more
            session.limits_armed = False
            self.note("trip", f"{trip}; while stopping")
        except LinkLost as lost:
            self._blind = True
            self.note("note", f"{lost}; from here on only the drive says how the rotor is")
        except KeyboardInterrupt:  # it hung, and the operator broke it off
            self._blind = True
            self.note("note", "the samples hung; from here on only the drive says how the rotor is")
        except Exception as error:  # the recorder: what matters now is that the rotor stops
            self.note("note", f"{type(error).__name__}: {error}")

    def _bring_back_samples(self) -> None:
        if self._session.bring_back_samples():
            self._blind, self._session.limits_armed = False, False
            self.note(
                "note", "the DAQ was opened again; from here on times are to some 0.1 s, by this computer's clock"
            )

    def note(self, kind: str, text: str) -> None:
        """Record an event, if the recorder can."""
        with suppress(Exception):
            self._session.note(kind, text)

    def make_it_an_emergency(self) -> None:
        """Note that the operator wants it stopped as fast as can be; the signal has sent the stop."""
        self.emergency = True
        self.note("emergency", "emergency stop by the operator")

    def record_what_turns(self, limit: float) -> None:
        """Record no more of a rotor of which nothing is seen for long, until it gives pulses again."""
        unseen = self._session.rest is not RotorState.TURNING and self._session.t - self.began > limit
        if unseen and not self._session.recording_paused:
            self.note("note", f"the rotor is {self._describe()} {limit:.0f} s after the stop; recorded no further")
        self._session.recording_paused = unseen

    def warn_of_trouble(self) -> None:
        """Tell the operator once that the drive does not confirm the stop."""
        report = self._session.control.report
        if report and report.trouble and report.tries > 1 and not self._warned_of_trouble:
            self._warned_of_trouble = True
            self._operator.tell(
                f"The drive does not confirm the stop ({report.trouble}); trying again. "
                "If the rotor does not slow down, cut its power by hand."
            )

    def offer_to_leave(self, signals: int) -> None:
        """Tell the operator now and then that the rotor is not stopped or not seen, and how to leave it."""
        now = self._session.clock.now()
        if now < self._warn_at or not (self._climbed or self._speed() is None):
            return
        self._warn_at = now + WARN_EVERY
        self._offered_at = signals if self._offered_at is None else self._offered_at
        self._operator.tell(
            f"THE ROTOR MAY STILL BE TURNING: it is {self._describe()}. Still trying to stop it; look at it. "
            "Ctrl-C twice leaves it as it is."
        )

    def is_left(self, signals: int) -> bool:
        """Return whether the operator has said twice, after it was offered, to leave the rotor as it is."""
        return self._offered_at is not None and signals >= self._offered_at + LEAVE_COUNT

    def shows_nothing_for(self, patience: float) -> bool:
        """Return whether the drive is off by its word, and for so long [s of wall time] the rotor has not been seen."""
        state, now = self._session.motor_state, self._session.clock.now()
        if self._speed() is not None or (state is not None and state.running):
            self._unseen_since = now
        return self._is_confirmed() and state is not None and now - self._unseen_since > patience

    def stop_harder_if_needed(self) -> None:
        """Go up the ladder if the rotor goes on as before; time counts from when the present stop was first tried."""
        session, report, now = self._session, self._session.control.report, self._session.clock.now()
        seconds = now - self._looked_wall if self._blind else session.t - self._looked
        self._looked, self._looked_wall = session.t, now
        if self._speed() is None and session.motor_state is not None and not session.motor_state.running:
            seconds /= PATIENT  # the drive says that it is off, and the probes need their time to prove it
        if report is None or not report.tries:
            return
        if report.kind is not self._begun:
            self._begun, self._tried_at = report.kind, now
            self._ladder.begin(Measure(report.kind.value), self._speed())
        elif now - self._tried_at > CONFIRM and (measure := self._ladder.advance(seconds, self._speed())):
            self._tried_at = now
            self._take(measure)

    def _take(self, measure: Measure) -> None:
        session, self._climbed = self._session, True
        self.note("emergency", f"the rotor is {self._describe()}, it does not slow down as it should: '{measure}'")
        if stop := measure.stop:
            self._begun = stop
            session.stop_rotor(stop)
            session.limits_armed = False
        elif measure is Measure.SILENCE:
            session.control.fall_silent(self._ladder.silence)
        elif self._cut_power:
            threading.Thread(target=self._cut_and_note, daemon=True).start()

    def _cut_and_note(self) -> None:
        assert self._cut_power
        text = self._cut_power()
        self.note("emergency", text)

    def _speed(self) -> float | None:
        """Speed [rad/s] by the keyphasor; None: it gives no pulses, or there are no samples."""
        if self._blind or self._session.rest is not RotorState.TURNING:
            return None
        return self._session.speed

    def _describe(self) -> str:
        state = self._session.rest
        if state is RotorState.TURNING and not self._blind:
            return f"turning at {self._session.speed * RPM:.0f} rpm"
        return "not seen to turn or to rest"

    def _is_confirmed(self) -> bool:
        report = self._session.control.report
        return report is not None and not math.isnan(report.confirmed)

    def result(self, *, unseen_for: float = 0.0) -> RunDown:
        """Return how the run-down ended; `unseen_for` [s] is for how long nothing was seen of a rotor let be."""
        session, report = self._session, self._session.control.report
        confirmed = self._is_confirmed()
        state = session.rest
        if self._blind and state is RotorState.TURNING:
            state = RotorState.UNKNOWN  # it was, when the samples ended
        passed = session.t - self.began
        trouble = report.trouble if report and report.trouble else "no answer yet"
        drive = f"the drive confirmed no stop in {report.tries if report else 0} tries ({trouble})"
        if state is RotorState.AT_REST:
            words = f"at rest {passed:.1f} s after the stop" + ("" if confirmed else f"; {drive}")
        elif state is RotorState.TURNING:
            words = f"THE ROTOR IS TURNING at {session.speed * RPM:.0f} rpm, left by the operator"
            words += "" if confirmed else f"; {drive}; cut its power by hand"
        elif unseen_for:
            why = "there were no samples" if self._blind else "the keyphasor gave no pulse, as a dead one gives none"
            words = "the drive has obeyed the stop and is off, but whether the rotor turns is unknown: "
            words += f"for {unseen_for:g} s {why}; look at it"
        else:
            words = "THE ROTOR MAY STILL BE TURNING, left by the operator: nothing proves that it is at rest"
            words += "" if confirmed else f"; {drive}; cut its power by hand"
        return RunDown(state=state, confirmed=confirmed, words=words, is_off=unseen_for > 0)
