"""The model's own error: what a rotor of beams, springs and dashpots leaves out, smooth over speed.

No rig is its model to the last digit: couplings, foundations and temperature move a response by parts of a per cent,
the same in neighbouring rows. Taken for noise that is independent from row to row it would be averaged away, and what
is left be named a cause. So the 1X motion at every probe may be off by a complex factor 1 + e(speed), e normally
distributed with a standard deviation of `prior.model_error` in either part, correlated over speed as a squared
exponential in its logarithm, independent from probe to probe and from recording to recording. Nor does a rig do the
same twice: a cabinet warms, grease moves, a coupling settles. By a share of `prior.repeatability` every run is off once
more. Their covariance is added to the noise's (Kennedy and O'Hagan, Journal of the Royal Statistical Society B 63
(2001) 425).

Above 1X the linear model has nothing of its own, and a rig is never quite linear: a bearing's, a coupling's or a
probe's curve makes harmonics that grow with a power of the motion and turn with its phase (`harmonic_motion`). Their
complex factor is of a standard deviation of `prior.harmonic_error`, and as smooth over speed.

The motion is the model's, not the measured one: errors in proportion to a measured value favour what is measured too
small (Peelle's puzzle; D'Agostini, Nuclear Instruments and Methods A 346 (1994) 306).

Of the rotor's coefficients one is least of all a constant: the damping of a bearing, which grease, rubber and speed
change by tenths (Tiwari, Lees and Friswell, Shock and Vibration Digest 36 (2004) 99, on the scatter of what is
identified). At its resonance a rotor is as far off as its damping, so there the error of its motion is no half a per
cent: every damping sought may be another at a speed by a share of `prior.damping_over_speed`, as smooth over speed. The
constant that is identified is what it is in the mean, as the data weigh it: at the resonance.

Shaft angle is counted from a mark that moves with the shaft: by what the driven end moves past the keyphasor as the
mark passes it, over `prior.mark_radius`, every angle is off, at all probes alike. In which direction the keyphasor
stands no config says.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]

LENGTH = 0.3  # in the logarithm of speed: over a factor 1.35 the error is another, about the width of a bearing's mode
NODES = 2 / 3  # of LENGTH, from one node of its basis to the next: leaves out a thousandth of the variance
DEAD = 1e-9  # of the largest: singular values of the basis that are rounding


def error_vectors(
    motion: Complex, omega: Reals, run: NDArray[np.intp], *, share: float, repeatability: float
) -> Complex:
    """Return vectors (row, probe, column) m whose sum with independent standard normal amounts is the error.

    Of the model's 1X `motion` (row, probe) [m] at `omega` (row,) [rad/s]; `share` is the standard deviation of what all
    runs have in common, `repeatability` that of what every `run` (row,) has for itself.
    """
    numbers, of_row = np.unique(run, return_inverse=True)
    between = np.full((len(numbers), len(numbers)), share**2) + np.eye(len(numbers)) * repeatability**2
    smooth = np.einsum("rn,rc->rnc", _basis(np.log(omega)), _root(between)[of_row]).reshape(len(omega), -1)
    rows, probes = motion.shape
    vectors = np.zeros((rows, probes, probes, smooth.shape[1], 2), complex)
    own = motion[:, :, None] * smooth[:, None, :]
    for probe in range(probes):
        vectors[:, probe, probe] = own[:, probe, :, None] * np.array([1, 1j])
    return vectors.reshape(rows, probes, -1)


def changed_vectors(slopes: Complex, omega: Reals, sigma: Reals, *, share: float) -> Complex:
    """Return vectors (row, probe, column) m whose sum with independent standard normal amounts is the error.

    Of coefficients that change over speed: `slopes` (row, probe, coefficient) m are those of the motion by the relative
    change of each, at `omega` (row,) [rad/s]; `share` is the standard deviation of that change before its mean is
    taken out, every row weighed as the data, of the noise `sigma` (row, probe) [m], weigh it.
    """
    basis = share * _basis(np.log(omega))
    weight = np.einsum("rpc,rp->cr", np.abs(slopes) ** 2, 1 / sigma**2)
    mean = weight @ basis / np.maximum(weight.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    changes = basis[:, None] - mean
    return np.einsum("rpc,rcn->rpcn", slopes, changes).reshape(*slopes.shape[:2], -1)


def mark_vectors(motion: Complex, at_mark: Complex, *, radius: float) -> Complex:
    """Return vectors (row, probe, 2) m whose sum with independent standard normal amounts is the error.

    Of the 1X `motion` (row, probe) [m] told from a mark at `radius` [m] about an axis that moves by `at_mark` (row, 2)
    [m] along x and y: where it is at angle zero.
    """
    return 1j * motion[:, :, None] * at_mark.real[:, None, :] / radius


def harmonic_motion(motion: Complex, order: int) -> Complex:
    """Return motion^n / largest^(n - 1), (row, probe) m: what a curve of the n-th power makes of 1X at n X.

    >>> abs(harmonic_motion(np.array([[1e-6], [2e-6j]]), 2))
    array([[5.e-07],
           [2.e-06]])
    """
    largest = np.abs(motion).max(axis=0, initial=0.0)
    return motion * np.divide(motion, largest, out=np.zeros_like(motion), where=largest > 0) ** (order - 1)


def _root(covariance: Reals) -> Reals:
    """Return columns whose sum with standard normal amounts has a covariance, which may be of any rank."""
    square, directions = np.linalg.eigh(covariance)
    kept = square > DEAD * square[-1]
    return directions[:, kept] * np.sqrt(square[kept])


def _basis(x: Reals) -> Reals:
    """Return functions (row, node) whose sum with standard normal amounts has the covariance, of variance one."""
    step = NODES * LENGTH
    nodes = np.arange(x.min() - step, x.max() + 2 * step, step)
    size, directions = np.linalg.eigh(_correlation(nodes, nodes))
    kept = size > DEAD * size[-1]
    return _correlation(x, nodes) @ (directions[:, kept] / np.sqrt(size[kept]))


def _correlation(x: Reals, y: Reals) -> Reals:
    return np.exp(-((x[:, None] - y) ** 2) / (2 * LENGTH**2))


@dataclass(frozen=True, slots=True)
class Shrinkage:
    """(1 + B B^T)^(-1/2), which makes white of figures whose covariance is that of noise, 1, and of an error B."""

    directions: Reals  # (figure, direction) orthonormal
    by: Reals  # (direction,) what it takes of them

    @classmethod
    def of(cls, error: Reals) -> "Shrinkage":
        """Return that of an error B (figure, column) in standard deviations of the noise."""
        square, turned = np.linalg.eigh(error.T @ error)
        kept = square > DEAD * max(square[-1], 1.0)
        return cls(error @ (turned[:, kept] / np.sqrt(square[kept])), 1 - 1 / np.sqrt(1 + square[kept]))

    def __call__(self, figures: Reals) -> Reals:
        """Return figures (figure, ...) made white."""
        flat = figures.reshape(len(self.directions), -1)
        return (flat - self.directions @ (self.by[:, None] * (self.directions.T @ flat))).reshape(figures.shape)
