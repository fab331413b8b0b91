"""What a search asks of the model: the whole model's response, true derivatives, starts neither free nor held."""

import numpy as np
import pytest

from rotorrig.identify.base_model.steady_forward import Steady, shaft_stiffness
from rotorrig.identify.base_model.unknowns import Space
from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.rig.config.units import RPM
from rotorrig.sims.rotor.model.assembly import assemble, with_bearing
from rotorrig.sims.rotor.steady.harmonic_response import probe_response
from tests.identify.matched import sought

OMEGA = np.linspace(480, 3600, 40) / RPM
EIGHT = {"bearings": [["left A", "left B"], ["spring"]], "coefficients": "all", "k_bounds": [1e2, 1e8]}


def steady(rig: RigConfig, *, planes: tuple[str, ...] = ("disk",)) -> Steady:
    return Steady.of(rig, OMEGA, Space.of(rig), planes=planes, probes=("1x", "1y", "2x"))


def test_the_response_is_that_of_the_whole_model(rig_config: RigConfig) -> None:
    one = steady(rig_config)
    u = np.array([0.55, 0.6, 0.5, 0.7])
    kxx, kyy, cxx, cyy = one.values(u)
    full = with_bearing(assemble(rig_config), "spring", np.diag([kxx, kyy]), np.diag([cxx, cyy]))
    want = probe_response(full, OMEGA, unbalance={"disk": 1.0})[:, :3]
    assert np.abs(one(u)[0][0] - want).max() < 1e-4 * np.abs(want).max()


def test_without_derivatives_it_is_the_same_for_every_group_and_plane(rig_config: RigConfig) -> None:
    rig = from_si(rig_config.model_dump(mode="json") | {"planes": [{"name": "end", "position": 0.45}]})
    one = steady(sought(rig, **EIGHT, also=["youngs_modulus"]), planes=("disk", "end"))
    points = np.random.default_rng(1).random((5, one.dim))
    alone = one.responses(points)
    assert alone.shape == (5, 2, len(OMEGA), 3)
    for u, z in zip(points, alone, strict=True):
        with_derivatives = one(u)[0]
        assert np.abs(z - with_derivatives).max() < 1e-12 * np.abs(with_derivatives).max()


def test_the_ends_of_the_cube_are_the_bounds(rig_config: RigConfig) -> None:
    one = steady(sought(rig_config, **EIGHT))
    low, high = one.space.bounds.T
    assert one.values(np.zeros(one.dim)) == pytest.approx(low)
    assert one.values(np.ones(one.dim)) == pytest.approx(high)


def test_derivatives_are_those_of_the_response_for_every_group_and_coefficient(rig_config: RigConfig) -> None:
    one = steady(sought(rig_config, **EIGHT))
    u = np.array([0.7, 0.51, 0.49, 0.72, 0.4, 0.52, 0.5, 0.5, 0.6, 0.49, 0.51, 0.62, 0.4, 0.49, 0.5, 0.3])
    _, by_u = one(u)
    assert by_u.shape == (16, 1, len(OMEGA), 3)
    for i, h in enumerate(1e-6 * np.eye(16)):
        central = (one(u + h)[0] - one(u - h)[0]) / 2e-6
        assert np.linalg.norm(by_u[i] - central) < 1e-5 * np.linalg.norm(by_u), one.space.names[i]


def test_modulus_and_density_stay_at_the_nameplates(rig_config: RigConfig) -> None:
    one = steady(sought(rig_config, also=["youngs_modulus", "density"]))
    assert one.dim == 4
    shaft = rig_config.shaft
    assert one.values(np.full(4, 0.5))[4:] == pytest.approx([shaft.youngs_modulus, shaft.density])
    assert one.starts(np.full((1, 4), 0.5)).shape == (1, 4)


def test_half_of_the_starts_are_softer_than_the_shaft(rig_config: RigConfig) -> None:
    one = steady(rig_config)
    middle = one.values(one.starts(np.full((1, 4), 0.5))[0])
    k0 = shaft_stiffness(rig_config)
    assert middle[:2] == pytest.approx([k0, k0])
    assert middle[2:] == pytest.approx(k0 / np.median(OMEGA))


def test_starts_of_cross_coefficients_have_either_sign_and_all_are_in_the_cube(
    rig_config: RigConfig, rng: np.random.Generator
) -> None:
    one = steady(sought(rig_config, coefficients="all"))
    starts = one.starts(np.vstack([rng.random((200, 8)), np.zeros(8), np.ones(8)]))
    assert starts.min() >= 0
    assert starts.max() <= 1
    kxy = np.array([one.values(u)[1] for u in starts])
    assert 0.4 < (kxy > 0).mean() < 0.6


def test_the_stiffness_of_a_uniform_shaft_is_the_textbooks(rig_config: RigConfig) -> None:
    assert shaft_stiffness(rig_config) == pytest.approx(48 * 208.11e9 * np.pi * 0.01**4 / 64 / 0.56**3)
