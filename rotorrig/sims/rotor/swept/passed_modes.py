"""The few modes a moving speed passes near, as polynomials in the speed.

With q = Re(A e^{j theta}) and y the state (A, its velocity), y' = (S(Omega) - j Omega) y + b law,
where S is the state matrix; for order n of the shaft's rotation, theta is n times its angle and Omega n times its
speed, here and throughout. The law of an unbalance is Omega^2 - j alpha, of a constant force 1. The invariant parts of
S are treated apart:

- passed modes, whose poles lie near j Omega: y = Phi(Omega) a with
  a' = (L - j Omega - alpha T) a + g law, stepped from turn to turn (time_stepping.py);
- the others, which follow at once: an error of about 2 alpha / (Omega d) of their part for a pole at distance d.

Phi spans the passed modes together and is held to a fixed gauge, so that nothing jumps where two of them, x and y of
one bending shape, cross or coincide. Everything is smooth in Omega: a polynomial through a few speeds.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig import ConfigError
from rotorrig.sims.rotor.model import RotorModel, hysteretic, matrices, speed_stiffness
from rotorrig.sims.rotor.swept.timeline import MOST_POWERS, SpeedRange

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

FEW, MOST_PASSED = 8, 12  # poles: the second only where the first would part what is close together
FAR = 0.3  # of the top speed: a pole at least so far from every j Omega may be left to follow at once
APART = 1.5  # of distances: what is nearer may change places over the speed. Parted at 1.03: off by 6.7 peaks
ACCURACY = 1e-5  # of the polynomials in Omega, as a part of the others' response
FEWEST = 5  # speeds the polynomials go through; odd, as is the most, so that the centre is one of them


@dataclass(frozen=True, slots=True, kw_only=True)
class PassedModes:
    """Passed modes and the others' response, as polynomials in x = (Omega - centre) / half.

    Each begins with an axis of powers, the lowest first; its derivatives have one of directions after that.
    """

    L: Complex  # (power, mode, mode) 1/s
    T: Complex  # (power, mode, mode) s
    g: Complex  # (power, mode, load)
    shape: Complex  # (power, mode, probe)
    others: Complex  # (power, probe, load) m per unit of load


@dataclass(frozen=True, slots=True, kw_only=True)
class Spectra:
    """Eigenvalues and eigenvectors of S at the speeds the polynomials go through, the passed ones first."""

    probes: Reals  # (probe, dof)
    M: Reals  # (dof, dof)
    order: float
    omega: Reals  # (speed,) rad/s, of the vibration: `order` times the shaft's
    passed: int
    values: Complex  # (speed, pole) rad/s
    vectors: Complex  # (speed, 2 dof, pole)
    dual: Complex  # (speed, pole, 2 dof): dual vectors = 1
    gauge: Complex  # (mode, 2 dof): gauge Phi = 1 at every speed
    fit: NDArray[np.floating]  # (power, speed): values at the speeds to coefficients
    slope: NDArray[np.floating]  # (speed, speed): values at the speeds to d/dOmega there

    def fit_powers(self, values: NDArray) -> Complex:
        """Return coefficients, (power, ..., i, j), of polynomials through values at the speeds, (..., speed, i, j)."""
        return np.tensordot(self.fit, values, (1, values.ndim - 3))

    def by_speed(self, values: Complex) -> Complex:
        """Return d/dOmega of such polynomials at the speeds, (..., speed, i, j)."""
        flat = values.reshape(*values.shape[:-2], values.shape[-2] * values.shape[-1])
        return (self.slope @ flat).reshape(values.shape)

    @property
    def by_force(self) -> Complex:
        """Modal participation of a force, D (0, M^-1), (speed, pole, dof)."""
        return self.dual[..., len(self.M) :] @ np.linalg.inv(self.M)

    @property
    def basis(self) -> Complex:
        """Phi, (speed, 2 dof, mode)."""
        return self.vectors[..., : self.passed] @ np.linalg.inv(self.weights)

    @property
    def weights(self) -> Complex:
        """W of Phi W = the passed eigenvectors, (speed, mode, mode)."""
        return self.gauge @ self.vectors[..., : self.passed]

    @property
    def basis_slope(self) -> Complex:
        """The derivative dPhi/dOmega, (speed, 2 dof, mode)."""
        return self.by_speed(self.basis)

    @property
    def lag(self) -> Complex:
        """1 / (j Omega - lambda) of the others, (speed, pole)."""
        return 1 / (1j * self.omega[:, None] - self.values[:, self.passed :])


def solve_spectra(model: RotorModel, speeds: SpeedRange, *, order: float = 1.0) -> Spectra:
    """Solve for the spectra at a few speeds of the range. Raises ConfigError on a bearing that depends on speed.

    The speeds are those of the vibration's phase, `order` times the shaft's.
    """
    for bearing in model.bearings:
        if not bearing.constant:
            raise ConfigError(
                f"bearing '{bearing.name}': its coefficients depend on speed, want constants while the speed moves"
            )
    state = _state_powers(model, order)
    middle, distance = _poles(_at(state, speeds.centre), speeds)
    passed = _count_passed(distance, far=FAR * speeds.fastest)
    x = _points(middle[0][passed:] / 1j, speeds)
    omega = speeds.centre + speeds.half * x
    poles = [middle if at == speeds.centre else _poles(_at(state, at), speeds)[0] for at in omega]
    values, vectors = (np.array(part) for part in zip(*poles, strict=True))
    power = np.vander(x, increasing=True)
    even = np.repeat([1.0, 1 / speeds.fastest], model.dof)[:, None]  # velocities as large as positions: L is no larger
    fit = np.linalg.inv(power)
    return Spectra(
        probes=model.probes,
        M=matrices(model).M,
        order=order,
        omega=omega,
        passed=passed,
        values=values,
        vectors=vectors,
        dual=np.linalg.inv(vectors),
        gauge=(even * np.linalg.qr(even * middle[1][:, :passed])[0]).conj().T,
        fit=fit,
        slope=(power[:, :-1] * np.arange(1, len(x)) / speeds.half) @ fit[1:],
    )


def fit_passed_modes(spectra: Spectra, loads: Complex) -> PassedModes:
    """Fit polynomials to the passed modes and to the others' response to loads per unit of their law, (dof, load)."""
    m, dof = spectra.passed, len(spectra.M)
    W, Phi = spectra.weights, spectra.basis
    left = W @ spectra.dual[:, :m]
    by_load = spectra.by_force @ loads  # (speed, pole, load)
    others = spectra.vectors[:, :dof, m:] @ (spectra.lag[..., None] * by_load[:, m:])
    return PassedModes(
        L=spectra.fit_powers((W * spectra.values[:, None, :m]) @ np.linalg.inv(W)),
        T=spectra.fit_powers(left @ spectra.basis_slope),
        g=spectra.fit_powers(W @ by_load[:, :m]),
        shape=spectra.fit_powers(Phi[:, :dof].swapaxes(1, 2) @ spectra.probes.T),
        others=spectra.fit_powers(spectra.probes @ others),
    )


def _state_powers(model: RotorModel, order: float) -> NDArray:
    """Return S as a polynomial in the speed of the vibration, (power, 2 dof, 2 dof), powers 0 to 2."""
    M, C, G, K = matrices(model)
    H, S = speed_stiffness(model)
    D = hysteretic(model)
    if D.any():  # A e^{j theta} turns forwards, so K + j D is its stiffness at every speed
        K = K + 1j * D
    zero = np.zeros_like(M)
    lower = -np.linalg.solve(
        M, np.array([np.hstack([K, C]), np.hstack([H, G]) / order, np.hstack([S, zero]) / order**2])
    )
    upper = np.zeros_like(lower)
    upper[0] = np.hstack([zero, np.eye(len(M))])
    return np.concatenate([upper, lower], axis=1)


def _at(powers: NDArray, omega: float) -> NDArray:
    return powers[0] + omega * powers[1] + omega**2 * powers[2]


def _poles(S: NDArray, speeds: SpeedRange) -> tuple[tuple[Complex, Complex], Reals]:
    """Return the eigenvalues and eigenvectors of S, nearest the passed speeds first, and how far they are [rad/s]."""
    values, vectors = np.linalg.eig(S)
    distance = np.abs(values - 1j * np.clip(values.imag, *speeds))
    nearest = np.argsort(distance)
    return (values[nearest].astype(complex), vectors[:, nearest].astype(complex)), distance[nearest]


def _count_passed(distance: Reals, *, far: float) -> int:
    """Return how many poles count as passed: those before the widest gap that leaves only far ones.

    It is sought among the first `FEW`, and up to `MOST_PASSED` only if none of those is clear: a pedestal under a
    rigid-body mode has 8 poles before one gap and 12 before a wider one, the same response within 2e-6 of its peak in
    2.5 times the time.
    """
    most = min(MOST_PASSED, len(distance) - 1)
    enough = distance[1 : most + 1] >= far
    gap = np.where(enough, distance[1 : most + 1] / distance[:most], 0.0)
    sought = gap[:FEW] if (gap[:FEW] >= APART).any() else gap
    return int(np.argmax(sought)) + 1 if enough.any() else most


def _points(others: Complex, speeds: SpeedRange) -> Reals:
    """Return Chebyshev points in [-1, 1], enough for a function with poles at Omega = `others`.

    The error falls as rho^-n, rho the size of the ellipse through the nearest pole (Trefethen, Approximation Theory
    and Approximation Practice, 2013, ch. 8).
    """
    x = (others - speeds.centre) / speeds.half
    root = np.sqrt(x**2 - 1)
    rho = float(np.maximum(abs(x + root), abs(x - root)).min())
    wanted = math.log(1 / ACCURACY) / math.log(rho)
    count = min(max(math.ceil(wanted), FEWEST), MOST_POWERS)
    count += 1 - count % 2
    return np.sin(np.pi * (np.arange(count) - count // 2) / count)  # exactly 0 in the middle
