"""Equations in which the unknown stands beside its conjugate: linear in real amounts, not in complex ones."""

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]


def solve_with_conjugate(Z: Complex, C: Complex, right: Complex) -> Complex:
    """Return q of Z q + C conj(q) = right: matrices (..., n, n), right and q (..., n, column).

    As 2 n real equations; raises LinAlgError where they have no solution.

    >>> solve_with_conjugate(np.array([[3.0]]), np.array([[1.0]]), np.array([[4.0, 2j]]))  # 3 q + q* = 4, and = 2j
    array([[1.+0.j, 0.+1.j]])
    """
    n = Z.shape[-1]
    upper = np.concatenate([Z.real + C.real, C.imag - Z.imag], axis=-1)
    lower = np.concatenate([Z.imag + C.imag, Z.real - C.real], axis=-1)
    q = np.linalg.solve(np.concatenate([upper, lower], axis=-2), np.concatenate([right.real, right.imag], axis=-2))
    return q[..., :n, :] + 1j * q[..., n:, :]
