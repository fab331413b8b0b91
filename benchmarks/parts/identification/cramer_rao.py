"""The Cramer-Rao bound: the standard deviations that no unbiased estimate from given data can be below.

What is passed around is a root of the Fisher information: the Jacobian J of independent figures in their own standard
deviations, the information being J^T J. For 1X vectors that is `Problem.jacobian`, priors included as rows of their
own; here are the roots for amplitudes. A bound on the logarithm of a parameter is one on its relative error. It is
linear in the noise: where it comes to half a parameter or more, it says no more than that.
"""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.least_squares import inverse_information
from rotorrig.identify.measurement import Measurement

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


def bounds(root: Real) -> Real:
    """Return the bounds on the parameters, (parameter,), all others free, of a root (figure, parameter)."""
    return np.sqrt(np.diag(inverse_information(root)))


def relative_root(by_log: Real, *, share: float) -> Real:
    """Return the root for values that are each off by a factor 1 + `share` N(0, 1), from d ln value / d parameter.

    Kay, Fundamentals of Statistical Signal Processing: Estimation Theory (1993), eq. (3.31): the mean tells of a
    parameter, and so does the variance, as it goes with the mean.

    >>> bounds(relative_root(np.ones((100, 1)), share=0.1)).round(5).tolist()  # 0.1 / sqrt(100 * (1 + 2 * 0.1^2))
    [0.0099]
    """
    return by_log * np.sqrt(1 / share**2 + 2)


def amplitude_root(root: Real, measured: Measurement, z: Complex, *, used: NDArray[np.bool_]) -> Real:
    """Return the root (figure, parameter) for the amplitudes of vectors less their slow roll, where `used`.

    `root` is that of the vectors of `measured`, prior rows after them if any: these stay. `z` (row + 1, probe) m are
    the vectors without noise, the slow roll last, `used` is (row, probe). The slow roll's noise is in all amplitudes
    of a probe alike; without a slow roll none is subtracted. To first order: amplitudes within a few standard
    deviations of zero are to be left out.
    """
    figures = 2 * measured.usable.size
    reading = _readings(measured, z, used)
    orthonormal, _ = np.linalg.qr(reading.T)
    return np.concatenate([orthonormal.T @ root[:figures], root[figures:]])


def _readings(measured: Measurement, z: Complex, used: NDArray[np.bool_]) -> Real:
    """Return how amplitudes change with whitened figures, (amplitude, row + 1 x 2 probe)."""
    rows, probes = used.shape
    there = measured.usable[-1]
    vector = z[:-1] - np.where(there, z[-1], 0)
    along = vector / np.abs(vector)
    colour = np.linalg.inv(measured.whiten).reshape(rows + 1, probes, 2, -1)  # figures of a row by whitened ones
    radial = np.stack([along.real, along.imag], axis=-1)
    row, probe = np.nonzero(used)
    reading = np.zeros((len(row), rows + 1, 2 * probes))
    index = np.arange(len(row))
    reading[index, row] = np.einsum("ai,aif->af", radial[row, probe], colour[row, probe])
    slow = np.einsum("ai,aif->af", radial[row, probe], colour[-1, probe])
    reading[:, -1] = -np.where(there[probe], 1.0, 0.0)[:, None] * slow
    return reading.reshape(len(row), -1)
