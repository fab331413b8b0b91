"""`Identification`: what a fit found, and its file `fit.json`."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing import Resonance
from rotorrig.rig import Provenance


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """One identified or nuisance parameter, SI; `sigma` is one standard deviation, infinite if undetermined."""

    name: str  # "kxx", "spring kxx", "u", "phase disk 2", "E"; nuisances "E", "disk mass", "gain 1x", "angle 1x"
    value: float
    sigma: float
    unit: str  # SI: "N/m", "N s/m", "kg m", "rad", "" for a ratio
    nameplate: float  # NaN: the nameplate does not say
    pull: float = math.nan  # of a nuisance: signed, in standard deviations of what a right config would show
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
class Deviation:
    """One statement of the config, and how far off it is by the data alone, all other priors kept."""

    kind: str  # "bearing_position"
    where: str  # "spring"; empty where there is one only
    title: str  # "position of bearing spring"
    words: str  # "bearing spring sits 2.1 ± 0.2 mm further from the coupling than the config says"
    value: float  # true value less the stated one, SI; relative to it where `unit` is ""
    sigma: float  # one standard deviation; infinite if the data say nothing
    unit: str
    nameplate: float  # as the config states it, SI; NaN: not as a single number
    nameplate_unit: str
    pull: float  # signed, in standard deviations of what a right config would show
    evidence: float  # 2 ln of the odds that it is wrong by several sigmas of its prior, not within one
    nuisances: tuple[str, ...] = ()  # of the fit, that say so
    parameter: str = "off"  # its name among a cause's parameters

    @property
    def label(self) -> str:
        """Kind and place: "bearing_position, spring"."""
        return f"{self.kind}, {self.where}" if self.where else self.kind


@dataclass(frozen=True, slots=True, kw_only=True)
class Pull:
    """Joint pull of a group of statements that the data hardly tell apart."""

    group: str  # "positions"
    sigmas: float  # standard deviations of one normal variable as improbable
    deviations: tuple[Deviation, ...]  # of its members, each taken alone, the most pulled first


@dataclass(frozen=True, slots=True, kw_only=True)
class NameplateFinding:
    """A statement of the config that the data contradict, as what they pull at is explained best by it."""

    group: str
    sigmas: float  # joint pull of that group, earlier findings taken into account
    deviation: Deviation
    alternatives: tuple[Deviation, ...] = ()  # which explain the pull of the group as well, the best first

    @property
    def words(self) -> str:
        """The finding and what else may be off instead, as a sentence without its end."""
        others = "".join(f"; or {other.words}" for other in self.alternatives)
        return f"{self.deviation.words}{others} ({self.sigmas:.1f} sigma)"


@dataclass(frozen=True, slots=True, kw_only=True)
class NameplateCheck:
    """The config against a fit: every group's pull, and what is off beyond doubt."""

    pulls: tuple[Pull, ...] = ()  # the largest first
    findings: tuple[NameplateFinding, ...] = ()


NO_CHECK = NameplateCheck()


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelResonance:
    """A critical speed of a fitted model, read off the curve it predicts for one run at one probe."""

    response: int  # number of the response, from 0
    run: str
    probe: str
    resonance: Resonance  # sigmas by the uncertainty of the fitted parameters


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
    p: float = math.nan  # of the adequacy test: that a right model has residuals as large
    scatter_ratio: float = math.nan  # of 1X residuals over their scatter from row to row: 1 where only noise is left
    adequate: bool = True  # it passed that test
    prediction: NDArray[np.complex128]  # (speed, probe) m, 1X as measured, all responses one after the other
    directions: tuple[Direction, ...] = ()  # what the data and priors determine, least known first
    nameplate: NameplateCheck = NO_CHECK  # pulls, and what of the config they contradict
    resonances: tuple[ModelResonance, ...] = ()  # none of amplitudes alone, nor of an older file
    budget: dict[str, dict[str, float]] = field(default_factory=dict)  # estimate -> "noise".. -> part of variance
    trace: SearchTrace = field(default_factory=SearchTrace)  # of the global search
    words: tuple[str, ...]  # what the data cannot tell, in sentences

    def estimate(self, name: str) -> Estimate:
        """Return the estimate of that name."""
        return next(e for e in self.estimates if e.name == name)


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialAngles:
    """How the angles of trial masses are counted, where the data say: not as they were told."""

    reversed: bool  # against the rotation
    offset: float  # rad: how far their zero is from the keyphasor mark in the sense of rotation
    sigma: float  # rad, one standard deviation of that
    chi2_told: float  # of the fit with the angles as told
    chi2: float  # with these
    or_offset: float | None  # rad: with the other sense this would be as good

    @property
    def words(self) -> str:
        """What it says, and what was done."""
        senses = ["in the sense of rotation", "against the rotation"]
        mine, other = senses[self.reversed], senses[not self.reversed]
        offset, sigma = round(math.degrees(self.offset)), math.degrees(self.sigma)
        words = (
            f"THE ANGLES OF THE TRIAL MASSES ARE NOT AS TOLD: counted {mine}, from a zero {offset} ± {sigma:.1g} deg "
            "from the keyphasor mark in the sense of rotation, chi2 falls from "
            f"{self.chi2_told:.3g} to {self.chi2:.3g}."
        )
        if self.or_offset is not None:
            words += f" Counted {other}, with {round(math.degrees(self.or_offset))} deg, it would be as good."
        return f"{words} The fit takes them so; see how they were mounted."


@dataclass(frozen=True, slots=True, kw_only=True)
class Identification:
    """The fits of one or more responses: the whole of them first, then the config's bands."""

    fits: tuple[Fit, ...]
    trial_angles: TrialAngles | None = None  # None: as told
    effects: tuple[str, ...]  # extensions of the model in use
    responses: tuple[tuple[str, int], ...] = ()  # source hash and rows of each response, in the order of the rows
    wall_s: float
    source: Provenance
