"""The shaft element: rigid motions, total inertias, static deflections."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.config.nameplate import Tube
from rotorrig.sims.rotor.model.beam import area, second_moment, shaft_element, shear_factor

LENGTH = 0.2
TUBE = Tube(
    start=0.0,
    length=1.0,
    diameter=0.05,
    inner_diameter=0.02,
    density=7800.0,
    youngs_modulus=2e11,
    poisson_ratio=0.3,
)
SHIFT_X = np.array([1, 0, 0, 0, 1, 0, 0, 0.0])
TILT_X = np.array([0, 0, 1, 0, LENGTH, 0, 1, 0.0])  # about the first node, x = z a
TILT_Y = np.array([0, 0, 0, 1, 0, LENGTH, 0, 1.0])


@pytest.mark.parametrize("kind", ["timoshenko", "lumped"])
def test_rigid_motions_strain_nothing(kind):
    K = shaft_element(TUBE, LENGTH, element=kind).K
    for motion in (SHIFT_X, TILT_X, TILT_Y):
        assert np.abs(K @ motion).max() < 1e-9 * np.abs(K).max()


@pytest.mark.parametrize("kind", ["timoshenko", "lumped"])
def test_the_element_weighs_what_the_tube_weighs(kind):
    mass = shaft_element(TUBE, LENGTH, element=kind).M
    assert SHIFT_X @ mass @ SHIFT_X == pytest.approx(7800 * np.pi / 4 * (0.05**2 - 0.02**2) * LENGTH)


def test_tilting_the_element_meets_the_tubes_transverse_inertia():
    m = 7800 * area(TUBE) * LENGTH
    about_end = m * LENGTH**2 / 3 + 7800 * second_moment(TUBE) * LENGTH
    M = shaft_element(TUBE, LENGTH).M
    assert pytest.approx(about_end) == TILT_X @ M @ TILT_X
    assert pytest.approx(about_end) == TILT_Y @ M @ TILT_Y


@pytest.mark.parametrize("kind", ["timoshenko", "lumped"])
def test_the_gyroscopic_matrix_has_the_polar_inertia_from_a_to_b(kind):
    G = shaft_element(TUBE, LENGTH, element=kind).G
    polar = 7800 * np.pi / 32 * (0.05**4 - 0.02**4) * LENGTH
    assert pytest.approx(polar) == TILT_X @ G @ TILT_Y
    np.testing.assert_allclose(G, -G.T, atol=1e-15 * polar)


def test_a_cantilever_bends_and_shears_by_the_textbook():
    K = shaft_element(TUBE, LENGTH).K[4:, 4:]  # first node clamped
    tip = np.linalg.solve(K, [1000.0, 0, 0, 0])
    EI = 2e11 * np.pi / 64 * (0.05**4 - 0.02**4)
    GA = 2e11 / 2.6 * np.pi / 4 * (0.05**2 - 0.02**2) * shear_factor(TUBE)
    assert tip[0] == pytest.approx(1000 * LENGTH**3 / (3 * EI) + 1000 * LENGTH / GA)
    assert tip[2] == pytest.approx(1000 * LENGTH**2 / (2 * EI))
    assert tip[1] == tip[3] == 0


def test_shear_in_a_thin_tube_is_carried_by_about_half_of_it():
    thin = replace(TUBE, inner_diameter=0.05 * (1 - 1e-9))
    assert shear_factor(thin) == pytest.approx(2 * 1.3 / (4 + 3 * 0.3))  # Cowper 1966, table 1: thin-walled round tube


@pytest.mark.parametrize("length", [0.0, -0.1, np.nan])
def test_an_element_without_length_is_refused(length):
    with pytest.raises(ValueError, match=r"the element's length is .* m, want one above zero"):
        shaft_element(TUBE, length)
