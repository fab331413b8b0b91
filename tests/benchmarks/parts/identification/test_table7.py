"""Table 7: a few of its seeds, and what its summary makes of known runs."""

import json

import numpy as np
import pytest

from benchmarks.parts.identification.table7 import (
    OBJECTIVES,
    TRUTH,
    VECTORS,
    RandomRun,
    Run,
    oracle_response,
    random_run,
    standard_deviations,
    steady,
    summarise,
    text,
    vector,
)
from rotorrig.identify.base_model.objectives import Amplitudes


def test_the_model_is_the_other_programs() -> None:
    kxx, kyy, cxx, cyy, u = TRUTH
    ours, theirs = steady().receptance.response(kxx, kyy, cxx, cyy, u), oracle_response()
    assert np.abs(ours - theirs).max() < 1e-10 * np.abs(theirs).max()


@pytest.mark.parametrize("objective", [*OBJECTIVES, "complex"])
def test_a_few_seeds_give_exact_parameters_in_few_calls(objective: str) -> None:
    runs = [vector(objective, seed) for seed in range(5)]
    assert max(run.error for run in runs) < 1e-6
    assert np.median([run.calls for run in runs]) <= 60


def test_random_truths_are_found() -> None:
    runs = [random_run(seed) for seed in range(10)]
    assert max(run.residual for run in runs) < 1e-8
    assert max(run.error for run in runs) < 1e-3


def test_where_bearings_hardly_move_their_damping_is_not_determined() -> None:
    amplitudes = Amplitudes(steady(), np.ones((75, 4)))
    low, high = amplitudes.steady.space.working_bounds.T
    weak, plain = (
        standard_deviations(amplitudes, np.append((np.log(theta) - low) / (high - low), 0.5), noise=1e-8)
        for theta in ([1e9, 1e9, 1.0, 1.0], [5e7, 7e7, 5e2, 7e2])
    )
    assert weak[2] > 1e-3 > weak[0]
    assert plain.max() < 1e-6


def test_the_summary_counts_calls_exact_runs_and_what_is_determined() -> None:
    runs = [Run(calls=10, error=1e-6), Run(calls=20, error=1e-4), Run(calls=60, error=0.5)]
    random = [
        RandomRun(calls=30, residual=1e-10, error=1e-5, determined=True),
        RandomRun(calls=50, residual=1e-10, error=0.2, determined=False),
        RandomRun(calls=90, residual=1e-3, error=0.5, determined=True),
    ]
    measured = {"runs": dict.fromkeys([*OBJECTIVES, *VECTORS], runs), "random": random}
    summary = json.loads(json.dumps(summarise(measured)))
    assert summary["f1"]["calls_median"] == 20
    assert summary["residual"]["success"] == pytest.approx(2 / 3)
    assert summary["random"]["residual_ok"] == pytest.approx(2 / 3)
    assert summary["random"]["parameters_ok"] == pytest.approx(1 / 2)
    assert summary["random"]["undetermined"] == pytest.approx(1 / 3)
    assert "2,768" in text(measured)
