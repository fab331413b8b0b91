"""Jeffcott's rotor on a ramp of speed, integrated as a vibration, and tracked from its waveform as an instrument does.

It shares no code with the package. `force` (x, y, vx, vy) -> (fx, fy) acts on the disk besides.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

from rotorrig.rig.config.description import RigConfig, from_si

M, KX, KY, C = 0.8, 3.4e4, 3.6e4, 12.0  # kg, N/m, N s/m


def rig() -> RigConfig:
    """Return its nameplate: a stiff light shaft on two soft bearings."""
    return from_si(
        {
            "name": "Jeffcott",
            "shaft": {"length": 0.4, "diameter": 0.08, "density": 1e-3, "youngs_modulus": 2e13},
            "disks": [{"name": "disk", "position": 0.2, "mass": M, "polar_inertia": 5e-4, "transverse_inertia": 3e-4}],
            "bearings": [
                {"name": name, "position": z, "kxx": KX / 2, "kyy": KY / 2, "cxx": C / 2, "cyy": C / 2}
                for name, z in (("a", 0.0), ("b", 0.4))
            ],
            "probes": [
                {"name": "x", "position": 0.2, "angle": 0.0, "channel": 0},
                {"name": "y", "position": 0.2, "angle": math.pi / 2, "channel": 1},
            ],
        }
    )


def tracked(ramp, unbalance: complex, *, turns: float, orders=(1,), force=None, static=(0.0, 0.0)) -> np.ndarray:
    """Return z = 2 mean(x e^{-j order theta}) of the rows (row, probe, order), Hann's window; of order 0 the mean.

    `static` [m] is where the weight, which acts besides, would hold it.
    """
    phase, size = np.angle(unbalance), abs(unbalance)
    weight = np.array([KX, KY]) * static

    def motion(t, state):
        x, y, u, v = state
        omega, angle = ramp.omega(t), ramp.theta(t) + phase
        fx = weight[0] + size * (omega**2 * math.cos(angle) + ramp.rate * math.sin(angle))  # -d2/dt2 (U cos angle)
        fy = weight[1] + size * (omega**2 * math.sin(angle) - ramp.rate * math.cos(angle))
        if force is not None:
            by = force(x, y, u, v)
            fx, fy = fx + by[0], fy + by[1]
        return [u, v, (fx - C * u - KX * x) / M, (fy - C * v - KY * y) / M]

    first = ramp.omega(0)
    Z = [k - first**2 * M + 1j * first * C for k in (KX, KY)]
    A = np.array([1 / Z[0], -1j / Z[1]]) * unbalance * first**2
    start = [*(A.real + static), *(1j * first * A).real]
    solution = solve_ivp(motion, (0, ramp.seconds), start, "DOP853", dense_output=True, rtol=1e-7, atol=1e-11)
    when, angle, window = ramp.window(turns, "hann", points=400)
    seen = solution.sol(when.ravel())[:2].reshape(2, *when.shape)
    return np.stack(
        [
            (2 if order else 1) * np.einsum("p,krp,rp->rk", window, seen, np.exp(-1j * order * angle))
            for order in orders
        ],
        axis=-1,
    )
