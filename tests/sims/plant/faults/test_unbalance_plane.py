"""Unbalance somewhere on the shaft."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults.base import apply_structure
from rotorrig.sims.plant.shaft import build
from rotorrig.sims.plant.truth import FaultSpec

from ..by_hand import difference


def test_at_midspan_it_moves_the_disk_as_the_closed_form_says(jeffcott: RigConfig) -> None:
    """U W^2 / (k - m W^2 + j c W) at half the critical speed: a third of U / m, nearly; 3 g at 10 mm weigh little."""
    values = {"amount": 30e-6, "angle": 0.0, "position": 0.2, "radius": 1.0}
    z = difference(jeffcott, "unbalance_plane", values, rpm=0.5 * 271.35 * 9.5493)
    assert z[0] == pytest.approx(30e-6 * 0.25 / (0.75 + 0.05j), rel=0.01)


def test_its_mass_makes_the_shaft_critical_earlier(jeffcott: RigConfig) -> None:
    """Of 1 kg at the disk and 50 g beside it: sqrt(1.05)."""
    spec = FaultSpec(name="unbalance_plane", parameters={"amount": 5e-4, "radius": 0.01, "position": 0.2})
    truth = nameplate(jeffcott, faults=[spec])
    plain = build(jeffcott, truth)
    heavy = apply_structure(jeffcott, truth, plain)
    ratio = plain.critical_speeds(1)[0] / heavy.critical_speeds(1)[0]
    assert ratio == pytest.approx(np.sqrt(1.05), rel=1e-3)


def test_elsewhere_it_moves_the_disk_less_by_the_shaft_s_influence(jeffcott: RigConfig) -> None:
    """A force at a quarter of the span bends midspan by 11/16 of what it does at midspan (Roark, table 8.1)."""
    values = {"amount": 90e-6, "angle": 0.0, "radius": 1.0}
    middle, quarter = (
        difference(jeffcott, "unbalance_plane", values | {"position": z}, rpm=500)[0] for z in (0.2, 0.1)
    )
    assert quarter / middle == pytest.approx(11 / 16, rel=0.02)
