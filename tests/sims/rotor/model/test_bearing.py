"""Bearings whose coefficients depend on speed, and rigid ones."""

import math

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.rig.errors import ConfigError
from rotorrig.sims.rotor.model.assembly import assemble, matrices, with_bearing
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.modes.modes import critical_speeds, natural_frequencies, static_sag
from rotorrig.sims.rotor.steady.harmonic_response import dynamic_stiffness, probe_response
from rotorrig.sims.rotor.swept.swept_response import Timeline, swept_response

KXX = {"speed": [100.0, 200.0, 400.0], "value": [2e4, 4e4, 5e4]}
CYX = {"speed": [0.0, 300.0], "value": [6.0, 0.0]}


def rig_with(rk4: RigConfig, **bearings: dict) -> RigConfig:
    """Return the RK4 with the bearings "left_A", "left_B", "spring" given other tables of coefficients."""
    table = rk4.model_dump()
    table["identify"] = None
    for name, update in bearings.items():
        one = next(b for b in table["bearings"] if b["name"] == name.replace("_", " "))
        one |= {"kxx": None, "kyy": None, "cxx": 0.0, "cyy": 0.0} | update
    return from_si(table)


@pytest.fixture(scope="module")
def varying(rk4) -> RigConfig:
    return rig_with(rk4, spring={"kxx": KXX, "kyy": 3.5e4, "cxx": 15.0, "cyy": 12.0, "cyx": CYX})


@pytest.mark.parametrize(
    ("omega", "kxx", "cyx"),
    [(0.0, 2e4, 6.0), (100.0, 2e4, 4.0), (150.0, 3e4, 3.0), (250.0, 4.25e4, 1.0), (400.0, 5e4, 0.0), (900.0, 5e4, 0.0)],
)
def test_coefficients_are_straight_between_the_speeds_and_held_beyond_them(varying, omega, kxx, cyx):
    K, C = assemble(varying).bearing("spring").at(omega)
    np.testing.assert_allclose(K, [[kxx, 0], [0, 3.5e4]], rtol=1e-14)
    np.testing.assert_allclose(C, [[15, 0], [cyx, 12]], rtol=1e-14)


@pytest.mark.parametrize("order", [1.0, 2.0, -1.0])
def test_the_response_is_at_every_speed_that_of_the_constants_there(varying, order):
    model = assemble(varying)
    omega = np.array([50.0, 150.0, 230.0, 370.0, 500.0])
    force = {"disk": (1.0, 0.5j)}
    got = probe_response(model, omega, unbalance={"disk": 1e-5}, force=force, order=order)
    for i, speed in enumerate(omega):
        fixed = with_bearing(model, "spring", *model.bearing("spring").at(speed))
        want = probe_response(fixed, speed, unbalance={"disk": 1e-5}, force=force, order=order)[0]
        np.testing.assert_allclose(got[i], want, rtol=1e-10)


def test_reduced_and_whole_model_answer_alike(varying):
    omega = np.linspace(50, 400, 30)
    whole = assemble(varying)
    want, got = (probe_response(model, omega, unbalance={"disk": 1e-5}) for model in (whole, reduce(whole)))
    assert np.abs(got - want).max() < 1e-6 * np.abs(want).max()


def test_a_critical_speed_is_found_with_the_stiffness_it_has_at_that_speed(varying):
    model = reduce(assemble(varying))
    for omega in critical_speeds(model, up_to=400.0):
        fixed = with_bearing(model, "spring", *model.bearing("spring").at(omega))
        assert np.abs(natural_frequencies(fixed, omega) / omega - 1).min() < 1e-9


def test_what_wants_constants_says_so(varying):
    model = assemble(varying)
    with pytest.raises(ConfigError, match="bearing 'spring': its coefficients depend on speed, want constants"):
        matrices(model)
    timeline = Timeline(np.arange(20) * 0.03)
    with pytest.raises(ConfigError, match="bearing 'spring': its coefficients depend on speed, want constants while"):
        swept_response(reduce(model), timeline, t=[0.3], revolutions=4.0, window="hann", unbalance={"disk": 1e-5})


def test_ever_stiffer_springs_approach_the_rigid_bearings(rk4):
    omega = np.linspace(50, 400, 12)
    unbalance = {"disk": 1e-5}
    rigid = assemble(rig_with(rk4, left_A={"rigid": True}, left_B={"rigid": True}))
    want = probe_response(rigid, omega, unbalance=unbalance)
    errors = []
    for k in (1e10, 1e11, 1e12):
        sprung = with_bearing(assemble(rk4), ["left A", "left B"], np.eye(2) * k, np.zeros((2, 2)))
        errors.append(np.abs(probe_response(sprung, omega, unbalance=unbalance) - want).max() / np.abs(want).max())
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.05)  # the support's flexibility is 1/k
    assert errors[1] / errors[2] == pytest.approx(10, rel=0.05)


def test_the_shaft_does_not_move_in_a_rigid_bearing(rk4):
    model = assemble(rig_with(rk4, left_A={"rigid": True}))
    assert model.dof == 4 * len(model.z) - 2
    node = np.argmin(np.abs(model.z - 0.065))
    assert np.abs(static_sag(model, "-y")[:, node]).max() == 0
    assert np.abs(dynamic_stiffness(model, 100.0)).min() == 0  # and it is still a plain matrix


def test_disk_probe_and_plane_may_sit_on_a_rigid_bearing(rk4):
    table = rig_with(rk4, left_B={"rigid": True}).model_dump()
    table["probes"][0]["position"] = 0.08
    table["planes"] = [{"name": "journal", "position": 0.08}]
    inertia = dict.fromkeys(("mass", "polar_inertia", "transverse_inertia"), 1e-9)
    table["disks"] = [*table["disks"], {"name": "flange", "position": 0.08} | inertia]
    whole = assemble(from_si(table))
    for model in (whole, reduce(whole)):
        z = probe_response(model, 200.0, unbalance={"disk": 1e-5, "flange": 1e-5, "journal": 1e-5})[0]
        assert z[0] == 0
        np.testing.assert_allclose(z, probe_response(whole, 200.0, unbalance={"disk": 1e-5})[0], rtol=1e-6)


def test_a_slender_shaft_on_rigid_bearings_has_eulers_and_bernoullis_frequencies():
    """(n pi / L)^2 sqrt(E I / rho A), exact but for rotary inertia and shear: (n pi r / L)^2 (1 + E / kappa G) / 2."""
    length, diameter, E, density = 2.0, 0.002, 2e11, 7800.0
    rig = from_si(
        {
            "name": "pinned",
            "shaft": {"length": length, "diameter": diameter, "density": density, "youngs_modulus": E},
            "disks": [
                {"name": "d", "position": 1.0, "mass": 1e-12, "polar_inertia": 1e-18, "transverse_inertia": 1e-18}
            ],
            "bearings": [{"name": name, "position": z, "rigid": True} for name, z in (("l", 0.0), ("r", length))],
            "probes": [{"name": "x", "position": 0.7, "angle": 0.0, "channel": 0}],
        }
    )
    model = assemble(rig)
    assert not model.bearings
    for solved in (model, reduce(model)):
        got = natural_frequencies(solved, 0.0)[[0, 2, 4]]
        want = [(n * math.pi / length) ** 2 * math.sqrt(E * diameter**2 / (16 * density)) for n in (1, 2, 3)]
        np.testing.assert_allclose(got, want, rtol=2e-5)


@pytest.mark.parametrize("wrong", [np.nan, -1.0, np.inf])
def test_a_stiffness_that_cannot_be_is_named(full, wrong):
    with pytest.raises(ValueError, match=r"K of bearing 'spring' is .*, want numbers, none negative on the diagonal"):
        with_bearing(full, "spring", np.diag([1e4, wrong]), np.eye(2))
    with pytest.raises(ValueError, match="C of bearing 'spring' is"):
        with_bearing(full, "spring", np.eye(2), np.diag([wrong, 0.0]))


def test_a_rigid_bearing_has_no_coefficients_to_change(rk4):
    model = assemble(rig_with(rk4, left_A={"rigid": True}))
    with pytest.raises(ValueError, match="bearing 'left A' is rigid and has no coefficients, want an elastic one"):
        with_bearing(model, "left A", np.eye(2), np.eye(2))
