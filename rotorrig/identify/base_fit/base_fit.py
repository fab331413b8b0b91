"""Fit of the base model, and its adequacy: a global search, then whitened complex least squares over all recordings.

The search, in the first recording, takes the speed as steady and the nameplate as exact. What it finds, all its
minima, is where the refinement starts; that one knows the moving speed and the nameplate's uncertainty, and frees
modulus and density where they are sought. Effects that the rig's config brings are part of the base.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from rotorrig.identify.adequacy import Adequacy, assess, assess_all, excess_scatter
from rotorrig.identify.base_model import ObjectiveName, Reals, SearchName, SearchResult, search
from rotorrig.identify.extended_model import ExtendedModel, ExtendedProblem, Recording, nuisance_effects
from rotorrig.identify.least_squares import LEAST_SQUARES, Solution
from rotorrig.rig import ConfigError
from rotorrig.rig.config import Identify, RigConfig
from rotorrig.sims.effects import Effect, find

KnownEffect = tuple[Effect, dict[str, float]]  # and its unknowns in SI


@dataclass(frozen=True, slots=True, kw_only=True)
class BaseFitSettings:
    """Starts of a fit, and the end of one for a diagnosis."""

    starts: int = 2  # minima of the search that are refined, beside the nameplate, unless an earlier start is good
    same: float = 0.01  # in working coordinates: unknowns so near to one another are one start
    begun: float = 0.01  # of chi2 of the first recording: where a refinement in it ends, and that in all begins
    settled: float = 0.1  # of chi2 of all, where a fit for a diagnosis ends: a step of a third of a standard deviation
    roughly: float = 1e-3  # of chi2, where it ends at first: how much rows scatter is not known yet
    wrong: float = 1e-5  # of chi2, where it ends at last if that is more: a wrong one wanders on for next to nothing
    poor: float = 2.0  # chi2 per degree of freedom from which it ends roughly: it is no place to begin from


BASE_FIT = BaseFitSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchOptions:
    """How the first recording is searched, and where least squares with all unknowns free end."""

    objective: ObjectiveName = "residual"
    method: SearchName = "vector"
    seed: int = 0
    tolerance: float = LEAST_SQUARES.tolerance  # of chi2, in all recordings
    share: float = 0.0  # of all of it, where that is more


@dataclass(frozen=True, slots=True, kw_only=True)
class BaseProblem:
    """The least-squares problem of the base model, and where a fit begins its effects."""

    problem: ExtendedProblem
    own: Reals  # unknowns of its effects, in sizes

    @classmethod
    def of(cls, recordings: Sequence[Recording], effects: Sequence[KnownEffect] = ()) -> "BaseProblem":
        """Return that of these recordings; `effects` begin at their values. Raises ConfigError as `check_rig`."""
        check_rig(recordings[0].response.rig)
        known = [*((effect, effect.at_zero) for effect in nuisance_effects(recordings)), *effects]
        problem = ExtendedProblem(ExtendedModel(recordings, [effect for effect, _ in known]))
        own = np.array([theta[q.name] / q.size for effect, theta in known for q in effect.parameters])
        return cls(problem=problem, own=own)


def check_rig(rig: RigConfig) -> Identify:
    """Return what is to be identified. Raises ConfigError if there is nothing, or nothing that can be."""
    if rig.identify is None:
        raise ConfigError(f"{rig.name}: the config has no [identify] section, want bearings and a disk to identify")
    for bearing in rig.bearings:
        if bearing.over_speed:
            raise ConfigError(
                f"{rig.name}: bearing '{bearing.name}' is given over speed, want constants to identify by"
            )
    return rig.identify


def config_effects(rig: RigConfig) -> list[KnownEffect]:
    """Return the effects that a rig's config brings, with their values. Raises ConfigError on an unknown one."""
    effects = []
    for extension in rig.effects:
        try:
            effect = find(rig, extension.label)
        except ValueError as error:
            raise ConfigError(f"{rig.name}: {error}") from error
        theta = effect.at_zero | extension.parameters
        effects.append((effect.fix_grid_searched(theta), theta))
    return effects


def search_and_refine(
    base: BaseProblem, options: SearchOptions, *, near: Reals | None = None
) -> tuple[SearchResult, ExtendedProblem, Solution]:
    """Search the first recording, refine at 1X of it what was found and, if given, the vector `near`; then fit all.

    Until then the model is taken for exact: its own error is a share of a motion that is not known yet. Returned with
    the minima found and the fit is the problem fitted in the end, which expects that error.
    """
    problem, first = base.problem.taken_for_exact(), base.problem.recordings[0]
    space = problem.parameters.base.space
    searched = search(
        first.response,
        first.measured[1],
        space,
        objective=options.objective,
        method=options.method,
        seed=options.seed,
    )
    optima = [np.array(o.theta[: len(space)]) for o in searched.optima]
    begun = BaseProblem(problem=problem.on([first.first_order()]), own=base.own)
    best = _best(begun.problem, _refine_starts(begun, optima, near))
    problem = problem.expecting_error(best.p)
    start = problem.solve_linear(best.p, problem.parameters.free)  # other orders and recordings have not been looked at
    return searched, problem, problem.solve(start, tolerance=options.tolerance, share=options.share)


def _refine_starts(base: BaseProblem, optima: list[Reals], near: Reals | None) -> Iterator[Solution]:
    """Refine one start after the other: `near`, the search's best minimum, the nameplate, the next minimum.

    Amplitudes of few probes leave valleys in which the search cannot choose; the nameplate is a fair guess there. A
    start that leads to where an earlier one did is passed over, as is a minimum of the steady model that is unstable
    and has no swept motion.
    """
    problem = base.problem
    approached: list[Reals] = []
    if near is not None:
        yield problem.solve(near, damped=True)
    for theta in (*optima[:1], problem.parameters.base.space.nameplate, *optima[1 : BASE_FIT.starts]):
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                begin = problem.approach(theta, base.own).p
                sought = begin[problem.parameters.base.sought]
                if any(np.abs(sought - other).max() < BASE_FIT.same for other in approached):
                    continue
                approached.append(sought)
                refined = problem.solve(begin, share=BASE_FIT.begun, damped=True)
        except np.linalg.LinAlgError:
            continue
        if np.isfinite(refined.chi2):
            yield refined


def _best(problem: ExtendedProblem, refined: Iterator[Solution]) -> Solution:
    """Return the first that fits as noise and the model's own error allow, else the best."""
    tried = []
    for candidate in refined:
        tried.append(candidate)
        off = problem.expecting_error(candidate.p).residual(candidate.p)
        if off @ off < candidate.dof:
            break
    return min(tried, key=lambda polished: polished.chi2)


@dataclass(frozen=True, slots=True, kw_only=True)
class AssessedFit:
    """A fit of all recordings and the test of it."""

    problem: ExtendedProblem
    polished: Solution
    adequacy: Adequacy  # its maps have the rows of all responses, one after the other


def fit_base(recordings: Sequence[Recording], effects: Sequence[KnownEffect] = (), *, seed: int = 0) -> AssessedFit:
    """Fit the base model to all recordings; `effects` of the config begin at their values. Raises as `identify`.

    Where rows scatter more than their covariance says, the recordings of the result have the noise they show.
    """
    base = BaseProblem.of(recordings, effects)
    options = SearchOptions(seed=seed, tolerance=BASE_FIT.settled, share=BASE_FIT.roughly)
    with threadpool_limits(1, user_api="blas"):
        _, fitted, roughly = search_and_refine(base, options)
        problem = with_scatter(fitted, roughly.p)
        known = roughly.jacobian if problem is fitted else None
        share = BASE_FIT.wrong if roughly.chi2 < BASE_FIT.poor * roughly.dof else BASE_FIT.roughly
        polished = problem.solve(roughly.p, tolerance=options.tolerance, share=share, jacobian=known)
    return assess_fit(problem, polished)


def refit_base(fit: AssessedFit, start: Reals) -> AssessedFit:
    """Return the base fitted anew from a vector that fits better than the one it was left at."""
    problem = fit.problem.expecting_error(start)
    return assess_fit(problem, problem.solve(start, tolerance=BASE_FIT.settled))


def with_scatter(problem: ExtendedProblem, p: Reals) -> ExtendedProblem:
    """Return the problem with recordings at least as noisy as their residuals at `p` scatter from row to row."""
    louder = []
    for recording, predicted in zip(problem.recordings, problem.model.predict(p), strict=True):
        run = recording.response.run[recording.rows]
        factors = {
            order: excess_scatter(measured.where_usable(measured.row_sigmas(predicted[order] - measured.z))[:-1], run)
            for order, measured in recording.measured.items()
        }
        louder.append(recording.louder(factors))
    same = all(after is before for after, before in zip(louder, problem.recordings, strict=True))
    return problem if same else problem.on(louder)


def assess_fit(problem: ExtendedProblem, polished: Solution, *, fitted_alone: bool = False) -> AssessedFit:
    """Test a fit: adequate if it is for every recording; with `fitted_alone` by the orders it is of and no others."""
    used = count_values_followed(problem, polished)
    each = []
    predictions, errors = problem.model.predict(polished.p), problem.known_error(polished.p)
    for recording, predicted, error in zip(problem.recordings, predictions, errors, strict=True):
        whole = {order: recording.in_response(z) for order, z in predicted.items()}
        if fitted_alone:
            nothing = np.full(recording.response.z.shape[:2], np.nan + 0j)
            whole = {int(order): nothing for order in recording.response.orders if order == int(order)} | whole
        known = {order: recording.in_response(vectors) for order, vectors in error.items()}
        each.append(assess(recording.response, whole, known=known, used=used[recording.number]))
    return AssessedFit(problem=problem, polished=polished, adequacy=assess_all(each))


def count_values_followed(problem: ExtendedProblem, polished: Solution) -> dict[int, float]:
    """Return recording number -> how many of its 1X values the fit could follow: the trace of the hat matrix."""
    length = np.linalg.norm(polished.jacobian, axis=0)
    basis = np.linalg.qr(polished.jacobian[:, length > 0] / length[length > 0])[0]
    leverage = np.einsum("fp,fp->f", basis, basis)
    followed, begin = {}, 0
    for recording in problem.recordings:
        for order, measured in recording.measured.items():
            end = begin + measured.whiten[..., 0].size
            if order == 1:
                followed[recording.number] = float(leverage[begin:end].sum())
            begin = end
    return followed
