"""Fit the model to a response: a global search over the unknowns, then whitened complex least squares.

The search takes the speed as steady and the nameplate as exact. What it finds, all its minima, is where the refinement
starts; that one knows the moving speed and the nameplate's uncertainty, and frees modulus and density where they are
sought.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from rotorrig.identify.base_model import BASE_MODEL, ObjectiveName, Problem, Reals, SearchName, SearchResult, search
from rotorrig.identify.identification import Fit, Identification
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.measurement import Measurement, measure
from rotorrig.identify.uncertainty import (
    Identifiability,
    Resampling,
    describe_identifiability,
    estimates,
    with_bootstrap_intervals,
    with_intervals,
)
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import ConfigError, DataError, code_version
from rotorrig.rig.config import Identify, RigConfig

WHOLE = "whole sweep"

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class FitSettings:
    """Starts and steps of a fit, and what a probe sees."""

    starts: int = 2  # minima of the search that are refined, beside the nameplate, unless an earlier start is good
    first_steps: int = 12  # of a fit that others only begin from
    seen: float = 0.3  # sine of the least angle between a probe and the other axis: then it looks along this one


FIT = FitSettings()


def identify(
    response: OrderTrackedResponse,
    *,
    seed: int = 0,
    objective: ObjectiveName = "residual",
    method: SearchName | None = None,
    profile: bool = False,
    resampling: Resampling | None = None,
    progress: Progress = lambda text: None,
) -> Identification:
    """Identify what the config's [identify] table names, on the whole sweep and on its bands.

    `objective` is that of the search: the whitened complex "residual", or the chapter's "f1", "f2" or "f3" on the
    amplitudes of a single unbalance. `method` is how: by the "vector" of residuals and its derivatives, or by the
    objective's value alone, "modern" or "seed", the chapter's; by default the config's. With `profile` all intervals
    are of the profile likelihood, and not only those that the covariance would get wrong; with `resampling` those of
    the whole sweep are of a bootstrap. A band with too few rows is left out and the first fit's words say so. Raises
    ConfigError if the rig has no [identify] section, DataError if the whole sweep holds too few rows.
    """
    rig = response.rig
    known = _check(rig)
    began = time.perf_counter()
    options = _Options(objective=objective, method=method or known.search, seed=seed, profile=profile)
    left_out = []
    with threadpool_limits(1, user_api="blas"):  # thousands of small products: threads cost 40 times what they save
        progress(WHOLE)
        whole = _band(response, WHOLE)
        searched, best = _search_and_refine(response, whole, options)
        fits = [_fit(response, whole, whole, options, searched, best)]
        for name, limits in known.bands.items():
            progress(name)
            try:
                part = _band(response, name, limits)
                fits.append(
                    _fit(response, part, whole, options, *_search_and_refine(response, part, options, near=best.p))
                )
            except DataError as error:
                left_out.append(f"The band '{name}' was left out: {error}.")
        if resampling:
            progress("bootstrap")
            again = _BandRefit(response, options)
            fits[0] = with_bootstrap_intervals(fits[0], whole.problem, best, resampling, seed=seed, search=again)
    return Identification(
        fits=(replace(fits[0], words=(*fits[0].words, *left_out)), *fits[1:]),
        effects=(),
        wall_s=time.perf_counter() - began,
        source=replace(response.source, code_version=code_version()),
    )


def _check(rig: RigConfig) -> Identify:
    if rig.identify is None:
        raise ConfigError(f"{rig.name}: the config has no [identify] section, want bearings and a disk to identify")
    for bearing in rig.bearings:
        if bearing.over_speed:
            raise ConfigError(
                f"{rig.name}: bearing '{bearing.name}' is given over speed, want constants to identify by"
            )
    return rig.identify


def first_fit(response: OrderTrackedResponse, *, seed: int = 0) -> Solution:
    """Return a fit of the whole sweep alone to begin others from, in the vector of `Parameters`. Raises as `fit`."""
    _check(response.rig)
    with threadpool_limits(1, user_api="blas"):
        return _search_and_refine(
            response,
            _band(response, WHOLE),
            _Options(objective="residual", method="vector", seed=seed, profile=False, steps=FIT.first_steps),
        )[1]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Options:
    """Of every band's fit."""

    objective: ObjectiveName  # of the global search
    method: SearchName
    seed: int
    profile: bool
    steps: int = BASE_MODEL.most_steps  # of the least squares with all unknowns free


@dataclass(frozen=True, slots=True, kw_only=True)
class _Band:
    """The rows of one band of speeds and their least-squares problem."""

    name: str
    measured: Measurement
    problem: Problem


def _band(response: OrderTrackedResponse, name: str, limits: tuple[float, float] | None = None) -> _Band:
    measured = measure(response, band=limits)
    return _Band(name=name, measured=measured, problem=Problem(response, measured))


def _search_and_refine(
    response: OrderTrackedResponse, band: _Band, options: _Options, *, near: Reals | None = None
) -> tuple[SearchResult, Solution]:
    """Search a band, and refine what was found and, if given, `near`: the parameters of another band."""
    space = band.problem.parameters.space
    searched = search(
        response, band.measured, space, objective=options.objective, method=options.method, seed=options.seed
    )
    return searched, _best(
        _refine_starts(
            band.problem, [np.array(o.theta[: len(space)]) for o in searched.optima], near, steps=options.steps
        )
    )


@dataclass(frozen=True)
class _BandRefit:
    """Fits a bootstrap's draw as the measured one was: by the whole search."""

    response: OrderTrackedResponse
    options: _Options

    def __call__(self, problem: Problem, start: Reals) -> Solution:
        band = _Band(name=WHOLE, measured=problem.measured, problem=problem)
        return _search_and_refine(self.response, band, self.options)[1]


def _refine_starts(problem: Problem, optima: list[Reals], near: Reals | None, *, steps: int) -> Iterator[Solution]:
    """Refine one start after the other: `near`, the search's best minimum, the nameplate, the next minimum.

    Amplitudes of few probes leave valleys in which the search cannot choose; the nameplate is a fair guess there.
    """
    if near is not None:
        yield problem.solve(near)
    for theta in (*optima[:1], problem.parameters.space.nameplate, *optima[1 : FIT.starts]):
        yield problem.refine(theta, max_steps=steps)


def _best(refined: Iterator[Solution]) -> Solution:
    """Return the first that fits as the noise allows, else the best."""
    tried = []
    for candidate in refined:
        tried.append(candidate)
        if candidate.chi2 < candidate.dof:
            break
    return min(tried, key=lambda polished: polished.chi2)


def _fit(
    response: OrderTrackedResponse, band: _Band, whole: _Band, options: _Options, searched: SearchResult, best: Solution
) -> Fit:
    """Put the results of a band into words and numbers; `whole` predicts the rows outside it too."""
    problem = band.problem
    space = problem.parameters.space
    able = Identifiability(best, problem.parameters)
    unseen = unseen_axes(response, band.measured)
    omega = response.omega[band.measured.rows]
    prediction = np.full((len(response.omega), len(response.probes)), np.nan + 0j)  # NaN in the slow roll's own rows
    prediction[whole.measured.rows] = whole.problem.predict(best.p)[:-1]
    return Fit(
        name=band.name,
        band=(float(omega.min()), float(omega.max())),
        estimates=with_intervals(
            estimates.estimate_unknowns(best, problem, response.rig, unseen=unseen),
            best,
            problem,
            unseen=unseen,
            profile=options.profile,
        ),
        nuisances=estimates.estimate_nuisances(best, problem),
        unknowns=(*space.names, *(amount.name for amount in space.amounts)),
        optima=searched.optima,
        trace=searched.trace,
        objective=options.objective,
        evaluations=searched.evaluations,
        stop=searched.stop,
        seed=options.seed,
        chi2=best.chi2,
        dof=best.dof,
        prediction=prediction,
        directions=able.directions(),
        budget=able.budget(),
        words=(*describe_identifiability(best, problem, able, unseen=unseen), *_caveats(problem)),
    )


def unseen_axes(response: OrderTrackedResponse, measured: Measurement) -> str:
    """Return "", "x" or "y": the axis no usable probe looks along.

    There k and c show through gyroscopic coupling alone. That does restrict a fit, but in several valleys at once:
    with a single x probe kyy came out 18 % wrong at a stated 2 %.
    """
    angles = [response.rig.probe(name).angle for name in np.array(response.probes)[measured.usable[:-1].any(axis=0)]]
    seen = {"x": np.abs(np.cos(angles)).max(), "y": np.abs(np.sin(angles)).max()}
    return "".join(axis for axis, most in seen.items() if most < FIT.seen)


def _caveats(problem: Problem) -> tuple[str, ...]:
    return () if problem.swept else ("The times of the rows are not known: the model takes the speed as steady.",)
