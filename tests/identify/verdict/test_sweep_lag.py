"""That the speed moved, as a cause: what it did to the resonance, against the group delay of the steady response."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify import base_fit
from rotorrig.identify.base_fit import AssessedFit
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.verdict.sweep_lag import lag, moving_speed
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.units import RPM
from tests.identify.swept import swept_response

pytestmark = pytest.mark.campaign  # two fits of a long sweep
RAMP = 60.0  # rpm/s: slow, so that the first order in the ramp holds


@pytest.fixture(scope="module")
def slow(rig: RigConfig) -> OrderTrackedResponse:
    response = swept_response(rig, rng=np.random.default_rng(5), orders=(1,), speeds=(1500, 3000), ramp=RAMP)
    return replace(response, revolutions=np.ones(len(response.t)))  # as good as no window


@pytest.fixture(scope="module")
def fits(slow: OrderTrackedResponse) -> tuple[AssessedFit, AssessedFit]:
    still, swept = (base_fit.fit_base([Recording(slow, swept=known)]) for known in (False, True))
    return still, swept


def test_the_peak_is_late_by_the_ramp_times_the_group_delay(
    slow: OrderTrackedResponse, fits: tuple[AssessedFit, AssessedFit]
) -> None:
    still, swept = fits
    found = lag(still, swept)
    z = still.problem.model.predict(swept.polished.p)[0][1][:-1, slow.probes.index(found.probe)]
    up = np.flatnonzero(slow.run == 0)
    delay = -np.gradient(np.unwrap(np.angle(z[up])), slow.omega[up])
    expected = RAMP / RPM * delay[np.abs(z[up]).argmax()]
    spacing = np.median(np.diff(slow.omega[up]))
    assert found.shift == pytest.approx(expected, rel=0.25, abs=1.5 * spacing)
    assert 0 < found.lower < 0.2


def test_it_is_said_in_numbers(slow: OrderTrackedResponse, fits: tuple[AssessedFit, AssessedFit]) -> None:
    cause = moving_speed(*fits, [slow])
    assert cause is not None
    assert f"by {RAMP:.0f} rpm/s" in cause.words
    assert "a single turn" in cause.words
    assert f"is off by {lag(*fits).apart * 1e6:.2g} um" in cause.words
    assert cause.heldout_after < cause.heldout_before


def test_a_table_without_times_says_nothing_of_a_moving_speed(
    slow: OrderTrackedResponse, fits: tuple[AssessedFit, AssessedFit]
) -> None:
    still, _ = fits
    assert moving_speed(still, still, [slow]) is None
