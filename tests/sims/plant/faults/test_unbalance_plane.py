"""Unbalance somewhere on the shaft."""

import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import difference


def test_at_midspan_it_moves_the_disk_as_the_closed_form_says(jeffcott: RigConfig) -> None:
    """U W^2 / (k - m W^2 + j c W) at half the critical speed: a third of U / m, nearly."""
    values = {"amount": 30e-6, "angle": 0.0, "position": 0.2}
    z = difference(jeffcott, "unbalance_plane", values, rpm=0.5 * 271.35 * 9.5493)
    assert z[0] == pytest.approx(30e-6 * 0.25 / (0.75 + 0.05j), rel=0.01)


def test_elsewhere_it_moves_the_disk_less_by_the_shaft_s_influence(jeffcott: RigConfig) -> None:
    """A force at a quarter of the span bends midspan by 11/16 of what it does at midspan (Roark, table 8.1)."""
    middle, quarter = (
        difference(jeffcott, "unbalance_plane", {"amount": 90e-6, "angle": 0.0, "position": z}, rpm=500)[0]
        for z in (0.2, 0.1)
    )
    assert quarter / middle == pytest.approx(11 / 16, rel=0.02)
