"""Fit of one candidate effect beside those a model has, given up once it falls far behind the best so far.

Evidence is the Bayesian information criterion, BIC = chi2 + k ln n (Schwarz, Annals of Statistics 6 (1978) 461), n the
values at 1X that are independent: those of neighbouring rows, `ADEQUACY.stretch` of them, are off together.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from rotorrig.identify.adequacy import ADEQUACY
from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes.score_test import Score, relocate
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Solution, Stop, Worth
from rotorrig.rig import DataError
from rotorrig.sims.effects import Effect, magnitudes

Refine = Callable[..., Solution]  # of a problem from a start


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """Fit of a model with one more effect, the candidate: the last of its effects."""

    problem: ExtendedProblem
    polished: Solution
    lam: float  # by how much chi2 is below that without the last effect
    evidence: float  # by how much BIC is

    @property
    def effect(self) -> Effect:
        """The candidate effect."""
        return self.problem.effects[-1]


def plausible(candidate: Candidate) -> bool:
    """Say whether the candidate effect may be of a size such rigs have; phasors by their magnitude."""
    names, effect, fit = candidate.problem.parameters, candidate.effect, candidate.polished
    theta, sigma = (names.of_effect(part, len(names.effects) - 1) for part in (fit.p, fit.sigma))
    sizes = {name: value for name, value, _ in magnitudes(effect.parameters, theta)}
    return effect.is_plausible(theta) and all(
        q.low - SELECTION.unsure * sigma[q.name]
        <= sizes.get(q.name.removesuffix(" re"), theta[q.name])
        <= q.high + SELECTION.unsure * sigma[q.name]
        for q in effect.parameters
        if not q.name.endswith(" im")
    )


def fit_candidate(
    problem: ExtendedProblem,
    polished: Solution,
    plain: Solution | None,
    score: Score,
    *,
    leader: float,
    go_on: Callable[[], bool] = lambda: True,
) -> Candidate | None:
    """Fit the effect of a score beside those of `problem`, fitted as `polished`; None if there is none.

    `plain` is the fit with the nuisances at their priors, where an unmodelled cause has biased them: from there a
    fit returns only slowly, as every other unknown has to move along; so the candidate is started from `plain`.

    It is given up once it could not come near `leader`, the evidence of the best so far, nor to any that counts, with
    twice the fall of chi2 that a full step promises, or ten times under a force law, which bends more (and counts at
    any evidence: what a step from far off promises says little there); and not begun where ten times its score could
    not. So it is once `go_on` says no.
    """
    cost = price(problem, score.effect)
    least = leader - SELECTION.near if score.effect.needs_starts else max(leader - SELECTION.near, SELECTION.enough)
    hoped = SELECTION.promised_by_law if score.effect.needs_starts else SELECTION.promised

    def worth(chi2: float, promise: float) -> bool:
        return go_on() and polished.chi2 - chi2 + hoped * promise - cost > least

    if not SELECTION.promised_by_law * score.lam - cost > least:
        return None
    larger = problem.extended((*problem.effects, score.effect))
    refine = partial(_refine, worth=worth, tolerance=tolerance(polished))
    try:
        best = _fit_first(larger, polished, plain, score, worth=worth, refine=refine)
        for _ in range(SELECTION.relocations if score.effect.grid and best.stop is not Stop.GIVEN_UP else 0):
            moved = relocate(problem, best.p[: len(polished.p)], score.effect)
            if _same_place(moved, larger.effects[-1]):
                break
            larger = problem.extended((*problem.effects, moved))
            best = refine(larger, best.p)
        if score.effect.initial_guesses and best.stop is not Stop.GIVEN_UP:
            best = _fit_from_better_guess(larger, best, refine)
    except (DataError, np.linalg.LinAlgError):
        return None  # no motion is found, or none that is finite
    if not np.isfinite(best.chi2):
        return None
    larger, best = relocate_last_effect(larger, best)
    lam = polished.chi2 - best.chi2
    best = replace(best, jacobian=np.zeros((0, len(best.p))))  # some 15 MB that nobody asks for again
    return Candidate(problem=larger, polished=best, lam=lam, evidence=lam - cost)


def finish(candidate: Candidate) -> Candidate:
    """Fit a candidate to its end, from where it was left; itself if no bounded motion is found further on."""
    problem = candidate.problem
    steps = SELECTION.steps_of_law if _under_law(problem) else SELECTION.steps_of_searched
    try:
        fit = problem.solve(candidate.polished.p, tolerance=SELECTION.settled, max_steps=steps)
    except (DataError, np.linalg.LinAlgError):
        return candidate
    problem, fit = relocate_last_effect(problem, fit)
    gained = candidate.polished.chi2 - fit.chi2
    fit = replace(fit, jacobian=np.zeros((0, len(fit.p))))
    return Candidate(problem=problem, polished=fit, lam=candidate.lam + gained, evidence=candidate.evidence + gained)


def price(problem: ExtendedProblem, effect: Effect) -> float:
    """Return what BIC asks for the unknowns of an effect."""
    independent = sum(recording.measured[1].size for recording in problem.recordings) / ADEQUACY.stretch
    return sum(q.low < q.high for q in effect.parameters) * float(np.log(independent))


def relocate_last_effect(problem: ExtendedProblem, fit: Solution) -> tuple[ExtendedProblem, Solution]:
    """Describe the last effect of a fit from the place nearest to where the fit took it."""
    names, effect = problem.parameters, problem.effects[-1]
    moved, theta = effect.relocate(names.of_effect(fit.p, len(names.effects) - 1))
    p = fit.p.copy()
    p[names.theta[-1]] = [theta[q.name] / q.size for q in moved.parameters]
    same = moved is effect
    return problem if same else problem.extended((*problem.effects[:-1], moved)), replace(fit, p=p)


def _fit_from_better_guess(problem: ExtendedProblem, fit: Solution, refine: Refine) -> Solution:
    """Return the better of a fit and that from another initial guess of its effect, if one promises to be better."""
    begin = better_guess(problem, fit)
    return fit if begin is None else min(refine(problem, begin), fit, key=_chi2)


def _chi2(fit: Solution) -> float:
    return fit.chi2


def _same_place(effect: Effect, other: Effect) -> bool:
    """Say whether two locations of a grid-searched effect are within a standard deviation: within 1 of chi2."""
    pairs = zip(effect.parameters, other.parameters, strict=True)
    return all(abs(a.at_zero - b.at_zero) <= a.spread for a, b in pairs if a.grid_searched)


def _fit_first(
    problem: ExtendedProblem,
    polished: Solution,
    plain: Solution | None,
    score: Score,
    *,
    worth: Worth,
    refine: Refine,
) -> Solution:
    """Fit from the start of the score, or else from the effect at zero amplitude: beside `plain`, if there is one.

    A first full step from there goes as far as the score says. What does not end beside `plain`, or was given up before
    it came as low as `polished`, may do so beside `polished`, if its score is worth it.
    """
    if score.begin is not None:
        return refine(problem, score.begin)
    at_zero = np.array([q.at_zero / q.size for q in score.effect.parameters])
    if plain is not None:
        start, pinned = np.append(plain.p, at_zero), problem.parameters.pinned
        near = problem.solve(
            start,
            fixed=pinned,
            tolerance=SELECTION.roughly * plain.chi2,
            max_steps=SELECTION.steps,
            jacobian=jacobian_at_zero(problem, plain, start),
        )
        fit = refine(problem, near.p)
        ended = fit.stop is Stop.CONVERGED or (fit.stop is Stop.GIVEN_UP and fit.chi2 < polished.chi2)
        if ended or not worth(polished.chi2, score.lam):
            return fit
    start = np.append(polished.p, at_zero)
    direct = refine(problem, start, jacobian=jacobian_at_zero(problem, polished, start))
    return direct if plain is None else min(direct, fit, key=_chi2)


def jacobian_at_zero(problem: ExtendedProblem, before: Solution, start: Reals) -> Reals | None:
    """Return the Jacobian at `start`, where the last effect is at zero amplitude and all else as in a fit without it.

    At zero amplitude an effect changes nothing, so only its own columns are new; what the fit held is zero. None where
    the fit's own was not kept, or the new one does not begin at `start`: beyond bounds, or under a force law.
    """
    low, high = problem.bounds
    if problem.curved or not len(before.jacobian) or (start < low).any() or (start > high).any():
        return None
    known, own = before.jacobian, np.arange(len(before.p), len(start))
    added = problem.jacobian(start, own)
    whole = np.zeros((len(added), len(start)))
    whole[: len(known), : len(before.p)] = known
    whole[:, own] = added
    return whole


def _refine(
    problem: ExtendedProblem, start: Reals, *, worth: Worth, tolerance: float, jacobian: Reals | None = None
) -> Solution:
    """Fit from `start` as long as it is worth it; `jacobian` is that there, where it is known."""
    start = np.clip(start, *problem.bounds)
    return problem.solve(start, tolerance=tolerance, max_steps=_most_steps(problem), worth=worth, jacobian=jacobian)


def tolerance(before: Solution) -> float:
    """Return where the first fit of a candidate ends [of chi2]: what `before` it leaves to explain says how near."""
    return max(SELECTION.settled, SELECTION.settled_share * (before.chi2 - before.dof))


def describes_data(fit: Solution) -> bool:
    """Say whether a fit leaves little more than noise."""
    return fit.chi2 < SELECTION.described * fit.dof


def refit(problem: ExtendedProblem, start: Reals) -> Solution:
    """Fit to convergence from a start in the valley of the minimum, which under a force law may be long and bent.

    The more a model leaves to explain, the less it matters where exactly it ends.
    """
    steps = SELECTION.steps_of_searched if problem.curved else SELECTION.steps
    share = SELECTION.settled_share
    return problem.solve(start, tolerance=SELECTION.settled, share=share, of_excess=True, max_steps=steps)


def _most_steps(problem: ExtendedProblem) -> int:
    if _under_law(problem):
        return SELECTION.steps_of_law
    return SELECTION.steps_of_searched if problem.curved else SELECTION.steps


def _under_law(problem: ExtendedProblem) -> bool:
    return any("force laws" in effect.acts_on for effect in problem.effects)


def better_guess(problem: ExtendedProblem, fit: Solution) -> Reals | None:
    """Return a start with one unknown of the last effect moved to an initial guess; None: no guess promises more.

    `fit` is that of `problem`, its Jacobian included.
    """
    effect, part = problem.effects[-1], problem.parameters.theta[-1]
    length = np.linalg.norm(fit.jacobian, axis=0)
    basis = np.linalg.qr(fit.jacobian[:, length > 0] / length[length > 0])[0]
    best, lowest = None, fit.chi2 - SELECTION.better
    for i, q in enumerate(effect.parameters, start=part.start):
        for value in sorted({begun[q.name] / q.size for begun in effect.initial_guesses if q.name in begun}):
            moved = fit.p.copy()
            moved[i] = value
            try:
                r = problem.residual(moved)
            except DataError:
                continue  # no bounded motion there
            left = float(r @ r - np.sum((basis.T @ r) ** 2))
            if left < lowest:
                best, lowest = moved, left
    return best
