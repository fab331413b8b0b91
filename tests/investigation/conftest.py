"""Diagnoses as they come: one that names a cause, one that finds nothing."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify import Diagnosis, Verdict
from rotorrig.identify.verdict import Cause
from rotorrig.rig import Provenance

BOW = Cause(
    label="bow",
    effect="bow",
    where="",
    title="shaft bow",
    words="the shaft is bowed",
    chosen=True,
    plausible=True,
    evidence=60.0,
    lam=70.0,
    heldout_before=2e-6,
    heldout_after=1e-6,
    parameters={},
    theta={"bow re": 2e-5, "bow im": 0.0},
    sigmas={"bow re": 1e-6, "bow im": 1e-6},
)


@pytest.fixture
def good() -> Diagnosis:
    return Diagnosis(
        verdict=Verdict.ADEQUATE,
        sentence="The model is adequate.",
        false_alarm_rate=0.01,
        noise_floor=1e-7,
        chi2=100.0,
        dof=100,
        p=0.5,
        worst=(),
        residual=np.zeros((1, 1, 1), dtype=complex),
        sigmas=np.zeros((1, 1, 1)),
        source=Provenance(config_hash="", code_version="", source=""),
    )


@pytest.fixture
def named(good: Diagnosis) -> Diagnosis:
    return replace(good, verdict=Verdict.NAMED, causes=(BOW,))
