"""Rotors of the literature, as configs."""

import math
from pathlib import Path
from typing import Any

import pytest

from rotorrig.rig.config.description import RigConfig, from_si, load

ROOT = Path(__file__).parents[2]


def ring(name: str, *, position: float, diameter: float, width: float) -> dict[str, Any]:
    """Return a steel disk with a bore of 0.1 m, as a table in SI."""
    outer, bore = diameter / 2, 0.05
    mass = 7800 * math.pi * (outer**2 - bore**2) * width
    return {
        "name": name,
        "position": position,
        "mass": mass,
        "polar_inertia": mass / 2 * (outer**2 + bore**2),
        "transverse_inertia": mass / 12 * (3 * (outer**2 + bore**2) + width**2),
    }


@pytest.fixture(scope="session")
def lalanne() -> RigConfig:
    """Lalanne and Ferraris (1998) as in the chapter's Table 5; probes 2x, 2y, 12x, 12y at nodes 2 and 12 of 14.

    The same data, x and y exchanged, are those of code_aster's validation case SDLL124 (document V2.02.124).
    """
    bearing = {"kxx": 50e6, "kyy": 70e6, "cxx": 500.0, "cyy": 700.0}
    places = [("2x", 0.1, 0.0), ("2y", 0.1, math.pi / 2), ("12x", 1.1, 0.0), ("12y", 1.1, math.pi / 2)]
    return from_si(
        {
            "name": "Lalanne",
            "shaft": {"length": 1.3, "diameter": 0.1, "density": 7800.0, "youngs_modulus": 200e9},
            "disks": [
                ring("1", position=0.2, diameter=0.24, width=0.05),
                ring("2", position=0.5, diameter=0.40, width=0.05),
                ring("3", position=1.0, diameter=0.40, width=0.06),
            ],
            "bearings": [{"name": "left", "position": 0.0, **bearing}, {"name": "right", "position": 1.3, **bearing}],
            "probes": [{"name": n, "position": z, "angle": a, "channel": i} for i, (n, z, a) in enumerate(places)],
        }
    )


@pytest.fixture(scope="session")
def rk4() -> RigConfig:
    return load(ROOT / "configs" / "rk4.toml")
