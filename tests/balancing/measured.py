"""Conditions from tables in tests/data: a real RK4 at two dwells with trial masses, published balancing cases."""

import cmath
import csv
import math

import numpy as np

from rotorrig.balancing.conditions import Conditions
from tests.conftest import CONFIGS

MIL = 25.4e-6  # m
GMM = 1e-6  # kg m
SPEEDS = {"N1": 1005.0, "N2": 1205.0}  # rpm
PROBES = ("p1x", "p1y", "p2x", "p2y")


def real_rig() -> Conditions:
    """Return the dwells of an RK4: repeats averaged, vectors conjugated back, masses counted against the rotation."""
    with (CONFIGS.parent / "tests" / "data" / "kfupm-rk4" / "vectors_1x_dwells.csv").open() as file:
        rows = list(csv.DictReader(file))
    names = tuple(dict.fromkeys(row["condition"] for row in rows))
    z = np.full((len(names), len(SPEEDS), len(PROBES)), np.nan + 0j)
    trial = np.zeros((len(names), 2), complex)
    for i, name in enumerate(names):
        for j, speed in enumerate(SPEEDS):
            mine = [row for row in rows if row["condition"] == name and row["speed_id"] == speed]
            if mine:
                z[i, j] = np.mean([[vector(row, probe) for probe in PROBES] for row in mine], axis=0)
        first = next(row for row in rows if row["condition"] == name)
        trial[i] = [
            float(first[f"U{k}_gmm"]) * GMM * cmath.exp(-1j * math.radians(float(first[f"U{k}_deg"]))) for k in (1, 2)
        ]
    return Conditions(
        probes=PROBES,
        planes=("disk 1", "disk 2"),
        names=names,
        trial=trial,
        omega=np.array(list(SPEEDS.values())) * math.pi / 30,
        direction=np.zeros(2, np.intp),
        z=z,
        variance=np.zeros(z.shape),
        compensated=True,
    )


def vector(row: dict[str, str], probe: str) -> complex:
    return MIL * complex(float(row[f"{probe}_re"]), -float(row[f"{probe}_im"]))


def published(case: str, quantity: str) -> np.ndarray:
    """Return the vectors of one quantity of a published case, by sensor and plane as the table has them."""
    with (CONFIGS.parent / "tests" / "data" / "balancing-published" / "published_balancing_vectors.csv").open() as file:
        rows = [r for r in csv.DictReader(file) if (r["case"], r["quantity"]) == (case, quantity)]
    return np.array([cmath.rect(float(r["amp"]), math.radians(float(r["phase_deg"]))) for r in rows])
