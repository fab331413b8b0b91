"""Modes, critical speeds and sag."""

import numpy as np
import pytest

from rotorrig.rig.config.description import from_si
from rotorrig.sims.rotor.model.assembly import assemble, with_bearing
from rotorrig.sims.rotor.modes.modes import (
    critical_modes,
    critical_speeds,
    natural_frequencies,
    static_sag,
    whirl_modes,
)
from rotorrig.sims.rotor.steady.harmonic_response import probe_response


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


def test_the_critical_speeds_of_twice_per_turn_are_met_at_half_the_frequency(small):
    twice = critical_modes(small, up_to=200.0, order=2.0)
    assert len(twice) == 2
    for mode in twice:
        assert mode.frequency == pytest.approx(2 * mode.omega, rel=1e-9)
        assert mode.damping_ratio == pytest.approx(0.02, abs=0.002)


def test_where_two_bending_planes_coincide_both_are_critical(rk4):
    """Without gyroscopic moment x and y of an isotropic rotor resonate at one speed."""
    flat = rk4.disks[0].model_copy(update={"polar_inertia": 1e-12})
    thin = rk4.shaft.model_copy(update={"density": 1e-6})  # an element's own gyroscopic moment goes with it
    model = assemble(rk4.model_copy(update={"disks": (flat,), "shaft": thin}))
    isotropic = with_bearing(model, "spring", np.eye(2) * 34e3, np.zeros((2, 2)))
    found = critical_speeds(isotropic, up_to=400.0)
    assert len(found) == 2
    assert found[1] == pytest.approx(found[0], rel=1e-7)


def on_rigid_bearings(rig, **shaft):
    bearings = tuple(
        {"name": b.name, "position": b.position, "rigid": True} for b in rig.bearings if b.name != "left A"
    )
    table = rig.model_dump() | {"bearings": bearings, "identify": None}
    return assemble(from_si(table | {"shaft": table["shaft"] | shaft}), max_element=0.05)


def test_structural_damping_gives_every_mode_of_a_pinned_shaft_half_the_loss_factor(rk4):
    """All its stiffness is K (1 + j eta), so lambda = j w sqrt(1 + j eta) with w the undamped frequency."""
    undamped = whirl_modes(on_rigid_bearings(rk4), 0.0, count=6)
    damped = whirl_modes(on_rigid_bearings(rk4, structural_damping=0.02), 0.0, count=6)
    for before, after in zip(undamped, damped, strict=True):
        assert after.eigenvalue == pytest.approx(1j * before.frequency * np.sqrt(1 + 0.02j), rel=1e-6)
        assert after.damping_ratio == pytest.approx(0.01, rel=1e-3)


def test_rayleigh_damping_gives_the_textbook_ratio(rk4):
    """zeta = (alpha / w + beta w) / 2 for C = alpha M + beta K of the shaft; light disks leave M to the shaft."""
    light = rk4.disks[0].model_copy(update={"mass": 1e-9, "polar_inertia": 1e-12, "transverse_inertia": 1e-12})
    bare = rk4.model_copy(update={"disks": (light,)})
    undamped = whirl_modes(on_rigid_bearings(bare), 0.0, count=6)
    damped = whirl_modes(on_rigid_bearings(bare, rayleigh={"mass": 4.0, "stiffness": 1e-5}), 0.0, count=6)
    for before, after in zip(undamped, damped, strict=True):
        w = before.frequency
        assert after.damping_ratio == pytest.approx((4.0 / w + 1e-5 * w) / 2, rel=1e-5)


def test_overdamped_modes_count_as_zero_with_structural_damping_too(rk4):
    table = rk4.model_dump()
    model = assemble(from_si(table | {"shaft": table["shaft"] | {"structural_damping": 0.01}}), max_element=0.1)
    damped = with_bearing(model, "spring", np.eye(2) * 1e3, np.eye(2) * 1e5)
    assert natural_frequencies(damped, 100.0)[0] == 0
    assert natural_frequencies(damped, 100.0)[-1] > 0


def test_critical_speeds_follow_a_bearing_that_stiffens_with_speed(rk4):
    """At the crossing the rotor is the one whose constant bearing has that speed's stiffness."""
    table = rk4.model_dump()
    rising = {"speed": (0.0, 400.0), "value": (20e3, 60e3)}
    table["bearings"][2].update(kxx=rising, kyy=rising)
    found = critical_speeds(assemble(from_si(table | {"identify": None})), up_to=400.0)
    assert len(found) >= 2
    for omega in found:
        constant = with_bearing(assemble(rk4), "spring", np.eye(2) * (20e3 + 100 * omega), np.eye(2) * 15)
        assert np.abs(critical_speeds(constant, up_to=400.0) - omega).min() < 1e-6 * omega


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
        (lambda model: critical_speeds(model, up_to=1.0, order=-1.0), "order is -1"),
        (lambda model: static_sag(with_bearing(model, "spring", *2 * [np.zeros((2, 2))]), "sideways"), "want one of"),
    ],
)
def test_a_wrong_argument_is_named(small, call, message):
    with pytest.raises(ValueError, match=message):
        call(small)


def test_a_shaft_that_nothing_holds_has_no_sag(full):
    free = with_bearing(full, [b.name for b in full.bearings], np.zeros((2, 2)), np.zeros((2, 2)))
    with pytest.raises(np.linalg.LinAlgError, match="do not hold the shaft"):
        static_sag(free, "-y")
