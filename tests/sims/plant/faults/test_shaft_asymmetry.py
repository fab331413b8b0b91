"""A shaft with a stiff and a soft plane."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import settled, steady

SAG = 9.80665 / 73.631e3  # m, the disk's 1 kg on the shaft


def test_it_sags_less_on_its_stiff_plane_than_on_its_soft_one(jeffcott: RigConfig) -> None:
    lying = jeffcott.model_copy(update={"gravity": "-x"})
    soft = 0.9 / 1.1  # of the stiff plane, which is the round shaft's
    for angle, k in ((0.0, 1.0), (np.pi / 2, soft), (np.pi, 1.0)):
        x, y = settled(lying, "shaft_asymmetry", {"asymmetry": 0.1, "stiff_plane": angle})
        assert x == pytest.approx(-SAG / k, rel=1e-3)
        assert abs(y) < 1e-3 * SAG
    x, y = settled(lying, "shaft_asymmetry", {"asymmetry": 0.1, "stiff_plane": np.pi / 4})
    # half the weight on either plane, seen along x and y
    assert (x, y) == pytest.approx((-SAG * (1 + 1 / soft) / 2, SAG * (1 / soft - 1) / 2), rel=1e-3)


def test_turning_slowly_its_weight_lifts_it_twice_per_turn(jeffcott: RigConfig) -> None:
    """By half of what the two planes' sags differ; the stiff plane upright at angle zero makes y highest there."""
    lying = jeffcott.model_copy(update={"gravity": "-y"})
    z = steady(lying, "shaft_asymmetry", {"asymmetry": 0.05, "stiff_plane": np.pi / 2}, rpm=90, order=2)
    differ = (1.05 / 0.95 - 1) / 2
    assert z[1] == pytest.approx(differ * SAG, rel=0.03)
    assert z[0] == pytest.approx(differ * SAG * 1j, rel=0.03)  # x is pushed aside a quarter of that turn before


def test_without_weight_and_unbalance_nothing_moves(jeffcott: RigConfig) -> None:
    disk = jeffcott.disks[0].model_copy(update={"unbalance": None})
    still = jeffcott.model_copy(update={"disks": (disk,)})
    assert np.abs(steady(still, "shaft_asymmetry", {"asymmetry": 0.05}, rpm=1200, order=2)).max() < 0.02e-6
