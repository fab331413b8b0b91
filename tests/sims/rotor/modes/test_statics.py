"""Weights and bearing loads by the lever rule."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.sims.rotor.modes.modes import GRAVITY
from rotorrig.sims.rotor.modes.statics import bearing_loads, shaft_mass

STEEL = {"density": 7800.0, "youngs_modulus": 2e11}
LIGHT = {"density": 1e-6, "youngs_modulus": 2e11}


def rotor(*bearings: dict, gravity: str = "-y") -> RigConfig:
    """A light shaft of 1 m with 10 kg at a quarter of it; bearings are named by their order."""
    disk = {"name": "disk", "position": 0.25, "mass": 10.0, "polar_inertia": 0.1, "transverse_inertia": 0.06}
    return from_si(
        {
            "name": "levers",
            "shaft": {"length": 1.0, "diameter": 0.05, **LIGHT},
            "disks": [disk],
            "bearings": [{"name": str(i), **bearing} for i, bearing in enumerate(bearings)],
            "probes": [{"name": "x", "position": 0.5, "angle": 0.0, "channel": 0}],
            "gravity": gravity,
        }
    )


ELASTIC = {"kxx": 2e6, "kyy": 1e5}


@pytest.mark.parametrize("left", [ELASTIC, {"rigid": True}], ids=["elastic", "rigid"])
@pytest.mark.parametrize("right", [ELASTIC, {"rigid": True}], ids=["elastic", "rigid"])
@pytest.mark.parametrize(("gravity", "axis"), [("-y", 1), ("-x", 0)])
def test_two_bearings_share_the_weight_by_the_lever_rule(left, right, gravity, axis):
    loads = bearing_loads(rotor({"position": 0.0, **left}, {"position": 1.0, **right}, gravity=gravity))
    assert -loads[:, axis] == pytest.approx(np.array([0.75, 0.25]) * 10 * GRAVITY, rel=1e-6)
    assert np.abs(loads[:, 1 - axis]).max() < 1e-6


def test_a_stiff_shaft_on_three_springs_loads_them_by_their_stiffness():
    """Rigid body: forces k (a + b z) with the sum and the moment of the weight."""
    k, z = np.array([1e2, 3e2, 2e2]), np.array([0.0, 0.5, 1.0])
    rig = rotor(
        *({"position": place, "kxx": float(each), "kyy": float(each)} for place, each in zip(z, k, strict=True))
    )
    a, b = np.linalg.solve([[k.sum(), k @ z], [k @ z, k @ z**2]], np.array([1.0, 0.25]) * 10 * GRAVITY)
    # the sag is 2 cm of a stiff shaft (48 EI / L^3 is 3e6 N/m)
    np.testing.assert_allclose(-bearing_loads(rig)[:, 1], k * (a + b * z), rtol=1e-3)


def test_a_third_rigid_bearing_takes_the_share_a_beam_gives_it():
    """Point load at a quarter of a beam pinned at its ends and middle: reactions 13/32, 22/32.. of the two-span beam.

    Three-moment equation for spans L/2, load P in the middle of the first: ends 13/32 P and -3/32 P, middle 22/32 P;
    the shear of this shaft (d / span = 1/50) moves them by 1e-4.
    """
    slender = rotor(*({"position": z, "rigid": True} for z in (0.0, 0.5, 1.0)))
    shaft = slender.shaft.model_copy(update={"diameter": 0.01})
    loads = -bearing_loads(slender.model_copy(update={"shaft": shaft}))[:, 1]
    np.testing.assert_allclose(loads / (10 * GRAVITY), [13 / 32, 22 / 32, -3 / 32], atol=1e-3)


def test_a_hollow_and_a_solid_section_weigh_what_they_are():
    table = rotor({"position": 0.0, **ELASTIC}, {"position": 1.0, **ELASTIC}).model_dump()
    sections = [{"length": 0.4, "diameter": 0.1, "inner_diameter": 0.08}, {"length": 0.6, "diameter": 0.02}]
    rig = from_si(table | {"shaft": {"sections": sections, **STEEL}})
    assert shaft_mass(rig.shaft) == pytest.approx(7800 * np.pi / 4 * (0.4 * (0.1**2 - 0.08**2) + 0.6 * 0.02**2))


def test_a_rotor_that_nothing_holds_has_no_loads():
    rig = rotor({"position": 0.0, "kxx": 1e5, "kyy": 0.0}, {"position": 1.0, "kxx": 1e5, "kyy": 0.0})
    with pytest.raises(ValueError, match="do not hold the shaft"):
        bearing_loads(rig)
