"""Tangent of the time stepping under force laws: the same steps, linear about the solved motion, many columns at once.

At every turn du = dknown + A dF with dF = F' du + dF', where F' du is the change of the force with the place's
motion and dF' its change with the law alone: a few equations, solved once for all columns (the theorem of
implicit functions). The modes are driven by the first harmonic of the force
alone, so only that is computed of

    dF = dF' + G (dknown + A dF'),  G = F' (1 - A F')^-1.

 The force depends on the phase of the motion, so columns are by real unknowns.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.sims.rotor.nonlinear.law_stepping import halfway_weights, put_compliance, put_unit_response
from rotorrig.sims.rotor.swept import add_matrix, invert

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.intp]


@njit(cache=True)
def step_tangent(
    L: Complex,
    steps: Complex,
    phases: Complex,
    participation: Complex,
    shapes: Complex,
    flexibility: Complex,
    mean: Reals,
    overtones: Complex,
    u: Reals,
    F: Reals,
    slopes: Reals,
    force: Complex,
    force_mid: Complex,
    known: Reals,
    law_force: Reals,
    law_columns: Index,
) -> tuple[Complex, Complex, Complex, Complex]:
    """Return the derivatives of a and a', (turn, mode, column), of the force's first harmonic, (turn, place, column).

    The last is A of that harmonic, (turn, place, place). The first arguments are those of step_with_laws, and what it
    returned; `slopes` (turn, part, part) are F'. `force` (turn, mode, column) and `force_mid` act on the modes as
    long as F stays. `known` (turn, 3 place, column), the change of mean and first harmonic as long as modes and forces
    stay, is filled up to dknown. `law_force` (turn, part, law column) is dF' of the columns `law_columns`; the others
    have none.
    """
    turns, modes, columns = force.shape
    places = participation.shape[2]
    a, rate = np.zeros(force.shape, dtype=np.complex128), force.copy()
    dF = np.zeros((turns, places, columns), dtype=np.complex128)
    free, unit_response = (
        np.zeros((modes, columns), dtype=np.complex128),
        np.zeros((modes, places), dtype=np.complex128),
    )
    compliance = np.empty(flexibility.shape, dtype=np.complex128)
    A = np.empty((1 + overtones.shape[1], places, places), dtype=np.complex128)
    at_rest, work = np.empty((2, modes, modes), dtype=np.complex128)
    invert(L[0], at_rest, work)
    add_matrix(at_rest, force[0], -1.0, free)
    add_matrix(at_rest, participation[0], -1.0, unit_response)
    for k in range(turns):
        put_compliance(flexibility[k], shapes[k], unit_response, A[0])
        A[1:] = overtones[k]
        compliance[k] = A[0]
        _add_mode_motion(shapes[k], free, known[k])
        _put_force_change(_force_sensitivity(A, mean, slopes[k]), A, mean, known[k], law_force[k], law_columns, dF[k])
        a[k] = free
        add_matrix(unit_response, dF[k], 1.0, a[k])
        add_matrix(participation[k], dF[k], 1.0, rate[k])  # so far the forces alone
        if k + 1 < turns:
            weights = halfway_weights(k, A[0], F, u)
            _add_halfway_forces(
                participation[k], participation[k + 1], weights, dF[max(k - 2, 0) : k + 1], force_mid[k]
            )
            middle, end = phases[k]
            free[:] = 0
            add_matrix(steps[k, 0], a[k], end.conjugate(), free)
            add_matrix(steps[k, 1], rate[k], end.conjugate(), free)
            add_matrix(steps[k, 2], force_mid[k], end.conjugate() * middle, free)
            add_matrix(steps[k, 3], force[k + 1], 1.0, free)
            put_unit_response(steps[k], phases[k], participation[k], participation[k + 1], weights[0], unit_response)
        add_matrix(L[k], a[k], 1.0, rate[k])
    return a, rate, dF, compliance


@njit(cache=True)
def _add_mode_motion(shapes: Complex, a: Complex, known: Reals) -> None:
    """Add the modes' motion at the places to `known`."""
    places, modes = shapes.shape
    for i in range(places):
        for mode in range(modes):
            by = shapes[i, mode]
            for c in range(a.shape[1]):
                Q = by * a[mode, c]
                known[places + i, c] += Q.real
                known[2 * places + i, c] += Q.imag


@njit(cache=True)
def _put_force_change(
    G: Reals, A: Complex, mean: Reals, known: Reals, law_force: Reals, law_columns: Index, dF: Complex
) -> None:
    """Put the first harmonic of dF' + G (dknown + A dF') into dF (place, column)."""
    places, columns = dF.shape
    for i in range(places):
        for j in range(len(known)):
            by = complex(G[i, j], G[places + i, j])
            for c in range(columns):
                dF[i, c] += by * known[j, c]
    if len(law_columns):
        moved = np.zeros(law_force.shape)
        _add_motion(A, mean, law_force, moved)
        for n in range(len(law_columns)):
            for i in range(places):
                total = complex(law_force[places + i, n], law_force[2 * places + i, n])
                for j in range(len(moved)):
                    total += complex(G[i, j], G[places + i, j]) * moved[j, n]
                dF[i, law_columns[n]] += total


@njit(cache=True)
def _add_motion(A: Complex, mean: Reals, F: Reals, u: Reals) -> None:
    """Add A F to u, both (part, column)."""
    harmonics, places = A.shape[:2]
    for i in range(places):
        for j in range(places):
            for c in range(F.shape[1]):
                u[i, c] += mean[i, j] * F[j, c]
            for h in range(harmonics):
                re, im, by = (2 * h + 1) * places, (2 * h + 2) * places, A[h, i, j]
                for c in range(F.shape[1]):
                    u[re + i, c] += by.real * F[re + j, c] - by.imag * F[im + j, c]
                    u[im + i, c] += by.imag * F[re + j, c] + by.real * F[im + j, c]


@njit(cache=True)
def _force_sensitivity(A: Complex, mean: Reals, slope: Reals) -> Reals:
    """Return the rows of G = F' (1 - A F')^-1 of the first harmonic, (2 place, part), from (1 - A F')^T G^T = F'^T."""
    places, size = len(mean), len(slope)
    moved = np.zeros((size, size))
    _add_motion(A, mean, slope, moved)
    rows = np.empty((size, size + 2 * places))  # the equations, and beyond them their right sides
    for i in range(size):
        for j in range(size):
            rows[i, j] = (1.0 if i == j else 0.0) - moved[j, i]
        for j in range(2 * places):
            rows[i, size + j] = slope[places + j, i]
    _eliminate(rows)
    return rows[:, size:].T.copy()


@njit(cache=True)
def _eliminate(rows: Reals) -> None:
    """Solve equations (row, unknown and right side): Gauss and Jordan, by rows of the largest pivot, in place."""
    size, width = rows.shape
    for i in range(size):
        best = i
        for j in range(i + 1, size):
            if abs(rows[j, i]) > abs(rows[best, i]):
                best = j
        for c in range(i, width):
            rows[i, c], rows[best, c] = rows[best, c], rows[i, c]
        by = 1.0 / rows[i, i]
        for c in range(i, width):
            rows[i, c] *= by
        for j in range(size):
            factor = rows[j, i]
            if j != i and factor != 0.0:
                for c in range(i, width):
                    rows[j, c] -= factor * rows[i, c]


@njit(cache=True)
def _add_halfway_forces(
    participation: Complex,
    later: Complex,
    weights: tuple[float, float, float, float],
    forces: Complex,
    force_mid: Complex,
) -> None:
    """Add the forces of the turns so far to those halfway, `force_mid` (mode, column), as the time stepping does.

    `forces` (3 or less, place, column) are the latest, the last of them that of this turn.
    """
    for mode in range(len(participation)):
        for i in range(participation.shape[1]):
            by = (participation[mode, i] + later[mode, i]) / 2
            for n in range(len(forces)):
                weight = by * weights[len(forces) - n]
                for c in range(force_mid.shape[1]):
                    force_mid[mode, c] += weight * forces[n, i, c]
