"""Score test of every candidate: how much chi2 its columns could explain, the base model refitted.

Rao's score test: chi2 falls by |Q^T r|^2, Q an orthonormal basis of the cause's columns less what the base parameters
can absorb. One linearisation for all, at the fit of the model so far.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes.locate import best_place
from rotorrig.identify.causes.score_jacobian import score_columns
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.sims.effects import Effect


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """Score of one candidate: the fall of chi2 it promises."""

    effect: Effect
    lam: float  # by how much chi2 would fall
    step: Reals  # (parameter,) of the effect, in its sizes, that would do it; empty of one that was searched for
    visible: float  # lambda of the effect at its typical size: what this data could show of it
    begin: Reals | None = None  # (parameter,) of the problem with it, of one without a first order: where to begin

    @property
    def begins_at_full_amount(self) -> bool:
        """Whether it was searched for, and begins at neither nothing nor a small amount."""
        return self.begin is not None and not self.step.size


def scores(problem: ExtendedProblem, p: Reals, candidates: Sequence[Effect]) -> list[Score]:
    """Return the scores of `candidates` beside the effects `problem` has, at its fit `p`; best first.

    One with a grid, or with several initial guesses, stands where its score is best. Those that have no first order, as
    a clearance, are left to nameplate_search.py.
    """
    Q, r = projection(problem, p)
    able = [effect for effect in candidates if not effect.needs_starts]
    placed = [_place(problem, p, effect, Q, r) if effect.grid else effect for effect in able]
    begun = [effect for several in placed for effect in several.at_initial_guesses()]
    ranked = sorted(_scores(problem, p, begun, Q, r), key=lambda score: -score.lam)
    first = {score.effect.label: score for score in reversed(ranked)}
    return [score for score in ranked if score is first[score.effect.label]]


def relocate(problem: ExtendedProblem, p: Reals, effect: Effect) -> Effect:
    """Return a grid-searched effect placed where its score is best beside the effects `problem` has, at `p`."""
    return _place(problem, p, effect, *projection(problem, p))


def _scores(problem: ExtendedProblem, p: Reals, able: Sequence[Effect], Q: Reals, r: Reals) -> list[Score]:
    columns = score_columns(problem, p, able)
    scored: list[Score] = []
    for i in range(0, len(able), SELECTION.scored_together):
        some = columns[i : i + SELECTION.scored_together]
        left = np.split(_beyond(np.hstack(some), Q), np.cumsum([own.shape[1] for own in some])[:-1], axis=1)
        scored += [_score(*each, r) for each in zip(able[i : i + SELECTION.scored_together], some, left, strict=True)]
    return scored


def _place(problem: ExtendedProblem, p: Reals, effect: Effect, Q: Reals, r: Reals) -> Effect:
    return best_place(effect, lambda tries: [score.lam for score in _scores(problem, p, tries, Q, r)])


def projection(problem: ExtendedProblem, p: Reals) -> tuple[Reals, Reals]:
    """Return an orthonormal basis of what the unknowns can do, and the residual beyond that."""
    r = problem.residual(p)
    Q = np.linalg.qr(_normalise(problem.jacobian(p)))[0]
    return Q, r - Q @ (Q.T @ r)


def score_beyond(effect: Effect, columns: Reals, Q: Reals, r: Reals) -> Score:
    """Score an effect by its columns (value, parameter), beside a `projection`."""
    return _score(effect, columns, _beyond(columns, Q), r)


def _beyond(columns: Reals, Q: Reals) -> Reals:
    """Return what of `columns` the basis Q cannot follow."""
    left = columns - Q @ (Q.T @ columns)
    left -= Q @ (Q.T @ left)
    return left


def _score(effect: Effect, columns: Reals, left: Reals, r: Reals) -> Score:
    """Score an effect by its `columns` and what of them is beyond the model so far.

    An unknown that is never less than nothing, as a loss factor, is left out where less is what would suit.
    """
    step = np.zeros(len(effect.parameters))
    length = _lengths(columns)
    size = _lengths(left)
    seen = size > SELECTION.beyond_base * np.maximum(length, 1e-300)
    one_sided = np.array([q.low == q.at_zero for q in effect.parameters])
    lam, visible = 0.0, float(np.max(size[seen] ** 2, initial=0.0))
    while seen.any():
        basis, triangle = np.linalg.qr(left[:, seen])
        along = basis.T @ r
        step[seen] = -np.linalg.lstsq(triangle, along, rcond=1e-9)[0]
        lam = float(along @ along)
        if not (backward := one_sided & (step < 0)).any():
            break
        lam, seen, step = 0.0, seen & ~backward, np.where(backward, 0.0, step)
    return Score(effect=effect, lam=lam, step=step, visible=visible)


def _normalise(J: Reals) -> Reals:
    length = _lengths(J)
    return J[:, length > 0] / length[length > 0]


def _lengths(columns: Reals) -> Reals:
    return np.sqrt(np.einsum("fp,fp->p", columns, columns))
