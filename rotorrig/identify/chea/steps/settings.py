"""Tuning of the steps that both profiles share."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class StepSettings:
    """Far search, quadratic programs, and sequential quadratic programming, in the unit cube."""

    # far search
    candidates: int = 64  # times one more than there are parameters

    # sequential quadratic programming
    first: float = 0.05  # length of the first step, in the steepest parameter: a start is most often in its basin
    sufficient: float = 1e-4  # of the decrease the slope promises (Armijo)
    shortest: float = 1e-6  # of a step: below, the slope leads nowhere
    shortening: tuple[float, float] = (0.1, 0.5)  # of a step that was too long: the least and the most that is kept

    # quadratic programs on a box
    passes: int = 8  # per parameter, at most: one lets a bound go or meets one


STEPS = StepSettings()
