"""Directions and the steady response's derivatives against differences."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.sims.rotor.model.assembly import (
    RotorModel,
    hysteretic,
    matrices,
    scale_properties,
    speed_stiffness,
    with_bearing,
)
from rotorrig.sims.rotor.model.derivatives import along_bearing, along_density, along_disk_mass, along_modulus
from rotorrig.sims.rotor.steady.derivatives import steady_derivatives
from rotorrig.sims.rotor.steady.harmonic_response import columns

STEP = 1e-4
K, C = np.array([[34e3, 1e3], [-1e3, 36e3]]), np.array([[15.0, 1.0], [2.0, 18.0]])


def bearing(model: RotorModel, p: float) -> RotorModel:
    return with_bearing(model, "spring", K * (1 + p), C * (1 + p))


CHANGES = {
    "bearing": (bearing, lambda model: along_bearing(model, "spring", K=K, C=C)),
    "modulus": (lambda model, p: scale_properties(model, youngs_modulus=1 + p), along_modulus),
    "density": (lambda model, p: scale_properties(model, density=1 + p), along_density),
    "disk mass": (lambda model, p: scale_properties(model, disk_mass=1 + p), along_disk_mass),
}


@pytest.fixture
def model(small) -> RotorModel:
    rayleigh = small.rayleigh.model_copy(update={"stiffness": 1e-5, "mass": 0.3})
    return bearing(replace(small, structural_damping=0.01, rayleigh=rayleigh, rotation=-1), 0.0)


@pytest.mark.parametrize("change", CHANGES)
def test_a_direction_is_the_difference_of_the_matrices(model, change):
    changed, direction = CHANGES[change]

    def whole(p: float) -> list[np.ndarray]:
        at = changed(model, p)
        M, C, G, K = matrices(at)
        nothing_turns = np.zeros_like(M)
        return [M, C, G, K + 1j * hysteretic(at), *speed_stiffness(at), nothing_turns, at.probes]

    for got, up, down in zip(direction(model), whole(0.5), whole(-0.5), strict=True):
        np.testing.assert_allclose(got, up - down, atol=1e-12 * np.abs(up).max())


@pytest.mark.parametrize("change", CHANGES)
def test_steady_derivatives_are_the_limit_of_differences(model, change):
    changed, direction = CHANGES[change]
    omega = np.array([0.0, 100.0, 230.0, 350.0])
    got = steady_derivatives(model, omega, unbalance=["disk"], directions=[along_modulus(model), direction(model)])
    np.testing.assert_allclose(got.z, columns(model, omega, unbalance=["disk"]), rtol=1e-9)
    up, down = (columns(changed(model, p), omega, unbalance=["disk"]) for p in (STEP, -STEP))
    want = (up - down) / (2 * STEP)
    np.testing.assert_allclose(got.by[1], want, atol=1e-5 * np.abs(want).max())


def test_no_direction_has_no_derivative(model):
    assert steady_derivatives(model, [100.0], unbalance=["disk"], directions=[]).by.shape == (0, 1, 4, 1)


def test_an_unknown_bearing_is_named(model):
    with pytest.raises(ValueError, match="sprung"):
        along_bearing(model, "sprung", K=K)
