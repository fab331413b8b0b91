"""Simulated cases are what they say, and shares are counted right."""

import json
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.identification_coverage import Outcome, Trial, case, summarise, text
from benchmarks.parts.identification.coverage_groups import GROUPS, NAMES
from benchmarks.parts.identification.matched_run import Case, Design, draw
from benchmarks.parts.identification.uncertainty_page import page
from rotorrig.identify.base_fit.fit import identify
from rotorrig.identify.measurement import measure
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.rotor.model.assembly import assemble, with_bearing
from rotorrig.sims.rotor.steady.harmonic_response import probe_response

QUICK = Design(ramp=60.0)  # rad/s^2


def drawn(rig: RigConfig, design: Design, seed: int = 1) -> Case:
    return draw(rig, design, rng=np.random.default_rng(seed))


def test_a_case_is_that_of_its_seed_and_its_noise_is_as_told(rig_config: RigConfig) -> None:
    first, again = drawn(rig_config, QUICK), drawn(rig_config, QUICK)
    np.testing.assert_array_equal(first.response.z, again.response.z)
    assert first.truth == again.truth
    found = identify([first.response]).fits[0]
    assert found.chi2 / found.dof == pytest.approx(1.0, abs=4 * np.sqrt(2 / found.dof))


def test_the_noise_is_all_that_differs_with_it(rig_config: RigConfig) -> None:
    loud, quiet = (drawn(rig_config, replace(QUICK, noise=n, linearity=0.0)) for n in (1.0, 1e-6))
    off = loud.response.z - quiet.response.z
    told = measure(loud.response).sigma[:-1]
    assert np.abs(off[..., 0] / told).std() == pytest.approx(np.sqrt(2 - np.pi / 2), rel=0.15)  # Rayleigh's


def test_the_truth_without_its_tolerances_is_the_models_response(rig_config: RigConfig) -> None:
    tiny = {"disk_mass": 1e-9, "youngs_modulus": 1e-9, "bearing": 1e-9, "probe_gain": 1e-9, "probe_angle": 1e-9}
    exact = rig_config.model_copy(update={"prior": rig_config.prior.model_copy(update=tiny | {"runout": 1e-12})})
    made = drawn(exact, replace(QUICK, noise=1e-3, linearity=0.0))
    truth = made.truth
    K, C = np.diag([truth["kxx"], truth["kyy"]]), np.diag([truth["cxx"], truth["cyy"]])
    model = with_bearing(assemble(exact), "spring", K, C)
    unbalance = {"disk": truth["u"] * np.exp(1j * truth["phase"])}
    slow = probe_response(model, made.response.slow_roll_omega, unbalance=unbalance)[0]
    np.testing.assert_allclose(made.response.slow_roll[:, 0], slow, rtol=0, atol=3e-4 * np.abs(slow).max())


def outcome(*covered: bool) -> Outcome:
    trials = tuple(
        Trial(name=name, covered=hit, by="covariance", off=1.0, relative=0.01)
        for name, hit in zip(NAMES, covered, strict=True)
    )
    return Outcome(trials=trials, reduced_chi2=1.0, seconds=0.5)


def test_shares_are_counted_by_estimate_and_pooled_over_the_first_group() -> None:
    outcomes = [outcome(True, True, True, True, True, True), outcome(False, True, True, False, True, True)]
    summary = summarise({"ordinary": outcomes * 10, "bound": outcomes[:1]})
    assert summary["coverage95"] == pytest.approx(10 / 12)
    assert summary["coverage"]["ordinary"]["kxx"]["share"] == 0.5
    assert summary["coverage"]["ordinary"]["kxx"]["low"] == pytest.approx(0.2720, abs=1e-4)  # Clopper, Pearson 10 of 20
    assert summary["coverage"]["bound"]["all"]["share"] == 1.0
    json.dumps(summary)
    assert "well determined" in text({"ordinary": outcomes})
    assert "83.3" in page(summary["coverage"])


def test_a_case_near_a_bound_is_profiled() -> None:
    found = case(("bound", 0, 1))
    assert [trial.name for trial in found.trials] == list(NAMES)
    assert {trial.by for trial in found.trials} == {"profile likelihood"}
    assert set(GROUPS) >= {"ordinary", "bound", "loose", "bootstrap"}
