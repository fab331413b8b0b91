"""Search for a missing force: its place and its law, or the probe that reads wrong, by evidence.

Every law is scored at every place of a grid along the shaft (shaft_forces.py), every law of a reading at every probe;
what scores high is fitted together with the base model, its place among the unknowns. To the law that has most evidence
others are added at the same place as long as evidence grows. Evidence is that of candidate_fit.py, BIC; the place
counts as an unknown.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes import (
    SELECTION,
    Candidate,
    Score,
    finish,
    fit_candidate,
    fit_with_pinned_nuisances,
    nuisances_biased,
    plausible,
    projection,
    scores,
)
from rotorrig.identify.discovery.settings import DISCOVERY
from rotorrig.identify.discovery.shaft_forces import ShaftForces, is_first_order
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Solution, Stop
from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects import (
    DAMPING,
    FREQUENCY,
    LAWS,
    SHARES,
    Effect,
    FoundForce,
    FoundReading,
    Law,
    ResonantForce,
    found_force,
    found_reading,
)

GoOn = Callable[[], bool]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Look:
    """A problem at its fit: what of its residual its own unknowns cannot follow, and what they can do, at 1X."""

    problem: ExtendedProblem
    fit: Solution
    chi2: float  # beyond its own unknowns, of all orders and priors
    Q: Reals  # (value, direction)
    r: Reals  # (value,)

    @classmethod
    def at(cls, problem: ExtendedProblem, fit: Solution) -> "_Look":
        Q, r = projection(problem, fit.p)
        first = is_first_order(problem)
        return cls(problem=problem, fit=fit, chi2=float(r @ r), Q=Q[first], r=r[first])

    @property
    def rig(self) -> RigConfig:
        return self.problem.recordings[0].rig

    def score(self, columns: Reals) -> tuple[Reals, Reals]:
        """Return by how much chi2 would fall with the columns (value, place, unknown) of each place, and the amounts.

        The columns are of vectors at 1X, so what of them is beyond the problem is known without those of other orders.
        """
        followed = np.tensordot(self.Q.T, columns, 1)
        own = np.einsum("vpi,vpj->pij", columns, columns)
        gram = own - np.einsum("kpi,kpj->pij", followed, followed)
        along = np.einsum("v,vpi->pi", self.r, columns)
        size = np.sqrt(np.maximum(np.einsum("pii->pi", own), 1e-300))
        scaled = gram / size[:, :, None] / size[:, None, :]
        inverse = np.linalg.pinv(scaled, rcond=DISCOVERY.beyond_base, hermitian=True)
        inverse[np.abs(scaled).max(axis=(1, 2)) < DISCOVERY.beyond_base] = 0.0
        amounts = -np.einsum("pij,pj->pi", inverse, along / size) / size
        return -np.einsum("pi,pi->p", amounts, along), amounts


def search_force(problem: ExtendedProblem, fit: Solution, go_on: GoOn = lambda: True) -> list[Candidate]:
    """Return fits of the missing force or reading beside the effects of a problem at its fit, best first.

    Those without evidence are left out. Once `go_on` says no, those so far are returned. Force laws are not tried where
    a rotor turned backwards.
    """
    look = _Look.at(problem, fit)
    taken = {effect.label for effect in problem.effects}
    new = (score for score in _scores(look) if score.effect.label not in taken)
    promising = sorted(new, key=lambda score: -score.lam)
    least = max(SELECTION.detected, DISCOVERY.promising * promising[0].lam if promising else 0.0)
    kept = [score for score in promising if score.lam > least][: DISCOVERY.fitted]
    tried = _settle_rivals(_fit_all(look, kept, go_on), go_on)
    for _ in range(1, DISCOVERY.laws):
        if not (better := _with_another_law(look, tried, go_on)):
            break
        tried = _settle_rivals([*tried, *better], go_on)
    return [c for c in tried if c.evidence > SELECTION.enough]


def grid(rig: RigConfig) -> Reals:
    """Return the places along the shaft that are looked at [m]."""
    return np.arange(0.0, rig.shaft.length + DISCOVERY.step / 2, DISCOVERY.step)


def _fit_all(look: _Look, kept: Sequence[Score], go_on: GoOn) -> list[Candidate]:
    plain = None
    if kept and nuisances_biased(look.problem, look.fit.p):
        plain = fit_with_pinned_nuisances(look.problem, look.fit.p)
    tried: list[Candidate] = []
    for score in kept:
        if not go_on():
            break
        leader = max((c.evidence for c in tried), default=-np.inf)
        if found := fit_candidate(look.problem, look.fit, plain, score, leader=leader, go_on=go_on):
            tried.append(found)
    return _rank(tried)


def _rank(tried: Sequence[Candidate]) -> list[Candidate]:
    """Return the best of every label, what is plausible before what is not."""
    ranked = sorted(tried, key=lambda c: (not plausible(c), -c.evidence))
    first = {c.effect.label: c for c in reversed(ranked)}
    return [c for c in ranked if c is first[c.effect.label]]


def _settle_rivals(tried: Sequence[Candidate], go_on: GoOn) -> list[Candidate]:
    """Return the fits with those near the best taken to their end: only then their evidence compares."""
    leader = max((c.evidence for c in tried), default=0.0)
    return _rank([_settle(c, go_on) if leader - c.evidence < SELECTION.near else c for c in tried])


def _settle(found: Candidate, go_on: GoOn) -> Candidate:
    """Return a fit that ran out of steps taken on to its end."""
    for _ in range(DISCOVERY.rounds):
        if found.polished.stop is not Stop.BUDGET or not go_on():
            break
        before, found = found, finish(found)
        if found is before:
            break
    return found


def fitted_laws(force: FoundForce, found: Candidate) -> Iterator[Law]:
    """Yield the laws of a fitted force, resonances as it has them."""
    theta = found.problem.parameters.of_effect(found.polished.p, len(found.problem.effects) - 1)
    for name in force.laws:
        law = LAWS[name]
        yield replace(law, frequency=theta[FREQUENCY], ratio=theta[DAMPING]) if isinstance(law, ResonantForce) else law


def _with_another_law(look: _Look, tried: Sequence[Candidate], go_on: GoOn) -> list[Candidate]:
    """Return fits of the best so far with one more law at its place or probe, that explain clearly more than it."""
    if not tried or not plausible(tried[0]):
        return []
    best = tried[0]
    fit = replace(best.polished, jacobian=best.problem.jacobian(best.polished.p))
    taken = {effect.label for effect in look.problem.effects}
    new = (s for s in _scores_beside(_Look.at(best.problem, fit), best) if s.effect.label not in taken)
    wider = sorted(new, key=lambda score: -score.lam)
    found = []
    for score in wider[: DISCOVERY.further]:
        if score.lam > max(SELECTION.detected, DISCOVERY.worth * best.lam) and go_on():
            whole = replace(score, lam=best.lam + score.lam)
            more = fit_candidate(look.problem, look.fit, None, whole, leader=best.evidence, go_on=go_on)
            if more and plausible(more) and more.lam > (1 + DISCOVERY.worth) * best.lam:
                found.append(more)
    return found


def _scores(look: _Look) -> Iterator[Score]:
    """Yield every law at its best places, and every law of a reading at every probe."""
    rig, places = look.rig, grid(look.rig)
    shaft = ShaftForces(look.problem, look.fit.p, places)
    for name in _laws(look.problem):
        law, lam, amounts = _best_variant(name, look, shaft)
        for i in _peaks(lam):
            yield _score(look, _tune_force(rig, [name], float(places[i]), law), float(lam[i]), amounts[i])
    readings = [found_reading(rig, p.name, [law]) for p in rig.probes for law in SHARES]
    yield from scores(look.problem, look.fit.p, readings)


def _best_variant(name: str, look: _Look, shaft: ShaftForces) -> tuple[Law, Reals, Reals]:
    """Return a law, tuned to the frequency that suits best if it resonates, with its scores and amounts by place."""
    law = LAWS[name]
    if not isinstance(law, ResonantForce):
        return law, *look.score(shaft.columns(law))
    omega = np.concatenate([r.response.omega[r.rows] for r in look.problem.recordings])
    tuned = [replace(law, frequency=float(w)) for w in np.geomspace(omega.min(), omega.max(), DISCOVERY.frequencies)]
    return max(((each, *look.score(shaft.columns(each))) for each in tuned), key=lambda found: found[1].max())


def _tune_force(rig: RigConfig, laws: Sequence[str], place: float, law: Law) -> FoundForce:
    """Return the force of `laws`, the last of which is `law`."""
    force = found_force(rig, laws, place)
    return force.tune(law.frequency, law.ratio) if isinstance(law, ResonantForce) else force


def _peaks(lam: Reals) -> list[int]:
    """Return the places no neighbour of which scores more, the best first, as far as they score much."""
    padded = np.concatenate([[-np.inf], lam, [-np.inf]])
    tops = np.flatnonzero((lam >= padded[:-2]) & (lam > padded[2:]))
    ranked = tops[np.argsort(-lam[tops])][: DISCOVERY.places]
    return [int(i) for i in ranked if lam[i] > DISCOVERY.rival_place * lam.max()]


def _scores_beside(look: _Look, best: Candidate) -> Iterator[Score]:
    """Yield the best of all so far with one more law, scored by what the law would explain of what is left."""
    own, rig = best.effect, look.rig
    theta = best.problem.parameters.of_effect(best.polished.p, len(best.problem.effects) - 1)
    if isinstance(own, FoundReading):
        for law in (law for law in SHARES if law not in own.laws):
            score = scores(look.problem, look.fit.p, [found_reading(rig, own.probe, [law])])[0]
            yield _beginning(look, score, found_reading(rig, own.probe, [*own.laws, law]), theta)
    if isinstance(own, FoundForce):
        place = own.place(theta)
        shaft = ShaftForces(look.problem, look.fit.p, np.array([place]))
        for name in (name for name in _laws(look.problem) if name not in own.laws):
            tuned, lam, amounts = _best_variant(name, look, shaft)
            force = _tune_force(rig, [*own.laws, name], place, tuned)
            yield _beginning(look, _score(look, force, float(lam[0]), amounts[0]), force, theta)


def _laws(problem: ExtendedProblem) -> Iterator[str]:
    backward = any(recording.backward for recording in problem.recordings)
    return (name for name, law in LAWS.items() if not (backward and law.is_nonlinear))


def _score(look: _Look, effect: FoundForce, lam: float, amounts: Reals) -> Score:
    """Return the score of a force for its last law; under one that is not linear it begins at those amounts."""
    begin = None
    if "force laws" in effect.acts_on or FREQUENCY in effect.at_zero:
        last = dict(zip(LAWS[effect.laws[-1]].unknowns, amounts, strict=True))
        begin = np.append(look.fit.p, [last.get(q.name, q.at_zero) / q.size for q in effect.parameters])
    return Score(effect=effect, lam=lam, step=np.zeros(0), visible=0.0, begin=begin)


def _beginning(look: _Look, score: Score, larger: Effect, theta: dict[str, float]) -> Score:
    """Return the score of an effect that begins where a smaller one, the last of `look`, was fitted."""
    shared = look.fit.p[: look.problem.parameters.theta[-1].start]
    at_zero = [q.at_zero / q.size for q in larger.parameters]
    begin = score.begin[-len(at_zero) :] if score.begin is not None else at_zero
    own = [theta[q.name] / q.size if q.name in theta else x for q, x in zip(larger.parameters, begin, strict=True)]
    return replace(score, effect=larger, begin=np.append(shared, own))
