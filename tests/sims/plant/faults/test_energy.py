"""The work a passive part of a rig at standstill takes over a closed path; none, if all it does is store."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults.base import load_fault

from ..by_hand import driven

STEP = 2e-5
TURNS = 4

#: fault -> what it is driven by [m, or rad where it bends the shaft], and changes to its defaults
STORES: dict[str, tuple[float, dict[str, float]]] = {
    "clearance": (4e-5, {"gap": 2e-5}),
    "crack": (2e-4, {}),
    "cubic_spring": (3e-4, {}),
    "loose_pedestal": (5e-5, {}),
    "magnetic_pull": (3e-4, {}),
    "shaft_asymmetry": (2e-4, {}),
    "snubber": (3e-4, {}),
}
TAKES: dict[str, tuple[float, dict[str, float]]] = {
    "drag": (1e-4, {}),
    "friction": (2e-5, {}),
    "hysteresis": (8e-5, {}),
    "internal_damping": (2e-4, {}),
    "rub": (3e-4, {}),
    "seal": (2e-4, {}),
}


def work(rig: RigConfig, name: str, size: float, values: dict[str, float]) -> tuple[float, float]:
    """Return the work done on the part over the last turn of an eight in the plane, and over its outward halves.

    An eight goes to and fro and round in either sense: a law that pumps on either would be found out.
    """
    module: Any = load_fault(name)
    t = STEP * np.arange(1, round(TURNS * 0.1 / STEP) + 1)
    w = 2 * np.pi / 0.1
    grows = 1 - np.exp(-t / 0.03)
    x, y = size * grows * np.sin(w * t), 0.7 * size * grows * np.sin(2 * w * t + 0.4)
    last = slice(round((TURNS - 1) * 0.1 / STEP), None)
    total = np.zeros(len(t))
    for force in module.forces(rig, nameplate(rig), module.PARAMETERS | values):
        total += power(driven(force, x, y, step=STEP), x, y)
    return float(total[last].sum()), float(np.maximum(total[last], 0.0).sum())


def power(f: NDArray[np.float64], x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the work against the law on the way to each point, the force taken half way: trapezoidal rule."""
    half = (f + np.roll(f, 1, axis=0)) / 2
    return -(half[:, 0] * np.diff(x, prepend=x[0]) + half[:, 1] * np.diff(y, prepend=y[0]))


@pytest.mark.parametrize("name", STORES)
def test_what_only_stores_gives_back_all_of_it(rk4: RigConfig, name: str) -> None:
    taken, moved = work(rk4, name, *STORES[name])
    assert moved > 0
    assert abs(taken) < 2e-3 * moved


@pytest.mark.parametrize("name", TAKES)
def test_what_rubs_or_flows_takes_work(rk4: RigConfig, name: str) -> None:
    taken, moved = work(rk4, name, *TAKES[name])
    assert taken > 0.05 * moved


@pytest.mark.parametrize("name", TAKES)
def test_it_never_gives_back_more_than_it_has_stored(rk4: RigConfig, name: str) -> None:
    """From ease on, whatever the path: here a random one, within the band of 100 Hz."""
    size, values = TAKES[name]
    module: Any = load_fault(name)
    rng = np.random.default_rng(8)
    t = STEP * np.arange(10_000)
    tones = 2 * np.pi * rng.uniform(5, 100, (2, 12))
    phases = rng.uniform(0, 2 * np.pi, (2, 12))
    waves = np.sin(tones[..., None] * t + phases[..., None]) - np.sin(phases)[..., None]
    x, y = size * waves.sum(axis=1) / 4
    forces = module.forces(rk4, nameplate(rk4), module.PARAMETERS | values)
    for force in forces:
        path = power(driven(force, x, y, step=STEP), x, y).cumsum()
        # the springs that the nameplate holds are taken off, and give and take by themselves
        spare = 0.0 if name != "hysteresis" else 0.02 / 2 * 34.6e3 * (x**2 + y**2) / 2
        assert np.all(path + spare > -1e-3 * np.abs(path).max())
