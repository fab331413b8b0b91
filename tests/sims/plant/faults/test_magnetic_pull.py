"""A magnet beside the disk."""

import numpy as np
import pytest
from scipy.optimize import brentq

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import magnetic_pull

from ..by_hand import felt, ring_down, settled, upward_crossings

MAGNET = {"pull": 2.0, "gap": 1e-3, "angle": 0.0, "disk": 0.0}
K = 73.631e3  # N/m at the disk


def test_it_pulls_as_one_over_the_square_of_the_gap_until_the_iron_is_saturated(jeffcott: RigConfig) -> None:
    (magnet,) = magnetic_pull.forces(jeffcott, nameplate(jeffcott), MAGNET)
    for x, want in ((0.0, 2.0), (5e-4, 8.0), (-1e-3, 0.5), (8e-4, 50.0), (1.2e-3, 50.0)):
        assert felt(magnet, x=x, y=3e-4, omega=300.0) == pytest.approx((want, 0.0))
    (upright,) = magnetic_pull.forces(jeffcott, nameplate(jeffcott), MAGNET | {"angle": np.pi / 2})
    assert felt(upright, x=3e-4, y=5e-4) == pytest.approx((0.0, 8.0))


@pytest.mark.parametrize("pull", [2.0, 8.0])
def test_the_disk_comes_to_rest_where_shaft_and_magnet_pull_alike(jeffcott: RigConfig, pull: float) -> None:
    def off(u: float) -> float:
        return K * u - pull / (1 - u / 1e-3) ** 2

    x, y = settled(jeffcott, "magnetic_pull", MAGNET | {"pull": pull, "angle": 0.6})
    u = brentq(off, 0.0, 3e-4)
    assert (x, y) == pytest.approx((u * np.cos(0.6), u * np.sin(0.6)), rel=1e-3)


def test_towards_it_the_shaft_rings_slower_as_on_a_softer_spring(jeffcott: RigConfig) -> None:
    """About its place u there, k - 2 F / g (1 - u / g)^-3: 3.01 per cent slower; across it, as without."""

    def hertz(angle: float) -> float:
        x = ring_down(jeffcott, "magnetic_pull", MAGNET | {"angle": angle}, amplitude=6e-5, seconds=1.0)
        return float(1 / np.diff(upward_crossings(x - x.mean())).mean())

    u = brentq(lambda u: K * u - 2.0 / (1 - u / 1e-3) ** 2, 0.0, 3e-4)
    k = K - 2 * 2.0 / 1e-3 * (1 - u / 1e-3) ** -3
    assert np.sqrt(k / K) == pytest.approx(1 - 0.0301, abs=1e-4)
    assert hertz(0.0) / hertz(np.pi / 2) == pytest.approx(np.sqrt(k / K), rel=3e-4)
