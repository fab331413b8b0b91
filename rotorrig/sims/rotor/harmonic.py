"""Steady response to unbalance (chapter, section 5.5, eq. 9 to 11), as phasors.

q = Re(Q e^{j n theta}); eq. (11) in its real form is the same with Q = q_C - j q_S (as printed there, the signs of
Omega C are swapped: it gives the response of the backward whirl).
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.sims.rotor.assembly import RotorModel, matrices
from rotorrig.sims.rotor.disk import unbalance_direction

SPEEDS_AT_ONCE = 64  # bounds the memory of a batch: 16 MB at 124 DOF


def steady_response(
    model: RotorModel,
    omega: ArrayLike,
    *,
    unbalance: Mapping[str, complex],
    order: float = 1.0,
    alpha: ArrayLike = 0.0,
) -> NDArray[np.complex128]:
    """Return the steady amplitudes Q at the speeds `omega` [rad/s], (speed, dof): m and rad, 0-peak.

    `unbalance` is disk -> U e^{j phi} [kg m], phi from the keyphasor mark in the sense of rotation. `order`: the
    masses turn that many times per revolution. `alpha` [rad/s^2] adds the tangential force of a changing speed, but
    not the response's lag: sweep.py. Raises ValueError on a disk the model does not have.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    force = unbalance_force(model, omega, unbalance=unbalance, order=order, alpha=alpha)
    response = np.empty_like(force)
    for first in range(0, len(omega), SPEEDS_AT_ONCE):
        some = slice(first, first + SPEEDS_AT_ONCE)
        Z = dynamic_stiffness(model, omega[some], order=order)
        response[some] = np.linalg.solve(Z, force[some, :, None])[..., 0]
    return response


def probe_response(
    model: RotorModel,
    omega: ArrayLike,
    *,
    unbalance: Mapping[str, complex],
    order: float = 1.0,
    alpha: ArrayLike = 0.0,
) -> NDArray[np.complex128]:
    """Return what the probes see of `steady_response`, (speed, probe): m, 0-peak, z as in x = Re(z e^{j n theta})."""
    return steady_response(model, omega, unbalance=unbalance, order=order, alpha=alpha) @ model.probes.T


def dynamic_stiffness(model: RotorModel, omega: ArrayLike, *, order: float = 1.0) -> NDArray[np.complex128]:
    """Return Z = K - n^2 Omega^2 M + j n Omega (C + Omega G) for order n, (speed, dof, dof) N/m."""
    M, C, G, K = matrices(model)
    O = np.atleast_1d(np.asarray(omega, dtype=float))[:, None, None]  # noqa: E741
    return K - (order * O) ** 2 * M + 1j * order * O * (C + O * G)


def unbalance_force(
    model: RotorModel,
    omega: ArrayLike,
    *,
    unbalance: Mapping[str, complex],
    order: float = 1.0,
    alpha: ArrayLike = 0.0,
) -> NDArray[np.complex128]:
    """Return the force phasors, (speed, dof) N: (n^2 Omega^2 - j n alpha) U e^{j phi} (1, -j) at each disk."""
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    per_unit = (order * omega) ** 2 - 1j * order * np.asarray(alpha)
    return per_unit[:, None] * unbalance_pattern(model, unbalance)


def unbalance_pattern(model: RotorModel, unbalance: Mapping[str, complex]) -> NDArray[np.complex128]:
    """Return U e^{j phi} (1, -j) summed over the disks, (dof,) kg m: the force phasor per Omega^2."""
    pattern = np.zeros(model.dof, dtype=complex)
    for name, amount in unbalance.items():
        pattern += amount * unbalance_direction(model.disk(name), model.rotation)
    return pattern
