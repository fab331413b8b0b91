"""Random rotors for property tests: stepped and hollow shafts of several materials, disks, bearings of all eight
coefficients (stable enough to answer: damped, the cross terms smaller than the direct ones), probes at any angle."""

import math
from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from rotorrig.rig.config.description import RigConfig, from_si

PLACES = 16  # steps of the shaft on which parts sit, so that no element is a sliver


def number(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_subnormal=False)


def size(low: float, high: float) -> st.SearchStrategy[float]:
    """Evenly over the decades."""
    return number(math.log10(low), math.log10(high)).map(lambda power: 10.0**power)


@st.composite
def rotors(draw: st.DrawFn) -> RigConfig:
    sections = [draw(_sections()) for _ in range(draw(st.integers(1, 3)))]
    length = sum(section["length"] for section in sections)

    def places(count: int) -> list[float]:
        steps = draw(st.lists(st.integers(0, PLACES), min_size=count, max_size=count, unique=True))
        return [step / PLACES * length for step in steps]

    return from_si(
        {
            "name": "random",
            "shaft": {
                "sections": sections,
                "density": 7800.0,
                "youngs_modulus": 2e11,
                "rayleigh": {"mass": draw(number(0, 1)), "stiffness": draw(number(0, 1e-6))},
                "structural_damping": draw(st.sampled_from([0.0, 0.01])),
            },
            "disks": [draw(_disks(f"disk {i}", z)) for i, z in enumerate(places(draw(st.integers(1, 3))))],
            "bearings": [draw(_bearings(f"bearing {i}", z)) for i, z in enumerate(places(draw(st.integers(2, 3))))],
            "probes": [
                {"name": f"p{i}", "position": z, "angle": draw(number(-math.pi, math.pi)), "channel": i}
                for i, z in enumerate(places(2))
            ],
            "rotation": draw(st.sampled_from(["x-to-y", "y-to-x"])),
        }
    )


@st.composite
def _sections(draw: st.DrawFn) -> dict[str, Any]:
    diameter = draw(number(0.01, 0.1))
    section = {
        "length": draw(number(0.15, 0.6)),
        "diameter": diameter,
        "inner_diameter": diameter * draw(st.sampled_from([0.0, 0.4, 0.8])),
    }
    if draw(st.booleans()):
        section |= {"density": 4430.0, "youngs_modulus": 114e9, "poisson_ratio": 0.34}  # titanium
    return section


@st.composite
def _disks(draw: st.DrawFn, name: str, position: float) -> dict[str, Any]:
    mass, radius = draw(size(0.1, 30)), draw(number(0.02, 0.2))
    polar = mass * radius**2 / 2
    return {
        "name": name,
        "position": position,
        "mass": mass,
        "polar_inertia": polar,
        "transverse_inertia": polar * draw(number(0.5, 2)),
    }


@st.composite
def _bearings(draw: st.DrawFn, name: str, position: float) -> dict[str, Any]:
    k, c = draw(size(1e4, 1e8)), draw(size(10, 1e4))
    return {
        "name": name,
        "position": position,
        "kxx": k,
        "kyy": k * draw(number(0.3, 1)),
        "kxy": k * draw(number(-0.2, 0.2)),
        "kyx": k * draw(number(-0.2, 0.2)),
        "cxx": c,
        "cyy": c * draw(number(0.3, 1)),
        "cxy": c * draw(number(-0.2, 0.2)),
        "cyx": c * draw(number(-0.2, 0.2)),
    }


def turned(matrix: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Return a bearing's (2, 2) matrix after the bearing has been turned by `angle`, from +x towards +y."""
    R = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    return R @ matrix @ R.T
