"""The derivatives of a march under force laws: the same steps, linear about the motion found, for many columns at once.

At every turn du = dknown + A dF with dF = F' du + dF', where F' du is what the force makes of the place's changed
motion and dF' what a changed law makes of it unchanged: a few equations, solved once for all columns (the theorem of
implicit functions). The force depends on the phase of the motion, so columns are by real unknowns.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.sims.rotor.law_march import comply, interpolation, press_ahead
from rotorrig.sims.rotor.march import add_matrix, invert

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


@njit(cache=True)
def tangent(
    L: Complex,
    steps: Complex,
    turned: Complex,
    push: Complex,
    seen: Complex,
    flexibility: Complex,
    mean: Reals,
    above: Complex,
    u: Reals,
    F: Reals,
    slopes: Reals,
    force: Complex,
    force_mid: Complex,
    du: Reals,
    dF: Reals,
) -> tuple[Complex, Complex]:
    """Return the derivatives of a and a', (turn, mode, column); fill in those of u and F, (turn, part, column).

    The first arguments are those of law_march.march, and what it returned; `slopes` (turn, part, part) are F'.
    `force` (turn, mode, column) and `force_mid` push the modes as long as F stays; given are `du` as long as modes and
    forces stay, and `dF` as long as u does.
    """
    turns, modes, columns = force.shape
    places = push.shape[2]
    a, rate = np.zeros(force.shape, dtype=np.complex128), force.copy()
    forces = np.zeros((3, places, columns), dtype=np.complex128)  # at the turn, and at the two before it
    free, moved = np.zeros((modes, columns), dtype=np.complex128), np.zeros((modes, places), dtype=np.complex128)
    A = np.empty((1 + above.shape[1], places, places), dtype=np.complex128)
    at_rest, work = np.empty((2, modes, modes), dtype=np.complex128)
    invert(L[0], at_rest, work)
    add_matrix(at_rest, force[0], -1.0, free)
    add_matrix(at_rest, push[0], -1.0, moved)
    for k in range(turns):
        comply(flexibility[k], seen[k], moved, A[0])
        A[1:] = above[k]
        _see(seen[k], free, du[k])
        _settle(A, mean, slopes[k], du[k], dF[k])
        _shift(forces, dF[k])
        a[k] = free
        add_matrix(moved, forces[0], 1.0, a[k])
        add_matrix(push[k], forces[0], 1.0, rate[k])  # so far all that pushes
        if k + 1 < turns:
            weights = interpolation(k, A[0], F, u)
            _push_halfway(push[k], push[k + 1], weights, forces, force_mid[k])
            middle, end = turned[k]
            free[:] = 0
            add_matrix(steps[k, 0], a[k], end.conjugate(), free)
            add_matrix(steps[k, 1], rate[k], end.conjugate(), free)
            add_matrix(steps[k, 2], force_mid[k], end.conjugate() * middle, free)
            add_matrix(steps[k, 3], force[k + 1], 1.0, free)
            press_ahead(steps[k], turned[k], push[k], push[k + 1], weights[0], moved)
        add_matrix(L[k], a[k], 1.0, rate[k])
    return a, rate


@njit(cache=True)
def _see(seen: Complex, a: Complex, du: Reals) -> None:
    """Add what the places see of the modes to `du`."""
    places, modes = seen.shape
    for i in range(places):
        for mode in range(modes):
            by = seen[i, mode]
            for c in range(a.shape[1]):
                Q = by * a[mode, c]
                du[places + i, c] += Q.real
                du[2 * places + i, c] += Q.imag


@njit(cache=True)
def _settle(A: Complex, mean: Reals, slope: Reals, du: Reals, dF: Reals) -> None:
    """Solve du = dknown + A dF, dF = F' du + dF' in place, of dknown and dF'."""
    harmonics, places = A.shape[:2]
    size = len(du)
    whole, equations = np.zeros((2, size, size))  # A for means, real and imaginary parts; 1 - A F'
    for i in range(places):
        for j in range(places):
            whole[i, j] = mean[i, j]
            for h in range(harmonics):
                re, im, by = (2 * h + 1) * places, (2 * h + 2) * places, A[h, i, j]
                whole[re + i, re + j] = whole[im + i, im + j] = by.real
                whole[re + i, im + j], whole[im + i, re + j] = -by.imag, by.imag
    for i in range(size):
        for j in range(size):
            equations[i, j] = 1.0 if i == j else 0.0
            for m in range(size):
                equations[i, j] -= whole[i, m] * slope[m, j]
    inverse, work = np.empty((2, size, size))
    invert(equations, inverse, work)
    _add_real(whole, dF, du)
    known = du.copy()
    du[:] = 0
    _add_real(inverse, known, du)
    _add_real(slope, du, dF)


@njit(cache=True)
def _add_real(A: Reals, x: Reals, y: Reals) -> None:
    """Add A x to y, x and y (row, column)."""
    for i in range(len(A)):
        for j in range(len(x)):
            entry = A[i, j]
            if entry != 0.0:
                for c in range(x.shape[1]):
                    y[i, c] += entry * x[j, c]


@njit(cache=True)
def _shift(forces: Complex, dF: Reals) -> None:
    """Let the forces (3, place, column) be those at the next turn, with the first harmonic of `dF`."""
    places = forces.shape[1]
    for i in range(places):
        for c in range(forces.shape[2]):
            forces[2, i, c], forces[1, i, c] = forces[1, i, c], forces[0, i, c]
            forces[0, i, c] = complex(dF[places + i, c], dF[2 * places + i, c])


@njit(cache=True)
def _push_halfway(
    push: Complex, later: Complex, weights: tuple[float, float, float, float], forces: Complex, force_mid: Complex
) -> None:
    """Add what the forces known so far do halfway to `force_mid` (mode, column), as the march does."""
    for mode in range(len(push)):
        for i in range(push.shape[1]):
            by = (push[mode, i] + later[mode, i]) / 2
            for c in range(force_mid.shape[1]):
                now, last, before = forces[0, i, c], forces[1, i, c], forces[2, i, c]
                force_mid[mode, c] += by * (weights[1] * now + weights[2] * last + weights[3] * before)
