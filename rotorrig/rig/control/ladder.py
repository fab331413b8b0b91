"""Escalation of a stop: which measure comes next when the rotor does not obey the present one.

A measure has helped if the speed has fallen by a tenth within its time: a drive that hunts by a few rpm around its
speed has not obeyed. Where nobody sees the speed, measures follow each other by time alone. After the last one
the ladder begins anew at the quick stop.
"""

from enum import StrEnum

from rotorrig.rig.motor import Stop

FALL = 0.1  # of the speed, by which it has to fall within a measure's time ...
LEAST_FALL = 1.0  # ... and at least by so much [rad/s], ten times what a drive's speed hunts by
PATIENCE = 3.0  # s for a stop to show, and twice the time its ramp takes for the fall
COAST_PATIENCE = 10.0  # s: an RK4 slows down by a tenth in four seconds by friction alone
UNSEEN_PATIENCE = 5.0  # s for each measure while nobody sees the speed
SILENCE_MARGIN = 1.0  # s beyond the drive's watchdog time


class Measure(StrEnum):
    """What can be done about a rotor that turns, from gentle to harsh."""

    RAMP = "ramp"
    EMERGENCY = "emergency"
    COAST = "coast"
    SILENCE = "silence"  # the drive is left without a word until its watchdog acts
    POWER_CUT = "power cut"

    @property
    def stop(self) -> Stop | None:
        """The stop to send; None: it is none."""
        return Stop(self.value) if self.value in list(Stop) else None


class Ladder:
    """Measures in their order, and how long the present one has been given; `watchdog` [s] is the drive's, if any."""

    def __init__(self, *, ramp: float, watchdog: float | None, power_cut: bool) -> None:
        """`ramp` [rad/s^2] is the slowest that a stop down the ramp may slow down by."""
        self.silence = watchdog + SILENCE_MARGIN if watchdog else 0.0
        self._ramp = ramp
        self._measures = [Measure.RAMP, Measure.EMERGENCY, Measure.COAST]
        self._measures += [Measure.SILENCE] if watchdog else []
        self._measures += [Measure.POWER_CUT] if power_cut else []
        self._present = Measure.RAMP
        self._elapsed = 0.0  # s the present measure has had
        self._from: float | None = None  # speed [rad/s] it has to bring down; None: not seen
        self._helped = False  # once, so far

    def begin(self, measure: Measure, speed: float | None) -> None:
        """Note that a measure was taken at this speed [rad/s]; None: nobody sees it."""
        self._present, self._elapsed, self._from, self._helped = measure, 0.0, speed, False

    def advance(self, seconds: float, speed: float | None) -> Measure | None:
        """Give the present measure more time; return the one that shall replace it, if it did not help in its time."""
        self._elapsed += seconds
        if speed is not None and self._from is not None and not self._helped:
            self._from = max(self._from, speed)  # a keyphasor that was silent has come back
        if speed is not None and (self._from is None or speed <= self._from - fall(self._from)):
            self._elapsed, self._from, self._helped = 0.0, speed, True  # it has to go on slowing down
        if self._elapsed <= self._patience():
            return None
        after = self._measures.index(self._present) + 1
        following = self._measures[after] if after < len(self._measures) else Measure.EMERGENCY
        self.begin(following, speed)
        return following

    def _patience(self) -> float:
        if self._present is Measure.SILENCE:
            return self.silence + PATIENCE
        if self._from is None:
            return UNSEEN_PATIENCE
        if self._present is Measure.RAMP:
            return PATIENCE + 2 * fall(self._from) / self._ramp
        return COAST_PATIENCE if self._present in (Measure.COAST, Measure.POWER_CUT) else PATIENCE


def fall(speed: float) -> float:
    """Return by how much a speed [rad/s] has to fall for a measure to have helped.

    >>> fall(100.0), fall(3.0)
    (10.0, 1.0)
    """
    return max(FALL * speed, LEAST_FALL)
