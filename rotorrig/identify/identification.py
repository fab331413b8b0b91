"""`Identification`: what a fit found, and its file `fit.json`."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig import Provenance


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """One identified or nuisance parameter, SI; `sigma` is one standard deviation, infinite if undetermined."""

    name: str  # "kxx", "spring kxx", "u", "phase disk 2", "E"; nuisances "E", "disk mass", "gain 1x", "angle 1x"
    value: float
    sigma: float
    unit: str  # SI: "N/m", "N s/m", "kg m", "rad", "" for a ratio
    nameplate: float  # NaN: the nameplate does not say
    determined: bool = True  # False: at a bound, or the data hardly restrict it
    bounds: tuple[float, float] | None = None  # within which it was looked for
    interval: tuple[float, float] | None = None  # 95 %; an end equal to that of `bounds` is open
    interval_by: str = ""  # "covariance", "profile likelihood" or "bootstrap"


@dataclass(frozen=True, slots=True, kw_only=True)
class Optimum:
    """One minimum of the search objective."""

    theta: tuple[float, ...]  # SI, in the order of `Fit.unknowns`
    cost: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """What one kind of step of a search did."""

    name: str  # "gather" or "genetic", "local", "breed", "far", "polish"
    steps: int
    evaluations: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchTrace:
    """The way of a global search: its stages, and where it looked. Places are in the unknowns of `Fit.unknowns`, SI."""

    method: str = "vector"  # by residuals and derivatives; by values alone "modern", or "seed": the chapter's
    stages: tuple[Stage, ...] = ()
    reduced: int = 0  # clusters that were not convex, in whose bounds points were gathered again
    heads: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 0)))  # (cluster, unknown) best of each
    points: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 0)))  # (point, unknown) evenly thinned


@dataclass(frozen=True, slots=True, kw_only=True)
class Direction:
    """A combination of the estimates, as a unit vector of relative changes (rad for phases), and how well it is known.

    The singular directions of the Fisher information: orthogonal, so that what one cannot tell another may.
    """

    weights: dict[str, float]  # estimate -> weight
    sigma: float  # one standard deviation along it, nuisances free within their priors
    sigma_of_noise: float  # the same with every nuisance known exactly: what the data alone would leave


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """The fit of one band of speeds."""

    name: str  # "whole sweep", or the band's name in the config
    band: tuple[float, float]  # rad/s
    estimates: tuple[Estimate, ...]  # kxx, kyy, cxx, cyy.., E and density where sought, u and phase
    nuisances: tuple[Estimate, ...]
    unknowns: tuple[str, ...]  # of the global search: names of the estimates, phases left out
    optima: tuple[Optimum, ...]  # all found by the global search, best first
    objective: str  # of the global search
    evaluations: int  # calls of that objective
    stop: str
    seed: int
    chi2: float  # of the refined fit, whitened complex residual of 1X
    dof: int
    prediction: NDArray[np.complex128]  # (speed, probe) m, 1X as measured, all responses one after the other
    directions: tuple[Direction, ...] = ()  # what the data and priors determine, least known first
    budget: dict[str, dict[str, float]] = field(default_factory=dict)  # estimate -> "noise".. -> part of variance
    trace: SearchTrace = field(default_factory=SearchTrace)  # of the global search
    words: tuple[str, ...]  # what the data cannot tell, in sentences

    def estimate(self, name: str) -> Estimate:
        """Return the estimate of that name."""
        return next(e for e in self.estimates if e.name == name)


@dataclass(frozen=True, slots=True, kw_only=True)
class Identification:
    """The fits of one or more responses: the whole of them first, then the config's bands."""

    fits: tuple[Fit, ...]
    effects: tuple[str, ...]  # extensions of the model in use
    responses: tuple[tuple[str, int], ...] = ()  # source hash and rows of each response, in the order of the rows
    wall_s: float
    source: Provenance
