"""A skewed disk bends the shaft to an S."""

import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import difference


def test_it_bends_the_shaft_beside_the_disk_and_not_at_it(jeffcott: RigConfig) -> None:
    """A moment M at midspan of a simply supported shaft moves its quarter point by M L^2 / (128 E I) (Roark, 8.1).

    M = (It - Ip) skew W^2 = -1e-4 * 0.3 * 150^2 N m; to the left of a moment that tips the disk towards +x, x is less.
    """
    rig = jeffcott.model_copy(
        update={"probes": (jeffcott.probes[0], jeffcott.probes[1].model_copy(update={"angle": 0.0, "position": 0.1}))}
    )
    z = difference(rig, "couple", {"skew": 0.3, "angle": 0.0}, rpm=150 * 9.5493)
    expected = 1e-4 * 0.3 * 150**2 * 0.4**2 / (128 * 98.17)
    assert z[1] == pytest.approx(expected, rel=0.03)
    assert abs(z[0]) < 0.02 * expected
