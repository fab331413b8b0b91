"""Derivatives of the passed modes and of the others' response along directions of the matrices, speed by speed.

With D S V = diag(lambda), D = V^-1, and N = D dS V, perturbation of first order turns the passed vectors V1 into
V1 + V2 E and their duals D1 into D1 + F D2, where only differences between a passed pole and another are divided by:
E = N21 / (lambda_1 - lambda_2), F = N12 / (lambda_1 - lambda_2). Poles of one kind may coincide. (Kato, Perturbation
Theory for Linear Operators, 1995, ch. II; Daleckii, Krein 1965 for functions of S.)
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.rotor.model import Direction, probe_changes
from rotorrig.sims.rotor.swept.passed_modes import Complex, PassedModes, Spectra


class _Changes(NamedTuple):
    """N = D dS V where it is wanted, and D db: (direction, speed, ...)."""

    N1: Complex  # (.., pole, mode) by the passed vectors
    N12: Complex  # (.., mode, other) of the others by the passed duals
    others: Complex  # (.., other, load) D dS y, y the others' response
    load: Complex  # (.., pole, load) D db


def differentiate_passed_modes(spectra: Spectra, loads: Complex, directions: Sequence[Direction]) -> PassedModes:
    """Differentiate `fit_passed_modes(spectra, loads)`, with an axis of directions after that of powers."""
    m, dof = spectra.passed, len(spectra.M)
    V1, V2, D1, D2 = spectra.vectors[..., :m], spectra.vectors[..., m:], spectra.dual[:, :m], spectra.dual[:, m:]
    W, Phi, lag, by_load = spectra.weights, spectra.basis, spectra.lag[..., None], spectra.by_force @ loads
    back = np.linalg.inv(W)
    others = lag * by_load[:, m:]  # in their vectors
    N = _project_changes(spectra, directions, loads, others)

    gap = spectra.values[:, :m, None] - spectra.values[:, None, m:]  # (speed, mode, other)
    E, F = N.N1[..., m:, :] / gap.swapaxes(1, 2), N.N12 / gap
    moved = V2 @ E
    dW = spectra.gauge @ moved
    dPhi = (moved - Phi @ dW) @ back
    turned, L = dW @ back, (W * spectra.values[:, None, :m]) @ back
    dL = W @ N.N1[..., :m, :] @ back + turned @ L - L @ turned
    dT = dW @ (D1 @ spectra.basis_slope) + W @ (F @ (D2 @ spectra.basis_slope)) + W @ D1 @ spectra.by_speed(dPhi)
    dg = dW @ by_load[:, :m] + W @ (F @ by_load[:, m:] + N.load[..., :m, :])
    d_others = V2[:, :dof] @ (lag * (N.others + N.load[..., m:, :] - E @ by_load[:, :m])) - V1[:, :dof] @ (F @ others)
    d_probes = probe_changes(directions, len(spectra.probes), dof)[:, None]
    d_shape = spectra.probes @ dPhi[..., :dof, :] + d_probes @ Phi[:, :dof]
    return PassedModes(
        L=spectra.fit_powers(dL),
        T=spectra.fit_powers(dT),
        g=spectra.fit_powers(dg),
        shape=spectra.fit_powers(d_shape.swapaxes(-1, -2)),
        others=spectra.fit_powers(spectra.probes @ d_others + d_probes @ (spectra.vectors[:, :dof, m:] @ others)),
    )


def _project_changes(spectra: Spectra, directions: Sequence[Direction], loads: Complex, others: Complex) -> _Changes:
    """Return what the directions change; `others` (speed, other, load) is the others' response in their vectors.

    Of S, whose change is -M^-1 (dK, dC + Omega dG) - M^-1 dM M^-1 (-K, -C - Omega G), on positions, velocities and
    accelerations.
    """
    m, dof = spectra.passed, len(spectra.M)
    V, values = spectra.vectors, spectra.values[:, None]
    motion = np.concatenate([V, values * V[:, dof:]], axis=1)  # (speed, 3 dof, pole): position, velocity, acceleration
    dM, dC, dG, dK, dH, dS = (_stack([d[i] for d in directions], dof) for i in range(6))
    shaft = spectra.omega[:, None, None] / spectra.order  # rad/s
    by_motion = np.concatenate(  # (direction, speed, dof, 3 dof)
        np.broadcast_arrays(dK + shaft * dH + shaft**2 * dS, dC + shaft * dG, dM), axis=-1
    )
    seen = np.concatenate([motion[..., :m], motion[..., m:] @ others], axis=-1)
    change = -spectra.by_force @ (by_motion @ seen)  # (direction, speed, pole, mode and load)
    return _Changes(
        N1=change[..., :m],
        N12=-(spectra.by_force[:, :m] @ by_motion) @ motion[..., m:],
        others=change[..., m:, m:],
        load=-spectra.by_force @ (dM @ np.linalg.solve(spectra.M, loads)),
    )


def _stack(changes: Sequence[NDArray | float], dof: int) -> NDArray:
    """Return one matrix of every direction, (direction, 1, dof, dof), or zero for all where none has any."""
    if changes and not any(map(np.ndim, changes)):
        return np.zeros((1, 1, 1, 1))
    return np.array([np.broadcast_to(change, (dof, dof)) for change in changes]).reshape(-1, 1, dof, dof)
