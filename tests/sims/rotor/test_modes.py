"""Modes, critical speeds and sag."""

import numpy as np
import pytest

from rotorrig.sims.rotor.assembly import assemble, with_bearing
from rotorrig.sims.rotor.harmonic import probe_response
from rotorrig.sims.rotor.modes import critical_speeds, natural_frequencies, static_sag, whirl_modes


def test_a_mode_is_a_free_motion_of_the_rotor(small):
    frequencies = natural_frequencies(small, 200.0)
    modes = whirl_modes(small, 200.0, count=4)
    np.testing.assert_allclose([mode.frequency for mode in modes], frequencies[:4], rtol=1e-9)
    assert all(np.abs(mode.shape).max() == pytest.approx(1) for mode in modes)
    assert all(0 < mode.damping_ratio < 0.1 for mode in modes)


def test_the_gyroscopic_moment_parts_forward_and_backward_whirl(rk4):
    isotropic = with_bearing(assemble(rk4), "spring", np.eye(2) * 34e3, np.zeros((2, 2)))
    modes = whirl_modes(isotropic, 300.0, count=4)
    assert [round(mode.whirl) for mode in modes] == [-1, 1, -1, 1]
    reversed_rig = rk4.model_copy(update={"rotation": "y-to-x"})
    backwards = with_bearing(assemble(reversed_rig), "spring", np.eye(2) * 34e3, np.zeros((2, 2)))
    assert [round(mode.whirl) for mode in whirl_modes(backwards, 300.0, count=4)] == [1, -1, 1, -1]


def test_a_critical_speed_is_where_the_response_peaks(small):
    undamped = with_bearing(small, "spring", np.eye(2) * 34e3, np.eye(2) * 0.01)
    forward = critical_speeds(undamped, up_to=400.0)[-1]
    near = forward * (1 + np.linspace(-1e-3, 1e-3, 401))
    peak = near[np.argmax(np.abs(probe_response(undamped, near, unbalance={"disk": 1e-5})[:, 0]))]
    assert peak == pytest.approx(forward, rel=1e-5)


def test_whole_and_reduced_model_have_the_same_critical_speeds(full, small):
    np.testing.assert_allclose(critical_speeds(small, up_to=400.0), critical_speeds(full, up_to=400.0), rtol=1e-6)


def test_there_is_no_critical_speed_below_the_first(small):
    assert critical_speeds(small, up_to=200.0).size == 0


def test_an_overdamped_mode_counts_as_frequency_zero(small):
    damped = with_bearing(small, "spring", np.eye(2) * 1e3, np.eye(2) * 1e5)
    assert natural_frequencies(damped, 100.0).shape == (small.dof,)
    assert natural_frequencies(damped, 100.0)[0] == 0


def test_the_rotor_sags_in_the_direction_of_gravity_only(full):
    x, y = static_sag(full, "-y")
    assert -2.5e-4 < y.min() < -1e-4  # 8 N on 76 kN/m of shaft and half of it on 35 kN/m of spring
    assert np.abs(x).max() < 1e-12
    assert np.abs(static_sag(full, "none")).max() == 0
    assert static_sag(full, "-x")[0].min() < -1e-4


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda model: static_sag(model, "down"), "gravity is 'down', want one of"),
        (lambda model: critical_speeds(model, up_to=0.0), "up_to is 0 rad/s"),
    ],
)
def test_a_wrong_argument_is_named(small, call, message):
    with pytest.raises(ValueError, match=message):
        call(small)
