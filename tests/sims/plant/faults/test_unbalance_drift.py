"""An unbalance that drifts towards an end."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import unbalance_drift
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec, UnbalanceTruth

from ..by_hand import difference, driven, measured, run_to

DRIFT = {"amount": 6e-6, "angle": 2.0, "time": 8.0, "disk": 0.0}


def test_its_pull_grows_towards_that_of_an_unbalance(rk4: RigConfig) -> None:
    (force,) = unbalance_drift.forces(rk4, nameplate(rk4), DRIFT | {"time": 0.5})
    f = driven(force, np.zeros(20_001), omega=200.0)
    t = 1e-4 * np.arange(1, 20_002)
    along = f[:, 0] * np.cos(200.0 * t + 2.0) + f[:, 1] * np.sin(200.0 * t + 2.0)
    across = f[:, 1] * np.cos(200.0 * t + 2.0) - f[:, 0] * np.sin(200.0 * t + 2.0)
    assert along / (6e-6 * 200.0**2) == pytest.approx(1 - np.exp(-t / 0.5), abs=1e-9)
    assert np.abs(across).max() < 1e-12


def test_at_a_steady_speed_the_vectors_move_along_a_line_as_it_warms(rk4: RigConfig) -> None:
    """Every second's vector, less the healthy rig's, is that second's mean of 1 - exp(-t / 8 s) of the last's."""
    plant, healthy = (
        run_to(Plant(rk4, nameplate(rk4, faults=faults)), 900, settle=1.5)
        for faults in ([FaultSpec(name="unbalance_drift", parameters=DRIFT)], [])
    )
    begin = plant.t
    moved = np.array([measured(plant, 1.0)[0] - measured(healthy, 1.0)[0] for _ in range(6)])
    seconds = begin + np.arange(6)
    mean = 1 - 8.0 * (np.exp(-seconds / 8.0) - np.exp(-(seconds + 1) / 8.0))
    assert moved / moved[-1] == pytest.approx(mean / mean[-1], abs=0.01)


def test_warm_it_is_a_rig_with_the_sum_of_two_unbalances_and_the_next_recording_begins_cold(rk4: RigConfig) -> None:
    spec = FaultSpec(name="unbalance_drift", parameters=DRIFT | {"time": 0.4})
    got = difference(rk4, "unbalance_drift", spec.parameters, rpm=1000)
    total = 15e-6 + 6e-6 * np.exp(2j)
    other = replace(nameplate(rk4), unbalances=(UnbalanceTruth(disk="disk", amount=abs(total), angle=np.angle(total)),))
    want = measured(run_to(Plant(rk4, other), 1000), 1.0) - measured(run_to(Plant(rk4, nameplate(rk4)), 1000), 1.0)
    assert got == pytest.approx(want, abs=0.05e-6)
    truth = nameplate(rk4, faults=[spec])
    first, second = (Plant(rk4, replace(truth, run=run)) for run in (0, 1))
    for plant in (first, second):
        plant.command(100.0, 500.0, True)
    assert np.array_equal(first.advance(0.5), second.advance(0.5))
