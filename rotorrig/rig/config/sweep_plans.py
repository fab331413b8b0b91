"""Tables of sweep plans, one per kind; acquisition.sweep.plans makes steps of them."""

import math
from typing import Annotated, Literal, Self

from pydantic import Discriminator, Field, model_validator

from rotorrig.rig.config.nameplate import MOST, Name, Part, RampRate, Speed, Time

MOST_SPEEDS = 1000  # of a stepped plan


class _RunUp(Part):
    """A slow roll, and a ramp from `start` to `end`."""

    slow_roll: Speed  # below start
    slow_roll_time: Time  # how long the slow roll is recorded
    start: Speed  # the lowest speed of the ramp
    end: Speed  # the highest speed
    ramp: RampRate  # of the run; of settling and slow roll too, on a drive with one ramp

    @property
    def fastest(self) -> float:
        """The highest speed it goes to [rad/s]."""
        return self.end

    @model_validator(mode="after")
    def _rises(self) -> Self:
        if not self.slow_roll < self.start < self.end:
            raise ValueError("want slow_roll < start < end")
        return self


class RunUpCoastDown(_RunUp):
    """Slow roll, a ramp from `start` to `end`, then coast-down with the power off."""

    kind: Literal["run-up-coast-down"]  # chooses this table


class RunUpRampDown(_RunUp):
    """Slow roll, a ramp from `start` to `end` and back, under power both ways."""

    kind: Literal["run-up-ramp-down"]  # chooses this table


class Stepped(Part):
    """Slow roll, then one speed after the other, each held for `dwell` once it has settled.

    The speeds are a list, or `start` to `end` every `step`; of those, the ones inside a critical band are left out.
    """

    kind: Literal["stepped"]  # chooses this table
    slow_roll: Speed  # before the steps
    slow_roll_time: Time  # how long the slow roll is recorded
    speeds: tuple[Speed, ...] = Field((), max_length=MOST_SPEEDS)  # instead of start, end and step
    start: Speed | None = None  # the lowest speed
    end: Speed | None = None  # the highest speed
    step: Speed | None = None  # between neighbouring speeds
    ramp: RampRate  # from one speed to the next
    settle: Time = 2.0  # time at each speed before it is recorded
    dwell: Time  # how long each speed is recorded
    direction: Literal["up", "down", "up-down"] = "up"  # order of the speeds

    @property
    def listed(self) -> bool:
        """True if every speed was named."""
        return bool(self.speeds)

    @property
    def rising(self) -> tuple[float, ...]:
        """The speeds, lowest first [rad/s]."""
        if self.speeds:
            return tuple(sorted(self.speeds))
        assert self.start is not None and self.end is not None and self.step is not None  # _says_speeds_once
        count = math.floor((self.end - self.start) / self.step * (1 + 1e-9)) + 1  # 0.3 / 0.1 is a bit less than 3
        return tuple(self.start + i * self.step for i in range(count))

    @property
    def fastest(self) -> float:
        """The highest speed it goes to [rad/s]."""
        return max(self.rising)

    @model_validator(mode="after")
    def _says_speeds_once(self) -> Self:
        grid = (self.start, self.end, self.step)
        if self.speeds and any(value is not None for value in grid):
            raise ValueError("speeds stands beside start, end and step, want one or the other")
        if self.speeds:
            if len(set(self.speeds)) < len(self.speeds):
                raise ValueError("speeds: one stands there twice, want each once")
            return self
        if self.start is None or self.end is None or self.step is None:
            raise ValueError("want speeds, or start, end and step")
        if not self.start < self.end:
            raise ValueError("want start < end; direction says which way they are gone through")
        if (self.end - self.start) / self.step > MOST_SPEEDS:
            raise ValueError(f"want at most {MOST_SPEEDS} steps between start and end")
        return self


class DwellAt(Part):
    """One speed, held for `time` once it has settled."""

    kind: Literal["dwell"]  # chooses this table
    speed: Speed  # to hold
    time: Time  # how long it is recorded
    ramp: RampRate  # up to it
    settle: Time = 2.0  # time at the speed before it is recorded

    @property
    def fastest(self) -> float:
        """The highest speed it goes to [rad/s]."""
        return self.speed


class TrialMassRuns(Part):
    """Another plan as it is, then at rest a prompt to mount the first mass and the plan again, and so on.

    A mass is written as for `rotor sweep --trial`; each is taken off before the next one is mounted.
    """

    kind: Literal["trial-mass"]  # chooses this table
    plan: Name = "default"  # another plan of the config
    masses: tuple[str, ...] = Field(min_length=1, max_length=MOST)  # "disk: 12 g mm at 90 deg", one after the other

    @property
    def fastest(self) -> float:
        """0: the highest speed is that of the plan it names."""
        return 0.0


Plan = Annotated[RunUpCoastDown | RunUpRampDown | Stepped | DwellAt | TrialMassRuns, Discriminator("kind")]
