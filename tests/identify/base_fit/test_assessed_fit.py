"""The base model fitted to all recordings together."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.base_fit import AssessedFit, assess_fit, fit_base
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.sims.effects.base import find
from tests.identify.swept import C, K, U, swept_response


@pytest.fixture(scope="module")
def pair(rig: RigConfig) -> AssessedFit:
    rng = np.random.default_rng(21)
    responses = [swept_response(rig, rng=rng), swept_response(rig, rng=rng, trial=8e-6j)]
    return fit_base([Recording(r, number=i) for i, r in enumerate(responses)])


def test_two_recordings_give_what_made_them_within_its_uncertainty(pair: AssessedFit) -> None:
    names, polished = pair.problem.parameters.base, pair.polished
    truth = names.space.to_working(np.array([*K, *C]))
    found, sigma = polished.p[names.sought], polished.sigma[names.sought]
    assert (np.abs(found - truth) < 4 * sigma).all()
    amount = names.amounts(polished.p[: len(names)])["disk"]
    assert abs(amount - U) < 4 * np.hypot(*polished.sigma[names.unbalance])


def test_a_trial_mass_makes_the_scale_of_the_unbalance_known_better(pair: AssessedFit) -> None:
    alone = fit_base(pair.problem.recordings[:1])
    sigma = [np.hypot(*fit.polished.sigma[fit.problem.parameters.base.unbalance]) for fit in (alone, pair)]
    assert sigma[1] < sigma[0]


def test_a_healthy_pair_is_adequate_and_its_maps_have_the_rows_of_both(pair: AssessedFit) -> None:
    assert pair.adequacy.adequate
    rows = sum(len(r.response.omega) for r in pair.problem.recordings)
    assert pair.adequacy.residual.shape == pair.adequacy.sigmas.shape == (rows, 4, 2)


def test_one_bad_recording_makes_the_pair_inadequate(pair: AssessedFit) -> None:
    good, _ = pair.problem.recordings
    louder = swept_response(good.response.rig, trial=8e-6j, unbalance=1.3 * U)
    problem = pair.problem.on([good, Recording(louder, number=1)])
    found = assess_fit(problem, pair.polished).adequacy
    assert not found.adequate
    assert found.misfits[0].sigma == max(m.sigma for m in found.misfits)
    rows = len(good.response.omega)
    assert np.nanmax(found.sigmas[rows:]) > np.nanmax(found.sigmas[:rows])


@pytest.mark.campaign
def test_effects_of_the_config_begin_at_their_figures(rig: RigConfig) -> None:
    effect = find(rig, "unbalance_plane, at 160 mm")
    theta = {"unbalance re": 8e-6, "unbalance im": 3e-6, "shift": 0.0}
    response = swept_response(rig, rng=np.random.default_rng(22), hidden=[(effect, theta)])
    found = fit_base([Recording(response)], [(effect, theta)])
    assert found.adequacy.adequate
    names, last = found.problem.parameters, len(found.problem.effects) - 1
    sigma = names.of_effect(found.polished.sigma, last)
    for name, value in names.of_effect(found.polished.p, last).items():
        assert abs(value - theta[name]) < 3 * sigma[name], name


def test_a_healthy_rig_far_from_its_nameplate_is_fitted_to_the_end(rig: RigConfig) -> None:
    """One that ends short of it is taken for a wrong model: whatever else is free there lowers chi2."""
    rng = np.random.default_rng(23)
    built = _put_together(rig)
    loud = {"rng": rng, "unbalance": 20 * U}
    responses = [swept_response(built, **loud), swept_response(built, **loud, trial=160e-6j)]
    found = fit_base([Recording(replace(r, rig=rig), number=i) for i, r in enumerate(responses)])
    assert found.adequacy.adequate
    further = found.problem.solve(found.polished.p, max_steps=200)
    assert found.polished.chi2 - further.chi2 < 1.0


def _put_together(rig: RigConfig) -> RigConfig:
    """Return the rig with parts 2 to 3 mm from where its config says, and a shaft that is thicker and softer."""
    table = rig.model_dump(mode="json")
    for part, off in zip((*table["bearings"], *table["disks"]), (2e-3, -2e-3, 2.5e-3, -3e-3), strict=True):
        part["position"] += off
    table["shaft"]["diameter"] *= 1.008
    table["shaft"]["youngs_modulus"] *= 0.97
    return from_si(table)
