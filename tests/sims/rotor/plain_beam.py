"""A rotor in plain numpy that shares no code with the package: forward whirl of a round shaft in round bearings.

One complex coordinate r = x + j y and its slope s at every node, 4 mm apart or less, with nodes wherever something is.
A piece of shaft is an inverted flexibility (bending and shear under an end force and moment), its mass is lumped. In
forward whirl at the speed of rotation a thin slice and a disk feel the inertia It - Ip against tilt.
"""

import math
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

E, DENSITY, POISSON = 208.11e9, 7801.0, 0.3
SHEAR = 6 * (1 + POISSON) / (7 + 6 * POISSON)
FINEST = 4e-3  # m


@dataclass(kw_only=True)
class Rotor:
    """The RK4's rotor with bearings alike in x and y; SI."""

    length: float = 0.560
    diameter: float = 0.010
    disk: float = 0.2805
    mass: float = 0.809
    polar: float = 568.46e-6
    transverse: float = 327.60e-6
    bearings: dict[str, float] = field(default_factory=lambda: {"left A": 0.065, "left B": 0.080, "spring": 0.481})
    k: dict[str, float] = field(default_factory=lambda: {"left A": 2e6, "left B": 2e6, "spring": 34e3})
    c: float = 15.0  # of the spring bearing
    tilt: dict[str, float] = field(default_factory=dict)
    probes: tuple[float, float] = (0.2505, 0.3805)
    hub_width: float = 0.025
    hub: float = 0.0  # share of the flexibility in bending that is taken away within the hub's width

    def response(self, omega: np.ndarray) -> np.ndarray:
        """Return r at the probes per kg m of unbalance on the disk, (speed, probe)."""
        edges = [self.disk - self.hub_width / 2, self.disk + self.hub_width / 2]
        places = sorted({0.0, self.length, self.disk, *self.bearings.values(), *self.probes, *edges})
        z = np.concatenate(
            [np.linspace(a, b, math.ceil((b - a) / FINEST), endpoint=False) for a, b in pairwise(places)]
            + [[self.length]]
        )
        area, second_moment = math.pi / 4 * self.diameter**2, math.pi / 64 * self.diameter**4
        shear = SHEAR * area * E / (2 * (1 + POISSON))
        K, M = np.zeros((2, 2 * len(z), 2 * len(z)))
        for n, (a, b) in enumerate(pairwise(z)):
            h, under = b - a, edges[0] < (a + b) / 2 < edges[1]
            EI = E * second_moment / (1 - self.hub * under)
            flexibility = np.array([[h**3 / (3 * EI) + h / shear, h**2 / (2 * EI)], [h**2 / (2 * EI), h / EI]])
            motion = np.array([[-1, -h, 1, 0], [0, -1, 0, 1]])  # of the far end against the near one, as a cantilever
            own = np.s_[2 * n : 2 * n + 4]
            K[own, own] += motion.T @ np.linalg.inv(flexibility) @ motion
            lump = DENSITY * area * h / 2
            tilt = -DENSITY * second_moment * h / 2  # It - Ip of a slice is -It
            M[own, own] += np.diag([lump, tilt, lump, tilt])

        def at(place: float) -> int:
            return 2 * int(np.argmin(abs(z - place)))

        C = np.zeros_like(K)
        for name, place in self.bearings.items():
            K[at(place), at(place)] += self.k[name]
            K[at(place) + 1, at(place) + 1] += self.tilt.get(name, 0.0)
        C[at(self.bearings["spring"]), at(self.bearings["spring"])] += self.c
        M[at(self.disk), at(self.disk)] += self.mass
        M[at(self.disk) + 1, at(self.disk) + 1] += self.transverse - self.polar
        push = np.zeros(len(K))
        push[at(self.disk)] = 1.0
        seen = [at(place) for place in self.probes]
        return np.array([np.linalg.solve(K - w**2 * M + 1j * w * C, w**2 * push)[seen] for w in omega])
