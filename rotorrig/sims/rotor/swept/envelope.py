"""Amplitudes of the passed modes from turn to turn, and their derivatives: the equation of passed_modes.py in time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.rotor.swept.excitation import Excitation
from rotorrig.sims.rotor.swept.passed_modes import PassedModes
from rotorrig.sims.rotor.swept.time_stepping import add_operator_change, propagators, step_modes
from rotorrig.sims.rotor.swept.timeline import TURN
from rotorrig.sims.rotor.swept.tracking_windows import TrackedRows

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Columns of a modal motion at every whole turn, and its averages over the rows."""

    a: Complex  # (turn, mode, column)
    rate: Complex  # (turn, mode, column) 1/s
    average: Complex  # (row, power, mode, column), see TrackedRows.averages

    def conjugate(self) -> "Motion":
        """Return the conjugate of it all."""
        return Motion(a=self.a.conj(), rate=self.rate.conj(), average=self.average.conj())


class Envelope:
    """a' = (L - j Omega - alpha T) a + g law on one timeline; the propagators serve all columns."""

    def __init__(self, L: Complex, T: Complex, rows: TrackedRows) -> None:
        """Compute the propagators; `L` and `T` are those of PassedModes."""
        turns = rows.turns
        self._powers, self._rows = len(L), rows
        self._h = np.diff(turns.t)
        self.operator = _fixed_frame_operator(L, T, rows.power, turns.alpha)
        _subtract_rotation(self.operator, turns.omega)
        middle = _fixed_frame_operator(L, T, rows.power_mid, turns.alpha_mid)
        _subtract_rotation(middle, turns.omega_mid)
        self.steps = propagators(middle, self._h)
        # Within a step Omega moves on from omega_mid: that phase, known from the pulses, is put into the force.
        phase = np.stack([turns.theta_mid - turns.omega_mid * self._h / 2, TURN - turns.omega_mid * self._h], axis=1)
        self.phases = np.exp(1j * phase)

    def response(self, g: Complex, loads: Excitation) -> Motion:
        """Return the motion under a unit of each load, steady at the first turn; `g` is that of PassedModes."""
        return self.step(*self.forces(g, loads))

    def derivatives(self, change: PassedModes, motion: Motion, loads: Excitation) -> Motion:
        """Return the derivative of the motion along directions, its columns (direction, load).

        da' = (L - j Omega - alpha T) da + (dL - alpha dT) a + dg law: the same operator, forced by a.
        """
        return self.step(*self.forces_of_change(change, motion, loads))

    def forces_of_change(self, change: PassedModes, motion: Motion, loads: Excitation) -> tuple[Complex, Complex]:
        """Return those forces, (dL - alpha dT) a + dg law, at the turns and halfway, (turn, mode, direction load)."""
        force, force_mid = (  # (.., mode, direction load)
            np.reshape(f, (*f.shape[:2], change.g.shape[1] * change.g.shape[3]))
            for f in self.forces(change.g.swapaxes(1, 2), loads)
        )
        self.add_operator_change(change, motion.a, motion.rate, force, force_mid)
        return force, force_mid

    def add_operator_change(
        self, change: PassedModes, a: Complex, rate: Complex, force: Complex, force_mid: Complex
    ) -> None:
        """Add (dL - alpha dT) a to forces at the turns and halfway, (turn, mode, direction load)."""
        a_mid = (a[:-1] + a[1:]) / 2 + self._h[:, None, None] / 8 * (rate[:-1] - rate[1:])  # by the cubic
        add_operator_change(
            _flat(change.L), _flat(change.T), self._rows.power, self._rows.turns.alpha, a, a_mid, force, force_mid
        )

    def forces(self, g: Complex, loads: Excitation) -> tuple[Complex, Complex]:
        """Return g times the laws at the turns and halfway in time, (turn, mode, ..., load)."""
        return loads.forces(polynomial(self._rows.power, g), polynomial(self._rows.power_mid, g))

    def step(self, force: Complex, force_mid: Complex) -> Motion:
        """Step through a force at the turns and halfway in time, (turn, mode, column), from its steady state."""
        start = np.linalg.solve(self.operator[0], -force[0])
        a, rate = step_modes(self.operator, self.steps, self.phases, force, force_mid, start)
        return Motion(a=a, rate=rate, average=self._rows.averages(a, rate, powers=self._powers))


def polynomial(power: Reals, coefficients: Complex) -> Complex:
    """Return polynomials of `coefficients` (power, ...), (n, ...), where x has these powers, (n, power or more)."""
    flat = _flat(coefficients)  # the powers are real: half the work
    return (power[:, : len(flat)] @ flat).view(complex).reshape(len(power), *coefficients.shape[1:])


def _flat(coefficients: Complex) -> Reals:
    """Return (power, ...) as real (power, n), re and im in turn."""
    return np.ascontiguousarray(coefficients).reshape(len(coefficients), coefficients[0].size).view(float)


def _fixed_frame_operator(L: Complex, T: Complex, power: Reals, alpha: Reals) -> Complex:
    """Return L - alpha T, (turn, mode, mode)."""
    operator = polynomial(power, L)
    operator -= polynomial(alpha[:, None] * power, T)
    return operator


def _subtract_rotation(L: Complex, omega: Reals) -> None:
    """Subtract j Omega from L (turn, mode, mode), in place: into the frame that turns with the shaft."""
    i = np.arange(L.shape[1])
    L[:, i, i] -= 1j * omega[:, None]
