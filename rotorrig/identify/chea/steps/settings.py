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
    risen: float = 0.99  # of the slope along a step: what may be left at its end (Wolfe); 0.9 costs eq. (2) 2 % more
    bracket: float = 0.01  # of a step: places between which the slope turns, so close, are one kink
    shortest: float = 1e-6  # of a step: below, the slope leads nowhere
    difference: float = 1.5e-8  # of the cube: forward differences; the square root of the float's resolution
    difference_at_kinks: float = 1e-10  # once a line search found nothing where it was promised something; see sqp.py
    shortening: tuple[float, float] = (0.1, 0.5)  # of a step that was too long: the least and the most that is kept

    # quadratic programs on a box
    passes: int = 8  # per parameter, at most: one lets a bound go or meets one


STEPS = StepSettings()
