"""Vectors that were compensated before they came, and do not say so: waveforms of the simulated rig, bent, through
the chain, and the slow-roll vector taken off behind it."""

from dataclasses import replace

import pytest

from benchmarks.parts.blind.run import record
from rotorrig.identify.diagnosis import Diagnosis, Verdict, diagnose
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.settings import Tracking
from rotorrig.rig.config.description import load
from rotorrig.rig.config.units import RPM
from rotorrig.sims.effects.base import catalogue
from rotorrig.sims.plant.truth import FaultSpec
from tests.conftest import CONFIGS

pytestmark = pytest.mark.campaign

BOW = FaultSpec(name="bow", parameters={"amount": 20e-6})
TRIED = {"slow_roll_subtracted", "bow", "runout"}  # without force laws


@pytest.fixture(scope="module")
def bent() -> OrderTrackedResponse:
    """Some 120 rows through the critical speed, their slow roll at the speed of a too hasty one."""
    rig = load(CONFIGS / "rk4.toml")
    plan = rig.plans["default"].model_copy(
        update={"slow_roll": 600 / RPM, "slow_roll_time": 4.0, "start": 700 / RPM, "end": 2600 / RPM, "ramp": 120 / RPM}
    )
    hasty = rig.model_copy(update={"plans": {"default": plan}})
    return track(record(hasty, seed=11, faults=(BOW,)), Tracking(orders=(1.0, 2.0)))


def judged(response: OrderTrackedResponse) -> Diagnosis:
    kinds = {effect.name for effect in catalogue(response.rig)}
    return diagnose([response], without=kinds - TRIED)


def test_kept_raw_the_bow_is_found_or_tied_with_run_out_and_nothing_seems_taken_off(bent: OrderTrackedResponse) -> None:
    """At the speeds of a hasty slow roll a bow of 20 um hardly moves: it may as well be run-out twice its tolerance."""
    found = judged(bent)
    told = {cause.label for cause in found.causes if cause.chosen}.union(*found.tied)
    assert "bow, even" in told
    assert told <= {"bow", "bow, even", "runout, plane 1", "runout, plane 2"}


def test_what_was_taken_off_is_named_with_its_share(bent: OrderTrackedResponse) -> None:
    """A vector at 600 rpm, which has response to unbalance in it besides, taken off once too often."""
    found = judged(replace(bent, z=bent.z - bent.slow_roll))
    assert found.verdict is Verdict.NAMED
    causes = {cause.effect: cause for cause in found.causes if cause.chosen}
    assert causes["slow_roll_subtracted"].theta["share"] == pytest.approx(1.0, abs=0.005)
    # the shaft is bent, too, by what at these speeds may be less than an error of one per cent of what was taken off
    assert set(causes) <= {"slow_roll_subtracted", "bow"}
