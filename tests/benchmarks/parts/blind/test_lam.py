"""What a case could show: nothing of no fault, a gain but not which probe has it, a step that is like nothing else."""

import numpy as np
import pytest

from benchmarks.parts.blind.cases import nameplate
from benchmarks.parts.blind.lam import ENOUGH, lam
from benchmarks.parts.blind.names import Answer
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.sims.plant.draw import draw
from tests.identify.swept import swept_response

RIG = nameplate("P1")
TRUTH = draw(RIG, seed=1)


@pytest.fixture(scope="module")
def recordings() -> list[Recording]:
    """A quick sweep through the critical speed; its vectors are of no account, its noise is."""
    return [Recording(swept_response(RIG, speeds=(700.0, 2600.0), ramp=400.0))]


def hidden(label: str, **theta: float) -> Answer:
    return Answer(labels=(label,), exact=label, theta=theta)


def test_an_effect_of_no_size_leaves_nothing(recordings: list[Recording]) -> None:
    found = lam(RIG, TRUTH, hidden("skew_stiffness", k=0.0), recordings)
    assert found["lam"] == pytest.approx(0, abs=1e-3)
    assert found["rival"] == ""


def test_of_two_probes_without_a_trial_mass_either_may_have_the_gain(recordings: list[Recording]) -> None:
    """The one shows too much or the other too little: the unbalance, which is sought, takes the rest."""
    found = lam(RIG, TRUTH, hidden("probe_gain, probe 1y", error=0.25), recordings)
    assert found["lam"] > VERDICT.detectable
    assert found["rival_lam"] < VERDICT.nameable


def test_a_step_of_unbalance_is_taken_for_nothing_else(recordings: list[Recording]) -> None:
    omega, t = recordings[0].response.omega, recordings[0].response.t
    found = lam(
        RIG,
        TRUTH,
        hidden("unbalance_step", **{"step re": 6e-6, "step im": 0.0, "time": float(t[np.argmax(omega)])}),
        recordings,
    )
    assert found["lam"] > VERDICT.detectable
    assert found["rival_lam"] == ENOUGH, "no further than that is asked"
    assert found["rival"] == ""
