"""The simulated rig, balanced by one trial run: it shares no code with the model, and influence needs none."""

import cmath
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.parts.blind.run import record
from rotorrig.balancing import Balance, Task, balance
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.conftest import BLIND_SEED

pytestmark = pytest.mark.campaign  # three sweeps
TRIAL = cmath.rect(12e-6, 1.0)  # kg m


@pytest.fixture(scope="module")
def balanced(hurried_rig: RigConfig, blind_response: OrderTrackedResponse) -> Balance:
    def run(number: int, u: complex) -> OrderTrackedResponse:
        trial = {"disk": (abs(u), cmath.phase(u))}
        return track(record(hurried_rig, seed=BLIND_SEED, trial=trial, run=number))

    tried = [blind_response, with_mass(run(1, TRIAL), TRIAL)]
    W = complex(balance(tried, Task()).mounted[0])
    return balance(tried, Task(), after=run(2, W))


def with_mass(response: OrderTrackedResponse, u: complex) -> OrderTrackedResponse:
    return replace(response, runs=tuple(replace(run, trial_unbalance={"disk": u}) for run in response.runs))


def test_one_trial_run_takes_the_vibration_down_tenfold(balanced: Balance) -> None:
    compared = balanced.comparison
    assert compared is not None
    assert np.abs(compared.measured).max() < 0.1 * np.abs(compared.prediction.before).max()


def test_the_run_after_is_inside_its_band(balanced: Balance) -> None:
    assert balanced.comparison is not None
    assert balanced.comparison.share > 0.9
