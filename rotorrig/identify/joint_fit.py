"""Joint fit of the base model to all recordings, and the adequacy of a fit of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rotorrig.identify.adequacy import Adequacy, assess
from rotorrig.identify.causes import background
from rotorrig.identify.extended_model import ExtendedModel, ExtendedProblem, MarkEdge, Recording
from rotorrig.identify.fit import first_fit
from rotorrig.identify.least_squares import Solution
from rotorrig.sims.effects import Effect


@dataclass(frozen=True, slots=True, kw_only=True)
class JointFitSettings:
    """End of a joint fit."""

    settled: float = 0.1  # of chi2: a step of a third of a standard deviation
    steps: int = 15  # a model that is wrong wanders on among its nuisances


JOINT_FIT = JointFitSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class AssessedFit:
    """A fit of all recordings and the test of it."""

    problem: ExtendedProblem
    polished: Solution
    adequacy: Adequacy  # its maps have the rows of all responses, one after the other


def fit_base(
    recordings: Sequence[Recording], effects: Sequence[tuple[Effect, dict[str, float]]] = (), *, seed: int = 0
) -> AssessedFit:
    """Fit the base model: search the first recording, then fit all.

    `effects` of the config begin at their values. Raises as fit.
    """
    first = first_fit(recordings[0].response, seed=seed)
    marks = (MarkEdge.of_recording(r.number) for r in recordings if r.backward)
    nuisances = [(effect, effect.at_zero) for effect in (*background(recordings[0].response.rig), *marks)]
    known = [*nuisances, *effects]
    problem = ExtendedProblem(ExtendedModel(recordings, [effect for effect, _ in known]))
    start = problem.parameters.start(first.p)
    start[problem.parameters.own] = [theta[q.name] / q.size for effect, theta in known for q in effect.parameters]
    return assess_fit(problem, problem.solve(start, tolerance=JOINT_FIT.settled, max_steps=JOINT_FIT.steps))


def assess_fit(problem: ExtendedProblem, polished: Solution) -> AssessedFit:
    """Test a fit: adequate if it is for every recording."""
    reduced = _reduced_chi2(problem, polished)
    each = []
    for recording, predicted in zip(problem.recordings, problem.model.predict(polished.p), strict=True):
        shape = (len(recording.response.omega), len(recording.response.probes))
        whole = {}
        for order, z in predicted.items():
            whole[order] = np.full(shape, np.nan + 0j)
            whole[order][recording.rows] = recording.as_measured(z[:-1])
        each.append(assess(recording.response, whole, reduced_chi2=reduced))
    worst = max(each, key=lambda a: a.worst_sigma)
    return AssessedFit(
        problem=problem,
        polished=polished,
        adequacy=replace(
            worst,
            adequate=all(a.adequate for a in each),
            misfits=tuple(sorted((m for a in each for m in a.misfits), key=lambda m: -m.sigma)),
            centreline=tuple(sorted((m for a in each for m in a.centreline), key=lambda m: -m.sigma)),
            residual=np.concatenate([a.residual for a in each]),
            sigmas=np.concatenate([a.sigmas for a in each]),
        ),
    )


def _reduced_chi2(problem: ExtendedProblem, polished: Solution) -> float:
    """Return chi2 per degree of freedom of 1X, priors included, as the limits of residual_tests.py were set for."""
    square, size = 0.0, 0
    for recording, predicted in zip(problem.recordings, problem.model.predict(polished.p), strict=True):
        measured = recording.measured[1]
        square += float(np.sum(measured.sigmas(predicted[1] - measured.z) ** 2))
        size += measured.size
    priors = problem.parameters.prior_residual(polished.p)
    names = problem.parameters
    free = len(names.base) + names.own.stop - names.own.start
    return (square + float(priors @ priors)) / max(size + len(names.base.priors) - free, 1)
