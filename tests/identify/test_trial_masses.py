"""The unbalance that trial masses add, row by row."""

from dataclasses import replace

import numpy as np

from rotorrig.identify.trial_masses import trial_unbalance
from rotorrig.processing.response import OrderTrackedResponse, Run

MASS = {"disk": 12e-6j}


def test_each_row_has_the_mass_of_its_run_and_the_slow_roll_that_of_its_own(healthy: OrderTrackedResponse) -> None:
    up, down = (replace(run, trial_unbalance={}) for run in healthy.runs)
    rows = np.array([0, len(healthy.omega) - 1], dtype=np.intp)
    assert [healthy.runs[i].name for i in healthy.run[rows]] == ["up", "down"]
    roll = Run(name="slow roll", direction=0, trial_unbalance=MASS)
    later = replace(healthy, runs=(up, replace(down, trial_unbalance=MASS)))
    np.testing.assert_array_equal(trial_unbalance(later, rows)["disk"], [0, 12e-6j, 0])
    always = replace(healthy, runs=(up, down, roll))
    np.testing.assert_array_equal(trial_unbalance(always, rows)["disk"], [0, 0, 12e-6j])


def test_a_rig_without_trial_masses_has_none(healthy: OrderTrackedResponse) -> None:
    bare = replace(healthy, runs=tuple(replace(run, trial_unbalance={}) for run in healthy.runs))
    assert trial_unbalance(bare, np.arange(3)) == {}
