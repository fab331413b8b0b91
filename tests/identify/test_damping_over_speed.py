"""A healthy rig whose bearing damps less as it runs faster, and what a model makes of it that takes it for constant."""

from dataclasses import replace

import pytest

from benchmarks.parts.blind.run import record
from rotorrig.identify.base_fit import AssessedFit, fit_base
from rotorrig.identify.causes import SELECTION, candidates, is_significant
from rotorrig.identify.causes.stepwise_selection import select
from rotorrig.identify.extended_model import recordings_of
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.truth import Geometry, Unmodelled
from tests.identify.test_nameplate_findings import with_priors

GROWTH = -0.3  # of the damping, from standstill to 230 rad/s
TRIED = {"couple", "unbalance_step", "stiffness_over_speed", "skew_stiffness"}


@pytest.fixture(scope="module")
def changing(hurried_rig: RigConfig) -> OrderTrackedResponse:
    damping = Unmodelled(damping_growth=GROWTH)
    return track(record(hurried_rig, seed=11, geometry=Geometry(), unmodelled=damping))


@pytest.fixture(scope="module")
def taken_for_constant(changing: OrderTrackedResponse, hurried_rig: RigConfig) -> AssessedFit:
    return fitted(changing, with_priors(hurried_rig, "damping_over_speed = 0"))


@pytest.fixture(scope="module")
def expected_to_change(changing: OrderTrackedResponse, hurried_rig: RigConfig) -> AssessedFit:
    return fitted(changing, hurried_rig)


def test_what_changes_by_tenths_is_no_cause(expected_to_change: AssessedFit) -> None:
    assert expected_to_change.adequacy.adequate
    assert significant(expected_to_change) == set()


def test_taken_for_a_constant_it_leaves_enough_for_a_cause(
    taken_for_constant: AssessedFit, expected_to_change: AssessedFit
) -> None:
    assert taken_for_constant.polished.chi2 > expected_to_change.polished.chi2 + SELECTION.detected


def fitted(response: OrderTrackedResponse, rig: RigConfig) -> AssessedFit:
    return fit_base(recordings_of([replace(response, rig=rig)]))


def significant(fit: AssessedFit) -> set[str]:
    known = [e for e in candidates(fit.problem.recordings) if e.name in TRIED]
    found = select(fit.problem, fit.polished, known, wrong=False)
    return {c.effect.name for step in found.steps[:1] for c in step.tried if is_significant(c)}
