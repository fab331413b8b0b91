"""Critical speed, height and amplification factor, of a rotor in closed form."""

import numpy as np
import pytest

from rotorrig.app.lab.peaks import peaks_of
from rotorrig.processing.response import OrderTrackedResponse
from tests.app.conftest import CRITICAL, DAMPING, ECCENTRICITY, RAD


def test_the_peaks_of_a_response_are_those_of_the_rotor_it_was_made_of(response: OrderTrackedResponse) -> None:
    """A disk on a massless shaft: the largest is e / (2 zeta sqrt(1 - zeta^2)), at wn / sqrt(1 - 2 zeta^2)."""
    peaks = list(peaks_of(response))
    assert [(p["run"], p["probe"]) for p in peaks] == [
        (run, probe) for probe in response.probes for run in ("up", "down")
    ]
    for peak in peaks:
        assert peak["critical_speed_rpm"] == pytest.approx(CRITICAL / RAD / np.sqrt(1 - 2 * DAMPING**2), rel=2e-3)
        assert peak["peak_um"] == pytest.approx(1e6 * ECCENTRICITY / (2 * DAMPING), rel=0.01)
        assert peak["damping_ratio"] == pytest.approx(DAMPING, rel=0.05)
        assert peak["amplification_factor"] == pytest.approx(1 / (2 * peak["damping_ratio"]))
