"""Expected timeline of a sweep, for its preview and its progress: begin, end and speeds of every step."""

from collections.abc import Iterable
from dataclasses import dataclass

from rotorrig.acquisition.sweep.critical_speeds import with_start_speeds
from rotorrig.acquisition.sweep.steps import Ask, Coast, Dwell, Mark, Provoke, Ramp, Rest, Step, Trial

COAST_SECONDS = 45.0  # an RK4's from full speed; another rotor's is not known before it has been measured


@dataclass(frozen=True, slots=True, kw_only=True)
class TimedStep:
    """Step with the times [s] and speeds [rad/s] expected of it."""

    step: Step
    begin: float
    end: float
    speed: float  # at which it begins
    to: float  # at which it ends

    @property
    def seconds(self) -> float:
        """Expected duration [s]."""
        return self.end - self.begin


def plan_timeline(steps: Iterable[Step]) -> tuple[TimedStep, ...]:
    """Return the steps with their times, from rest; the time an operator takes is unknown and counts as zero."""
    timeline: list[TimedStep] = []
    t, ramp = 0.0, 1.0
    for step, speed in with_start_speeds(steps):
        seconds, to = _duration_and_end(step, speed, ramp)
        timeline.append(TimedStep(step=step, begin=t, end=t + seconds, speed=speed, to=to))
        t += seconds
        ramp = step.rate if isinstance(step, Ramp) else ramp
    return tuple(timeline)


def _duration_and_end(step: Step, speed: float, ramp: float) -> tuple[float, float]:
    """Return the seconds expected of a step from `speed` [rad/s], and its end speed; `ramp` [rad/s^2] was the last."""
    match step:
        case Ramp():
            return abs(step.end - speed) / step.rate, step.end
        case Dwell():
            return step.seconds, speed
        case Coast():
            return COAST_SECONDS, step.until
        case Rest():
            return speed / ramp, 0.0
        case Ask() | Mark() | Provoke() | Trial():
            return 0.0, speed
