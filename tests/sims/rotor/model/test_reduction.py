"""The reduced model answers as the full one over the whole space a fit may visit."""

import numpy as np
import pytest

from rotorrig.sims.rotor.model.assembly import matrices, scale_properties, with_bearing
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.modes.modes import static_sag
from rotorrig.sims.rotor.steady.harmonic_response import probe_response

OMEGA = np.linspace(25, 420, 40)  # 240 to 4000 rpm


@pytest.mark.parametrize("k", [1e2, 1e3, 1e4, 3.4e4, 1e5, 1e6, 1e7])
@pytest.mark.parametrize(("modulus", "mass"), [(1.0, 1.0), (0.95, 1.05), (1.05, 0.95)])
def test_the_response_is_within_1e_6_of_the_peak(full, small, k, modulus, mass):
    want, got = (
        probe_response(
            scale_properties(
                with_bearing(model, "spring", np.diag([k, 1.05 * k]), np.diag([15.0, 12.0])),
                youngs_modulus=modulus,
                disk_mass=mass,
            ),
            OMEGA,
            unbalance={"disk": 15e-6},
        )
        for model in (full, small)
    )
    assert np.abs(got - want).max() < 1e-6 * np.abs(want).max()


def test_left_bearings_may_change_too(full, small):
    for k in (1e4, 1e7):
        want, got = (
            probe_response(
                with_bearing(model, ["left A", "left B"], np.eye(2) * k, np.eye(2) * 5), OMEGA, unbalance={"disk": 1e-5}
            )
            for model in (full, small)
        )
        assert np.abs(got - want).max() < 1e-6 * np.abs(want).max()


def test_it_is_small_and_its_mass_is_the_unit_matrix(full, small):
    assert 20 <= small.dof <= 28
    np.testing.assert_allclose(matrices(small).M, np.eye(small.dof), atol=1e-9)


def test_a_static_load_at_a_probe_is_exact_whatever_the_bearing(full, small):
    flexibility = []
    for model in (full, small):
        K = matrices(with_bearing(model, "spring", np.eye(2) * 123.0, np.zeros((2, 2)))).K
        flexibility.append(model.probes @ np.linalg.solve(K, model.probes.T))
    np.testing.assert_allclose(flexibility[1], flexibility[0], rtol=1e-7, atol=1e-12)


def test_a_bearing_of_unknown_stiffness_does_not_stop_the_reduction(full, small):
    loose = with_bearing(full, ["left A", "spring"], np.zeros((2, 2)), np.zeros((2, 2)))
    known = with_bearing(reduce(loose), ["left A"], np.eye(2) * 2e6, np.zeros((2, 2)))
    known = with_bearing(known, ["spring"], np.diag([33.9e3, 34.6e3]), np.eye(2) * 15)
    want = probe_response(full, OMEGA, unbalance={"disk": 1e-5})
    got = probe_response(known, OMEGA, unbalance={"disk": 1e-5})
    assert np.abs(got - want).max() < 1e-5 * np.abs(want).max()


def test_shapes_and_sag_are_still_those_of_the_whole_shaft(full, small):
    assert small.centreline.shape == (2, len(full.z), small.dof)
    want = static_sag(full, "-y")
    np.testing.assert_allclose(static_sag(small, "-y"), want, atol=2e-5 * np.abs(want).max())
