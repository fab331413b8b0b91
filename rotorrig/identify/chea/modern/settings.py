"""Settings of `profile="modern"`: the search, its descents, and the Taylor model these follow."""

from dataclasses import dataclass, field
from math import factorial


@dataclass(frozen=True, slots=True, kw_only=True)
class TaylorSettings:
    """Prior of the local model. Lengths are in radii."""

    #: Expected size of the derivatives of 2nd, 3rd, 4th and 5th order. Measured: a factor of three changes the calls of
    #: a descent by some per cent; without 3rd and 4th order the banana function takes thrice as many.
    sizes: tuple[float, float, float, float] = (1000.0, 30.0, 10.0, 1.0)
    nearest: float = 0.5  # points nearer than that are trusted alike
    flat: float = 1e8  # size of the slope: so large that it is free

    @property
    def variances(self) -> tuple[float, float, float]:
        """Coefficients of the kernel from the power 2 on: the variance of the terms of Taylor's series."""
        second, third, fourth, _ = ((size / factorial(order)) ** 2 for order, size in enumerate(self.sizes, start=2))
        return second, third, fourth

    @property
    def remainder(self) -> float:
        """Variance of what the series leaves out."""
        return (self.sizes[-1] / factorial(len(self.sizes) + 1)) ** 2


@dataclass(frozen=True, slots=True, kw_only=True)
class DescentSettings:
    """One local search. Lengths are in the unit cube or, where it says so, in radii of the trust region."""

    taylor: TaylorSettings = field(default_factory=TaylorSettings)

    # the model
    points: int = 40  # nearest ones it is fitted to, or (dim + 1) (dim + 2) if that is more
    outlook: float = 4.0  # radii within which the model's minimum is shown to `stop_if`
    cliff: float = 1e8  # see _without_cliffs; from 1e4 on it costs nothing on smooth ground
    quadratics: int = 3  # in succession, for the least of the model

    # the trust region
    widest: float = 0.5  # of the cube
    foreseen: float = 0.7  # of the foreseen gain, above which the radius may grow
    poor: float = 0.1  # of it, below which the step was too long

    # the end
    certified: float = 3e-4  # radius of the points that confirm a minimum
    round: float = 0.1  # ratio of curvatures above which a valley is not narrow
    narrow: float = 30.0  # tolerances: how far along a narrow one its floor is tried
    sure: float = 0.02  # error of the rise foreseen there, of twice the rise: the minimum is off by 0.01 of the way
    attempts: int = 3  # at confirming one point; beyond, that the model sees no step down and none was met must do
    calls: int = 200  # after which a descent is over, times one more than there are parameters

    @property
    def poised(self) -> float:
        """Largest doubt of a slope: half of it is left by a lone point at the radius, all by one at two radii."""
        return self.taylor.sizes[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModernSettings:
    """Control parameters. Lengths are in the unit cube, where every parameter runs from 0 to 1."""

    sample: int = 16  # points gathered first, times one more than there are parameters
    neighbours: int = 3  # that the head of a cluster is no worse than, beyond one per parameter
    children: int = 6  # bred from the minima per round
    breeding: int = 16  # attempts per child wanted: with few minima most lead to known places
    far: int = 2  # points far from all others per round

    # Local searches
    radius: float = 0.1  # within which a descent from a gathered point trusts its first model
    basin: float = 0.25  # of the distance between minima: how far the basin of one is trusted to reach
    hops: tuple[float, float] = (1e-3, 0.3)  # from beside the lowest point: the shortest and the longest
    same_point: float = 2e-3  # ends of local searches this close are one minimum
    heading: float = 0.03  # of the way to go: a descent that makes for a known minimum this closely is given up
    stint: int = 24  # calls after which a descent ends, times one more than there are parameters
    promising: float = 0.1  # of the way from the best value to the sample's median: a child as low is descended from
    funnel_error: float = 0.8  # up to which a trend is followed, in standard deviations of what it describes

    descent: DescentSettings = field(default_factory=DescentSettings)

    # The natural end
    tie: float = 1e-5  # of the way from the best value to the sample's median: minima as low share the best value
    patience: float = 2.0  # calls without a find, times those until the last, for one best minimum among many,
    idle: int = 200  # or this, times one more than there are parameters, if that is less
    agreeing: int = 3  # descents are enough if they all lead to one minimum,
    per_minimum: int = 4  # descents each further minimum asks for,
    descents: int = 6  # up to so many,
    descents_per_parameter: int = 3  # and so many more per parameter
    shared: int = 3  # minima with one value: more say no more about a lower one

    # Beyond it, for all minima as low as the best
    doublings: int = 5  # of the sample, round by round
    patience_for_all: float = 3.0  # calls without one more, times those until the last
    idle_for_all: int = 3000  # and so many at least, times one more than there are parameters


#: One set of values for every function.
MODERN = ModernSettings()
