"""When each step of a sweep should begin and end, before it is run: for its preview and its progress."""

from collections.abc import Iterable
from dataclasses import dataclass

from rotorrig.acquisition.sweep.critical_speeds import with_speeds
from rotorrig.acquisition.sweep.steps import Ask, Coast, Dwell, Mark, Ramp, Rest, Step, Trial

COAST_SECONDS = 45.0  # an RK4's from full speed; nobody knows another rotor's before it was measured


@dataclass(frozen=True, slots=True, kw_only=True)
class Timed:
    """A step, when it is expected [s] and at what speeds [rad/s]."""

    step: Step
    begin: float
    end: float
    speed: float  # at which it begins
    to: float  # at which it ends

    @property
    def seconds(self) -> float:
        """How long it is expected to take [s]."""
        return self.end - self.begin


def plan_timeline(steps: Iterable[Step]) -> tuple[Timed, ...]:
    """Return the steps with their times, from rest; the time an operator takes is not known and counts as none."""
    timed: list[Timed] = []
    t, ramp = 0.0, 1.0
    for step, speed in with_speeds(steps):
        seconds, to = _expected(step, speed, ramp)
        timed.append(Timed(step=step, begin=t, end=t + seconds, speed=speed, to=to))
        t += seconds
        ramp = step.rate if isinstance(step, Ramp) else ramp
    return tuple(timed)


def _expected(step: Step, speed: float, ramp: float) -> tuple[float, float]:
    """Return the seconds a step should take from `speed` [rad/s], and the speed it ends with; `ramp` was the last."""
    match step:
        case Ramp():
            return abs(step.end - speed) / step.rate, step.end
        case Dwell():
            return step.seconds, speed
        case Coast():
            return COAST_SECONDS, step.until
        case Rest():
            return speed / ramp, 0.0
        case Ask() | Mark() | Trial():
            return 0.0, speed
