"""What a model may be off by where an effect came on by and by, not at once."""

import numpy as np
import pytest

from rotorrig.identify.extended_model import ExtendedModel, Recording
from rotorrig.identify.extended_model.known_error import error_of_effects
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects import find
from rotorrig.sims.rotor.model import between_recordings
from tests.identify.swept import swept_response

STEP = {"step re": 4e-6, "step im": 1e-6}


@pytest.fixture(scope="module")
def slow(rig: RigConfig) -> OrderTrackedResponse:
    """Up to 2100 rpm and down again in 80 s, past the critical speeds."""
    return swept_response(rig, orders=(1,), speeds=(1300, 2100), ramp=20)


def model_and_vector(
    slow: OrderTrackedResponse, hidden: np.ndarray, time: float
) -> tuple[ExtendedModel, np.ndarray, slice]:
    effect = find(slow.rig, "unbalance_step")
    model = ExtendedModel([Recording(slow)], [effect])
    p = model.parameters.start(hidden)
    theta = STEP | {"time": time}
    p[model.parameters.own] = [theta[q.name] / q.size for q in effect.parameters]
    return model, p, model.parameters.own


def test_a_step_that_comes_within_some_seconds_is_within_the_error_of_one_at_once(
    slow: OrderTrackedResponse, hidden: np.ndarray
) -> None:
    moment = float(0.4 * slow.t[0] + 0.6 * slow.t[-1])
    model, p, own = model_and_vector(slow, hidden, moment)
    at_once = model.predict(p, orders=(1,))[0][1]
    by_and_by = np.zeros_like(at_once)
    lags = 0.05 + 0.1 * np.arange(40)
    shares = np.exp(-lags / 0.8)
    for lag, share in zip(lags, shares / shares.sum(), strict=True):
        later = p.copy()
        later[own][-1] = p[own][-1] + lag
        by_and_by += share * model.predict(later, orders=(1,))[0][1]
    columns = error_of_effects(model, p)[0][1]
    missed = (by_and_by - at_once).ravel()
    real = np.concatenate([columns.reshape(len(missed), -1).real, columns.reshape(len(missed), -1).imag])
    wanted = np.concatenate([missed.real, missed.imag])
    times, left, *_ = np.linalg.lstsq(real, wanted, rcond=None)
    assert np.sqrt(left[0]) < 0.25 * np.linalg.norm(wanted)
    assert np.abs(times).max() < 2.0  # standard deviations


@pytest.mark.parametrize("time", [between_recordings(0), between_recordings(1)])
def test_none_of_a_step_that_no_recording_saw(slow: OrderTrackedResponse, hidden: np.ndarray, time: float) -> None:
    model, p, _ = model_and_vector(slow, hidden, time)
    assert 1 not in error_of_effects(model, p)[0]
