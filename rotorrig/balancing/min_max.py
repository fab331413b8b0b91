"""The correction by min-max: what to add so that the largest amplitude of all entries is least.

A second-order cone problem, min t with |z + H W| <= t, solved to a known gap by linear programmes (scipy's HiGHS) with
tangents to the cones (Kelley, SIAM Journal 8 (1960) 703): each programme is a lower bound, its solution an upper one.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]

GAP = 1e-4  # relative, between the bounds: no probe knows an amplitude better
MOST_ROUNDS = 60
CUTS = 12  # tangents added per round, at the entries that are furthest out


def min_max_correction(z: Complex, H: Complex, start: Complex) -> Complex:
    """Return W (plane,) for which the largest |z + H W| is least, from a `start` that is not too far off.

    >>> z, H = np.array([1.0 + 0j, 3.0]), np.array([[1.0 + 0j], [1.0]])
    >>> W = min_max_correction(z, H, np.array([0j]))  # between them: -2, which leaves 1 of either
    >>> bool(np.abs(z + H @ W).max() < 1 + 2 * GAP)
    True
    """
    size = float(np.abs(z).max())
    unit = size / max(float(np.abs(H).max()), 1e-300)
    best, least, lower = start, float(np.abs(z + H @ start).max()), 0.0
    cuts: list[tuple[int, complex]] = []
    trial = start
    for _ in range(MOST_ROUNDS):
        residual = z + H @ trial
        largest = float(np.abs(residual).max())
        if largest < least:
            best, least = trial, largest
        if least - lower <= GAP * least or least <= 1e-12 * size:
            break
        worst = np.argsort(np.abs(residual))[-CUTS:]
        cuts += [(int(m), complex(np.exp(-1j * np.angle(residual[m])))) for m in worst]
        trial, lower = _solve_programme(z / size, H * unit / size, cuts, reach=10 * (1 + np.abs(start).max() / unit))
        trial, lower = trial * unit, lower * size
    return best


def _solve_programme(z: Complex, H: Complex, cuts: list[tuple[int, complex]], *, reach: float) -> tuple[Complex, float]:
    """Minimise t with Re(c (z + H W)) <= t for each cut, W within `reach`."""
    which = np.array([m for m, _ in cuts])
    turn = np.array([c for _, c in cuts])
    rows = turn[:, None] * H[which]
    A = np.concatenate([rows.real, -rows.imag, -np.ones((len(cuts), 1))], axis=1)
    planes = H.shape[1]
    bounds = [(-reach, reach)] * (2 * planes) + [(0, None)]
    solved = linprog(np.append(np.zeros(2 * planes), 1.0), A_ub=A, b_ub=-(turn * z[which]).real, bounds=bounds)
    x: Reals = np.asarray(solved.x, dtype=float)
    return np.asarray(x[:planes] + 1j * x[planes:-1]), float(x[-1])
