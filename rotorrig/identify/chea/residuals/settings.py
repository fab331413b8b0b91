"""Tuning of the linear models of residuals, and of the descent to least absolute values."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearModelSettings:
    """Limits from which the linear model of a residual is solved in another way."""

    independent: float = 1e-4  # of a column's length lies beyond those before it: the normal equations keep 8 digits
    least_damping: float = 1e-14  # of a full step, in units of the columns: no more than rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class AbsoluteSettings:
    """The descent to a least sum of absolute values, and the linear program of each of its steps."""

    # trust region, in the unit cube
    shortest: float = 1e-12  # at which the cube has no finer points
    poor: float = 0.25  # of what the program promised: a step that gains less was too long,
    shrink: float = 0.25  # and the next goes that part of its way
    good: float = 0.75  # of it: after a step that gains more
    grow: float = 2.0  # the next may be so many times as long

    # the walk from corner to corner
    level: float = 1e-10  # of what it could be: a slope or a rate below is rounding
    still: float = 1e-14  # of the fastest parameter: one that moves less does not move
    edges: int = 20  # per parameter; 300 random residuals take 2, at most 4
    apart: float = 1e-9  # of the largest residual: moved apart by that, none coincide


LINEAR_MODEL = LinearModelSettings()
ABSOLUTE = AbsoluteSettings()
