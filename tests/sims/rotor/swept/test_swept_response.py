"""The swept response against integration in time, in two ways that share no code with it.

One integrates Jeffcott's rotor as a vibration and tracks its waveform as an instrument does; the other integrates the
envelope equation of the whole reduced model by Gauss's fourth-order collocation.
"""

import numpy as np
import pytest

from rotorrig.rig.errors import DataError
from rotorrig.sims.rotor.model.assembly import assemble, with_bearing
from rotorrig.sims.rotor.model.loads import unbalance_pattern
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.steady.harmonic_response import probe_response
from rotorrig.sims.rotor.swept.swept_response import Timeline, swept_response
from tests.sims.rotor import jeffcott
from tests.sims.rotor.collocation import RPM, Ramp, integrated

U = {"disk": 15e-6 * np.exp(0.6j)}


@pytest.fixture(scope="module", params=[(1800, 30, 24.0), (2800, -60, 18.0)], ids=["up", "down"])
def passage_through_resonance(request, full):
    start, rate, seconds = request.param  # rpm, rpm/s, s
    ramp = Ramp(start * RPM, rate * RPM, seconds)
    model = reduce(full, modes=2)
    return model, ramp, integrated(model, ramp, unbalance_pattern(model, U), step=0.01)


@pytest.mark.parametrize(("turns", "window"), [(8, "hann"), (16, "rectangular"), (12.5, "hann")])
def test_a_passage_through_resonance_is_that_of_integration_in_time(passage_through_resonance, turns, window):
    model, ramp, amplitude = passage_through_resonance
    when, _, weight = ramp.window(turns, window)
    want = np.einsum("p,rpk->rk", weight, amplitude(when))
    got = swept_response(model, ramp.timeline, t=ramp.rows, revolutions=turns, window=window, unbalance=U)
    peak = np.abs(want).max()
    assert np.abs(got - want).max() < 1e-4 * peak
    steady = probe_response(model, ramp.omega(ramp.rows), unbalance=U)
    assert np.abs(steady - want).max() > 0.05 * peak  # what is being modelled


@pytest.mark.parametrize("rate", [30 * RPM, -60 * RPM], ids=["up", "down"])
def test_jeffcotts_rotor_tracked_from_its_waveform(rate):
    start = 1700 * RPM if rate > 0 else 2400 * RPM
    ramp = Ramp(start, rate, 22.0 if rate > 0 else 12.0)
    want = jeffcott.tracked(ramp, U["disk"], turns=10)[..., 0]
    model = reduce(assemble(jeffcott.rig(), max_element=0.1))
    got = swept_response(model, ramp.timeline, t=ramp.rows, revolutions=10, window="hann", unbalance=U)
    assert np.abs(got - want).max() < 2e-4 * np.abs(want).max()


def test_at_constant_speed_it_is_the_steady_response(small):
    omega = 210.0
    timeline = Timeline(2 * np.pi / omega * np.arange(300))
    got = swept_response(small, timeline, t=[3.0, 5.0], revolutions=8, window="hann", unbalance=U)
    want = probe_response(small, [omega, omega], unbalance=U)
    np.testing.assert_allclose(got, want, atol=1e-8 * np.abs(want).max())


def test_very_slow_ramps_come_down_to_the_steady_response(small):
    ramp = Ramp(2000 * RPM, 0.02 * RPM, 60.0)
    got = swept_response(small, ramp.timeline, t=ramp.rows, revolutions=8, window="hann", unbalance=U)
    want = probe_response(small, ramp.omega(ramp.rows), unbalance=U)
    assert np.abs(got - want).max() < 1e-3 * np.abs(want).max()


def test_the_peak_lags_behind_on_the_way_up_and_on_the_way_down(small):
    speeds = []
    for ramp in (Ramp(1800 * RPM, 60 * RPM, 15.0), Ramp(2700 * RPM, -60 * RPM, 15.0)):
        z = swept_response(small, ramp.timeline, t=ramp.rows, revolutions=4, window="hann", unbalance=U)
        speeds.append(ramp.omega(ramp.rows)[np.argmax(np.abs(z[:, 0]))])
    up, down = np.array(speeds) / RPM
    assert down < 2226 < up


def test_a_heavily_damped_bearing_is_no_exception(small):
    """All poles far from the passed speeds: nothing lags, whatever is counted as passed."""
    damped = with_bearing(small, "spring", np.eye(2) * 34e3, np.eye(2) * 1e3)
    ramp = Ramp(600 * RPM, 30 * RPM, 60.0)
    got = swept_response(damped, ramp.timeline, t=ramp.rows, revolutions=8, window="hann", unbalance=U)
    want = probe_response(damped, ramp.omega(ramp.rows), unbalance=U)
    assert np.abs(got - want).max() < 2e-3 * np.abs(want).max()


def test_x_and_y_modes_that_coincide_are_passed_together(full):
    model = with_bearing(reduce(full, modes=2), "spring", np.eye(2) * 34e3, np.eye(2) * 15)
    ramp = Ramp(2000 * RPM, 60 * RPM, 8.0)
    amplitude = integrated(model, ramp, unbalance_pattern(model, U), step=0.01)
    when, _, weight = ramp.window(8, "hann")
    want = np.einsum("p,rpk->rk", weight, amplitude(when))
    got = swept_response(model, ramp.timeline, t=ramp.rows, revolutions=8, window="hann", unbalance=U)
    assert np.abs(got - want).max() < 1e-4 * np.abs(want).max()


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        (
            {"t": [0.01]},
            DataError,
            "row 0: its window of 8 turns about 0.01 s is not within the keyphasor pulses, 0 to",
        ),
        ({"t": [2.0, np.nan]}, DataError, "row 1: .* about nan s is not within"),
        ({"window": "flat"}, ValueError, "window is 'flat', want one of 'blackman', 'hann', 'rectangular'"),
        ({"unbalance": {"disc": 1.0}}, ValueError, "no disk 'disc'"),
    ],
)
def test_what_cannot_be_answered_is_said(small, change, error, message):
    timeline = Timeline(0.03 * np.arange(200))
    asked = {"t": [2.0], "revolutions": 8, "window": "hann", "unbalance": U} | change
    with pytest.raises(error, match=message):
        swept_response(small, timeline, **asked)
