"""The unknowns of an [identify] table: their names and bounds, two scales, and the matrices they fill."""

import numpy as np
import pytest

from rotorrig.identify.base_model.unknowns import Space
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import ConfigError
from tests.identify.matched import sought


def test_a_single_set_and_a_single_disk_have_short_names(rig_config: RigConfig) -> None:
    space = Space.of(rig_config)
    assert space.names == ("kxx", "kyy", "cxx", "cyy")
    assert [amount.name for amount in space.amounts] == ["u"]
    assert space.groups == (("spring",),)
    np.testing.assert_array_equal(space.bounds, [[1e2, 1e6], [1e2, 1e6], [1.0, 1e3], [1.0, 1e3]])
    np.testing.assert_allclose(space.nameplate, [33.9e3, 34.6e3, 15.0, 15.0], rtol=1e-12)


def test_several_sets_carry_their_bearings_and_what_else_is_sought_comes_last(rig_config: RigConfig) -> None:
    rig = sought(rig_config, bearings=[["left A", "left B"], ["spring"]], also=["density", "youngs_modulus"])
    space = Space.of(rig)
    assert space.names[0] == "left A+left B kxx"
    assert space.names[7:] == ("spring cyy", "density", "E")
    assert [unknown.unit for unknown in space.unknowns[-2:]] == ["kg/m^3", "Pa"]
    assert space.bounds[-1] == pytest.approx([208.11e9 / 3, 208.11e9 * 3])


def test_all_eight_fill_both_matrices(rig_config: RigConfig) -> None:
    space = Space.of(sought(rig_config, coefficients="all", bearings=[["left A"], ["spring"]]))
    K, C = space.matrices(np.arange(16.0))
    np.testing.assert_array_equal(K, [[[0, 1], [2, 3]], [[8, 9], [10, 11]]])
    np.testing.assert_array_equal(C, [[[4, 5], [6, 7]], [[12, 13], [14, 15]]])


def test_matrices_of_many_candidates_are_those_of_each(rig_config: RigConfig, rng: np.random.Generator) -> None:
    space = Space.of(sought(rig_config, also=["density"]))
    values = rng.uniform(1, 2, (3, 2, len(space)))
    K, C = space.matrices(values)
    assert K.shape == C.shape == (3, 2, 1, 2, 2)
    np.testing.assert_array_equal(K[1, 1], space.matrices(values[1, 1])[0])
    np.testing.assert_allclose(space.shaft_factor("density", values), values[..., -1] / 7801)
    np.testing.assert_array_equal(space.shaft_factor("E", values), np.ones((3, 2)))


def test_cross_coefficients_may_be_as_large_as_the_largest_direct_one_and_negative(rig_config: RigConfig) -> None:
    space = Space.of(sought(rig_config, coefficients="all", k_bounds=[1e3, 1e5]))
    assert space.unknowns[1].name == "kxy"
    assert space.unknowns[1].scale == "linear"
    np.testing.assert_array_equal(space.bounds[1], [-1e5, 1e5])
    np.testing.assert_array_equal(space.working_bounds[1], [-1, 1])
    given = Space.of(sought(rig_config, coefficients="all", kxy_bounds=[-3e4, 1e4]))
    np.testing.assert_array_equal(given.bounds[2], [-3e4, 1e4])


def test_working_coordinates_come_back_and_slopes_are_their_derivative(
    rig_config: RigConfig, rng: np.random.Generator
) -> None:
    space = Space.of(sought(rig_config, coefficients="all", also=["youngs_modulus"]))
    low, high = space.working_bounds.T
    working = rng.uniform(low, high)
    np.testing.assert_allclose(space.to_working(space.from_working(working)), working, atol=1e-12)
    step = 1e-6
    central = (space.from_working(working + step) - space.from_working(working - step)) / (2 * step)
    np.testing.assert_allclose(space.slopes(space.from_working(working)), central, rtol=1e-6)


def test_a_cross_coefficient_is_held_against_the_direct_ones_of_its_bearing(rig_config: RigConfig) -> None:
    space = Space.of(sought(rig_config, coefficients="all", bearings=[["left A"], ["spring"]]))
    values = np.array([4.0, 0, 0, 9.0, 1.0, 0, 0, 4.0, 16.0, 0, 0, 1.0, 9.0, 0, 0, 9.0])
    expected = [4, 6, 6, 9, 1, 2, 2, 4, 16, 4, 4, 1, 9, 9, 9, 9]
    np.testing.assert_allclose(space.references(values), expected)


def test_a_nameplate_outside_the_bounds_is_moved_into_them(rig_config: RigConfig) -> None:
    space = Space.of(sought(rig_config, bearings=["left A"]))  # 2e6 N/m and no damping
    np.testing.assert_array_equal(space.nameplate, [1e6, 1e6, 1.0, 1.0])


def test_a_rig_without_an_identify_table_has_none(rig_config: RigConfig) -> None:
    with pytest.raises(ConfigError, match=r"no \[identify\] section"):
        Space.of(rig_config.model_copy(update={"identify": None}))
