"""What of a correction the data determine: condition number, the well-known and the ill-determined combination.

Two planes whose masses move all probes alike, but for a factor, can only be corrected together: what one adds the
other may take away unseen. The combination that hardly moves the probes is the last right-singular vector of H.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.balancing.correction import Correction, region_radius
from rotorrig.balancing.influence import Influence

Complex = NDArray[np.complex128]

ILL_CONDITIONED = 10.0  # condition number above which planes are nearly alike: the classical warning of balancing


@dataclass(frozen=True, slots=True, kw_only=True)
class Combination:
    """Masses on all planes in one proportion, and how much of it the correction has."""

    weights: Complex  # (plane,) of unit length; that of the largest is real
    amount: complex  # kg m, along it
    sigma: float  # kg m, one standard deviation along the worse of its two parts
    effect: float  # m / (kg m), root of the sum of squares over the entries


@dataclass(frozen=True, slots=True, kw_only=True)
class Determinacy:
    """How well planes are told apart."""

    condition: float  # of the influence coefficients: the largest effect of a unit combination over the least
    best: Combination
    worst: Combination
    alike: bool  # the planes move the probes nearly alike: the condition number is beyond ILL_CONDITIONED
    needed: bool  # the worst combination is a part of the correction beyond doubt: its 95 % region leaves out zero


def judge_determinacy(influence: Influence, correction: Correction) -> Determinacy:
    """Judge a least-squares correction by the singular values of its influence coefficients."""
    _, effects, right = np.linalg.svd(influence.H, full_matrices=False)
    best, worst = (_combine(right[i].conj(), float(effects[i]), correction) for i in (0, -1))
    condition = float(effects[0] / effects[-1]) if effects[-1] > 0 else math.inf
    return Determinacy(
        condition=condition,
        best=best,
        worst=worst,
        alike=condition > ILL_CONDITIONED,
        needed=abs(worst.amount) > region_radius(correction.dof) * worst.sigma,
    )


def leave_out(correction: Correction, combination: Combination) -> Correction:
    """Return a correction without its part along a combination."""
    v = combination.weights
    keep = np.eye(len(v)) - np.outer(v, v.conj())
    real = np.kron(keep.real, np.eye(2)) + np.kron(keep.imag, np.array([[0.0, -1.0], [1.0, 0.0]]))
    return Correction(
        by=correction.by,
        planes=correction.planes,
        W=keep @ correction.W,
        covariance=real @ correction.covariance @ real.T,
        dof=correction.dof,
    )


def _combine(v: Complex, effect: float, correction: Correction) -> Combination:
    largest = v[np.argmax(np.abs(v))]
    v = v * np.conj(largest) / abs(largest)
    row = np.stack([v.conj().real, -v.conj().imag], axis=1).ravel()  # re of v^H W over (re, im) pairs
    turned = np.stack([v.conj().imag, v.conj().real], axis=1).ravel()
    part = np.array([row, turned]) @ correction.covariance @ np.array([row, turned]).T
    return Combination(
        weights=v,
        amount=complex(v.conj() @ correction.W),
        sigma=math.sqrt(max(float(np.linalg.eigvalsh(part)[-1]), 0.0)),
        effect=effect,
    )
