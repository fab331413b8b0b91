"""A crack opens on the stretched side."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import settled, steady

CRACK = {"compliance": 1e-4, "position": 0.15}


def sag(rig: RigConfig, angle: float) -> float:
    """Return how far down the disk hangs with the crack's mouth at `angle` from +x."""
    return -settled(rig.model_copy(update={"gravity": "-y"}), "crack", CRACK | {"angle": angle})[1]


def test_below_it_gives_as_a_hinge_and_above_not_at_all(jeffcott: RigConfig) -> None:
    """The hinge turns by M c under M = W z / 2 and lowers midspan by z / 2 of that: W c (z / 2)^2."""
    whole = 9.80665 / 73.631e3
    assert sag(jeffcott, -np.pi / 2) - whole == pytest.approx(9.80665 * 1e-4 * 0.075**2, rel=0.02)
    assert sag(jeffcott, np.pi / 2) == pytest.approx(whole, rel=1e-4)


def test_turning_slowly_it_lowers_the_shaft_once_per_turn_with_harmonics(jeffcott: RigConfig) -> None:
    """Upright it gives as s^2, s the mouth's depth, while s > 0: 1X 4 / (3 pi), 2X 1/4, 3X 4 / (15 pi) of its sag."""
    disk = jeffcott.disks[0].model_copy(update={"unbalance": None})
    lying = jeffcott.model_copy(update={"gravity": "-y", "disks": (disk,)})
    drop = 9.80665 * 1e-4 * 0.075**2
    for order, share in ((1, 4 / (3 * np.pi)), (2, 1 / 4), (3, 4 / (15 * np.pi))):
        z = steady(lying, "crack", CRACK | {"angle": -np.pi / 2}, rpm=60, order=order)
        assert z[1] == pytest.approx(-drop * share, rel=0.05)
