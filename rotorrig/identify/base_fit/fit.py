"""Identification of what the config's [identify] table names, from recordings of one rig, whole and in bands of speed.

The model and its noise are those of a diagnosis: base_fit.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from rotorrig.identify.base_fit.amplitudes_alone import judge_amplitudes, take_amplitudes
from rotorrig.identify.base_fit.base_fit import (
    BaseProblem,
    SearchOptions,
    assess_fit,
    check_rig,
    config_effects,
    search_and_refine,
)
from rotorrig.identify.base_fit.trial_angles import judge_trial_angles, recount
from rotorrig.identify.base_model import ObjectiveName, Reals, SearchName, SearchResult
from rotorrig.identify.extended_model import ExtendedProblem, Recording, recordings_of
from rotorrig.identify.identification import Fit, Identification, TrialAngles
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.uncertainty import (
    Identifiability,
    Resampling,
    check_nameplate,
    describe_identifiability,
    estimates,
    model_resonances,
    with_bootstrap_intervals,
    with_intervals,
)
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import DataError, code_version

WHOLE = "whole sweep"
SEEN = 0.3  # sine of the least angle between a probe and the other axis: then it looks along this one

Progress = Callable[[str], None]


def identify(
    responses: Sequence[OrderTrackedResponse],
    *,
    seed: int = 0,
    objective: ObjectiveName = "residual",
    method: SearchName | None = None,
    profile: bool = False,
    resampling: Resampling | None = None,
    progress: Progress = lambda text: None,
) -> Identification:
    """Identify what the config's [identify] table names, on the whole of all recordings and on bands of speed.

    `objective` is that of the search, in the first recording: the whitened complex "residual", or the chapter's "f1",
    "f2" or "f3" on the amplitudes of a single unbalance. `method` is how: by the "vector" of residuals and its
    derivatives, or by the objective's value alone, "modern" or "seed", the chapter's; by default the config's. With
    `profile` all intervals are of the profile likelihood, and not only those that the covariance would get wrong; with
    `resampling` those of the whole are of a bootstrap. A band with too few rows is left out and the first fit's words
    say so. Recordings turn backwards whose rig has the other sense of rotation than the first's. Of responses without
    phases the amplitudes are fitted, searched by "f1", "f2" or "f3" and refined by least squares of predicted less
    measured amplitude in standard deviations. Raises ConfigError if the rig has no [identify] section or an unknown
    effect, DataError if a recording holds too few rows or other probes or orders than the first, or no phases and what
    is asked for wants them.
    """
    if not responses:
        raise DataError("no response was given, want at least one to identify from")
    rig = responses[0].rig
    taken, remarks = take_amplitudes(responses, objective=objective, bootstrap=resampling is not None)
    known = check_rig(rig)
    began = time.perf_counter()
    options = SearchOptions(objective=objective, method=method or known.search, seed=seed)
    fitting = _Fitting(responses=taken, search=options, profile=profile)
    with threadpool_limits(1, user_api="blas"):  # thousands of small products: threads cost 40 times what they save
        progress(WHOLE)
        whole = fitting.base()
        searched, problem, best = search_and_refine(whole, fitting.search)
        fits = [fitting.fit(WHOLE, problem, problem, searched, best)]
        angles = None if fits[0].adequate else fitting.judge_trial_angles(best)
        if angles:
            counted = [recount(r, reversed_=angles.reversed, offset=angles.offset) for r in taken]
            fitting = replace(fitting, responses=counted)
            whole = fitting.base()
            searched, problem, best = search_and_refine(whole, fitting.search)
            fits = [fitting.fit(WHOLE, problem, problem, searched, best)]
            remarks += (angles.words,)
        for name, limits in known.bands.items():
            progress(name)
            try:
                searched, of_part, near = search_and_refine(fitting.base(limits), fitting.search, near=best.p)
                fits.append(fitting.fit(name, of_part, problem, searched, near))
            except DataError as error:
                remarks += (f"The band '{name}' was left out: {error}.",)
        if resampling:
            progress("bootstrap")
            again = _Refit(whole, fitting.search)
            fits[0] = with_bootstrap_intervals(fits[0], problem, best, resampling, seed=seed, search=again)
    return Identification(
        fits=(replace(fits[0], words=(*fits[0].words, *remarks)), *fits[1:]),
        trial_angles=angles,
        effects=tuple(effect.label for effect in rig.effects),
        responses=tuple((r.source.source_hash, len(r.omega)) for r in responses),
        wall_s=time.perf_counter() - began,
        source=replace(responses[0].source, code_version=code_version()),
    )


@dataclass(frozen=True)
class _Refit:
    """Fits a bootstrap's draw as the measured one was: by the whole search."""

    base: BaseProblem
    search: SearchOptions

    def __call__(self, problem: ExtendedProblem, start: Reals) -> Solution:
        return search_and_refine(replace(self.base, problem=problem), self.search)[-1]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Fitting:
    """What the fits of all bands share."""

    responses: Sequence[OrderTrackedResponse]
    search: SearchOptions
    profile: bool

    def base(self, band: tuple[float, float] | None = None) -> BaseProblem:
        """Lay out the problem at 1X of a band of speeds [rad/s]. Raises DataError if it has too few rows."""
        recordings = recordings_of(self.responses, orders=(1,), band=band)
        return BaseProblem.of(recordings, config_effects(self.responses[0].rig))

    def judge_trial_angles(self, told: Solution) -> TrialAngles | None:
        """Return how the angles of trial masses are counted if not as they are `told` to that fit."""
        return judge_trial_angles(self.responses, config_effects(self.responses[0].rig), self.search, told=told)

    def fit(
        self, name: str, problem: ExtendedProblem, whole: ExtendedProblem, searched: SearchResult, best: Solution
    ) -> Fit:
        """Put the results of a band into words and numbers; `whole` predicts the rows outside it too."""
        space = problem.parameters.base.space
        able = Identifiability(best, problem.parameters, phases=not problem.model.amplitudes_alone)
        unseen = unseen_axes(problem.recordings)
        if problem.model.amplitudes_alone:
            scatter_ratio, p, adequate = judge_amplitudes(problem, best)
        else:
            adequacy = assess_fit(problem, best, fitted_alone=True).adequacy
            scatter_ratio, p, adequate = adequacy.scatter_ratio, adequacy.p, adequacy.adequate
        omega = np.concatenate([r.response.omega[r.rows] for r in problem.recordings])
        return Fit(
            name=name,
            band=(float(omega.min()), float(omega.max())),
            estimates=with_intervals(
                estimates.estimate_unknowns(best, problem, unseen=unseen),
                best,
                problem,
                unseen=unseen,
                profile=self.profile,
            ),
            nuisances=estimates.estimate_nuisances(best, problem),
            unknowns=(*space.names, *(amount.name for amount in space.amounts)),
            optima=searched.optima,
            trace=searched.trace,
            objective=self.search.objective,
            evaluations=searched.evaluations,
            stop=searched.stop,
            seed=self.search.seed,
            chi2=best.chi2,
            dof=best.dof,
            p=p,
            scatter_ratio=scatter_ratio,
            adequate=adequate,
            nameplate=check_nameplate(best, problem),
            resonances=model_resonances(best, problem),
            prediction=_predict_all(whole, best.p),
            directions=able.directions(),
            budget=able.budget(),
            words=(*describe_identifiability(best, problem, able, unseen=unseen), *_caveats(problem)),
        )


def _predict_all(problem: ExtendedProblem, p: Reals) -> NDArray[np.complex128]:
    """Return 1X as measured, (speed, probe) of all recordings one after the other; NaN in a slow roll's own rows."""
    return np.concatenate(
        [
            recording.in_response(predicted[1])
            for recording, predicted in zip(problem.recordings, problem.model.predict(p), strict=True)
        ]
    )


def unseen_axes(recordings: Sequence[Recording]) -> str:
    """Return "", "x" or "y": the axis no usable probe looks along.

    There k and c show through gyroscopic coupling alone. That does restrict a fit, but in several valleys at once:
    with a single x probe kyy came out 18 % wrong at a stated 2 %.
    """
    first = recordings[0].response
    used = np.any([recording.measured[1].usable[:-1].any(axis=0) for recording in recordings], axis=0)
    angles = [first.rig.probe(name).angle for name in np.array(first.probes)[used]]
    seen = {"x": np.abs(np.cos(angles)).max(), "y": np.abs(np.sin(angles)).max()}
    return "".join(axis for axis, most in seen.items() if most < SEEN)


def _caveats(problem: ExtendedProblem) -> tuple[str, ...]:
    return () if problem.swept else ("The times of the rows are not known: the model takes the speed as steady.",)
