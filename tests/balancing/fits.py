"""Three runs of a rotor to balance, and a fit without its search: least squares from where they were made."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rotorrig.identify.base_fit import BaseProblem
from rotorrig.identify.extended_model.tracked_recording import recordings_of
from rotorrig.identify.identification import Fit, Identification
from rotorrig.identify.uncertainty.estimates import estimate_nuisances, estimate_unknowns
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.identify.matched import sought
from tests.identify.swept import C, K, U, swept_response

TRIAL = 12e-6j  # kg m


def three_runs(rig: RigConfig) -> list[OrderTrackedResponse]:
    """Return a run as the rotor is, one with the trial mass, and one with the correction on."""
    rng, fitted = np.random.default_rng(3), sought(rig)
    made = [
        swept_response(fitted, rng=rng, orders=(1,), trial=trial, speeds=(900, 2600), ramp=600)
        for trial in (0j, TRIAL, -U)
    ]
    return [replace(r, source=replace(r.source, source_hash=f"{i:016x}")) for i, r in enumerate(made)]


def fit_from(responses: Sequence[OrderTrackedResponse], start: Sequence[float] = (*K, *C)) -> Identification:
    """Return the fit of some responses from stiffness and damping that are near, or theirs."""
    problem = BaseProblem.of(recordings_of(responses, orders=(1,))).problem
    begun = problem.begin(np.array(start))
    problem = problem.expecting_error(begun)
    best = problem.solve(begun)
    fit = Fit(
        name="whole sweep",
        band=(0.0, 1e3),
        estimates=estimate_unknowns(best, problem, unseen=""),
        nuisances=estimate_nuisances(best, problem),
        unknowns=(),
        optima=(),
        objective="residual",
        evaluations=0,
        stop="converged",
        seed=0,
        chi2=best.chi2,
        dof=best.dof,
        prediction=np.zeros((len(responses[0].omega), len(responses[0].probes)), complex),
        words=(),
    )
    return Identification(
        fits=(fit,),
        effects=(),
        responses=tuple((r.source.source_hash, len(r.omega)) for r in responses),
        wall_s=0.0,
        source=responses[0].source,
    )
